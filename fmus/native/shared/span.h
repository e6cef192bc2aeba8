/* Connections with a force along the line between two ports, a law of their distance: the twin of
   components/numerics/span.py. A kernel defines the tension of an instant and the load of a step. */

#ifndef FANFOLD_SPAN_H
#define FANFOLD_SPAN_H

#include "connection.h"
#include "strand.h"

typedef struct Span {
    Connection base;
    Law law;
    Law table; /* added to the law; without pieces where there is none */
} Span;

static inline real span_value(const Span *self, real elongation) {
    real value = law_value(&self->law, elongation);
    return self->table.pieces ? value + law_value(&self->table, elongation) : value;
}

/* Centre line of an instant, its length and rate of change. */
typedef struct Instant {
    Vector3 span;
    real length, elongation, rate;
} Instant;

/* Tension of an instant, and load on the elongation over a step: by each kernel. */
static inline real span_tension(const Span *self, real elongation, real rate);
static inline MeanLoad span_load(const Span *self, const StepMotion *motion, int paired);

static inline Instant span_instant(const Span *self, const real *u) {
    Instant line;
    line.span = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    line.length = vector_norm(line.span);
    line.elongation = line.length - self->base.p[P_PRELOAD_LENGTH];
    line.rate = vector_dot(vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7)), line.span) / line.length;
    return line;
}

/* Wrenches on both ports from the force on the second one. */
static inline void store_force(Vector3 force, real *wrench) {
    for (int i = 0; i < 2 * WRENCH_SIZE; i++) wrench[i] = 0.0;
    vector_store(vector_scaled(-1.0, force), wrench);
    vector_store(force, wrench + WRENCH_SIZE);
}

/* What the length remembers of a step, and its rate. */
static inline void store_rates(const double *x, const StepMotion *motion, const Instant *now, int paired, int impulse,
                               real *x_next) {
    real rate = (motion->end - motion->start) / motion->h;
    if (impulse) {
        store_rate(now->rate, x_next + X_MEMORY);
        store_mid_step_start(now->rate, x_next + X_SLIDE);
    } else if (paired) {
        store_path(motion, x_next + X_MEMORY);
        store_mid_step_start(rate + 3.0 * motion->moment / motion->h, x_next + X_SLIDE);
    } else {
        store_memory(motion, now->rate, x_next + X_MEMORY);
        store_mid_step_after(x + X_SLIDE, rate, motion->h, x_next + X_SLIDE);
    }
}

/* One step: the mean tension of the lengths at both ends along the mean of the line. */
static inline int span_step(const Span *self, const double *x, const real *u, double h, real *x_next) {
    Instant now = span_instant(self, u);
    Vector3 old = {x[X_SPAN], x[X_SPAN + 1], x[X_SPAN + 2]};
    real length = vector_norm(old);
    const int impulse = commanded(u, U_IMPULSE), paired = self->base.paired && !impulse;
    Line line = line_between(old, now.span, 2.0 / (length + now.length));
    StepMotion motion = step_motion(x + X_MEMORY, length - self->base.p[P_PRELOAD_LENGTH], now.elongation, h);
    if (paired) {
        const real *moments = u + INPUTS;
        motion.moment = line_moment(&line, vector_subtract(vector_of(moments + WRENCH_SIZE), vector_of(moments)));
    }
    if (self->base.endpoint) leave_inertia_out(&motion);
    MeanLoad load = span_load(self, &motion, paired);
    Vector3 slope = {0.0, 0.0, 0.0};
    if (paired) slope = vector_scaled(load.slope * line.scale, line.mean);
    store_force(line_force(&line, -load.force, -load.slope), x_next + X_WRENCH);
    store_force(slope, x_next + X_SLOPES);
    store_rates(x, &motion, &now, paired, impulse, x_next);
    vector_store(now.span, x_next + X_SPAN);
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
static inline void span_outputs(const Span *self, const real *x, const real *u, real *y) {
    if (gives_means(&self->base, x, y)) return;
    Instant now = span_instant(self, u);
    store_force(vector_scaled(-span_tension(self, now.elongation, now.rate) / now.length, now.span), y);
}

/* Heat of the end-point tension. */
static inline int span_rates(const Span *self, const real *u, real *rates) {
    Instant now = span_instant(self, u);
    rates[0] = (span_tension(self, now.elongation, now.rate) + span_value(self, now.elongation)) * now.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

/* At the place of the inputs. */
static int span_initial(void *self, const double *u, double *x, Reason *why) {
    Instant now = span_instant(self, u);
    if (now.length < LEAST_SPAN)
        return refuse(why, "the ports of the " KIND " are at one point; its force has no direction");
    memset(x, 0, STATES * sizeof *x);
    vector_store(now.span, x + X_SPAN);
    store_mid_step_start(now.rate, x + X_SLIDE);
    store_rate(now.rate, x + X_MEMORY);
    return 1;
}

/* Length and tension at the communication point, and energies. */
static void span_observe(void *self, const double *x, const double *u, double *z) {
    const Span *spring = self;
    Instant now = span_instant(spring, u);
    z[Z_LENGTH] = now.length;
    z[Z_TENSION] = span_tension(spring, now.elongation, spring->base.endpoint ? now.rate : mid_step_now(x + X_SLIDE));
    z[Z_POTENTIAL_ENERGY] = law_potential(&spring->law, now.elongation);
    if (spring->table.pieces) z[Z_POTENTIAL_ENERGY] += law_potential(&spring->table, now.elongation);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

#endif

/* The functions that a kernel exports for both number types. */
#define SPAN_FUNCTIONS(name)                                                                                        \
    int NAME(name##_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {        \
        (void)why;                                                                                                  \
        return span_step(self, x, u, h, x_next);                                                                    \
    }                                                                                                               \
    void NAME(name##_outputs)(void *self, const real *x, const real *u, real *y) { span_outputs(self, x, u, y); }   \
    int NAME(name##_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {   \
        (void)raw, (void)x, (void)why;                                                                              \
        return span_rates(self, u, rates);                                                                          \
    }

#endif
