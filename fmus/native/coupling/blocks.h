/* Block-sparse linear algebra over the connection graph: assembly of I - stiffness x mobility, LU, solving.

   Connections between the same bodies form a group; a group is eliminated at once, with pivoting inside it.
   Its unknowns are sorted by body, so what couples two groups is one range of columns. The structure comes from
   orchestrator/cosim/implicit/elimination.py and is trusted: nothing here checks an index. */

#ifndef FANFOLD_BLOCKS_H
#define FANFOLD_BLOCKS_H

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Loops that pay it are compiled for processors with fused multiply-add as well, with all that is INLINE in them;
   glibc chooses at load time. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#define VECTORISED __attribute__((target_clones("fma", "default")))
#define INLINE inline __attribute__((always_inline))
#else
#define VECTORISED
#define INLINE inline
#endif

/* Rows of a group, and the columns [first, first + columns) of another that they depend on. */
typedef struct {
    size_t row_group, column_group, first, columns, offset;
} MatrixBlock;

/* Where a 6 x 6 part of the matrix stands in `values`, and the distance between its rows. */
typedef struct {
    size_t offset, stride;
} Part;

/* Group g has the unknowns begin[g] .. begin[g + 1] - 1, and block g is its diagonal block. Lists by eliminated
   group k: blocks below the diagonal in column k, blocks right of it in row k, and for each pair of both the
   block that the product is taken from, in that order. */
typedef struct {
    size_t groups, block_count, size, length;
    const size_t *begin;
    const MatrixBlock *blocks;
    const size_t *lower_begin, *lower, *upper_begin, *upper, *targets;
    double *values, *transposed;
    size_t *pivots;
    double *ordered;
} Matrix;

/* Rows and columns that are taken at once; unknowns come in groups of six. */
enum { CHUNK = 6 };

/* c -= a b, with a (rows, inner), b (inner, columns), all row by row with the given distances between rows. */
static INLINE void subtract_product(double *restrict c, size_t c_stride, const double *restrict a, size_t a_stride,
                                    const double *restrict b, size_t b_stride, size_t rows, size_t inner,
                                    size_t columns) {
    const size_t whole = inner - inner % CHUNK;
    for (size_t i = 0; i < rows; i++) {
        double *restrict row = c + i * c_stride;
        const double *s = a + i * a_stride, *t = b;
        size_t k = 0;
        for (; k < whole; k += CHUNK, s += CHUNK, t += CHUNK * b_stride) { /* a row of c is loaded and stored once */
            const double s0 = s[0], s1 = s[1], s2 = s[2], s3 = s[3], s4 = s[4], s5 = s[5];
            const double *t1 = t + b_stride, *t2 = t1 + b_stride, *t3 = t2 + b_stride, *t4 = t3 + b_stride,
                         *t5 = t4 + b_stride;
            for (size_t j = 0; j < columns; j++)
                row[j] -= (s0 * t[j] + s1 * t1[j] + s2 * t2[j]) + (s3 * t3[j] + s4 * t4[j] + s5 * t5[j]);
        }
        for (; k < inner; k++, s++, t += b_stride)
            for (size_t j = 0; j < columns; j++) row[j] -= *s * t[j];
    }
}

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

/* LU factors of the assembled matrix in place; 0 where a group has no pivot. */
VECTORISED static int factorize_blocks(Matrix *m) {
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

/* Solve in place for a right-hand side in the order of elimination. */
VECTORISED static void solve_blocks(const Matrix *m, double *b) {
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

#endif
