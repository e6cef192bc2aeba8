/* Block-sparse linear algebra over the connection graph: assembly of I - stiffness x mobility, LU, solving.

   Connections between the same bodies form a group; a group is eliminated at once, with pivoting inside it.
   Its unknowns are sorted by body, so what couples two groups is one range of columns. The structure comes from
   orchestrator/cosim/elimination.py and is trusted: nothing here checks an index. */

#ifndef FANFOLD_BLOCKS_H
#define FANFOLD_BLOCKS_H

#include <stddef.h>
#include <string.h> /* tells, too, whether this is the GNU C library */

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

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

/* LU factors of the assembled matrix in place; 0 where a group has no pivot. */
int factorize_blocks(Matrix *m);
/* Solve in place for a right-hand side in the order of elimination. */
void solve_blocks(const Matrix *m, double *b);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
