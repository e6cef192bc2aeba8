/* Inputs that are linear in time over a step: the first derivatives that a host gives, taken up by slope inputs.

   An input `name` with a partner `name_slope` is name + name_slope P1(t) over a step of size h, P1 = 2 t / h - 1. Its
   derivative r at the step's beginning therefore adds r h / 2 to both. Derivatives hold until others are set. */

#ifndef FANFOLD_INPUT_SLOPES_H
#define FANFOLD_INPUT_SLOPES_H

#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Which inputs have slopes, and room for their derivatives; 0 and a sentence where memory lacks. */
int input_slopes_create(Instance *instance, Reason *why);
/* Derivatives are zero again. */
void input_slopes_reset(Instance *instance);
Status input_slopes_set(Instance *instance, const uint32_t *references, size_t count, const int *orders,
                        const double *values);
/* Inputs as the equations take them over a step h: those that are set, with what derivatives add. */
const double *input_slopes_over_step(Instance *instance, double h);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
