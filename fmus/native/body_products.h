/* Products of a body's constant matrices with vectors over its modes: rows combined, and matrices of which only
   the triangle is kept. Most of the time of a step passes here. */

#ifndef FANFOLD_BODY_PRODUCTS_H
#define FANFOLD_BODY_PRODUCTS_H

#include <stddef.h>
#include <string.h>

#include "real.h"

/* Vectors have a multiple of this length, their surplus elements 0. */
#define FANFOLD_LANES 4

/* Loops that pay it are compiled for processors with fused multiply-add as well; glibc chooses at load time. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#define FANFOLD_VECTORISED __attribute__((target_clones("fma", "default")))
#else
#define FANFOLD_VECTORISED
#endif

static inline size_t padded(size_t count) { return (count + FANFOLD_LANES - 1) / FANFOLD_LANES * FANFOLD_LANES; }

/* out = sum of weight[k] times row k, for two sets of weights that share the rows; `count` rows of `length`
   numbers, both multiples of FANFOLD_LANES. */
FANFOLD_VECTORISED static void rows_combined_twice_double(const double *restrict rows, size_t count,
                                                          size_t length, const double *restrict weight,
                                                          const double *restrict other, double *restrict out,
                                                          double *restrict other_out) {
    for (size_t i = 0; i < length; i++) out[i] = other_out[i] = 0.0;
    for (size_t k = 0; k < count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        double v0 = other[k], v1 = other[k + 1], v2 = other[k + 2], v3 = other[k + 3];
        for (size_t i = 0; i < length; i++) {
            double r0 = row[i], r1 = row[length + i], r2 = row[2 * length + i], r3 = row[3 * length + i];
            out[i] += w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
            other_out[i] += v0 * r0 + v1 * r1 + v2 * r2 + v3 * r3;
        }
    }
}

/* The blocks of a (modes, modes) matrix that are kept when it equals its transpose, or minus it: those on and
   above the diagonal, of FANFOLD_LANES rows and columns each. */
static inline size_t triangle_size(size_t modes) {
    size_t blocks = modes / FANFOLD_LANES;
    return blocks * (blocks + 1) / 2 * FANFOLD_LANES * FANFOLD_LANES;
}

/* `parts` stacked matrices (m, m), each equal to `sign` times its transpose, as the blocks that are kept: by
   block row, then by part. A block holds, row by row, what its rows of the weight give to the columns; only the
   triangle is read. */
static inline void triangles_pack(const double *stacked, size_t parts, double sign, size_t m, double *blocks) {
    size_t n = padded(m);
    for (size_t first = 0; first < n; first += FANFOLD_LANES)
        for (size_t part = 0; part < parts; part++)
            for (size_t next = first; next < n; next += FANFOLD_LANES)
                for (size_t k = first; k < first + FANFOLD_LANES; k++)
                    for (size_t j = next; j < next + FANFOLD_LANES; j++, blocks++) {
                        const double *matrix = stacked + part * m * m;
                        if (k < m && j < m) *blocks = k <= j ? matrix[j * m + k] : sign * matrix[k * m + j];
                    }
}

/* GCC and Clang: so many doubles, computed with at once. Compilers do not vectorise the sums by themselves. */
typedef double Lanes __attribute__((vector_size(FANFOLD_LANES * sizeof(double))));

#ifdef __clang__
#define LANES_PICKED(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
typedef long long LaneNumbers __attribute__((vector_size(FANFOLD_LANES * sizeof(long long))));
#define LANES_PICKED(a, b, i, j, k, l) __builtin_shuffle(a, b, (LaneNumbers){i, j, k, l})
#endif

