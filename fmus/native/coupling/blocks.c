/* LU factors of a block-sparse matrix, and solving with them. */

#include "blocks.h"

#include "dense_lu.h"

/* Blocks (rows, columns) of the factors as (columns, rows), for solving along the columns. */
static INLINE void transpose_blocks(Matrix *m) {
    for (const MatrixBlock *block = m->blocks; block < m->blocks + m->block_count; block++) {
        const size_t rows = m->begin[block->row_group + 1] - m->begin[block->row_group], columns = block->columns;
        const double *from = m->values + block->offset;
        double *to = m->transposed + block->offset;
        for (size_t i = 0; i < rows; i += CHUNK)
            for (size_t j = 0; j < columns; j++)
                for (size_t k = i; k < i + CHUNK; k++) to[j * rows + k] = from[k * columns + j];
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
    for (size_t first = 0, last = CHUNK; first < n; first = last, last += CHUNK) {
        solve_lower(t + first * n + first, 1, n, b + first, 1, 1);
        subtract_row(b + last, b + first, t + first * n + last, n, CHUNK, n - last);
    }
    for (size_t last = n, first; last > 0; last = first) {
        first = last - CHUNK;
        solve_upper(t + first * n + first, 1, n, b + first, 1, 1);
        subtract_row(b, b + first, t + first * n, n, CHUNK, first);
    }
}

VECTORISED void solve_blocks(const Matrix *m, double *b) {
    for (size_t k = 0; k < m->groups; k++) {
        double *own = b + m->begin[k];
        solve_vector(m->transposed + m->blocks[k].offset, m->begin[k + 1] - m->begin[k], m->pivots + m->begin[k], own);
        for (size_t l = m->lower_begin[k]; l < m->lower_begin[k + 1]; l++) {
            const MatrixBlock *below = m->blocks + m->lower[l];
            const size_t row = m->begin[below->row_group], rows = m->begin[below->row_group + 1] - row;
            subtract_row(b + row, own + below->first, m->transposed + below->offset, rows, below->columns, rows);
        }
    }
    for (size_t k = m->groups; k-- > 0;) {
        const size_t rows = m->begin[k + 1] - m->begin[k];
        for (size_t u = m->upper_begin[k]; u < m->upper_begin[k + 1]; u++) {
            const MatrixBlock *right = m->blocks + m->upper[u];
            subtract_row(b + m->begin[k], b + m->begin[right->column_group] + right->first,
                         m->transposed + right->offset, rows, right->columns, rows);
        }
    }
}
