/* What a hinge is made of, its motion and what holds it: part of hinge.c, of either number type.

   Six coordinates: offset x, y, z, hinge angle, swing y, z, all in hinge axes. */

#ifndef FANFOLD_HINGE_MODEL_H
#define FANFOLD_HINGE_MODEL_H

#include "laws.h"
#include "relative.h"
#include "workless.h"

enum { COORDINATE_COUNT = 6, HINGE_ANGLE = 3 };

/* Loads of which the last means and slopes are remembered at order 4: of the bushing in the six coordinates, and of the latch. */
enum { LATCH_LOAD = COORDINATE_COUNT, LOAD_COUNT };

/* State: where each part begins. SLIDE are the mean hinge rates and the sizes of the last two steps, SLIDING the same
   with slopes, of order 4. */
enum {
    FRAME = 0,
    GAP = 4,
    COORDINATES = 7,
    RATES = 13,
    MEAN_RATES = 19,
    END_RATES = 25,
    WRENCH = 31,
    POWER = 43,
    SLIDE = 46,
    HEAT = 50, /* of friction, latch, damping */
    LATCHED = 53,
    LATCHED_ANGLE = 54,
    HOLDING = 55,
    HOLD_ANGLE = 56,
    NUMERICAL = 57, /* what the scheme took away */
    ROUGHNESS = 58,
    SLOPES = 64,
    LOADS = 76,
    SLIDING = LOADS + LOAD_COUNT * MID_STEP_SLOPE_SIZE,
    STATES = SLIDING + MID_STEP_SLOPE_SIZE
};

enum {
    HEAT_CAUSES = 3,
    PAIR_SIZE = 2 * WRENCH_SIZE,
    COMMANDS = 3,
    OUTPUTS = PAIR_SIZE + 2, /* and slopes, of mean wrenches */
    OBSERVATIONS = 16, /* and lagged loads, of mean wrenches */
    LAGGED_LOADS = 3
};

enum { NO_LATCH, SPRING_LATCH, TABLE_LATCH, KINEMATIC_LATCH };

enum {
    TRANSLATIONAL_STIFFNESS,
    TRANSLATIONAL_DAMPING,
    ROTATIONAL_STIFFNESS,
    ROTATIONAL_DAMPING,
    ALIGNED_ANGLE,
    STOWED_ANGLE,
    MOTOR_STIFFNESS,
    MOTOR_WIND_UP,
    FRICTION_COEFFICIENT,
    STATIC_FRICTION_RATIO,
    PIN_RADIUS,
    FRICTION_BENDING_ARM,
    FRICTION_PRELOAD,
    STICTION_VELOCITY,
    LATCH_ANGLE,
    LATCH_STIFFNESS,
    LATCH_DAMPING,
    LATCH_AUTOMATIC,
    LOCK_MASS,
    LOCK_INERTIA,
    LOCK_STIFFNESS,
    HOLD_STIFFNESS,
    END_WEIGHT,
    ORDER,
    PARAMETERS
};

typedef struct Hinge {
    double axis_frame[4];
    int latch_kind, endpoint, locks;
    int paired; /* loads are of order 4; those of static solutions are not */
    size_t latch_command, impulse, hold, moments, places[PARAMETERS];
    double stiffness[COORDINATE_COUNT], damping[COORDINATE_COUNT];
    double aligned_angle, stowed_angle;
    double friction, static_ratio, pin_radius, bending_arm, friction_preload, stiction_velocity;
    double latch_angle, latch_stiffness, latch_damping, lock_mass, lock_inertia, hold_stiffness, end_weight;
    int latch_automatic;
    Law motor, harness, latch;
} Hinge;

/* Pose of one instant, its six coordinates (the hinge angle unwrapped) and their rates. */
typedef struct Motion {
    Quaternion frame;
    Vector3 gap;
    real coordinates[COORDINATE_COUNT], rates[COORDINATE_COUNT];
} Motion;

/* What holds the hinge, and the angles where it took hold. */
typedef struct Grip {
    double latched, holding;
    real latched_angle, hold_angle;
} Grip;

/* Force and torque on B in hinge axes, torque of latch and of friction, heat of friction, latch and damping,
   what the scheme took away; the slopes of force and torque, zero at order 2. */
typedef struct Loads {
    Vector3 force, torque;
    real latch_torque, friction_torque, heat[HEAT_CAUSES], numerical;
    Vector3 force_slope, torque_slope;
} Loads;

/* Mean loads of the bushing in the six coordinates and of the latch. */
typedef struct StiffLoads {
    MeanLoad bushing[COORDINATE_COUNT], latch;
} StiffLoads;

/* Where the last steps of a load begin in the state. */
static inline int load_place(int load) { return LOADS + MID_STEP_SLOPE_SIZE * load; }

/* Motion of the inputs; the angle is the one nearest the reference. */
static inline Motion hinge_motion(const Hinge *hinge, const real *u, real reference) {
    Pose pose = relative_pose(u, hinge->axis_frame);
    Rates rates = relative_rates(u, &pose);
    real angle = nearest_turn(hinge->aligned_angle + pose.twist, reference);
    return (Motion){
        pose.frame,
        pose.gap,
        {pose.offset.x, pose.offset.y, pose.offset.z, angle, pose.swing.y, pose.swing.z},
        {rates.offset.x, rates.offset.y, rates.offset.z, rates.twist, rates.swing.y, rates.swing.z},
    };
}

/* Latch or hold at the angle where the command arrives. */
static inline Grip commanded_grip(const Hinge *hinge, const double *x, const real *u) {
    Grip grip = {x[LATCHED], 0.0, x[LATCHED_ANGLE], x[HOLD_ANGLE]};
    if (value_of(u[hinge->latch_command]) > 0.5 && x[LATCHED] == 0.0) {
        grip.latched = 1.0;
        grip.latched_angle = x[COORDINATES + HINGE_ANGLE];
    }
    if (value_of(u[hinge->hold]) > 0.5) {
        grip.holding = 1.0;
        if (x[HOLDING] == 0.0) grip.hold_angle = x[COORDINATES + HINGE_ANGLE];
    }
    return grip;
}

/* Whether there is a latch and it is engaged. */
static inline int latch_acts(const Hinge *hinge, const Grip *grip) {
    return grip->latched != 0.0 && hinge->latch_kind != NO_LATCH;
}

/* The grip of a state under the present hold command. */
static inline Grip present_grip(const Hinge *hinge, const real *x, const real *u) {
    double holding = value_of(u[hinge->hold]) > 0.5 ? 1.0 : 0.0;
    return (Grip){value_of(x[LATCHED]), holding, x[LATCHED_ANGLE], x[HOLD_ANGLE]};
}

/* Whether the latch engages by itself and has not yet. */
static inline int awaits_latch(const Hinge *hinge, const Grip *grip) {
    return hinge->latch_automatic && grip->latched == 0.0 && hinge->latch_kind != NO_LATCH;
}

static inline void latch_if_reached(const Hinge *hinge, Grip *grip, int reached) {
    if (!reached || !awaits_latch(hinge, grip)) return;
    grip->latched = 1.0;
    grip->latched_angle = hinge->latch_angle;
}

#endif
