/* Connections that turn one port against the other about an axis that both share: the twin of
   components/numerics/axial.py. Their states begin with a turn. */

#ifndef FANFOLD_AXIAL_H
#define FANFOLD_AXIAL_H

#include "connection.h"
#include "workless.h"

typedef struct Axial {
    Connection base;
    double axis_frame[4];
} Axial;

/* How the outboard port is turned against the inboard one, and the rate of the angle. */
typedef struct Turn {
    Quaternion frame;
    Transverse swing;
    real angle, rate;
} Turn;

/* The way from the turn of a state to the next: change of the angle, first moment of its rate, 0 below order 4. */
typedef struct Arc {
    Passage passage;
    Transverse swing;
    real change, moment;
} Arc;

/* The turn of an instant; the angle, `aligned` where the axes are, is nearest the reference. */
static inline Turn turn_of(const Axial *axial, const real *u, real reference, double aligned) {
    Pose pose = relative_pose(u, axial->axis_frame);
    return (Turn){pose.frame, pose.swing, nearest_turn(aligned + pose.twist, reference), relative_rates(u, &pose).twist};
}

static inline void store_turn(const Turn *turn, real *x) {
    x[X_ANGLE] = turn->angle;
    quaternion_store(turn->frame, x + X_FRAME);
    x[X_SWING] = turn->swing.y;
    x[X_SWING + 1] = turn->swing.z;
}

static inline Arc arc_to(const Turn *end, const double *x, const real *u, int paired) {
    const double *q = x + X_FRAME, *swing = x + X_SWING;
    const Vector3 nowhere = {0.0, 0.0, 0.0};
    Arc arc = {
        .passage = {{q[0], q[1], q[2], q[3]}, end->frame, nowhere, nowhere},
        .swing = {0.5 * (swing[0] + end->swing.y), 0.5 * (swing[1] + end->swing.z)},
        .change = end->angle - x[X_ANGLE],
    };
    if (paired) arc.moment = rate_moments(&arc.passage, u + INPUTS, arc.swing).twist;
    return arc;
}

/* Stores the wrenches of a torque about the axis, the mean over a step. */
static inline void store_mean_torque(const Arc *arc, real torque, real *wrench) {
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, arc->swing);
    store_mean_pair(&arc->passage, (Vector3){0.0, 0.0, 0.0}, conjugate, wrench);
}

/* Stores the wrenches of a load over a step, and their slopes. */
static inline void store_load(const Arc *arc, const MeanLoad *load, int paired, real *x_next) {
    store_mean_torque(arc, load->force, x_next + X_WRENCH);
    for (int i = 0; i < MOMENTS; i++) x_next[X_SLOPES + i] = 0.0;
    if (paired) store_mean_torque(arc, load->slope, x_next + X_SLOPES);
}

/* Stores the wrenches of a torque about the axis at an instant. */
static inline void store_torque(const Turn *turn, real torque, real *y) {
    const Vector3 nowhere = {0.0, 0.0, 0.0};
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, turn->swing);
    store_pair(nowhere, quaternion_rotate(turn->frame, conjugate), nowhere, y);
}

#ifndef FANFOLD_COMPLEX

static void *axial_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Axial *axial = create_connection(data, sizes, memory, sizeof *axial, states, why);
    return axial && read_axis_frame(data, axial->axis_frame, why) ? axial : NULL;
}

#endif
#endif
