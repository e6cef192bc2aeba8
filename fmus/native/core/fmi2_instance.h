/* What is behind an fmi2Component. */

#ifndef FANFOLD_FMI2_INSTANCE_H
#define FANFOLD_FMI2_INSTANCE_H

#include "fmi2.h"
#include "instance.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* The instance; NULL for none. */
Instance *fmi2_instance_of(fmi2Component component);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
