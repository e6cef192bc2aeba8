/* Declared variables of an instance: where they are, what they are called, and in which range they must be. */

#ifndef FANFOLD_LAYOUT_H
#define FANFOLD_LAYOUT_H

#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Sizes, ranges and start values from the data; 0 and a sentence where a variable lies outside of its group. */
int layout_read(Instance *instance, Reason *why);
/* Name of the scalar with a value reference below ends[3], with its index where the variable has several. */
void layout_scalar_name(const Instance *instance, uint32_t reference, char *name, size_t size);
/* Whether all parameters are finite and in their ranges; 0 and a sentence with the first that is not. */
int layout_ranges_hold(const Instance *instance, Reason *why);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
