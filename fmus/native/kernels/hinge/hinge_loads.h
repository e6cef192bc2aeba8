/* Loads of a hinge, mean over a step, of an impulse and of one instant: part of hinge.c, of either number type. */

#ifndef FANFOLD_HINGE_LOADS_H
#define FANFOLD_HINGE_LOADS_H

#include "hinge_friction.h"

/* Swing in the middle of a step. */
static inline Transverse mean_swing(const double *x, const Motion *new) {
    return (Transverse){
        0.5 * (x[X_COORDINATES + 4] + new->coordinates[4]),
        0.5 * (x[X_COORDINATES + 5] + new->coordinates[5]),
    };
}

/* Load of the bushing in a coordinate. */
static inline MeanLoad stiff_load(const Hinge *hinge, int i, const StepMotion *motion) {
    if (hinge->base.paired) return workless_spring(hinge->stiffness[i], hinge->damping[i], motion);
    return bushing_load(hinge->stiffness[i], hinge->damping[i], motion);
}

/* Load of a law that drives or brakes the hinge angle, too soft to need numerical damping. */
static inline MeanLoad drive_load(const Hinge *hinge, const Law *law, const StepMotion *motion) {
    if (hinge->base.paired) return workless_law(law, 0.0, motion, 0.0);
    return (MeanLoad){law_mean_force(law, motion->start, motion->end), 0.0, 0.0, 0.0};
}

/* Mean latch torque, its heat, and what the scheme took away. */
static inline MeanLoad mean_latch_load(const Hinge *hinge, const Grip *grip, StepMotion motion) {
    StepMotion deflection = shifted_motion(motion, grip->latched_angle);
    const real share = share_beyond(hinge->play, deflection.start, deflection.end);
    if (hinge->base.paired)
        return workless_law(&hinge->latch, share * hinge->latch_damping, &deflection, deflection.roughness);
    real elastic = law_mean_force(&hinge->latch, deflection.start, deflection.end);
    return damped_load(elastic, hinge->latch_stiffness, share * hinge->latch_damping, &deflection);
}

/* Loads beyond a clearance, in the place of those of its coordinates. */
static inline void loose_loads(const Hinge *hinge, const Clearance *clearance, const StepMotion *motions,
                               MeanLoad *loads) {
    StepMotion aligned[COORDINATE_COUNT];
    memcpy(aligned, motions, sizeof aligned);
    aligned[HINGE_ANGLE] = shifted_motion(aligned[HINGE_ANGLE], hinge->base.p[P_ALIGNED_ANGLE]);
    clearance_loads(clearance, aligned, hinge->base.paired, loads);
}

/* Mean loads of bushing and latch. */
static inline StiffLoads stiff_loads(const Hinge *hinge, const Grip *grip, const StepMotion *motions) {
    StiffLoads loads = {.latch = {0.0, 0.0, 0.0, 0.0}};
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        StepMotion motion = motions[i];
        if (i == HINGE_ANGLE) motion = shifted_motion(motion, hinge->base.p[P_ALIGNED_ANGLE]);
        loads.bushing[i] = stiff_load(hinge, i, &motion);
    }
    for (int k = 0; k < hinge->loose; k++) loose_loads(hinge, hinge->clearances + k, motions, loads.bushing);
    if (latch_acts(hinge, grip)) loads.latch = mean_latch_load(hinge, grip, motions[HINGE_ANGLE]);
    return loads;
}

