/* Friction that sticks: an elastic deflection before sliding, whose force never exceeds the friction: the twin of
   components/numerics/presliding.py, which says why. */

#ifndef FANFOLD_PRESLIDING_H
#define FANFOLD_PRESLIDING_H

#include "real.h"

/* Force against the motion, its heat (over a step, or as power of an instant), deflection. */
typedef struct Presliding {
    real force, heat, deflection;
} Presliding;

/* The value, at most the limit in size. */
static inline real within(real value, real limit) {
    if (value_of(value) > value_of(limit)) return limit;
    if (value_of(value) < -value_of(limit)) return -limit;
    return value;
}

/* Mean force over a step of size h, with the deflection at its end. */
static inline Presliding step_force(double stiffness, double damping, real friction, real deflection, real change,
                                    double h) {
    const double side = value_of(change) >= 0.0 ? 1.0 : -1.0;
    const real limit = friction / stiffness, way = side * change, begin = side * within(deflection, limit);
    const real let_go = 0.5 * stiffness * (deflection * deflection - begin * begin);
    const real viscous = damping * way / h, sticking = (friction - viscous) / stiffness - begin;
    if (value_of(way) <= value_of(sticking)) {
        const real force = stiffness * (begin + 0.5 * way) + viscous;
        return (Presliding){-side * force, viscous * way + let_go, side * (begin + way)};
    }
    real force = friction, end = begin + way;
    if (value_of(sticking) > 0.0) force -= 0.5 * stiffness * sticking * (sticking / way);
    if (value_of(end) > value_of(limit)) end = limit;
    const real kept = 0.5 * stiffness * (end - begin) * (end + begin);
    return (Presliding){-side * force, force * way - kept + let_go, side * end};
}

/* Force of one instant. */
static inline Presliding instant_force(double stiffness, double damping, real friction, real deflection, real rate) {
    const real held = within(deflection, friction / stiffness);
    const real force = -within(stiffness * held + damping * rate, friction);
    const int slides = value_of(held) * value_of(rate) > 0.0 && stiffness * fabs(value_of(held)) >= value_of(friction);
    real heat = -force * rate;
    if (!slides) heat -= stiffness * held * rate;
    return (Presliding){force, heat, held};
}

#endif
