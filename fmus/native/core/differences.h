/* Derivatives that complex equations do not give: of observations, and of everything during initialization. */

#ifndef FANFOLD_DIFFERENCES_H
#define FANFOLD_DIFFERENCES_H

#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Unknowns whose derivatives are exact: two ranges of value references, each up to but not including its end. */
typedef struct {
    size_t first[2], end[2];
} ExactRanges;

int is_exact(const ExactRanges *exact, uint32_t unknown);

/* Fills the derivatives of all other unknowns along `seed` of the knowns, by central differences. */
Status differences_fill(Instance *instance, const ExactRanges *exact, const uint32_t *unknowns, size_t unknown_count,
                        const uint32_t *knowns, size_t known_count, const double *seed, double *result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