/* Mean loads over a step from both its ends (discrete gradients and mean rates), and their slopes at order 4. */
static inline Loads mean_loads(const Hinge *hinge, const double *x, const Grip *grip, const Motion *new,
                               const StepMotion *motions, const StiffLoads *stiff) {
    real elastic[COORDINATE_COUNT], slope[COORDINATE_COUNT], heat = 0.0, numerical = 0.0;
    StepMotion turn = motions[HINGE_ANGLE];
    MeanLoad latch = stiff->latch;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        elastic[i] = stiff->bushing[i].force;
        slope[i] = stiff->bushing[i].slope;
        heat += stiff->bushing[i].heat;
        numerical += stiff->bushing[i].numerical;
    }
    real change = turn.end - turn.start;
    const Presliding friction = step_friction(hinge, grip, stiff, &turn);
    MeanLoad motor = drive_load(hinge, &hinge->motor, &turn), harness = drive_load(hinge, &hinge->harness, &turn);
    real twist = elastic[HINGE_ANGLE] + motor.force + harness.force + friction.force + latch.force;
    numerical += latch.numerical;
    if (grip->holding != 0.0) {
        twist -= hinge->base.p[P_HOLD_STIFFNESS] * (turn.end - grip->hold_angle);
        numerical += 0.5 * hinge->base.p[P_HOLD_STIFFNESS] * change * change;
    }
    Transverse swing = mean_swing(x, new);
    Loads loads = {
        {elastic[0], elastic[1], elastic[2]},
        conjugate_torque(twist, (Transverse){elastic[4], elastic[5]}, swing),
        latch.force,
        friction,
        {friction.heat, latch.heat, heat},
        numerical,
        {0.0, 0.0, 0.0},
        {0.0, 0.0, 0.0},
    };
    loads.about_line[0] = twist;
    if (hinge->base.paired) {
        twist = loads.about_line[1] = slope[HINGE_ANGLE] + motor.slope + harness.slope + friction.slope + latch.slope;
        loads.force_slope = (Vector3){slope[0], slope[1], slope[2]};
        loads.torque_slope = conjugate_torque(twist, (Transverse){slope[4], slope[5]}, swing);
    }
    return loads;
}

/* Loads that remove the relative rate in every stiff direction at the end of a vanishing step: an ideal joint
   transmits a latch impulse through its constrained directions in no time. The heat is that of the latch; what other
   directions lose is due to the joint taken for ideal. */
static inline Loads impulse_loads(const Hinge *hinge, const double *x, const Grip *grip, const Motion *new, double h) {
    int locked = grip->latched > 0.5 && hinge->locks;
    real load[COORDINATE_COUNT], latch = 0.0, sum = 0.0;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        int stiff = hinge->stiffness[i] > 0.0 || (i == HINGE_ANGLE && locked);
        double inertia = i < HINGE_ANGLE ? hinge->base.p[P_LOCK_MASS] : hinge->base.p[P_LOCK_INERTIA];
        load[i] = stiff ? -inertia / h * new->rates[i] : 0.0;
        real work = -load[i] * (new->coordinates[i] - x[X_COORDINATES + i]);
        sum += work;
        if (i == HINGE_ANGLE && locked) latch = work;
    }
    return (Loads){
        {load[0], load[1], load[2]},
        conjugate_torque(load[HINGE_ANGLE], (Transverse){load[4], load[5]}, mean_swing(x, new)),
        locked ? load[HINGE_ANGLE] : 0.0,
        {0.0, 0.0, grip->presliding, 0.0},
        {0.0, latch, 0.0},
        sum - latch,
        {0.0, 0.0, 0.0},
        {0.0, 0.0, 0.0},
    };
}

/* Damping of the latch at an angle: none within its play. */
static inline double latch_damping_at(const Hinge *hinge, const Grip *grip, real angle) {
    const real deflection = angle - grip->latched_angle;
    return hinge->latch_damping * value_of(share_beyond(hinge->play, deflection, deflection));
}

/* What bushing and latch exert at one instant, and the power (W) of dampers beyond clearances. */
typedef struct Held {
    real bushing[COORDINATE_COUNT], latch, power;
} Held;