/* out = each of the matrices times weight; a block gives to its columns and, off the diagonal, to its rows. */
FANFOLD_VECTORISED static void triangles_combined_double(const double *restrict blocks, size_t parts, double sign,
                                                         size_t n, const double *restrict weight,
                                                         double *restrict out) {
    Lanes r0, r1, r2, r3, x, y;
    for (size_t i = 0; i < parts * n; i++) out[i] = 0.0;
    for (size_t k = 0; k < n; k += FANFOLD_LANES) {
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        for (size_t part = 0; part < parts; part++) {
            double *own = out + part * n;
            Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, s3 = {0.0}, diagonal = {0.0};
            for (size_t j = k; j < n; j += FANFOLD_LANES, blocks += FANFOLD_LANES * FANFOLD_LANES) {
                memcpy(&r0, blocks, sizeof r0);
                memcpy(&r1, blocks + FANFOLD_LANES, sizeof r1);
                memcpy(&r2, blocks + 2 * FANFOLD_LANES, sizeof r2);
                memcpy(&r3, blocks + 3 * FANFOLD_LANES, sizeof r3);
                if (j == k) {
                    diagonal = w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
                    continue;
                }
                memcpy(&x, weight + j, sizeof x);
                memcpy(&y, own + j, sizeof y);
                y += w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
                memcpy(own + j, &y, sizeof y);
                s0 += r0 * x;
                s1 += r1 * x;
                s2 += r2 * x;
                s3 += r3 * x;
            }
            /* the four sums over lanes, made at once */
            r0 = LANES_PICKED(s0, s1, 0, 4, 2, 6) + LANES_PICKED(s0, s1, 1, 5, 3, 7);
            r1 = LANES_PICKED(s2, s3, 0, 4, 2, 6) + LANES_PICKED(s2, s3, 1, 5, 3, 7);
            r2 = LANES_PICKED(r0, r1, 0, 1, 4, 5) + LANES_PICKED(r0, r1, 2, 3, 6, 7);
            memcpy(&y, own + k, sizeof y);
            y += diagonal + sign * r2;
            memcpy(own + k, &y, sizeof y);
        }
    }
}

#ifdef FANFOLD_COMPLEX

/* Values and slopes are two sets of weights; `split` holds 2 (count + length) doubles. */
static inline void rows_combined(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                 double *split) {
    double *value = split, *slope = value + count, *value_out = slope + count, *slope_out = value_out + length;
    for (size_t k = 0; k < count; k++) {
        value[k] = creal(weight[k]);
        slope[k] = cimag(weight[k]);
    }
    rows_combined_twice_double(rows, count, length, value, slope, value_out, slope_out);
    for (size_t i = 0; i < length; i++) out[i] = complex_of(value_out[i], slope_out[i]);
}

static inline void rows_combined_twice(const double *rows, size_t count, size_t length, const real *weight,
                                       const real *other, real *out, real *other_out, double *split) {
    rows_combined(rows, count, length, weight, out, split);
    rows_combined(rows, count, length, other, other_out, split);
}

/* `split` holds 2 (n + parts n) doubles. */
static inline void triangles_combined(const double *blocks, size_t parts, double sign, size_t n, const real *weight,
                                      real *out, double *split) {
    double *value = split, *slope = value + n, *value_out = slope + n, *slope_out = value_out + parts * n;
    for (size_t k = 0; k < n; k++) {
        value[k] = creal(weight[k]);
        slope[k] = cimag(weight[k]);
    }
    triangles_combined_double(blocks, parts, sign, n, value, value_out);
    triangles_combined_double(blocks, parts, sign, n, slope, slope_out);
    for (size_t i = 0; i < parts * n; i++) out[i] = complex_of(value_out[i], slope_out[i]);
}

#else

/* The same for one set of weights. */
FANFOLD_VECTORISED static void rows_combined_double(const double *restrict rows, size_t count, size_t length,
                                                    const double *restrict weight, double *restrict out) {
    for (size_t i = 0; i < length; i++) out[i] = 0.0;
    for (size_t k = 0; k < count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        for (size_t i = 0; i < length; i++)
            out[i] += w0 * row[i] + w1 * row[length + i] + w2 * row[2 * length + i] + w3 * row[3 * length + i];
    }
}

static inline void rows_combined(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                 double *split) {
    (void)split;
    rows_combined_double(rows, count, length, weight, out);
}

static inline void rows_combined_twice(const double *rows, size_t count, size_t length, const real *weight,
                                       const real *other, real *out, real *other_out, double *split) {
    (void)split;
    rows_combined_twice_double(rows, count, length, weight, other, out, other_out);
}

static inline void triangles_combined(const double *blocks, size_t parts, double sign, size_t n, const real *weight,
                                      real *out, double *split) {
    (void)split;
    triangles_combined_double(blocks, parts, sign, n, weight, out);
}

#endif

#endif
