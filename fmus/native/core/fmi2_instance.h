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

/* The body of a function that is a call of the core, of `instance`. */
#define CALLED(call)                                                                                             \
    Instance *instance = fmi2_instance_of(component);                                                            \
    return instance ? (fmi2Status)(call) : fmi2Error

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
