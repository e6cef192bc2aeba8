/* One coupled step: wrenches at all ports for which both sides agree.

   The unknown are the mean wrenches that bodies take over the step, at order 4 with their slopes. Residual: wrenches that the
   connections return for the motions that the wrenches cause, minus the wrenches. A chord Newton iteration on the interface
   Jacobian, sharpened by Broyden's update. */

#ifndef FANFOLD_SOLVER_H
#define FANFOLD_SOLVER_H

#include "interface_jacobians.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* ready_step: size (s) of the step whose matrices are factorised, not a number for none. persistent: whether a slow damped
   iteration is made before giving up. predicted, start, step: room for wrenches (size,) and for the matrix of any
   participant. */
typedef struct {
    Network *network;
    Jacobians jacobians;
    double ready_step, *predicted, *start, *step;
    int persistent;
} Solver;

/* How a step is solved; REFUSED where a participant cannot, see network_fail. */
enum { CONVERGED, NOT_CONVERGED, REFUSED, NOT_FINITE, GOES_ON };

/* Laws changed (an event): evaluate connections anew at the next solve. */
void forget_stiffnesses(Solver *s);
/* Keep nothing but what a step starts from. */
void forget_all(Solver *s);
/* Find the wrenches of the step h from a time, from the saved states; participants end stepped where it converges. guess:
   no array of the network that iterations write. */
int solve(Solver *s, double time, double h, const double *guess);
/* The same from what the steps before lead to expect. */
int solve_predicted(Solver *s, double time, double h);
/* Have the matrices of a step h in use, about the wrenches accepted last; participants end stepped. 0 where they cannot. */
int linearize(Solver *s, double time, double h);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
