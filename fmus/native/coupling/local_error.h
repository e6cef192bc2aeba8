/* Local error of a coupled step from the curvature of its wrenches.

   The mean wrench over a step of size h errs by h^2 u''/12, less the part that slopes represent. The work of this error
   on the motion that it causes, over an energy, is the square of a relative error in velocity. The bend is twelve times
   the error. */

#ifndef FANFOLD_LOCAL_ERROR_H
#define FANFOLD_LOCAL_ERROR_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Square of the relative error of velocities by the bend of wrenches: its work over an energy (J), or the largest of
   the watched loads. Errors that solutions leave in it do not count. NaN with too few points. */
double error_square(Network *n, double middle, double h, double energy);
/* Work (J) of a change of mean wrenches (size,) on the motion that it causes, by the turned mobilities. */
double work_of(const Network *n, const double *change);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
