/* A strand or spring that only pulls, with a damper that never pushes and is none where it is slack: the twin of
   components/numerics/strand.py. */

#ifndef FANFOLD_STRAND_H
#define FANFOLD_STRAND_H

#include "workless.h"

/* Tension of an instant. */
static inline real tension_at(const Law *strand, double damping, real elongation, real rate) {
    real elastic = -law_value(strand, elongation);
    if (!(value_of(elastic) > 0.0)) return 0.0;
    return above(elastic + damping * rate, 0.0);
}

/* Heat of the damper at an instant. */
static inline real damping_power(const Law *strand, double damping, real elongation, real rate) {
    return (tension_at(strand, damping, elongation, rate) + law_value(strand, elongation)) * rate;
}

/* Mean tension over a step between two elongations; adds to the heat. */
static inline real mean_tension(const Law *strand, double damping, real before, real after, double h, real *heat) {
    real plain = law_mean_force(strand, before, after);
    real tension = above(-plain + damping * taut_share(strand, before, after) * ((after - before) / h), 0.0);
    *heat += (tension + plain) * (after - before);
    return tension;
}

/* Load on the elongation at order 4; damping never turns the mean tension into a push. */
static inline MeanLoad strand_load(const Law *strand, double damping, const StepMotion *m) {
    real elastic = -workless_law(strand, 0.0, m, 0.0).force, change = m->end - m->start;
    real acting = damping * taut_share(strand, m->start, m->end);
    if (value_of(change) < 0.0 && value_of(elastic * m->h) < value_of(-acting * change))
        acting = above(elastic, 0.0) * m->h / -change;
    return workless_law(strand, acting, m, 0.0);
}

#endif
