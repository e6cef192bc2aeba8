/* Products and LU factors of dense matrices, inlined where they are used. Sizes are multiples of six. */

#ifndef FANFOLD_DENSE_LU_H
#define FANFOLD_DENSE_LU_H

#include <math.h>

#include "blocks.h"

/* Rows and columns that are processed at once; unknowns come in groups of six. */
enum { CHUNK = 6 };

/* c -= a b for one row of c, with b (inner, columns) row by row with a given distance between rows. */
static INLINE void subtract_row(double *restrict c, const double *restrict a, const double *restrict b,
                                size_t b_stride, size_t inner, size_t columns) {
    for (size_t k = 0; k < inner; k += CHUNK, a += CHUNK, b += CHUNK * b_stride) { /* c is loaded and stored once */
        const double a0 = a[0], a1 = a[1], a2 = a[2], a3 = a[3], a4 = a[4], a5 = a[5];
        const double *b1 = b + b_stride, *b2 = b1 + b_stride, *b3 = b2 + b_stride, *b4 = b3 + b_stride,
                     *b5 = b4 + b_stride;
        for (size_t j = 0; j < columns; j++)
            c[j] -= (a0 * b[j] + a1 * b1[j] + a2 * b2[j]) + (a3 * b3[j] + a4 * b4[j] + a5 * b5[j]);
    }
}

/* Vectors of GCC and Clang, anywhere in memory. */
typedef double Pair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));
typedef double Quad __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

/* The same for CHUNK rows and columns of c, whose sums stay in registers; all have distances between rows. */
static INLINE void subtract_tile(double *restrict c, size_t c_stride, const double *restrict a, size_t a_stride,
                                 const double *restrict b, size_t b_stride, size_t inner) {
    Quad sum[CHUNK] = {{0.0}};
    Pair rest[CHUNK] = {{0.0}};
    for (size_t k = 0; k < inner; k++, b += b_stride) {
        const Quad right = *(const Quad *)b;
        const Pair last = *(const Pair *)(b + 4);
        for (size_t i = 0; i < CHUNK; i++) {
            sum[i] += a[i * a_stride + k] * right;
            rest[i] += a[i * a_stride + k] * last;
        }
    }
    for (size_t i = 0; i < CHUNK; i++) {
        *(Quad *)(c + i * c_stride) -= sum[i];
        *(Pair *)(c + i * c_stride + 4) -= rest[i];
    }
}

/* The same for a (rows, inner) and b (inner, columns). */
static INLINE void subtract_product(double *restrict c, size_t c_stride, const double *restrict a, size_t a_stride,
                                    const double *restrict b, size_t b_stride, size_t rows, size_t inner,
                                    size_t columns) {
    for (size_t i = 0; i < rows; i += CHUNK)
        for (size_t j = 0; j < columns; j += CHUNK)
            subtract_tile(c + i * c_stride + j, c_stride, a + i * a_stride, a_stride, b + j, b_stride, inner);
}

static INLINE void swap_rows(double *a, size_t columns, size_t i, size_t j) {
    if (i == j) return;
    for (size_t k = 0; k < columns; k++) {
        const double kept = a[i * columns + k];
        a[i * columns + k] = a[j * columns + k];
        a[j * columns + k] = kept;
    }
}

/* b := a^-1 b for CHUNK rows of b, by the unit lower triangle of a, whose entries lie `down` and `right` apart. */
static INLINE void solve_lower(const double *restrict a, size_t down, size_t right, double *restrict b, size_t stride,
                               size_t columns) {
    double *b1 = b + stride, *b2 = b1 + stride, *b3 = b2 + stride, *b4 = b3 + stride, *b5 = b4 + stride;
    const double *a1 = a + down, *a2 = a1 + down, *a3 = a2 + down, *a4 = a3 + down, *a5 = a4 + down;
    for (size_t j = 0; j < columns; j++) {
        const double x0 = b[j], x1 = b1[j] - a1[0] * x0, x2 = b2[j] - a2[0] * x0 - a2[right] * x1;
        const double x3 = b3[j] - a3[0] * x0 - a3[right] * x1 - a3[2 * right] * x2;
        const double x4 = b4[j] - a4[0] * x0 - a4[right] * x1 - a4[2 * right] * x2 - a4[3 * right] * x3;
        b5[j] -= a5[0] * x0 + a5[right] * x1 + a5[2 * right] * x2 + a5[3 * right] * x3 + a5[4 * right] * x4;
        b1[j] = x1, b2[j] = x2, b3[j] = x3, b4[j] = x4;
    }
}

