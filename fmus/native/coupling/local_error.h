/* Local error of a coupled step from the curvature of its wrenches.

   The mean over a step of size h errs by a twelfth of h^2 u'', less the part that slopes cover. The work of such wrenches on
   the motion that they cause, over an energy, is the square of a relative error in velocity. */

#ifndef FANFOLD_LOCAL_ERROR_H
#define FANFOLD_LOCAL_ERROR_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Square of the relative error that what bends wrenches makes of velocities: its work over an energy (J), or what it is at
   a watched load. What errors left by the solutions have in it does not count; not a number with fewer points. */
double error_square(Network *n, double middle, double h, double energy);
/* Work (J) that a change of mean wrenches (size,) does on the motion it causes, by the turned mobilities. */
double work_of(const Network *n, const double *change);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
