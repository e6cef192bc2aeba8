/* One coupled step: wrenches at all ports on which both sides agree.

   The unknowns are the mean wrenches on bodies over the step, at order 4 with their slopes. The residual is what
   connections return for the motions under these wrenches, minus the wrenches. A chord Newton iteration on the
   interface Jacobian, improved by Broyden's update, finds its root. */

#ifndef FANFOLD_SOLVER_H
#define FANFOLD_SOLVER_H

#include "interface_jacobians.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* ready_step (s): size of the step whose matrices are factorised, NaN without. persistent: whether a slow damped
   iteration is made before giving up. predicted, start, step: work space for wrenches (size,) and for the matrix of any
   participant. */
typedef struct {
    Network *network;
    Jacobians jacobians;
    double ready_step, *predicted, *start, *step;
    int persistent;
} Solver;

/* How a solution ends; REFUSED: a participant failed, see network_fail. */
enum { CONVERGED, NOT_CONVERGED, REFUSED, NOT_FINITE, GOES_ON };

/* Evaluate connections anew at the next solve, as an event changed their laws. */
void forget_stiffnesses(Solver *s);
/* Evaluate all matrices anew at the next solve. */
void forget_all(Solver *s);
/* Find the wrenches of a step h (s) from a time (s) and the saved states. If it converges, participants stand at the
   end of the step. guess: start of the iteration, in no array of the network that iterations write to. */
int solve(Solver *s, double time, double h, const double *guess);
/* The same from the predicted wrenches. */
int solve_predicted(Solver *s, double time, double h);
/* Use the matrices of a step h (s) about the wrenches accepted last; participants then stand at its end. 0 if one
   fails. */
int linearize(Solver *s, double time, double h);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