/* By the laws, from coordinates and rates. */
static inline Held held_at(const Hinge *hinge, const Grip *grip, const real *coordinates, const real *rates) {
    Held held = {.latch = 0.0};
    real aligned[COORDINATE_COUNT];
    from_aligned(hinge, coordinates, aligned);
    for (int i = 0; i < COORDINATE_COUNT; i++)
        held.bushing[i] = -hinge->stiffness[i] * aligned[i] - hinge->damping[i] * rates[i];
    for (int k = 0; k < hinge->loose; k++)
        held.power += add_clearance_force(hinge->clearances + k, aligned, rates, held.bushing);
    if (latch_acts(hinge, grip))
        held.latch = law_value(&hinge->latch, coordinates[HINGE_ANGLE] - grip->latched_angle) +
                     -latch_damping_at(hinge, grip, coordinates[HINGE_ANGLE]) * rates[HINGE_ANGLE];
    return held;
}

/* Loads of one instant; heat as power (W). */
static inline Loads instant_loads(const Hinge *hinge, const Grip *grip, const real *coordinates, const real *rates,
                                  const Held *held) {
    const real *load = held->bushing;
    real angle = coordinates[HINGE_ANGLE], rate = rates[HINGE_ANGLE], viscous = 0.0, damping = held->power;
    for (int i = 0; i < COORDINATE_COUNT; i++) damping += hinge->damping[i] * rates[i] * rates[i];
    Presliding friction = instant_friction(hinge, grip, load, angle, rate);
    if (latch_acts(hinge, grip)) viscous = -latch_damping_at(hinge, grip, angle) * rate;
    real twist = load[HINGE_ANGLE] + law_value(&hinge->motor, angle) + law_value(&hinge->harness, angle) +
                 friction.force + held->latch;
    if (grip->holding != 0.0) twist -= hinge->base.p[P_HOLD_STIFFNESS] * (angle - grip->hold_angle);
    return (Loads){
        {load[0], load[1], load[2]},
        conjugate_torque(twist, (Transverse){load[4], load[5]}, (Transverse){coordinates[4], coordinates[5]}),
        held->latch,
        friction,
        {friction.heat, -viscous * rate, damping},
        0.0,
        {0.0, 0.0, 0.0},
        {0.0, 0.0, 0.0},
    };
}

/* Energy of motor and harness, zero at an arbitrary angle of tables and of a constant torque. */
static inline real driving_energy(const Hinge *hinge, real angle) {
    return law_potential(&hinge->motor, angle) + law_potential(&hinge->harness, angle);
}

/* Energy in bushing, latch, friction that sticks and hold, which is lost where the joint fails; not negative. */
static inline real held_energy(const Hinge *hinge, const Grip *grip, const real *coordinates) {
    real angle = coordinates[HINGE_ANGLE], energy = 0.0, aligned[COORDINATE_COUNT];
    from_aligned(hinge, coordinates, aligned);
    for (int i = 0; i < COORDINATE_COUNT; i++) energy += 0.5 * hinge->stiffness[i] * aligned[i] * aligned[i];
    for (int k = 0; k < hinge->loose; k++) energy += clearance_potential(hinge->clearances + k, aligned);
    energy += latch_energy(hinge, grip, angle);
    energy += 0.5 * hinge->base.p[P_PRESLIDING_STIFFNESS] * grip->presliding * grip->presliding;
    if (grip->holding != 0.0) {
        real held = angle - grip->hold_angle;
        energy += 0.5 * hinge->base.p[P_HOLD_STIFFNESS] * held * held;
    }
    return energy;
}

/* Energy of the whole joint. */
static inline real stored_energy(const Hinge *hinge, const Grip *grip, const real *coordinates) {
    return held_energy(hinge, grip, coordinates) + driving_energy(hinge, coordinates[HINGE_ANGLE]);
}

/* Loads of one instant from coordinates and rates. */
static inline Loads endpoint_loads(const Hinge *hinge, const Grip *grip, const real *coordinates, const real *rates) {
    if (grip->failed) return (Loads){.numerical = 0.0};
    Held held = held_at(hinge, grip, coordinates, rates);
    return instant_loads(hinge, grip, coordinates, rates, &held);
}

#endif
