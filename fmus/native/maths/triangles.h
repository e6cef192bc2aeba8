/* Stacked matrices that equal their transpose, or minus it: of each only the triangle is kept, in blocks of
   FANFOLD_LANES rows and columns, and of these only the ones that are not all zero. The modes of a body with planes of
   symmetry fall into classes of which few pairs interact; with the modes of a class next to each other
   most blocks vanish, and a chain of bodies stays in the cache. */

#ifndef FANFOLD_TRIANGLES_H
#define FANFOLD_TRIANGLES_H

#include "body_products.h"
#include "kernel.h"

enum { TRIANGLE_BLOCK = FANFOLD_LANES * FANFOLD_LANES };

/* Successive blocks of one part in one row of blocks: the row's first mode, and the number of blocks. */
typedef struct {
    unsigned short part, row, count;
} TriangleRun;

/* `blocks` run by run, `columns` the first mode of the columns of each. A block holds, row by row, what its rows
   of the weight give to the columns. */
typedef struct {
    size_t parts, modes, runs;
    double sign;
    TriangleRun *run;
    unsigned short *columns;
    double *blocks;
} Triangles;

/* out = each of the matrices times weight; a block gives to its columns and, off the diagonal, to its rows. */
FANFOLD_VECTORISED static void triangles_combined_double(const Triangles *triangles, const double *restrict weight,
                                                         double *restrict out) {
    const double *restrict blocks = triangles->blocks;
    const unsigned short *column = triangles->columns;
    size_t n = triangles->modes;
    Lanes r0, r1, r2, r3, x, y;
    for (size_t i = 0; i < triangles->parts * n; i++) out[i] = 0.0;
    for (const TriangleRun *run = triangles->run, *end = run + triangles->runs; run < end; run++) {
        size_t k = run->row;
        double *own = out + run->part * n;
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, s3 = {0.0};
        size_t left = run->count;
        if (*column == k) { /* the diagonal comes first, and most often alone */
            memcpy(&r0, blocks, sizeof r0);
            memcpy(&r1, blocks + FANFOLD_LANES, sizeof r1);
            memcpy(&r2, blocks + 2 * FANFOLD_LANES, sizeof r2);
            memcpy(&r3, blocks + 3 * FANFOLD_LANES, sizeof r3);
            memcpy(&y, own + k, sizeof y);
            y += w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
            memcpy(own + k, &y, sizeof y);
            blocks += TRIANGLE_BLOCK;
            column++;
            if (--left == 0) continue;
        }
        for (; left > 0; left--, blocks += TRIANGLE_BLOCK) {
            size_t j = *column++;
            memcpy(&r0, blocks, sizeof r0);
            memcpy(&r1, blocks + FANFOLD_LANES, sizeof r1);
            memcpy(&r2, blocks + 2 * FANFOLD_LANES, sizeof r2);
            memcpy(&r3, blocks + 3 * FANFOLD_LANES, sizeof r3);
            memcpy(&x, weight + j, sizeof x);
            memcpy(&y, own + j, sizeof y);
            y += w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
            memcpy(own + j, &y, sizeof y);
            s0 += r0 * x;
            s1 += r1 * x;
            s2 += r2 * x;
            s3 += r3 * x;
        }
        LANES_SUM(x, s0, s1, s2, s3);
        memcpy(&y, own + k, sizeof y);
        y += triangles->sign * x;
        memcpy(own + k, &y, sizeof y);
    }
}

#ifdef FANFOLD_COMPLEX

/* `split` holds 2 (modes + parts modes) doubles. */
static inline void triangles_combined(const Triangles *triangles, const real *weight, real *out, double *split) {
    size_t n = triangles->modes, length = triangles->parts * n;
    double *value = split, *slope = value + n, *value_out = slope + n, *slope_out = value_out + length;
    values_and_slopes(weight, n, value, slope);
    triangles_combined_double(triangles, value, value_out);
    triangles_combined_double(triangles, slope, slope_out);
    joined(value_out, slope_out, length, out);
}

