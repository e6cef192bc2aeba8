/* Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch: the twin of
   components/hinge.py. */

#include "hinge_step.h"
#include "hinge_exchange.h"
#include "hinge_stiffness.h"

#ifndef FANFOLD_COMPLEX

#include "hinge_data.h"

DECLARE_COMPLEX(hinge)
int hinge_stiffness(void *self, const double *x, const double *u, double h, size_t ports, double *matrix);

/* Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle. */
static int hinge_initial(void *self, const double *u, double *x, Reason *why) {
    const Hinge *hinge = self;
    (void)why;
    Motion motion = hinge_motion(hinge, u, hinge->base.p[P_STOWED_ANGLE]);
    memset(x, 0, STATES * sizeof *x);
    store_motion(&motion, x);
    store_rates_after_impulse(&motion, x);
    store_mid_step_slope_start(motion.rates[HINGE_ANGLE], x + X_SLIDING);
    x[X_HOLD_ANGLE] = motion.coordinates[HINGE_ANGLE];
    x[X_PRESLIDING] = starting_deflection(hinge, motion.coordinates[HINGE_ANGLE]);
    return 1;
}

/* At order 4, from what bushing and latch did over the last steps. */
static void correct(const double *x, Held *held) {
    for (int i = 0; i < COORDINATE_COUNT; i++)
        held->bushing[i] = load_with_slopes_now(x + load_place(i), held->bushing[i], x[memory_place(i) + ROUGHNESS]);
    held->latch = load_with_slopes_now(x + load_place(LATCH_LOAD), held->latch, x[memory_place(HINGE_ANGLE) + ROUGHNESS]);
}

/* A vector of hinge axes in the axes of the inboard port. */
static void store_on_port(const Hinge *hinge, Vector3 v, double *z) {
    const double *q = hinge->axis_frame;
    vector_store(quaternion_rotate((Quaternion){q[0], q[1], q[2], q[3]}, v), z);
}

/* Latch torque, axial and radial force, and the vectors, at the communication point before the last step. How the swing
   changed in the step is nothing beside 1. */
static void store_lagged_loads(const Hinge *hinge, const double *x, double *z) {
    double before[LOAD_COUNT];
    for (int i = 0; i < LOAD_COUNT; i++) before[i] = mid_step_slope_before(x + load_place(i));
    double twist = before[HINGE_ANGLE] + before[LATCH_LOAD] + before[DRIVING_LOAD];
    Transverse swing = {x[X_COORDINATES + 4], x[X_COORDINATES + 5]};
    store_on_port(hinge, (Vector3){before[0], before[1], before[2]}, z + Z_HINGE_FORCE_LAGGED);
    store_on_port(hinge, conjugate_torque(twist, (Transverse){before[4], before[5]}, swing), z + Z_HINGE_TORQUE_LAGGED);
    z[Z_LATCH_TORQUE_LAGGED] = before[LATCH_LOAD];
    z[Z_AXIAL_FORCE_LAGGED] = before[0];
    z[Z_RADIAL_FORCE_LAGGED] = sqrt(before[1] * before[1] + before[2] * before[2]);
}

/* Energy that the motorisation spring gave from the stowed angle to another. */
static double motor_energy(const Hinge *hinge, double angle) {
    return law_potential(&hinge->motor, hinge->base.p[P_STOWED_ANGLE]) - law_potential(&hinge->motor, angle);
}

/* Of a joint that has failed, or does at this instant: no loads, and the energies as they were at the failure. */
static void observe_failed(const Hinge *hinge, const double *x, double *z) {
    double failing[STATES];
    memcpy(failing, x, sizeof failing);
    store_failure(hinge, x, x + X_COORDINATES, failing);
    for (int i = Z_MOTOR_TORQUE; i < Z_MOTOR_ENERGY; i++) z[i] = 0.0;
    z[Z_MOTOR_ENERGY] = motor_energy(hinge, failing[X_FAILURE_ANGLE]);
    z[Z_FAILURE_ENERGY] = failing[X_FAILURE_HEAT];
    z[Z_POTENTIAL_ENERGY] = driving_energy(hinge, failing[X_FAILURE_ANGLE]);
    z[Z_DISSIPATED_ENERGY] = x[X_FRICTION_HEAT] + x[X_LATCH_HEAT] + x[X_DAMPING_HEAT] + failing[X_FAILURE_HEAT];
}

/* Angles, torques and forces at the communication point, and energies. Loads follow from the end-point law, at order 4
   corrected by what the last steps' loads were. */
