/* LU factors of a block-sparse matrix, and solving with them. */

#include "blocks.h"

#include <math.h>
#include <string.h>

static INLINE void swap_rows(double *a, size_t columns, size_t i, size_t j) {
    if (i == j) return;
    for (size_t k = 0; k < columns; k++) {
        const double kept = a[i * columns + k];
        a[i * columns + k] = a[j * columns + k];
        a[j * columns + k] = kept;
    }
}

static INLINE size_t chunk_end(size_t first, size_t n) { return first + CHUNK < n ? first + CHUNK : n; }

/* The columns [first, last) of the LU factors of a (n, n), those before being done; 0 where there is no pivot. */
static INLINE int factorize_columns(double *restrict a, size_t n, size_t first, size_t last, size_t *restrict pivots) {
    for (size_t k = first; k < last; k++) {
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
            for (size_t j = k + 1; j < last; j++) a[i * n + j] -= factor * a[k * n + j];
        }
    }
    return 1;
}

/* LU factors of a (n, n) in place, with the reciprocal pivots on the diagonal; 0 where there is no pivot. */
static INLINE int factorize(double *a, size_t n, size_t *pivots) {
    for (size_t first = 0, last; first < n; first = last) {
        last = chunk_end(first, n);
        const size_t rest = n - last;
        if (!factorize_columns(a, n, first, last, pivots)) return 0;
        double *right = a + first * n + last;
        for (size_t i = 1; i < last - first; i++)
            subtract_product(right + i * n, n, a + (first + i) * n + first, n, right, n, 1, i, rest);
        subtract_product(a + last * n + last, n, a + last * n + first, n, right, n, rest, last - first, rest);
    }
    return 1;
}

/* b := a^-1 b for b (n, columns). */
static INLINE void solve_dense(const double *restrict a, size_t n, const size_t *restrict pivots,
                               double *restrict b, size_t columns) {
    for (size_t k = 0; k < n; k++) swap_rows(b, columns, k, pivots[k]);
    for (size_t first = 0, last; first < n; first = last) {
        last = chunk_end(first, n);
        double *rows = b + first * columns;
        subtract_product(rows, columns, a + first * n, n, b, columns, last - first, first, columns);
        for (size_t i = 1; i < last - first; i++)
            subtract_product(rows + i * columns, columns, a + (first + i) * n + first, n, rows, columns, 1, i, columns);
    }
    for (size_t last = n, first; last > 0; last = first) {
        first = (last - 1) / CHUNK * CHUNK;
        subtract_product(b + first * columns, columns, a + first * n + last, n, b + last * columns, columns,
                         last - first, n - last, columns);
        for (size_t i = last; i-- > first;) {
            double *restrict row = b + i * columns;
            subtract_product(row, columns, a + i * n + i + 1, n, row + columns, columns, 1, last - i - 1, columns);
            for (size_t j = 0; j < columns; j++) row[j] *= a[i * n + i];
        }
    }
}

/* Blocks (rows, columns) of the factors as (columns, rows), for solving along the columns. */
static INLINE void transpose_blocks(Matrix *m) {
    for (const MatrixBlock *block = m->blocks; block < m->blocks + m->block_count; block++) {
        const size_t rows = m->begin[block->row_group + 1] - m->begin[block->row_group];
        const double *from = m->values + block->offset;
        double *to = m->transposed + block->offset;
        for (size_t i = 0; i < rows; i++, from += block->columns)
            for (size_t j = 0; j < block->columns; j++) to[j * rows + i] = from[j];
    }
}

VECTORISED int factorize_blocks(Matrix *m) {
    const size_t *target = m->targets;
    for (size_t k = 0; k < m->groups; k++) {
        const size_t n = m->begin[k + 1] - m->begin[k];
        double *diagonal = m->values + m->blocks[k].offset;
        if (!factorize(diagonal, n, m->pivots + m->begin[k])) return 0;
        for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
            const MatrixBlock *right = m->blocks + m->upper[u];
            solve_dense(diagonal, n, m->pivots + m->begin[k], m->values + right->offset, right->columns);
        }
        for (size_t l = m->lower_begin[k]; l < m->lower_begin[k + 1]; l++) {
            const MatrixBlock *below = m->blocks + m->lower[l];
            const size_t rows = m->begin[below->row_group + 1] - m->begin[below->row_group];
            for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
                const MatrixBlock *right = m->blocks + m->upper[u], *into = m->blocks + *target++;
                subtract_product(m->values + into->offset + right->first - into->first, into->columns,
                                 m->values + below->offset, below->columns,
                                 m->values + right->offset + below->first * right->columns, right->columns,
                                 rows, below->columns, right->columns);
            }
        }
    }
    transpose_blocks(m);
    return 1;
}

/* b := a^-1 b for one column, with the transposed factors of a. */
static INLINE void solve_vector(const double *restrict t, size_t n, const size_t *restrict pivots, double *restrict b) {
    for (size_t k = 0; k < n; k++) swap_rows(b, 1, k, pivots[k]);
    for (size_t first = 0, last; first < n; first = last) {
        last = chunk_end(first, n);
        for (size_t k = first; k < last; k++)
            for (size_t i = k + 1; i < last; i++) b[i] -= t[k * n + i] * b[k];
        subtract_product(b + last, n, b + first, n, t + first * n + last, n, 1, last - first, n - last);
    }
    for (size_t last = n, first; last > 0; last = first) {
        first = (last - 1) / CHUNK * CHUNK;
        for (size_t k = last; k-- > first;) {
            b[k] *= t[k * n + k];
            for (size_t i = first; i < k; i++) b[i] -= t[k * n + i] * b[k];
        }
        subtract_product(b, n, b + first, n, t + first * n, n, 1, last - first, first);
    }
}

VECTORISED void solve_blocks(const Matrix *m, double *b) {
    for (size_t k = 0; k < m->groups; k++) {
        double *own = b + m->begin[k];
        solve_vector(m->transposed + m->blocks[k].offset, m->begin[k + 1] - m->begin[k], m->pivots + m->begin[k], own);
        for (size_t l = m->lower_begin[k]; l < m->lower_begin[k + 1]; l++) {
            const MatrixBlock *below = m->blocks + m->lower[l];
            const size_t row = m->begin[below->row_group], rows = m->begin[below->row_group + 1] - row;
            subtract_product(b + row, rows, own + below->first, below->columns, m->transposed + below->offset, rows, 1,
                             below->columns, rows);
        }
    }
    for (size_t k = m->groups; k-- > 0;) {
        const size_t rows = m->begin[k + 1] - m->begin[k];
        for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
            const MatrixBlock *right = m->blocks + m->upper[u];
            subtract_product(b + m->begin[k], rows, b + m->begin[right->column_group] + right->first, right->columns,
                             m->transposed + right->offset, rows, 1, right->columns, rows);
        }
    }
}
