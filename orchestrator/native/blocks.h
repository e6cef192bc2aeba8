/* Block-sparse linear algebra over the connection graph: assembly of I - stiffness x mobility, LU, solving.

   Connections between the same bodies form a group; a group is eliminated at once, with pivoting inside it.
   Its unknowns are sorted by body, so what couples two groups is one range of columns. The structure comes from
   orchestrator/elimination.py and is trusted: nothing here checks an index. */

#ifndef FANFOLD_BLOCKS_H
#define FANFOLD_BLOCKS_H

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Rows of a group, and the columns [first, first + columns) of another that they depend on. */
typedef struct {
    size_t row_group, column_group, first, columns, offset;
} Block;

/* Where a 6 x 6 part of the matrix stands in `values`, and the distance between its rows. */
typedef struct {
    size_t offset, stride;
} Part;

/* Group g has the unknowns begin[g] .. begin[g + 1] - 1, and block g is its diagonal block. Lists by eliminated
   group k: blocks below the diagonal in column k, blocks right of it in row k, and for each pair of both the
   block that the product is taken from, in that order. */
typedef struct {
    size_t groups, size, length;
    const size_t *begin;
    const Block *blocks;
    const size_t *lower_begin, *lower, *upper_begin, *upper, *targets;
    double *values;
    size_t *pivots;
    double *ordered;
} Matrix;

/* c -= a b, with a (rows, inner), b (inner, columns), all row by row with the given distances between rows. */
static void subtract_product(double *restrict c, size_t c_stride, const double *restrict a, size_t a_stride,
                             const double *restrict b, size_t b_stride, size_t rows, size_t inner,
                             size_t columns) {
    const size_t rest = inner % 4, whole = inner - rest;
    for (size_t i = 0; i < rows; i++) {
        double *restrict row = c + i * c_stride;
        for (size_t k = 0; k < whole; k += 4) { /* four at a time: a row of c is loaded and stored a quarter as often */
            const double *s = a + i * a_stride + k, *t = b + k * b_stride;
            const double s0 = s[0], s1 = s[1], s2 = s[2], s3 = s[3];
            const double *t1 = t + b_stride, *t2 = t1 + b_stride, *t3 = t2 + b_stride;
            for (size_t j = 0; j < columns; j++)
                row[j] -= s0 * t[j] + s1 * t1[j] + s2 * t2[j] + s3 * t3[j];
        }
        for (size_t k = whole; k < whole + rest; k++) {
            const double s = a[i * a_stride + k];
            const double *t = b + k * b_stride;
            for (size_t j = 0; j < columns; j++) row[j] -= s * t[j];
        }
    }
}

static void swap_rows(double *a, size_t columns, size_t i, size_t j) {
    if (i == j) return;
    for (size_t k = 0; k < columns; k++) {
        const double kept = a[i * columns + k];
        a[i * columns + k] = a[j * columns + k];
        a[j * columns + k] = kept;
    }
}

/* LU factors of a (n, n) in place, with the reciprocal pivots on the diagonal; 0 where there is no pivot. */
static int factorize(double *restrict a, size_t n, size_t *restrict pivots) {
    for (size_t k = 0; k < n; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
        pivots[k] = best;
        swap_rows(a, n, k, best);
        const double inverse = 1.0 / a[k * n + k];
        if (!isfinite(inverse)) return 0;
        a[k * n + k] = inverse;
        for (size_t i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] *= inverse;
            const double *restrict pivot_row = a + k * n;
            double *restrict row = a + i * n;
            for (size_t j = k + 1; j < n; j++) row[j] -= factor * pivot_row[j];
        }
    }
    return 1;
}

/* b := a^-1 b for b (n, columns). */
static void solve_dense(const double *restrict a, size_t n, const size_t *restrict pivots, double *restrict b,
                        size_t columns) {
    for (size_t k = 0; k < n; k++) swap_rows(b, columns, k, pivots[k]);
    for (size_t i = 1; i < n; i++) subtract_product(b + i * columns, columns, a + i * n, n, b, columns, 1, i, columns);
    for (size_t i = n; i-- > 0;) {
        double *restrict row = b + i * columns;
        subtract_product(row, columns, a + i * n + i + 1, n, row + columns, columns, 1, n - i - 1, columns);
        for (size_t j = 0; j < columns; j++) row[j] *= a[i * n + i];
    }
}

/* LU factors of the assembled matrix in place; 0 where a group has no pivot. */
static int factorize_blocks(Matrix *m) {
    const size_t *target = m->targets;
    for (size_t k = 0; k < m->groups; k++) {
        const size_t n = m->begin[k + 1] - m->begin[k];
        double *diagonal = m->values + m->blocks[k].offset;
        if (!factorize(diagonal, n, m->pivots + m->begin[k])) return 0;
        for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
            const Block *right = m->blocks + m->upper[u];
            solve_dense(diagonal, n, m->pivots + m->begin[k], m->values + right->offset, right->columns);
        }
        for (size_t l = m->lower_begin[k]; l < m->lower_begin[k + 1]; l++) {
            const Block *below = m->blocks + m->lower[l];
            const size_t rows = m->begin[below->row_group + 1] - m->begin[below->row_group];
            for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
                const Block *right = m->blocks + m->upper[u], *into = m->blocks + *target++;
                subtract_product(m->values + into->offset + right->first - into->first, into->columns,
                                 m->values + below->offset, below->columns,
                                 m->values + right->offset + below->first * right->columns, right->columns,
                                 rows, below->columns, right->columns);
            }
        }
    }
    return 1;
}

