/* Suspension: a spring that only pulls, along the line between two points: the twin of components/suspension.py. */

#include "suspension_layout.h"
#include "connection.h"
#include "strand.h"

typedef struct Suspension {
    Connection base;
    Law spring;
} Suspension;

/* Centre line of an instant, its length and rate of change. */
typedef struct Instant {
    Vector3 span;
    real length, rate;
} Instant;

static inline Instant suspension_instant(const real *u) {
    Instant line;
    line.span = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    line.length = vector_norm(line.span);
    line.rate = vector_dot(vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7)), line.span) / line.length;
    return line;
}

/* Tension of an instant. */
static inline real tension_of(const Suspension *suspension, real elongation, real rate) {
    return tension_at(&suspension->spring, suspension->base.p[P_DAMPING], elongation, rate);
}

/* Wrenches on both ports from the force on the lower one. */
static inline void store_force(Vector3 force, real *wrench) {
    for (int i = 0; i < 2 * WRENCH_SIZE; i++) wrench[i] = 0.0;
    vector_store(vector_scaled(-1.0, force), wrench);
    vector_store(force, wrench + WRENCH_SIZE);
}

/* Mean force of the lengths at both ends along the mean of the line; adds to the heat. */
static inline Vector3 mean_force(const Suspension *suspension, Vector3 old, const Instant *now, double h, real *heat) {
    real length = vector_norm(old);
    real before = length - suspension->base.p[P_PRELOAD_LENGTH], after = now->length - suspension->base.p[P_PRELOAD_LENGTH];
    real tension = mean_tension(&suspension->spring, suspension->base.p[P_DAMPING], before, after, h,
                                heat);
    return vector_scaled(-tension / (length + now->length), vector_add(old, now->span));
}

/* One step: the mean tension of the lengths at both ends along the mean of the line. */
int NAME(suspension_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Suspension *suspension = self;
    (void)why;
    Instant now = suspension_instant(u);
    Vector3 old = {x[X_SPAN], x[X_SPAN + 1], x[X_SPAN + 2]}, force, slope = {0.0, 0.0, 0.0};
    real length = vector_norm(old), rate = (now.length - length) / h, heat = 0.0;
    const int impulse = commanded(u, U_IMPULSE);
    if (suspension->base.paired && !impulse) {
        const real *moments = u + INPUTS;
        double preload = suspension->base.p[P_PRELOAD_LENGTH];
        Line line = line_between(old, now.span, 2.0 / (length + now.length));
        real moment = line_moment(&line, vector_subtract(vector_of(moments + WRENCH_SIZE), vector_of(moments)));
        StepMotion motion = {length - preload, now.length - preload, h, 0.0, 0.0, 0.0, moment};
        MeanLoad load = strand_load(&suspension->spring, suspension->base.p[P_DAMPING], &motion);
        force = line_force(&line, -load.force, -load.slope);
        slope = vector_scaled(load.slope * line.scale, line.mean);
        heat = load.heat;
        store_mid_step_start(rate + 3.0 * moment / h, x_next + X_SLIDE);
    } else {
        force = mean_force(suspension, old, &now, h, &heat);
        if (impulse)
            store_mid_step_start(now.rate, x_next + X_SLIDE);
        else
            store_mid_step_after(x + X_SLIDE, rate, h, x_next + X_SLIDE);
    }
    vector_store(now.span, x_next + X_SPAN);
    x_next[X_HEAT] = x[X_HEAT] + heat;
    store_force(force, x_next + X_WRENCH);
    store_force(slope, x_next + X_SLOPES);
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
void NAME(suspension_outputs)(void *self, const real *x, const real *u, real *y) {
    const Suspension *suspension = self;
    if (gives_means(&suspension->base, x, y)) return;
    Instant now = suspension_instant(u);
    real tension = tension_of(suspension, now.length - suspension->base.p[P_PRELOAD_LENGTH], now.rate);
    store_force(vector_scaled(-tension / now.length, now.span), y);
}

/* Heat of the end-point tension. */
int NAME(suspension_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Suspension *suspension = self;
    (void)raw, (void)x, (void)why;
    Instant now = suspension_instant(u);
    real elongation = now.length - suspension->base.p[P_PRELOAD_LENGTH];
    rates[0] = damping_power(&suspension->spring, suspension->base.p[P_DAMPING], elongation, now.rate);
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(suspension)

static void *suspension_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    return create_connection(data, sizes, memory, sizeof(Suspension), states, why);
}

static int suspension_prepare(void *self, const double *p, Reason *why) {
    Suspension *suspension = self;
    suspension->spring = strand_law(p[P_STIFFNESS], p[P_PRELOAD]);
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the place of the inputs. */
static int suspension_initial(void *self, const double *u, double *x, Reason *why) {
    (void)self;
    Instant now = suspension_instant(u);
    if (now.length == 0.0)
        return refuse(why, "the ports of the suspension are at one point; it hangs along no line");
    memset(x, 0, STATES * sizeof *x);
    vector_store(now.span, x + X_SPAN);
    store_mid_step_start(now.rate, x + X_SLIDE);
    return 1;
}

/* Length and tension at the communication point, and energies. */
static void suspension_observe(void *self, const double *x, const double *u, double *z) {
    const Suspension *suspension = self;
    Instant now = suspension_instant(u);
    double elongation = now.length - suspension->base.p[P_PRELOAD_LENGTH];
    z[Z_LENGTH] = now.length;
    z[Z_TENSION] = tension_of(suspension, elongation, suspension->base.endpoint ? now.rate : mid_step_now(x + X_SLIDE));
    z[Z_POTENTIAL_ENERGY] = law_potential(&suspension->spring, elongation);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
}

const Kernel suspension_kernel = {CONNECTION_FUNCTIONS(suspension, suspension)};

#endif
