/* What a hinge is made of, its motion and what holds it: part of hinge.c, of either number type.

   Six coordinates: offset x, y, z, hinge angle, swing y, z, all in hinge axes. */

#ifndef FANFOLD_HINGE_MODEL_H
#define FANFOLD_HINGE_MODEL_H

#include "hinge_layout.h"
#include "clearance.h"
#include "connection.h"
#include "laws.h"
#include "presliding.h"
#include "workless.h"

enum { COORDINATE_COUNT = 6, HINGE_ANGLE = 3, HEAT_CAUSES = 3, CLEARANCE_COUNT = 4 };

/* Loads of which the last steps are remembered at order 4: of the bushing in the six coordinates, of the latch, and of
   all else about the hinge line. */
enum { LATCH_LOAD = COORDINATE_COUNT, DRIVING_LOAD, LOAD_COUNT };

typedef struct Hinge {
    Connection base;
    double axis_frame[4];
    int latch_kind, locks;
    double stiffness[COORDINATE_COUNT], damping[COORDINATE_COUNT], latch_stiffness, latch_damping;
    int loose;                             /* number of clearances, whose coordinates have no stiffness of their own */
    Clearance clearances[CLEARANCE_COUNT]; /* of coordinates from the aligned angle on */
    double play[2]; /* rad, deflections of the latch between which it has no torque */
    Law motor, harness, hysteresis, latch;
} Hinge;

/* Pose of one instant, its six coordinates (the hinge angle unwrapped) and their rates. */
typedef struct Motion {
    Quaternion frame;
    Vector3 gap;
    real coordinates[COORDINATE_COUNT], rates[COORDINATE_COUNT];
} Motion;

/* What holds the hinge, the angles where it took hold, how far friction that sticks has deflected, and whether the joint
   has failed: then nothing holds. opened: whether the latch is held open; lost: what it stored when it let go (J). */
typedef struct Grip {
    double latched, holding;
    real latched_angle, hold_angle, presliding;
    int failed, opened;
    real lost;
} Grip;

/* Force and torque on B in hinge axes, torque of the latch, friction, heat of friction, latch and damping,
   what the scheme took away; the slopes of force and torque, zero at order 2; of a step, what turns about the hinge line,
   and its slope. */
typedef struct Loads {
    Vector3 force, torque;
    real latch_torque;
    Presliding friction;
    real heat[HEAT_CAUSES], numerical;
    Vector3 force_slope, torque_slope;
    real about_line[2];
} Loads;

/* Mean loads of the bushing in the six coordinates and of the latch. */
typedef struct StiffLoads {
    MeanLoad bushing[COORDINATE_COUNT], latch;
} StiffLoads;

/* Where the last steps of a load, and the memory of a coordinate, begin in the state. */
static inline int load_place(int load) { return X_LOADS + MID_STEP_SLOPE_SIZE * load; }
static inline int memory_place(int coordinate) { return X_MEMORIES + MEMORY_SIZE * coordinate; }

/* Motion of the inputs; the angle is the one nearest the reference. */
static inline Motion hinge_motion(const Hinge *hinge, const real *u, real reference) {
    Pose pose = relative_pose(u, hinge->axis_frame);
    Rates rates = relative_rates(u, &pose);
    real angle = nearest_turn(hinge->base.p[P_ALIGNED_ANGLE] + pose.twist, reference);
    return (Motion){
        pose.frame,
        pose.gap,
        {pose.offset.x, pose.offset.y, pose.offset.z, angle, pose.swing.y, pose.swing.z},
        {rates.offset.x, rates.offset.y, rates.offset.z, rates.twist, rates.swing.y, rates.swing.z},
    };
}

/* The coordinates with the angle counted from where the axes of both ports coincide. */
static inline void from_aligned(const Hinge *hinge, const real *coordinates, real *aligned) {
    for (int i = 0; i < COORDINATE_COUNT; i++) aligned[i] = coordinates[i];
    aligned[HINGE_ANGLE] -= hinge->base.p[P_ALIGNED_ANGLE];
}

/* Whether there is a latch and it is engaged. */
static inline int latch_acts(const Hinge *hinge, const Grip *grip) {
    return grip->latched != 0.0 && hinge->latch_kind != NONE_LATCH;
}

/* Energy in the latch at an angle. */
static inline real latch_energy(const Hinge *hinge, const Grip *grip, real angle) {
    if (!latch_acts(hinge, grip)) return 0.0;
    return law_potential(&hinge->latch, angle - grip->latched_angle) - law_potential(&hinge->latch, 0.0);
}

/* Fail, or latch or hold at the angle where the command arrives; what a latch stored that lets go is lost. */
static inline Grip commanded_grip(const Hinge *hinge, const double *x, const real *u) {
    Grip grip = {x[X_LATCHED], 0.0, x[X_LATCHED_ANGLE], x[X_HOLD_ANGLE], x[X_PRESLIDING], 0, 0, 0.0};
    grip.failed = x[X_FAILED] != 0.0 || commanded(u, U_FAILURE_COMMAND);
    if (grip.failed) return grip;
    grip.opened = commanded(u, U_UNLATCH_COMMAND);
    if (grip.opened) {
        grip.lost = latch_energy(hinge, &grip, x[X_COORDINATES + HINGE_ANGLE]);
        grip.latched = 0.0;
    } else if (commanded(u, U_LATCH_COMMAND) && x[X_LATCHED] == 0.0) {
        grip.latched = 1.0;
        grip.latched_angle = x[X_COORDINATES + HINGE_ANGLE];
    }
    if (commanded(u, U_HOLD)) {
        grip.holding = 1.0;
        if (x[X_HOLDING] == 0.0) grip.hold_angle = x[X_COORDINATES + HINGE_ANGLE];
    }
    return grip;
}

/* The grip of a state under the present hold command. */
static inline Grip present_grip(const real *x, const real *u) {
    double holding = commanded(u, U_HOLD) ? 1.0 : 0.0;
    const int failed = value_of(x[X_FAILED]) != 0.0, opened = value_of(x[X_OPENED]) != 0.0;
    return (Grip){value_of(x[X_LATCHED]), holding, x[X_LATCHED_ANGLE], x[X_HOLD_ANGLE], x[X_PRESLIDING], failed, opened, 0.0};
}

/* Moves friction that sticks with the hinge from one angle to another. */
static inline void move_along(const Hinge *hinge, real from, real to, Grip *grip) {
    if (hinge->base.p[P_PRESLIDING_STIFFNESS] != 0.0) grip->presliding += to - from;
}

/* Whether the latch engages by itself and has not yet. */
static inline int awaits_latch(const Hinge *hinge, const Grip *grip) {
    const int is_free = grip->latched == 0.0 && !grip->opened && !grip->failed;
    return hinge->base.p[P_LATCH_AUTOMATIC] > 0.5 && is_free && hinge->latch_kind != NONE_LATCH;
}

static inline void latch_if_reached(const Hinge *hinge, Grip *grip, int reached) {
    if (!reached || !awaits_latch(hinge, grip)) return;
    grip->latched = 1.0;
    grip->latched_angle = hinge->base.p[P_LATCH_ANGLE];
}

#endif
