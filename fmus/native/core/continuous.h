/* The continuous states of an instance: for model exchange, and as variables to look at in co-simulation too.

   In model exchange the instance's state array holds them as the solver set them; equations see the completed
   state. The values of states and rates stand behind the observations. */

#ifndef FANFOLD_CONTINUOUS_H
#define FANFOLD_CONTINUOUS_H

#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Checks numbers of states and indicators against the equations; 0 and a sentence where they differ. */
int continuous_create(Instance *instance, Reason *why);
/* Makes a new instance one for model exchange; 0, with the reason logged, when it cannot. */
int continuous_use(Instance *instance);

/* Any finite time: solvers look beyond the stop time. */
Status continuous_set_time(Instance *instance, double time);
Status continuous_set_states(Instance *instance, const double *states, size_t count);
Status continuous_get_states(Instance *instance, double *states, size_t count);
Status continuous_get_nominals(Instance *instance, double *nominals, size_t count);
/* STATUS_DISCARD where they are not finite. */
Status continuous_get_rates(Instance *instance, double *rates, size_t count);
Status continuous_get_indicators(Instance *instance, double *indicators, size_t count);

Status continuous_enter_event_mode(Instance *instance);
Status continuous_enter_continuous_time_mode(Instance *instance);
Status continuous_update_discrete_states(Instance *instance);
/* Time until a law of the component changes its form, INFINITY for never. */
double continuous_time_to_break(Instance *instance);
/* Ends a step of the solver; `event` tells whether an event was stepped over. STATUS_ERROR, and nothing changes, for
   a step that ends after the stop time. */
Status continuous_complete_step(Instance *instance, int *event);

/* Derivative of outputs and rates along `seed` of inputs and states. */
Status continuous_derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count,
                             const uint32_t *knowns, size_t known_count, const double *seed, double *result);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
