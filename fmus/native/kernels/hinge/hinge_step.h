/* One step of a hinge and what it gives out: part of hinge.c, of either number type. */

#ifndef FANFOLD_HINGE_STEP_H
#define FANFOLD_HINGE_STEP_H

#include "hinge_loads.h"

static inline void store_motion(const Motion *motion, real *x) {
    quaternion_store(motion->frame, x + FRAME);
    vector_store(motion->gap, x + GAP);
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        x[COORDINATES + i] = motion->coordinates[i];
        x[RATES + i] = motion->rates[i];
    }
}

static inline void store_grip(const Grip *grip, real *x) {
    x[LATCHED] = grip->latched;
    x[LATCHED_ANGLE] = grip->latched_angle;
    x[HOLDING] = grip->holding;
    x[HOLD_ANGLE] = grip->hold_angle;
}

/* What the coordinates remember of the step. */
static inline void store_memories(const Hinge *hinge, const double *x, const Motion *new, const StepMotion *motions,
                                  double h, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        real *mean_rate = x_next + MEAN_RATES + i, *end_rate = x_next + END_RATES + i;
        x_next[ROUGHNESS + i] = 0.0;
        if (hinge->paired)
            remember_path(motions + i, mean_rate, end_rate, x_next + ROUGHNESS + i);
        else
            remember_rates(motions + i, new->rates[i], mean_rate, end_rate);
    }
    store_mid_step_after(x + SLIDE, x_next[MEAN_RATES + HINGE_ANGLE], h, x_next + SLIDE);
}

/* After an impulse only the rates of its end are known. */
static inline void store_rates_after_impulse(const Motion *new, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        x_next[MEAN_RATES + i] = x_next[END_RATES + i] = new->rates[i];
        x_next[ROUGHNESS + i] = 0.0;
    }
    store_mid_step_start(new->rates[HINGE_ANGLE], x_next + SLIDE);
}

static inline void store_load(const double *old, const MeanLoad *load, double h, real *x_next) {
    store_mid_step_slope_after(old, load->force, load->slope, h, x_next);
}

/* Loads and hinge rate of order 4 with one step more; the latch torque begins where the latch engages. */
static inline void store_loads(const Hinge *hinge, const double *x, const Grip *grip, const StepMotion *motions,
                               const StiffLoads *loads, double h, real *x_next) {
    const StepMotion *turn = motions + HINGE_ANGLE;
    for (int i = 0; i < COORDINATE_COUNT; i++)
        store_load(x + load_place(i), &loads->bushing[i], h, x_next + load_place(i));
    if (latch_acts(hinge, grip))
        store_load(x + load_place(LATCH_LOAD), &loads->latch, h, x_next + load_place(LATCH_LOAD));
    store_mid_step_slope_after(x + SLIDING, (turn->end - turn->start) / h, 3.0 * turn->moment / h, h,
                               x_next + SLIDING);
}

/* Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule. */
static inline void endpoint_step(const Hinge *hinge, const double *x, Grip *grip, const Motion *new, double h,
                                 real *x_next) {
    latch_if_reached(hinge, grip, value_of(new->coordinates[HINGE_ANGLE]) >= hinge->latch_angle);
    Loads loads = endpoint_loads(hinge, grip, new->coordinates, new->rates);
    for (int i = MEAN_RATES; i < HEAT; i++) x_next[i] = x[i];
    for (int i = NUMERICAL; i < STATES; i++) x_next[i] = x[i];
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[HEAT + i] = x[HEAT + i] + 0.5 * h * (x[POWER + i] + loads.heat[i]);
        x_next[POWER + i] = loads.heat[i];
    }
}

/* Motions of the six coordinates; at order 4 with the moments of their rates. */
static inline void step_motions(const Hinge *hinge, const double *x, const real *u, const Motion *new,
                                const Passage *passage, double h, StepMotion *motions) {
    Rates m = {{0.0, 0.0, 0.0}, 0.0, {0.0, 0.0}};
    if (hinge->paired) m = rate_moments(passage, u + hinge->moments, mean_swing(x, new));
    const real moments[COORDINATE_COUNT] = {m.offset.x, m.offset.y, m.offset.z, m.twist, m.swing.y, m.swing.z};
    for (int i = 0; i < COORDINATE_COUNT; i++) motions[i] = step_motion(x, new, i, moments[i], h);
}

/* Wrench and heat of mean loads. */
static inline void mean_step(const Hinge *hinge, const double *x, const real *u, Grip *grip, const Motion *new,
                             double h, real *x_next) {
    Passage passage = {
        {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]}, new->frame, {x[GAP], x[GAP + 1], x[GAP + 2]}, new->gap,
    };
    Loads loads;
    for (int i = LOADS; i < SLIDING; i++) x_next[i] = 0.0;
    store_mid_step_slope_start(new->rates[HINGE_ANGLE], x_next + SLIDING);
    if (value_of(u[hinge->impulse]) > 0.5) {
        loads = impulse_loads(hinge, x, grip, new, h);
        if (hinge->locks) grip->latched_angle = new->coordinates[HINGE_ANGLE];
        store_rates_after_impulse(new, x_next);
    } else {
        StepMotion motions[COORDINATE_COUNT];
        step_motions(hinge, x, u, new, &passage, h, motions);
        StiffLoads stiff = stiff_loads(hinge, grip, motions);
        loads = mean_loads(hinge, x, grip, new, motions, &stiff, h);
        store_memories(hinge, x, new, motions, h, x_next);
        if (hinge->paired) store_loads(hinge, x, grip, motions, &stiff, h, x_next);
    }
    store_mean_pair(&passage, loads.force, loads.torque, x_next + WRENCH);
    if (hinge->paired)
        store_slope_pair(&passage, loads.force_slope, loads.torque_slope, x_next + WRENCH, x_next + SLOPES);
    else
        for (int i = 0; i < PAIR_SIZE; i++) x_next[SLOPES + i] = 0.0;
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[HEAT + i] = x[HEAT + i] + loads.heat[i];
        x_next[POWER + i] = x[POWER + i];
    }
    x_next[NUMERICAL] = x[NUMERICAL] + loads.numerical;
}

/* One step; the inputs are those of its end. Commands act from its start. */
int NAME(hinge_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Hinge *hinge = self;
    (void)why;
    Grip grip = commanded_grip(hinge, x, u);
    Motion new = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    store_motion(&new, x_next);
    if (hinge->endpoint)
        endpoint_step(hinge, x, &grip, &new, h, x_next);
    else
        mean_step(hinge, x, u, &grip, &new, h, x_next);
    store_grip(&grip, x_next);
    return 1;
}

/* Wrenches on both ports, distance to the latch angle, latched or not, slopes of mean wrenches. */
void NAME(hinge_outputs)(void *self, const real *x, const real *u, real *y) {
    const Hinge *hinge = self;
    real angle = x[COORDINATES + HINGE_ANGLE];
    if (hinge->endpoint) {
        Motion now = hinge_motion(hinge, u, angle);
        Grip grip = present_grip(hinge, x, u);
        Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
        store_pair(quaternion_rotate(now.frame, loads.force), quaternion_rotate(now.frame, loads.torque), now.gap, y);
        angle = now.coordinates[HINGE_ANGLE];
    } else {
        for (int i = 0; i < PAIR_SIZE; i++) {
            y[i] = x[WRENCH + i];
            y[OUTPUTS + i] = x[SLOPES + i];
        }
    }
    y[PAIR_SIZE] = hinge->latch_angle - angle;
    y[PAIR_SIZE + 1] = x[LATCHED];
}

#endif
