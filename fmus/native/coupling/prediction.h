/* Wrenches extrapolated over the last accepted steps: where the iteration of the next step starts from. */

#ifndef FANFOLD_PREDICTION_H
#define FANFOLD_PREDICTION_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Remember the present wrenches, with slopes as rates, as those of a step h (s) with the mid-step time `middle` (s).
   The oldest ones are dropped. */
void history_add(Network *n, double middle, double h);
/* Forget all remembered wrenches, as something jumped. */
void history_clear(Network *n);
/* Wrenches from which the iteration of a step h (s) with the mid-step time `middle` (s) starts: the polynomial through
   the remembered ones, or without any those accepted last. */
void predict(const Network *n, double middle, double h, double *result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
