/* The coupled step, fmus/native/coupling/coupled_step.h, as the library that orchestrator/cosim/native/library.py loads. */

#define _POSIX_C_SOURCE 200112L

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#include "coupled_step.h"

/* Bytes of the structures, by which Python knows that it means the same. */
EXPORT void coupling_sizes(size_t *sizes) {
    sizes[0] = sizeof(Participant);
    sizes[1] = sizeof(Network);
    sizes[2] = sizeof(Loop);
}

/* Mobility (coordinates, wrenches) of the step just made; slope: room for all outputs. FMI status. */
EXPORT int coupling_mobility(const Participant *p, double *matrix, double *slope, int with_slopes) {
    return mobility_of(p, width_of(with_slopes), matrix, slope);
}

/* Stiffness (wrenches, coordinates) of the step just made; slope: room for all outputs. FMI status. */
EXPORT int coupling_stiffness(const Participant *p, double *matrix, double *slope, int with_slopes) {
    return stiffness_of(p, width_of(with_slopes), matrix, slope);
}

/* The same where the participant gives it at once; 1 or 0. */
EXPORT int coupling_stiffness_at_once(const Participant *p, double *matrix, int with_slopes) {
    return stiffness_at_once(p, width_of(with_slopes), matrix);
}