/* b[i] -= a[i] . x for a (rows, columns). */
static void subtract_times(double *restrict b, const double *restrict a, const double *restrict x, size_t rows,
                           size_t columns) {
    for (size_t i = 0; i < rows; i++) {
        const double *restrict row = a + i * columns;
        double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0; /* four sums at a time, which the processor overlaps */
        size_t j = 0;
        for (; j + 4 <= columns; j += 4) {
            s0 += row[j] * x[j];
            s1 += row[j + 1] * x[j + 1];
            s2 += row[j + 2] * x[j + 2];
            s3 += row[j + 3] * x[j + 3];
        }
        for (; j < columns; j++) s0 += row[j] * x[j];
        b[i] -= (s0 + s1) + (s2 + s3);
    }
}

/* b := a^-1 b for one column. */
static void solve_vector(const double *a, size_t n, const size_t *pivots, double *b) {
    for (size_t k = 0; k < n; k++) swap_rows(b, 1, k, pivots[k]);
    for (size_t i = 1; i < n; i++) subtract_times(b + i, a + i * n, b, 1, i);
    for (size_t i = n; i-- > 0;) {
        subtract_times(b + i, a + i * n + i + 1, b + i + 1, 1, n - i - 1);
        b[i] *= a[i * n + i];
    }
}

/* Solve in place for a right-hand side in the order of elimination. */
static void solve_blocks(const Matrix *m, double *b) {
    for (size_t k = 0; k < m->groups; k++) {
        double *own = b + m->begin[k];
        solve_vector(m->values + m->blocks[k].offset, m->begin[k + 1] - m->begin[k], m->pivots + m->begin[k], own);
        for (size_t l = m->lower_begin[k]; l < m->lower_begin[k + 1]; l++) {
            const Block *below = m->blocks + m->lower[l];
            const size_t row = m->begin[below->row_group];
            subtract_times(b + row, m->values + below->offset, own + below->first,
                           m->begin[below->row_group + 1] - row, below->columns);
        }
    }
    for (size_t k = m->groups; k-- > 0;) {
        for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
            const Block *right = m->blocks + m->upper[u];
            subtract_times(b + m->begin[k], m->values + right->offset,
                           b + m->begin[right->column_group] + right->first, m->begin[k + 1] - m->begin[k],
                           right->columns);
        }
    }
}

/* Rotation matrix (3, 3) of the unit quaternion of a port's motion. */
static void axes_of(const double *motion, double *axes) {
    const double w = motion[3], x = motion[4], y = motion[5], z = motion[6];
    axes[0] = 1.0 - 2.0 * (y * y + z * z), axes[1] = 2.0 * (x * y - w * z), axes[2] = 2.0 * (x * z + w * y);
    axes[3] = 2.0 * (x * y + w * z), axes[4] = 1.0 - 2.0 * (x * x + z * z), axes[5] = 2.0 * (y * z - w * x);
    axes[6] = 2.0 * (x * z - w * y), axes[7] = 2.0 * (y * z + w * x), axes[8] = 1.0 - 2.0 * (x * x + y * y);
}

/* A matrix (rows, columns) of 3-vectors over 3-vectors, turned from the axes `before` to those of `motion`. */
static void turn(const double *restrict matrix, const double *before, const double *motion, size_t rows,
                 size_t columns, double *restrict turned) {
    double now[9], t[9];
    axes_of(motion, now);
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            t[3 * i + j] = now[3 * i] * before[3 * j] + now[3 * i + 1] * before[3 * j + 1] +
                           now[3 * i + 2] * before[3 * j + 2];
    for (size_t row = 0; row < rows; row += 3) {
        const double *a = matrix + row * columns, *b = a + columns, *c = b + columns;
        for (size_t i = 0; i < 3; i++) {
            double *out = turned + (row + i) * columns;
            const double t0 = t[3 * i], t1 = t[3 * i + 1], t2 = t[3 * i + 2];
            for (size_t j = 0; j < columns; j++) out[j] = t0 * a[j] + t1 * b[j] + t2 * c[j];
            for (size_t j = 0; j < columns; j += 3) {
                const double p = out[j], q = out[j + 1], r = out[j + 2];
                out[j] = p * t[0] + q * t[1] + r * t[2];
                out[j + 1] = p * t[3] + q * t[4] + r * t[5];
                out[j + 2] = p * t[6] + q * t[7] + r * t[8];
            }
        }
    }
}

#endif
