/* The equations of an instance at its present values: whether they can be evaluated, and what they give.

   Everything returns 0 and a sentence where they cannot. */

#ifndef FANFOLD_EVALUATE_H
#define FANFOLD_EVALUATE_H

#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

double *evaluate_inputs(const Instance *instance);
/* Whether all numbers are finite; *bad is the first that is not. */
int evaluate_all_finite(const double *numbers, size_t count, size_t *bad);
int evaluate_state_finite(const Instance *instance, const double *x, Reason *why);
/* Whether the derivatives of unknowns, just computed, are finite: those at extreme inputs overflow. */
int evaluate_derivatives_finite(const Instance *instance, const uint32_t *unknowns, const double *result, size_t count,
                                Reason *why);

/* The state at the start, as long as initialization goes on. */
int evaluate_initial(Instance *instance, Reason *why);
/* Whether there are a state, checked parameters and finite inputs. */
int evaluate_ready(Instance *instance, Reason *why);
/* The state that equations are evaluated at: in model exchange the completed one. */
const double *evaluate_state(Instance *instance);
/* Continuous states and their rates, the latter at a state that is ready. */
void evaluate_states(const Instance *instance, double *states);
int evaluate_rates(Instance *instance, double *rates, Reason *why);

/* Bring values up to date: of outputs, of observations, of continuous states with their rates. */
int evaluate_outputs(Instance *instance, Reason *why);
int evaluate_observations(Instance *instance, Reason *why);
int evaluate_continuous(Instance *instance, Reason *why);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