#else

static inline void triangles_combined(const Triangles *triangles, const real *weight, real *out, double *split) {
    (void)split;
    triangles_combined_double(triangles, weight, out);
}

/* Matrices (m, m), one after the other, each equal to `sign` times its transpose; only one triangle is read. Mode j
   here is mode order[j] there. */
typedef struct {
    const double *stacked;
    size_t parts, m;
    double sign;
    const unsigned short *order;
} StackedMatrices;

/* What mode k of the weight gives to mode j, k and j below padded(m). */
static double triangle_entry(const StackedMatrices *from, size_t part, size_t k, size_t j) {
    if (k >= from->m || j >= from->m) return 0.0;
    const double *matrix = from->stacked + part * from->m * from->m;
    size_t row = from->order[k], column = from->order[j];
    return k <= j ? matrix[column * from->m + row] : from->sign * matrix[row * from->m + column];
}

/* Copies a block; whether it has something else than zeros. */
static int triangle_block(const StackedMatrices *from, size_t part, size_t row, size_t column, double *block) {
    int found = 0;
    for (size_t k = 0; k < FANFOLD_LANES; k++)
        for (size_t j = 0; j < FANFOLD_LANES; j++, block++) {
            *block = triangle_entry(from, part, row + k, column + j);
            found |= *block != 0.0;
        }
    return found;
}

/* Counts what is kept, and stores it where there is room: each array is NULL or large enough. */
static void triangles_sweep(Triangles *made, const StackedMatrices *from, size_t *kept) {
    double block[TRIANGLE_BLOCK];
    made->runs = *kept = 0;
    for (size_t row = 0; row < made->modes; row += FANFOLD_LANES)
        for (size_t part = 0; part < made->parts; part++) {
            TriangleRun run = {(unsigned short)part, (unsigned short)row, 0};
            for (size_t column = row; column < made->modes; column += FANFOLD_LANES) {
                if (!triangle_block(from, part, row, column, block)) continue;
                if (made->columns) made->columns[*kept] = (unsigned short)column;
                if (made->blocks) memcpy(made->blocks + TRIANGLE_BLOCK * *kept, block, sizeof block);
                run.count++;
                ++*kept;
            }
            if (run.count && made->run) made->run[made->runs] = run;
            made->runs += run.count > 0;
        }
}

/* Makes the triangles of matrices of at most 1024 modes; 0 without memory. */
static int triangles_create(Triangles *made, const StackedMatrices *from, Memory *memory) {
    size_t kept = 0;
    *made = (Triangles){from->parts, padded(from->m), 0, from->sign, NULL, NULL, NULL};
    triangles_sweep(made, from, &kept);
    made->run = allocate(memory, (made->runs + 1) * sizeof *made->run);
    made->columns = allocate(memory, (kept + 1) * sizeof *made->columns);
    made->blocks = allocate(memory, (kept * TRIANGLE_BLOCK + 1) * sizeof *made->blocks);
    if (!made->run || !made->columns || !made->blocks) return 0;
    triangles_sweep(made, from, &kept);
    return 1;
}

/* Modes in an order that puts those of one class next to each other: by which modes they interact with, as the
   pattern of the matrices tells. */
static int interacts_before(const StackedMatrices *from, size_t a, size_t b) {
    size_t size = from->m * from->m;
    for (size_t part = 0; part < from->parts; part++)
        for (size_t j = 0; j < from->m; j++) {
            int of_a = from->stacked[part * size + a * from->m + j] != 0.0;
            int of_b = from->stacked[part * size + b * from->m + j] != 0.0;
            if (of_a != of_b) return of_a < of_b;
        }
    return 0;
}

static void order_by_interaction(const StackedMatrices *from, unsigned short *order) {
    for (size_t i = 0; i < from->m; i++) {
        size_t place = i;
        for (; place > 0 && interacts_before(from, i, order[place - 1]); place--) order[place] = order[place - 1];
        order[place] = (unsigned short)i;
    }
}

#endif
#endif
