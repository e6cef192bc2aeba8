/* Mean force of a stiff linear coordinate over a step: the twin of components/_bushing.py, which says why.

   Two inertial terms of the size k h^2 damp what a held force would otherwise keep ringing; they only lose. */

#ifndef FANFOLD_BUSHING_H
#define FANFOLD_BUSHING_H

#include "real.h"

/* Motion of one coordinate over a step of size h, and what it remembers of the step before: its mean rate and
   its end rate as a held force on a rigid body gives it. */
typedef struct StepMotion {
    real start, end;
    double h, mean_rate, end_rate;
} StepMotion;

/* Mean force of a coordinate over a step, and the energy it turned to heat. */
typedef struct MeanLoad {
    real force, heat;
} MeanLoad;

/* The same motion counted from another origin. */
static inline StepMotion shifted_motion(StepMotion motion, real origin) {
    motion.start -= origin;
    motion.end -= origin;
    return motion;
}

/* The two inertial terms. */
static inline real inertial_force(double stiffness, const StepMotion *m) {
    real change = m->end - m->start;
    real from_mean = change - m->h * m->mean_rate, from_end = change - m->h * m->end_rate;
    return -stiffness * (0.20 * from_mean + 0.10 * from_end);
}

/* End rate to remember of a step with the given mean rate; `end_rate` is the true one. */
static inline real remembered_end_rate(real mean_rate, double previous, real end_rate) {
    real rigid = 2.0 * mean_rate - previous;
    return fabs(value_of(end_rate)) < fabs(value_of(rigid)) ? end_rate : rigid;
}

/* Mean force of spring, damper and inertial terms of one coordinate, and its heat. An end weight above one half
   (static solutions) weights the end value instead of adding inertial terms. */
static inline MeanLoad bushing_load(double stiffness, double damping, const StepMotion *m, double end_weight) {
    if (stiffness == 0.0 && damping == 0.0) return (MeanLoad){0.0, 0.0};
    real change = m->end - m->start;
    real extra = -damping * change / m->h;
    if (end_weight == 0.5)
        extra += inertial_force(stiffness, m);
    else
        extra -= stiffness * (end_weight - 0.5) * change;
    return (MeanLoad){-0.5 * stiffness * (m->start + m->end) + extra, -extra * change};
}

#endif
