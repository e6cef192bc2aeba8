/* When the wrenches of a coupled step agree, and how the iteration towards them fares. */

#ifndef FANFOLD_CONVERGENCE_H
#define FANFOLD_CONVERGENCE_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

#define SLOW 0.15          /* contraction above which turned matrices pay; new ones cost several iterations */
#define DIVERGED 50.0
#define STEEPEST 0.9
#define NEAR 1e-2          /* largest relative correction near a solution; beyond it wrenches may be absurd */
#define CREDIBLE 1e12      /* largest residual over wrench at a solution: stiff joints 1e5, absurd motions 1e30 */
#define AGREED 300.0       /* largest residual over the tolerance of a correction that needs no further sweep */
#define OVERSHOT 0.5       /* share of the last step, and cosine against it, from which a correction reverses it */
#define ROUGH_STEP 1e-5    /* least relative correction that reverses a step; smaller ones may be round-off */
enum {
    MOST_ITERATIONS = 14,
    MOST_HALVINGS = 24, /* in one iteration: from a radian down to 1e-7 rad, where friction sticks */
    PATIENCE = 8        /* slow but sufficient contractions after which new matrices pay for steps to come */
};

/* Set the unit of a correction in every row, for wrenches of the size of `wrenches + change`. */
void set_scale(Network *n, const double *change);
/* Largest component and its row; infinite where one is not finite. */
double largest_of(const double *values, size_t size, size_t *row);
/* Whether the correction is so small that a solution is near. */
int is_near(const Network *n);
/* Whether residuals are round-off, of motions times stiffness or of the largest wrench, or below
   `tolerance.residual`. */
int is_within_round_off(const Network *n);
/* Whether wrenches of this size can leave this residual; matrices of absurd motions correct nothing. */
int is_credible(const Network *n);
/* Whether a correction below 1 needs no further sweep. */
int is_enough(const Network *n);
/* Whether the present contraction is too slow for the iterations that are left. */
int is_too_slow(const Network *n);
/* Whether a correction (size,) takes back the step before without being smaller.

   Newton's method alternates for ever between two branches of a law that bends within its steps, as friction does
   between sticking and sliding. */
int overshoots(const Network *n, const double *step);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
