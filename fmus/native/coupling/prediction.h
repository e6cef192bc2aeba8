/* Wrenches extrapolated over the last accepted steps: where the iteration of the next step starts from. */

#ifndef FANFOLD_PREDICTION_H
#define FANFOLD_PREDICTION_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Remember the present wrenches as those of the step h with this mid-step time, slopes as rates; the oldest go. */
void history_add(Network *n, double middle, double h);
/* Forget the wrenches of steps before: something jumped. */
void history_clear(Network *n);
/* Wrenches that a step h with this mid-step time may start from: the polynomial through those remembered, or those
   accepted last. */
void predict(const Network *n, double middle, double h, double *result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
