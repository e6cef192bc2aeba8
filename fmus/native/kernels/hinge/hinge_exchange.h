/* Model exchange of hinges in end-point mode. Belongs to hinge.c, of either number type.

   Continuous states are the three dissipated energies; the angle's turns are counted from one completed step of
   the solver to the next, and commands act at events. */

#ifndef FANFOLD_HINGE_EXCHANGE_H
#define FANFOLD_HINGE_EXCHANGE_H

#include "hinge_step.h"

/* Heat of friction, latch and damping. */
int NAME(hinge_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Hinge *hinge = self;
    (void)raw, (void)why;
    Motion now = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    Grip grip = present_grip(x, u);
    move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], now.coordinates[HINGE_ANGLE], &grip);
    Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
    for (int i = 0; i < HEAT_CAUSES; i++) rates[i] = loads.heat[i];
    return 1;
}

#ifndef FANFOLD_COMPLEX

/* Angle left up to where the latch engages by itself; one where it does not. */
static size_t hinge_indicators(void *self, const double *x, const double *u, double *indicators) {
    const Hinge *hinge = self;
    size_t count = hinge->latch_kind != NONE_LATCH;
    if (!indicators || !count) return count;
    Grip grip = present_grip(x, u);
    indicators[0] = 1.0;
    if (awaits_latch(hinge, &grip))
        indicators[0] =
            hinge->base.p[P_LATCH_ANGLE] - hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]).coordinates[HINGE_ANGLE];
    return count;
}

/* Follows the angle; at an event commands act, and a latch that is reached engages at its angle. */
static void hinge_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const Hinge *hinge = self;
    Motion now = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    memcpy(x_next, x, STATES * sizeof *x);
    store_motion(&now, x_next);
    Grip present = present_grip(x, u);
    move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], now.coordinates[HINGE_ANGLE], &present);
    if (!present.failed)
        x_next[X_PRESLIDING] = endpoint_loads(hinge, &present, now.coordinates, now.rates).friction.deflection;
    if (!at_event) return;
    Grip grip = commanded_grip(hinge, x_next, u);
    if (grip.failed) {
        store_failure(hinge, x_next, now.coordinates, x_next);
        return;
    }
    latch_if_reached(hinge, &grip, now.coordinates[HINGE_ANGLE] >= hinge->base.p[P_LATCH_ANGLE] - REACHED);
    store_grip(&grip, x_next);
    x_next[X_LATCH_HEAT] += grip.lost;
}

#endif
#endif