static void hinge_observe(void *self, const double *x, const double *u, double *z) {
    const Hinge *hinge = self;
    Motion now = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    /* in a mean wrench a command acts from the next step's start, which is this instant */
    Grip grip = hinge->base.endpoint ? present_grip(x, u) : commanded_grip(hinge, x, u);
    double angle = now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (hinge->base.endpoint) {
        move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], angle, &grip);
    } else {
        for (int i = 0; i < COORDINATE_COUNT; i++)
            now.rates[i] = x[memory_place(i) + (hinge->base.paired ? END_RATE : MEAN_RATE)];
        now.rates[HINGE_ANGLE] = hinge->base.paired ? mid_step_slope_now(x + X_SLIDING) : mid_step_now(x + X_SLIDE);
    }
    z[Z_ANGLE] = angle;
    z[Z_ANGULAR_RATE] = rate;
    for (int i = 0; i < HEAT_CAUSES; i++) z[Z_FRICTION_ENERGY + i] = x[X_FRICTION_HEAT + i];
    z[Z_LATCH_ENERGY] += grip.lost;
    z[Z_LATCH_IMPULSE] = x[X_LATCH_IMPULSE];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
    if (!hinge->base.endpoint) store_lagged_loads(hinge, x, z);
    if (grip.failed) {
        observe_failed(hinge, x, z);
        return;
    }
    Held held = held_at(hinge, &grip, now.coordinates, now.rates);
    if (hinge->base.paired) correct(x, &held);
    Loads loads = instant_loads(hinge, &grip, now.coordinates, now.rates, &held);
    if (hinge->base.endpoint) grip.presliding = loads.friction.deflection;
    z[Z_MOTOR_TORQUE] = law_value(&hinge->motor, angle);
    z[Z_HARNESS_TORQUE] = law_value(&hinge->harness, angle);
    z[Z_FRICTION_TORQUE] = loads.friction.force;
    z[Z_FRICTION_LIMIT] = largest_friction(hinge, friction_magnitudes(hinge, &grip, held.bushing, angle), 0.0);
    z[Z_LATCH_TORQUE] = loads.latch_torque;
    z[Z_AXIAL_FORCE] = loads.force.x;
    z[Z_RADIAL_FORCE] = sqrt(loads.force.y * loads.force.y + loads.force.z * loads.force.z);
    z[Z_BENDING_MOMENT] = sqrt(loads.torque.y * loads.torque.y + loads.torque.z * loads.torque.z);
    store_on_port(hinge, loads.force, z + Z_HINGE_FORCE);
    store_on_port(hinge, loads.torque, z + Z_HINGE_TORQUE);
    z[Z_MOTOR_ENERGY] = motor_energy(hinge, angle);
    z[Z_FAILURE_ENERGY] = 0.0;
    z[Z_POTENTIAL_ENERGY] = stored_energy(hinge, &grip, now.coordinates);
    z[Z_DISSIPATED_ENERGY] = x[X_FRICTION_HEAT] + x[X_LATCH_HEAT] + x[X_DAMPING_HEAT] + grip.lost;
}

/* Time until the latch angle is reached at the present rate; in end-point mode only does a latch engage by itself. */
static double hinge_next_event(void *self, const double *x, const double *u) {
    const Hinge *hinge = self;
    Grip grip = commanded_grip(hinge, x, u);
    if (!hinge->base.endpoint || !awaits_latch(hinge, &grip)) return INFINITY;
    Motion now = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    double ahead = hinge->base.p[P_LATCH_ANGLE] - now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (ahead <= 0.0) return 0.0;
    return rate > 0.0 ? ahead / rate : INFINITY;
}

/* Commands act, and a latch that is due engages at its angle; from here on it gives off its own heat. */
static void hinge_event(void *self, const double *x, const double *u, int due, double *x_next) {
    const Hinge *hinge = self;
    memcpy(x_next, x, STATES * sizeof *x);
    if (!hinge->base.endpoint) return;
    Grip grip = commanded_grip(hinge, x, u);
    Motion now = hinge_motion(hinge, u, x[X_COORDINATES + HINGE_ANGLE]);
    if (grip.failed) {
        store_failure(hinge, x, now.coordinates, x_next);
        for (int i = 0; i < HEAT_CAUSES; i++) x_next[X_POWER + i] = 0.0;
        return;
    }
    latch_if_reached(hinge, &grip, due || now.coordinates[HINGE_ANGLE] >= hinge->base.p[P_LATCH_ANGLE]);
    store_grip(&grip, x_next);
    x_next[X_LATCH_HEAT] += grip.lost;
    move_along(hinge, x[X_COORDINATES + HINGE_ANGLE], now.coordinates[HINGE_ANGLE], &grip);
    Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
    for (int i = 0; i < HEAT_CAUSES; i++) x_next[X_POWER + i] = loads.heat[i];
}

const Kernel hinge_kernel = {
    CONNECTION_FUNCTIONS(hinge, hinge),
    .next_event = hinge_next_event,
    .event = hinge_event,
    .stiffness = hinge_stiffness,
    .indicators = hinge_indicators,
    .update = hinge_update,
};

#endif
