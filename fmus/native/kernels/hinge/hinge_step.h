/* One step of a hinge and what it gives out: part of hinge.c, of either number type. */

#ifndef FANFOLD_HINGE_STEP_H
#define FANFOLD_HINGE_STEP_H

#include "hinge_loads.h"

static inline void store_motion(const Motion *motion, real *x) {
    quaternion_store(motion->frame, x + X_FRAME);
    vector_store(motion->gap, x + X_GAP);
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        x[X_COORDINATES + i] = motion->coordinates[i];
        x[X_RATES + i] = motion->rates[i];
    }
}

static inline void store_grip(const Grip *grip, real *x) {
    x[X_LATCHED] = grip->latched;
    x[X_LATCHED_ANGLE] = grip->latched_angle;
    x[X_OPENED] = grip->opened;
    x[X_HOLDING] = grip->holding;
    x[X_HOLD_ANGLE] = grip->hold_angle;
    x[X_PRESLIDING] = grip->presliding;
}

/* A joint that fails turns to heat what it stores at the coordinates. */
static inline void store_failure(const Hinge *hinge, const double *x, const double *coordinates, real *x_next) {
    if (x[X_FAILED] != 0.0) return;
    const Grip grip = {x[X_LATCHED], x[X_HOLDING], x[X_LATCHED_ANGLE], x[X_HOLD_ANGLE], x[X_PRESLIDING], 0, 0, 0.0};
    real place[COORDINATE_COUNT];
    for (int i = 0; i < COORDINATE_COUNT; i++) place[i] = coordinates[i];
    x_next[X_FAILED] = 1.0;
    x_next[X_FAILURE_ANGLE] = coordinates[HINGE_ANGLE];
    x_next[X_FAILURE_HEAT] = held_energy(hinge, &grip, place);
}

/* What the coordinates remember of the step. */
static inline void store_memories(const Hinge *hinge, const double *x, const Motion *new, const StepMotion *motions,
                                  double h, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        if (hinge->base.paired)
            store_path(motions + i, x_next + memory_place(i));
        else
            store_memory(motions + i, new->rates[i], x_next + memory_place(i));
    }
    store_mid_step_after(x + X_SLIDE, x_next[memory_place(HINGE_ANGLE) + MEAN_RATE], h, x_next + X_SLIDE);
}

/* After an impulse only the rates of its end are known. */
static inline void store_rates_after_impulse(const Motion *new, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) store_rate(new->rates[i], x_next + memory_place(i));
    store_mid_step_start(new->rates[HINGE_ANGLE], x_next + X_SLIDE);
}

static inline void keep_load(const double *old, const MeanLoad *load, double h, real *x_next) {
    store_mid_step_slope_after(old, load->force, load->slope, h, x_next);
}

/* Loads and hinge rate of order 4 with one step more; the latch torque begins where the latch engages. */
static inline void store_loads(const Hinge *hinge, const double *x, const Grip *grip, const StepMotion *motions,
                               const StiffLoads *loads, const real about_line[2], double h, real *x_next) {
    const StepMotion *turn = motions + HINGE_ANGLE;
    for (int i = 0; i < COORDINATE_COUNT; i++)
        keep_load(x + load_place(i), &loads->bushing[i], h, x_next + load_place(i));
    if (latch_acts(hinge, grip))
        keep_load(x + load_place(LATCH_LOAD), &loads->latch, h, x_next + load_place(LATCH_LOAD));
    const MeanLoad *joint = &loads->bushing[HINGE_ANGLE], *latch = &loads->latch;
    store_mid_step_slope_after(x + load_place(DRIVING_LOAD), about_line[0] - joint->force - latch->force,
                               about_line[1] - joint->slope - latch->slope, h, x_next + load_place(DRIVING_LOAD));
    store_mid_step_slope_after(x + X_SLIDING, (turn->end - turn->start) / h, 3.0 * turn->moment / h, h,
                               x_next + X_SLIDING);
}

/* Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule. */
static inline void endpoint_step(const Hinge *hinge, const double *x, Grip *grip, const Motion *new, double h,
                                 real *x_next) {
    latch_if_reached(hinge, grip, value_of(new->coordinates[HINGE_ANGLE]) >= hinge->base.p[P_LATCH_ANGLE]);
    move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], new->coordinates[HINGE_ANGLE], grip);
    Loads loads = endpoint_loads(hinge, grip, new->coordinates, new->rates);
    grip->presliding = loads.friction.deflection;
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[X_FRICTION_HEAT + i] = x[X_FRICTION_HEAT + i] + 0.5 * h * (x[X_POWER + i] + loads.heat[i]);
        x_next[X_POWER + i] = loads.heat[i];
    }
    x_next[X_LATCH_HEAT] += grip->lost;
}

/* Motions of the six coordinates; at order 4 with the moments of their rates. */
static inline void step_motions(const Hinge *hinge, const double *x, const real *u, const Motion *new,
                                const Passage *passage, double h, StepMotion *motions) {
    Rates m = {{0.0, 0.0, 0.0}, 0.0, {0.0, 0.0}};
    if (hinge->base.paired) m = rate_moments(passage, u + INPUTS, mean_swing(x, new));
    const real moments[COORDINATE_COUNT] = {m.offset.x, m.offset.y, m.offset.z, m.twist, m.swing.y, m.swing.z};
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        motions[i] = step_motion(x + memory_place(i), x[X_COORDINATES + i], new->coordinates[i], h);
        motions[i].moment = moments[i];
    }
}

/* Wrench and heat of mean loads. */
static inline void mean_step(const Hinge *hinge, const double *x, const real *u, Grip *grip, const Motion *new,
                             double h, real *x_next) {
    const double *q = x + X_FRAME, *gap = x + X_GAP;
    Passage passage = {{q[0], q[1], q[2], q[3]}, new->frame, {gap[0], gap[1], gap[2]}, new->gap};
    Loads loads;
    for (int i = 0; i < LOAD_COUNT * MID_STEP_SLOPE_SIZE; i++) x_next[X_LOADS + i] = 0.0;
    store_mid_step_slope_start(new->rates[HINGE_ANGLE], x_next + X_SLIDING);
    x_next[X_LATCH_IMPULSE] = x[X_LATCH_IMPULSE];
    if (commanded(u, U_IMPULSE)) {
        loads = impulse_loads(hinge, x, grip, new, h);
        x_next[X_LATCH_IMPULSE] += h * loads.latch_torque;
        if (hinge->locks && x[X_LATCHED] == 0.0) grip->latched_angle = new->coordinates[HINGE_ANGLE];
        store_rates_after_impulse(new, x_next);
    } else {
        StepMotion motions[COORDINATE_COUNT];
        step_motions(hinge, x, u, new, &passage, h, motions);
        StiffLoads stiff = stiff_loads(hinge, grip, motions);
        loads = mean_loads(hinge, x, grip, new, motions, &stiff);
        store_memories(hinge, x, new, motions, h, x_next);
        if (hinge->base.paired) store_loads(hinge, x, grip, motions, &stiff, loads.about_line, h, x_next);
    }
    grip->presliding = loads.friction.deflection;
    store_mean_pair(&passage, loads.force, loads.torque, x_next + X_WRENCH);
    if (hinge->base.paired)
        store_slope_pair(&passage, loads.force_slope, loads.torque_slope, x_next + X_WRENCH, x_next + X_SLOPES);
    else
        for (int i = 0; i < MOMENTS; i++) x_next[X_SLOPES + i] = 0.0;
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[X_FRICTION_HEAT + i] = x[X_FRICTION_HEAT + i] + loads.heat[i];
        x_next[X_POWER + i] = x[X_POWER + i];
    }
    x_next[X_LATCH_HEAT] += grip->lost;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + loads.numerical;
    x_next[X_FAILED] = x_next[X_FAILURE_ANGLE] = x_next[X_FAILURE_HEAT] = 0.0;
}

