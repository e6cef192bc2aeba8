/* Eddy-current damper between two ports, about their common axis: the twin of components/damper.py. */

#include "damper_layout.h"
#include "axial.h"

/* Torque on the outboard side against the rate: c w / (1 + (w / w_peak)^2), linear where no peak rate is given. */
static inline real damper_torque(const Axial *damper, real rate) {
    const double coefficient = damper->base.p[P_DAMPING_COEFFICIENT], peak_rate = damper->base.p[P_PEAK_RATE];
    if (peak_rate == 0.0) return -coefficient * rate;
    real ratio = rate / peak_rate;
    return -coefficient * rate / (1.0 + ratio * ratio);
}

/* One step: the torque along the path, at order 2 that of the mean rate, and the heat it makes. */
int NAME(damper_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Axial *damper = self;
    (void)why;
    const int impulse = commanded(u, U_IMPULSE), paired = damper->base.paired && !impulse;
    Turn turn = turn_of(damper, u, x[X_ANGLE], 0.0);
    Arc arc = arc_to(&turn, x, u, paired);
    real rates[2], torques[2];
    gauss_rates(arc.change, arc.moment, h, rates);
    for (int i = 0; i < 2; i++) torques[i] = damper_torque(damper, rates[i]);
    MeanLoad load = viscous_load(rates, torques, h);
    store_turn(&turn, x_next);
    store_load(&arc, &load, paired, x_next);
    store_mid_step_after(x + X_RATE, arc.change / h, h, x_next + X_RATE);
    if (paired) store_mid_step_start((arc.change + 3.0 * arc.moment) / h, x_next + X_RATE);
    if (impulse) store_mid_step_start(turn.rate, x_next + X_RATE);
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    return 1;
}

void NAME(damper_outputs)(void *self, const real *x, const real *u, real *y) {
    const Axial *damper = self;
    if (gives_means(&damper->base, x, y)) return;
    Turn turn = turn_of(damper, u, x[X_ANGLE], 0.0);
    store_torque(&turn, damper_torque(damper, turn.rate), y);
}

/* Heat of the end-point torque. */
int NAME(damper_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Axial *damper = self;
    (void)raw, (void)why;
    Turn turn = turn_of(damper, u, x[X_ANGLE], 0.0);
    rates[0] = -damper_torque(damper, turn.rate) * turn.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(damper)

static int damper_prepare(void *self, const double *p, Reason *why) {
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the pose of the inputs. */
static int damper_initial(void *self, const double *u, double *x, Reason *why) {
    const Axial *damper = self;
    (void)why;
    Turn turn = turn_of(damper, u, 0.0, 0.0);
    memset(x, 0, STATES * sizeof *x);
    store_turn(&turn, x);
    store_mid_step_start(turn.rate, x + X_RATE);
    return 1;
}

static void damper_observe(void *self, const double *x, const double *u, double *z) {
    const Axial *damper = self;
    const double rate = turn_of(damper, u, x[X_ANGLE], 0.0).rate;
    z[Z_ANGULAR_RATE] = rate;
    z[Z_DAMPER_TORQUE] = damper_torque(damper, damper->base.endpoint ? rate : mid_step_now(x + X_RATE));
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
}

const Kernel damper_kernel = {CONNECTION_FUNCTIONS(damper, axial)};

#endif