/* The same by the upper triangle, whose diagonal holds reciprocals. */
static INLINE void solve_upper(const double *restrict a, size_t down, size_t right, double *restrict b, size_t stride,
                               size_t columns) {
    double *b1 = b + stride, *b2 = b1 + stride, *b3 = b2 + stride, *b4 = b3 + stride, *b5 = b4 + stride;
    const double *a1 = a + right, *a2 = a1 + right, *a3 = a2 + right, *a4 = a3 + right, *a5 = a4 + right;
    for (size_t j = 0; j < columns; j++) {
        const double x5 = b5[j] * a5[5 * down], x4 = (b4[j] - a5[4 * down] * x5) * a4[4 * down];
        const double x3 = (b3[j] - a5[3 * down] * x5 - a4[3 * down] * x4) * a3[3 * down];
        const double x2 = (b2[j] - a5[2 * down] * x5 - a4[2 * down] * x4 - a3[2 * down] * x3) * a2[2 * down];
        const double x1 = (b1[j] - a5[down] * x5 - a4[down] * x4 - a3[down] * x3 - a2[down] * x2) * a1[down];
        b[j] = (b[j] - a5[0] * x5 - a4[0] * x4 - a3[0] * x3 - a2[0] * x2 - a1[0] * x1) * a[0];
        b1[j] = x1, b2[j] = x2, b3[j] = x3, b4[j] = x4, b5[j] = x5;
    }
}

/* CHUNK columns of the LU factors of a (n, n) from `first` on, those before being done; 0 where there is no pivot. */
static INLINE int factorize_columns(double *restrict a, size_t n, size_t first, size_t *restrict pivots) {
    for (size_t k = first; k < first + CHUNK; k++) {
        size_t best = k;
        double right[CHUNK];
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
        pivots[k] = best;
        swap_rows(a, n, k, best);
        const double inverse = 1.0 / a[k * n + k];
        if (!isfinite(inverse)) return 0;
        a[k * n + k] = inverse;
        for (size_t j = 0; j < CHUNK; j++) right[j] = first + j > k ? a[k * n + first + j] : 0.0;
        for (size_t i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] *= inverse;
            for (size_t j = 0; j < CHUNK; j++) a[i * n + first + j] -= factor * right[j];
        }
    }
    return 1;
}

/* LU factors of a (n, n) in place, with the reciprocal pivots on the diagonal; 0 where there is no pivot. */
static INLINE int factorize(double *a, size_t n, size_t *pivots) {
    for (size_t first = 0, last = CHUNK; first < n; first = last, last += CHUNK) {
        if (!factorize_columns(a, n, first, pivots)) return 0;
        double *right = a + first * n + last;
        const double *below = a + last * n + first;
        solve_lower(a + first * n + first, n, 1, right, n, n - last);
        subtract_product(a + last * n + last, n, below, n, right, n, n - last, CHUNK, n - last);
    }
    return 1;
}

/* b := a^-1 b for b (n, columns). */
static INLINE void solve_dense(const double *restrict a, size_t n, const size_t *restrict pivots,
                               double *restrict b, size_t columns) {
    for (size_t k = 0; k < n; k++) swap_rows(b, columns, k, pivots[k]);
    for (size_t first = 0; first < n; first += CHUNK) {
        double *rows = b + first * columns;
        subtract_product(rows, columns, a + first * n, n, b, columns, CHUNK, first, columns);
        solve_lower(a + first * n + first, n, 1, rows, columns, columns);
    }
    for (size_t last = n, first; last > 0; last = first) {
        first = last - CHUNK;
        double *rows = b + first * columns;
        subtract_product(rows, columns, a + first * n + last, n, b + last * columns, columns, CHUNK, n - last, columns);
        solve_upper(a + first * n + first, n, 1, rows, columns, columns);
    }
}

#endif
