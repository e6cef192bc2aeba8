/* Mean force of a stiff linear coordinate over a step: the twin of components/numerics/stiff_coordinate.py, which says why.

   Two inertial terms of the size k h^2 damp what a held force would otherwise keep ringing; they only lose. */

#ifndef FANFOLD_BUSHING_H
#define FANFOLD_BUSHING_H

#include "real.h"
#include "scheme.h"

/* Motion of one coordinate over a step of size h, and what it remembers of the step before: its mean rate and
   its end rate as a held force on a rigid body gives it, or at order 4 as its path has it, and how rough it went.
   moment: of its rate, the integral of P1 s' dt with P1 = 2 t / h - 1, for laws of order 4. */
typedef struct StepMotion {
    real start, end;
    double h, mean_rate, end_rate, roughness;
    real moment;
} StepMotion;

/* Mean force of a coordinate over a step, its heat, what the scheme took away, and the coefficient of P1 of the
   force, zero at order 2. */
typedef struct MeanLoad {
    real force, heat, numerical, slope;
} MeanLoad;

/* The same motion counted from another origin. */
static inline StepMotion shifted_motion(StepMotion motion, real origin) {
    motion.start -= origin;
    motion.end -= origin;
    return motion;
}

/* What a coordinate keeps of the step before in the state of its component. */
enum { MEAN_RATE, END_RATE, ROUGHNESS, MEMORY_SIZE };

/* Motion from one coordinate to another, after the step that `memory` tells of. */
static inline StepMotion step_motion(const double *memory, real start, real end, double h) {
    return (StepMotion){start, end, h, memory[MEAN_RATE], memory[END_RATE], memory[ROUGHNESS], 0.0};
}

/* Leaves inertial terms out: they tame held forces, which those of an end point are not. */
static inline void leave_inertia_out(StepMotion *m) {
    m->mean_rate = m->end_rate = value_of(m->end - m->start) / m->h;
}

/* After an impulse only the rate of its end is known. */
static inline void store_rate(real rate, real *memory) {
    memory[MEAN_RATE] = memory[END_RATE] = rate;
    memory[ROUGHNESS] = 0.0;
}

/* The two inertial terms. */
static inline real inertial_force(double stiffness, const StepMotion *m) {
    real change = m->end - m->start;
    real from_mean = change - m->h * m->mean_rate, from_end = change - m->h * m->end_rate;
    return -stiffness * (OF_INCREMENTS * from_mean + 2.0 * OF_RATES * from_end);
}

/* Keeps what a coordinate remembers of a step at order 2; `end_rate` is the true rate at its end. */
static inline void store_memory(const StepMotion *m, real end_rate, real *memory) {
    real mean = (m->end - m->start) / m->h;
    real rigid = 2.0 * mean - m->end_rate, ahead = 1.5 * mean - 0.5 * m->mean_rate;
    real bound = fabs(value_of(end_rate)) < fabs(value_of(ahead)) ? ahead : end_rate;
    memory[MEAN_RATE] = mean;
    memory[END_RATE] = fabs(value_of(bound)) < fabs(value_of(rigid)) ? bound : rigid;
    memory[ROUGHNESS] = 0.0;
}

/* Mean load with a damper and inertial terms beside the mean elastic force. */
static inline MeanLoad damped_load(real elastic, double stiffness, double damping, const StepMotion *m) {
    real change = m->end - m->start;
    real viscous = -damping * change / m->h, numerical = inertial_force(stiffness, m);
    return (MeanLoad){elastic + viscous + numerical, -viscous * change, -numerical * change, 0.0};
}

/* Mean load of spring, damper and inertial terms of one coordinate. */
static inline MeanLoad bushing_load(double stiffness, double damping, const StepMotion *m) {
    if (stiffness == 0.0 && damping == 0.0) return (MeanLoad){0.0, 0.0, 0.0, 0.0};
    return damped_load(-0.5 * stiffness * (m->start + m->end), stiffness, damping, m);
}

#endif
