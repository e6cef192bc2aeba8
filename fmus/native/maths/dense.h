/* Linear equations with a full matrix (n, n), row by row: plain doubles, as factors of an iteration carry no derivative. */

#ifndef FANFOLD_DENSE_H
#define FANFOLD_DENSE_H

#include <math.h>
#include <stddef.h>

#include "real.h"

/* Factorises in place, rows exchanged as the pivots say. A pivot of zero leaves numbers that are not finite. */
FANFOLD_INLINED void factorise_dense(double *a, size_t n, unsigned short *pivots) {
    for (size_t j = 0; j < n; j++) {
        size_t best = j;
        for (size_t i = j + 1; i < n; i++)
            if (fabs(a[n * i + j]) > fabs(a[n * best + j])) best = i;
        pivots[j] = (unsigned short)best;
        if (best != j)
            for (size_t k = 0; k < n; k++) {
                double kept = a[n * j + k];
                a[n * j + k] = a[n * best + k];
                a[n * best + k] = kept;
            }
        const double scale = 1.0 / a[n * j + j];
        for (size_t i = j + 1; i < n; i++) {
            const double factor = a[n * i + j] *= scale;
            for (size_t k = j + 1; k < n; k++) a[n * i + k] -= factor * a[n * j + k];
        }
    }
}

/* Solves with such factors for `count` right sides, the columns of b. */
FANFOLD_INLINED void solve_dense(const double *a, size_t n, const unsigned short *pivots, double *b, size_t count) {
    for (size_t j = 0; j < n; j++)
        if (pivots[j] != j)
            for (size_t k = 0; k < count; k++) {
                double kept = b[count * j + k];
                b[count * j + k] = b[count * pivots[j] + k];
                b[count * pivots[j] + k] = kept;
            }
    for (size_t i = 1; i < n; i++)
        for (size_t j = 0; j < i; j++)
            for (size_t k = 0; k < count; k++) b[count * i + k] -= a[n * i + j] * b[count * j + k];
    for (size_t i = n; i-- > 0;) {
        for (size_t j = i + 1; j < n; j++)
            for (size_t k = 0; k < count; k++) b[count * i + k] -= a[n * i + j] * b[count * j + k];
        const double scale = 1.0 / a[n * i + i];
        for (size_t k = 0; k < count; k++) b[count * i + k] *= scale;
    }
}

#endif
