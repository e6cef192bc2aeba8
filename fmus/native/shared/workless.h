/* Force of a coordinate that is linear in time over a step: the twin of components/numerics/fourth_order_correction.py, which
   says why. */

#ifndef FANFOLD_WORKLESS_H
#define FANFOLD_WORKLESS_H

#include "bushing.h"
#include "laws.h"

/* Load of a discrete gradient, a tangent of its law and a damper over a step; numerical damping of the slope by the
   roughness. */
static inline MeanLoad workless_load(real elastic, real tangent, real damping, const StepMotion *m,
                                     double roughness) {
    real change = m->end - m->start, numerical = 0.0;
    if (value_of(tangent) > 0.0) numerical = NUMERICAL_DAMPING * tangent * m->h * roughness;
    real mean = change / m->h, slope = 3.0 * m->moment / m->h;
    real square = mean * change + slope * m->moment;
    return (MeanLoad){
        elastic + 0.5 * tangent * m->moment - damping * mean,
        damping * square,
        numerical * slope * m->moment,
        -0.5 * tangent * change - (damping + numerical) * slope,
    };
}

/* Load of a linear spring and a damper, with numerical damping. */
static inline MeanLoad workless_spring(double stiffness, double damping, const StepMotion *m) {
    if (stiffness == 0.0 && damping == 0.0) return (MeanLoad){0.0, 0.0, 0.0, 0.0};
    return workless_load(-0.5 * stiffness * (m->start + m->end), stiffness, damping, m, m->roughness);
}

/* Load of any law and a damper. */
static inline MeanLoad workless_law(const Law *law, real damping, const StepMotion *m, double roughness) {
    return workless_load(law_mean_force(law, m->start, m->end), law_tangent(law, m->start, m->end), damping, m,
                         roughness);
}

/* Rates at the two points of Gauss' rule along a rate that is linear in time. */
static inline void gauss_rates(real change, real moment, double h, real rates[2]) {
    real mean = change / h, bend = sqrt(3.0) * moment / h;
    rates[0] = mean - bend;
    rates[1] = mean + bend;
}

/* Load of a law of the rate that only brakes, from its forces at those rates. */
static inline MeanLoad viscous_load(const real rates[2], const real forces[2], double h) {
    real heat = -0.5 * h * (forces[0] * rates[0] + forces[1] * rates[1]);
    return (MeanLoad){0.5 * (forces[0] + forces[1]), heat, 0.0, 0.5 * sqrt(3.0) * (forces[1] - forces[0])};
}

/* Keeps what a coordinate remembers of a step of order 4. */
static inline void store_path(const StepMotion *m, real *memory) {
    real change = m->end - m->start, bend = 3.0 * m->moment;
    real begin = (change - bend) / m->h, end = (change + bend) / m->h;
    real jump = (begin - m->end_rate) / (real_abs(begin) + real_abs(end) + fabs(m->end_rate) + LEAST_RATE);
    memory[MEAN_RATE] = change / m->h;
    memory[END_RATE] = end;
    memory[ROUGHNESS] = m->roughness + ROUGHNESS_SHARE * (jump * jump - m->roughness);
}

#endif
