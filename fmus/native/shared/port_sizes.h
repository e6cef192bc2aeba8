/* Sizes of ports and of all that a kernel is given. */

#ifndef FANFOLD_PORT_SIZES_H
#define FANFOLD_PORT_SIZES_H

#include "kernel.h"

/* Scalars of the motion and of the wrench of one port; moments and slopes have as many as a wrench. */
enum { MOTION_SIZE = 13, WRENCH_SIZE = 6 };

/* Whether the flat arrays have the sizes that the equations write and read. */
static inline int check_sizes(const char *kind, const Sizes *sizes, const Sizes *own, Reason *why) {
    if (sizes->parameters == own->parameters && sizes->inputs == own->inputs && sizes->outputs == own->outputs &&
        sizes->observations == own->observations)
        return 1;
    return refuse(why, "the numbers of variables in the data are not those of this %s", kind);
}

#endif
