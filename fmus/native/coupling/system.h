/* The linear system of a coupled step: I - stiffness x mobility from matrices turned to the present orientations.

   The ports of a rigid body move as one, so that its mobility is a product: of what a wrench at its first port moves, and of
   the wrench that all wrenches on it are there. This is all the unknown that it has; a body that never moves has none. The
   wrenches on both follow from the motions of all. */

#ifndef FANFOLD_SYSTEM_H
#define FANFOLD_SYSTEM_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* LU factors of the matrices in use at the present orientations; `singular` where there are none. */
void system_assemble(Network *n);
/* How many unknowns the wrenches on a body have. */
size_t unknowns_of(const Participant *body, Width width);
/* Mobilities of all bodies at the present orientations. */
void system_turn_bodies(Network *n);
/* Correction of the wrenches by the chord Newton method; the residual itself where the matrix is singular. */
void system_direction(const Network *n, const double *residual, double *result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
