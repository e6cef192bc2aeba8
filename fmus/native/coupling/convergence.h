/* When the wrenches of a coupled step agree, and how the iteration towards them fares. */

#ifndef FANFOLD_CONVERGENCE_H
#define FANFOLD_CONVERGENCE_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

#define SLOW 0.15          /* contraction beyond which turning of matrices pays; probing costs several iterations */
#define DIVERGED 50.0
#define STEEPEST 0.9
#define NEAR 1e-2          /* largest relative correction of wrenches that are near a solution; beyond it they may be absurd */
#define CREDIBLE 1e12      /* largest residual over wrench at a solution; stiff joints leave up to 1e5, absurd motions 1e30 */
#define AGREED 300.0       /* largest residual over the tolerance of a correction that needs no further sweep */
#define OVERSHOT 0.5       /* part of the step before, and cosine against it, from which a correction takes it back */
#define ROUGH_STEP 1e-5    /* least relative correction that takes one back; smaller ones may be round-off of laws and joints */
enum {
    MOST_ITERATIONS = 14,
    MOST_HALVINGS = 24, /* of an iteration's steps: a way of a radian comes down to where friction of 1e-7 rad sticks */
    PATIENCE = 8        /* steps with slow contraction, though fast enough, after which probing pays for those to come */
};

/* What a correction of 1 means for every row, for wrenches of the size of `wrenches + change`. */
void set_scale(Network *n, const double *change);
/* Largest component and its row; infinite where one is not finite. */
double largest_of(const double *values, size_t size, size_t *row);
/* Whether the correction is small enough for the wrenches to be those of a solution nearby. */
int is_near(const Network *n);
/* Whether residuals are rounding: of motions times stiffness, and of the largest wrench itself, or as small as is asked. */
int is_within_round_off(const Network *n);
/* Whether wrenches like these can leave this residual; matrices of a motion gone astray correct nothing. */
int is_credible(const Network *n);
/* Whether a small correction needs no further sweep. */
int is_enough(const Network *n);
/* Whether the present contraction does not get there in the iterations that are left. */
int is_too_slow(const Network *n);
/* Whether a correction (size,), larger than round-off, takes back the step before without being smaller.

   Newton's method goes to and fro for ever between two branches of a law that bends within its steps, as friction does that
   slides on one side of where it sticks and on the other. */
int overshoots(const Network *n, const double *step);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