/* A step of a joint that has failed, or does at the start: there is no load. */
static inline void free_step(const Hinge *hinge, const double *x, const Motion *new, real *x_next) {
    for (int i = 0; i < STATES; i++) x_next[i] = x[i];
    store_motion(new, x_next);
    store_rates_after_impulse(new, x_next);
    store_mid_step_slope_start(new->rates[HINGE_ANGLE], x_next + X_SLIDING);
    for (int i = 0; i < LOAD_COUNT * MID_STEP_SLOPE_SIZE; i++) x_next[X_LOADS + i] = 0.0;
    for (int i = 0; i < MOMENTS; i++) x_next[X_WRENCH + i] = x_next[X_SLOPES + i] = 0.0;
    for (int i = 0; i < HEAT_CAUSES; i++) x_next[X_POWER + i] = 0.0;
    store_failure(hinge, x, x + X_COORDINATES, x_next);
}

/* 0 where a hinge that bends against springs is folded across its line: the angle about it has no meaning there. */
static inline int is_open_across(const Hinge *hinge, const Motion *new, Reason *why) {
    const double *stiffness = hinge->base.p + P_ROTATIONAL_STIFFNESS;
    if (stiffness[1] == 0.0 && stiffness[2] == 0.0) return 1;
    const double one = creal(new->coordinates[HINGE_ANGLE + 1]), other = creal(new->coordinates[HINGE_ANGLE + 2]);
    const double bent = sqrt(one * one + other * other); /* hypot needs a younger C library, and both are below pi */
    if (!(bent > FOLDED)) return 1;
    return refuse(why, "the hinge is bent by %.0f deg across its line, where the angle about it has no meaning; stiffen"
                  " it across (cross_stiffness of a scene's joints), or stop a universal joint before", bent * 57.29577951308232);
}

/* One step; the inputs are those of its end. Commands act from its start. */
int NAME(hinge_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Hinge *hinge = self;
    Grip grip = commanded_grip(hinge, x, u);
    Motion new = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    if (grip.failed) {
        free_step(hinge, x, &new, x_next);
        return 1;
    }
    if (!is_open_across(hinge, &new, why)) return 0;
    for (int i = 0; i < STATES && hinge->base.endpoint; i++) x_next[i] = x[i];
    store_motion(&new, x_next);
    if (hinge->base.endpoint)
        endpoint_step(hinge, x, &grip, &new, h, x_next);
    else
        mean_step(hinge, x, u, &grip, &new, h, x_next);
    store_grip(&grip, x_next);
    return 1;
}

/* Wrenches on both ports, distance to the latch angle, latched or not, slopes of mean wrenches. */
void NAME(hinge_outputs)(void *self, const real *x, const real *u, real *y) {
    const Hinge *hinge = self;
    real angle = x[X_COORDINATES + HINGE_ANGLE];
    if (hinge->base.endpoint) {
        Motion now = hinge_motion(hinge, u, angle);
        Grip grip = present_grip(x, u);
        move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], now.coordinates[HINGE_ANGLE], &grip);
        Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
        store_pair(quaternion_rotate(now.frame, loads.force), quaternion_rotate(now.frame, loads.torque), now.gap, y);
        angle = now.coordinates[HINGE_ANGLE];
    } else {
        for (int i = 0; i < MOMENTS; i++) {
            y[i] = x[X_WRENCH + i];
            y[OUTPUTS + i] = x[X_SLOPES + i];
        }
    }
    y[Y_LATCH_DISTANCE] = hinge->base.p[P_LATCH_ANGLE] - angle;
    y[Y_LATCHED] = x[X_LATCHED];
}

#endif
