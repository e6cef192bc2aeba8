/* A participant as the coupling calls it, by functions like those of FMI 2.0, and the derivatives of its last step in the
   coordinates of its ports. */

#ifndef FANFOLD_PARTICIPANT_H
#define FANFOLD_PARTICIPANT_H

#include <stddef.h>

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { WRENCH = 6, POSE = 6, RATES = 6, MOMENTS = 6, MOTION = 13 };
enum { FMI_WARNING = 1, FMI_FATAL = 4 };

typedef int SetReal(void *, const unsigned *, size_t, const double *);
typedef int GetReal(void *, const unsigned *, size_t, double *);
typedef int DoStep(void *, double, double, int);
typedef int GetState(void *, void **);
typedef int SetState(void *, void *);
typedef int FreeState(void *, void **);
typedef int PortStiffness(void *, size_t, double *);
typedef int Derivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, double *);

#include "records.h"

/* Numbers of a port: of its wrench, with slope, and of its motion as coordinates: pose, moments, rates. */
typedef struct {
    size_t wrench, coordinates;
} Width;

Width width_of(int with_slopes);

/* Derivative of a body's motions (coordinates, wrenches) by its wrenches over the step just made; slope: room for all
   outputs. FMI status. */
int participant_mobility(const Participant *p, Width width, double *matrix, double *slope);
/* Derivative of a connection's wrenches (wrenches, coordinates) by its motions over the step just made; slope: room for
   all outputs. FMI status. */
int participant_stiffness(const Participant *p, Width width, double *matrix, double *slope);
/* The same at once; 0 where a participant does not offer that. */
int participant_stiffness_at_once(const Participant *p, Width width, double *matrix);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
