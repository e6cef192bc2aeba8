/* Relative motion of a connection's two ports, seen from a frame on the first port whose x axis is a hinge
   line: the twin of components/numerics/relative_motion.py; and what all connections read from their data. */

#ifndef FANFOLD_RELATIVE_H
#define FANFOLD_RELATIVE_H

#include "frames.h"
#include "kernel.h"
#include "mid_step.h"
#include "port_sizes.h"

/* The two components normal to the hinge line, in hinge axes: of a swing or of a bending moment. */
typedef struct Transverse {
    real y, z;
} Transverse;

/* Positions of two ports relative to each other: quaternion of the hinge frame on port A; gap from A to B in
   world axes, offset the same in hinge axes; angle of B about x, in (-2 pi, 2 pi); rotation vector of the rest. */
typedef struct Pose {
    Quaternion frame;
    Vector3 gap, offset;
    real twist;
    Transverse swing;
} Pose;

/* Rates of change of a pose: of the offset in hinge axes, of the twist, of the swing. */
typedef struct Rates {
    Vector3 offset;
    real twist;
    Transverse swing;
} Rates;

/* tan(s/2) / s, sin(s) / s and (s / sin(s) - 1) / s^2 of the swing's angle s. */
typedef struct SwingFactors {
    real lean, shortening, across;
} SwingFactors;

static inline SwingFactors factors_of_swing(Transverse swing) {
    real angle = root_of_squares(swing.y * swing.y + swing.z * swing.z);
    if (value_of(angle) < 1e-4) return (SwingFactors){0.5, 1.0, 1.0 / 6.0};
    real shortening = real_sin(angle) / angle;
    return (SwingFactors){
        real_tan(0.5 * angle) / angle,
        shortening,
        (1.0 / shortening - 1.0) / (angle * angle),
    };
}

static inline Quaternion frame_on_port(const real *port, const double axis_frame[4]) {
    Quaternion axis = {axis_frame[0], axis_frame[1], axis_frame[2], axis_frame[3]};
    return quaternion_multiply(quaternion_of(port + 3), axis);
}

/* Pose from the 26 inputs of two connection ports (position, quaternion, velocities of A, then of B). */
static inline Pose relative_pose(const real *u, const double axis_frame[4]) {
    Quaternion frame = frame_on_port(u, axis_frame);
    Quaternion frame_b = frame_on_port(u + MOTION_SIZE, axis_frame);
    Vector3 gap = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    SwingTwist turn = swing_twist(quaternion_multiply(quaternion_conjugate(frame), frame_b));
    return (Pose){frame, gap, quaternion_rotate_back(frame, gap), turn.twist, {turn.swing_y, turn.swing_z}};
}

/* Rates from velocity and angular velocity in hinge axes. */
static inline Rates rates_of(Vector3 offset, Vector3 spin, Transverse swing) {
    SwingFactors factors = factors_of_swing(swing);
    real twist = spin.x + factors.lean * (swing.z * spin.y - swing.y * spin.z);
    /* what the twist adds to the angular velocity normal to the line, the axis of the twist being tilted */
    real y = spin.y - factors.shortening * swing.z * twist;
    real z = spin.z + factors.shortening * swing.y * twist;
    real normal = factors.across * (swing.z * y - swing.y * z);
    return (Rates){offset, twist, {y + normal * swing.z, z - normal * swing.y}};
}

/* Rates from the same 26 inputs. */
static inline Rates relative_rates(const real *u, const Pose *pose) {
    Vector3 spin_a = vector_of(u + 10);
    Vector3 apart = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7));
    Vector3 velocity = vector_subtract(apart, vector_cross(spin_a, pose->gap));
    Vector3 spin = quaternion_rotate_back(pose->frame, vector_subtract(vector_of(u + MOTION_SIZE + 10), spin_a));
    return rates_of(quaternion_rotate_back(pose->frame, velocity), spin, pose->swing);
}

/* Torque in hinge axes whose power is that of loads on the rates of relative_rates. */
static inline Vector3 conjugate_torque(real twist, Transverse bending, Transverse swing) {
    SwingFactors factors = factors_of_swing(swing);
    real normal = swing.z * bending.y - swing.y * bending.z;
    twist -= normal;
    real share = factors.across * normal + factors.lean * twist;
    return (Vector3){twist, bending.y + share * swing.z, bending.z - share * swing.y};
}

/* A vector held in hinge axes over a step, as its mean in world axes. */
static inline Vector3 mean_direction(Quaternion start, Quaternion end, Vector3 v) {
    return vector_mean(quaternion_rotate(start, v), quaternion_rotate(end, v));
}

/* Wrenches on A and on B, 12 numbers, that sum to zero about any point, from force and torque on B at its
   origin in world axes, and the gap from A to B, the mean over the step. */
static inline void store_pair(Vector3 force, Vector3 torque, Vector3 gap, real *wrench) {
    vector_store(vector_scaled(-1.0, force), wrench);
    vector_store(vector_scaled(-1.0, vector_add(torque, vector_cross(gap, force))), wrench + 3);
    vector_store(force, wrench + 6);
    vector_store(torque, wrench + 9);
}

/* Hinge frame and gap at both ends of a step: what makes wrenches of loads, and moments of coordinates of moments.
   Both maps are adjoint, so that slopes do the same work on the moments of ports and of coordinates. */
typedef struct Passage {
    Quaternion frame0, frame1;
    Vector3 gap0, gap1;
} Passage;

/* Centre line between two points over a step: mean and change of the vector, and the scale of its direction. A tension
   acts along scale x mean, and a slope of the tension also along the change of the direction within the step, so that
   no angular momentum is left over; moments of the length are taken with the adjoint. */
typedef struct Line {
    Vector3 mean, change;
    real scale;
} Line;

static inline Line line_between(Vector3 start, Vector3 end, real scale) {
    return (Line){vector_mean(start, end), vector_subtract(end, start), scale};
}

/* A sixth of the change of the direction. */
static inline Vector3 line_turning(const Line *line) {
    real share = vector_dot(line->mean, line->change) / vector_dot(line->mean, line->mean);
    return vector_scaled(line->scale / 6.0, vector_subtract(line->change, vector_scaled(share, line->mean)));
}

/* Moment of the length's rate, from that of the velocity of the second point against the first. */
static inline real line_moment(const Line *line, Vector3 apart) {
    return line->scale * vector_dot(line->mean, apart) + vector_dot(line_turning(line), line->change);
}

/* Mean force on the second point; its slope is along the line alone. */
static inline Vector3 line_force(const Line *line, real tension, real slope) {
    Vector3 along = vector_scaled(tension * line->scale, line->mean);
    return vector_scaled(-1.0, vector_add(along, vector_scaled(slope, line_turning(line))));
}

/* Twice the tangent of half the angle, along the axis, of the rotation from one frame to another, world axes. */
static inline Vector3 turn_between(Quaternion start, Quaternion end) {
    Quaternion turn = quaternion_multiply(end, quaternion_conjugate(start));
    return vector_scaled(2.0 / turn.w, (Vector3){turn.x, turn.y, turn.z});
}

/* What a slope of a force has for an arm beside the mean gap: the gap's own slope times the mean of P1^2. */
static inline Vector3 gap_slope(const Passage *passage) {
    return vector_scaled(1.0 / 6.0, vector_subtract(passage->gap1, passage->gap0));
}

/* A world vector in hinge axes, as the mean over the step. */
static inline Vector3 mean_back(const Passage *passage, Vector3 v) {
    return vector_mean(quaternion_rotate_back(passage->frame0, v), quaternion_rotate_back(passage->frame1, v));
}

/* Moments of the relative velocity and angular velocity in hinge axes, from those of both ports (12). */
static inline void relative_moments(const Passage *passage, const real *moments, Vector3 *velocity, Vector3 *spin) {
    Vector3 spin_a = vector_of(moments + 3);
    Vector3 apart = vector_subtract(vector_of(moments + 6), vector_of(moments));
    /* the gap changes while the first port turns */
    Vector3 turning = vector_cross(turn_between(passage->frame0, passage->frame1), gap_slope(passage));
    Vector3 carried = vector_add(vector_cross(spin_a, vector_mean(passage->gap0, passage->gap1)), turning);
    *velocity = mean_back(passage, vector_subtract(apart, carried));
    *spin = mean_back(passage, vector_subtract(vector_of(moments + 9), spin_a));
}

/* Moments of the rates of a pose; `swing` is the one in the middle of the step. */
static inline Rates rate_moments(const Passage *passage, const real *moments, Transverse swing) {
    Vector3 velocity, spin;
    relative_moments(passage, moments, &velocity, &spin);
    return rates_of(velocity, spin, swing);
}

/* Mean wrenches on A and B, 12 numbers, from loads on B in hinge axes that have no slopes. */
static inline void store_mean_pair(const Passage *passage, Vector3 force, Vector3 torque, real *wrench) {
    store_pair(mean_direction(passage->frame0, passage->frame1, force),
               mean_direction(passage->frame0, passage->frame1, torque), vector_mean(passage->gap0, passage->gap1),
               wrench);
}

/* The slopes of wrenches, 12 numbers, from those of the loads, and what they add to the mean ones already stored: the
   angular momentum that both ports get over the step is zero about any point. */
static inline void store_slope_pair(const Passage *passage, Vector3 force, Vector3 torque, real *wrench,
                                    real *slopes) {
    store_mean_pair(passage, force, torque, slopes);
    Vector3 added = vector_cross(gap_slope(passage), vector_of(slopes + 6));
    vector_store(vector_subtract(vector_of(wrench + 3), added), wrench + 3);
}

#ifndef FANFOLD_COMPLEX

/* A whole number from 0 to `largest`. */
static inline int read_choice(const Data *data, const char *name, int largest, int *choice, Reason *why) {
    const double *value = data_array(data, name, 1, why);
    if (!value) return 0;
    if (!(value[0] >= 0.0 && value[0] <= largest) || value[0] != floor(value[0]))
        return refuse(why, "%s is %g; it must be a whole number from 0 to %d", name, value[0], largest);
    *choice = (int)value[0];
    return 1;
}

/* `count` numbers whose squares sum to one. */
static inline int read_unit(const Data *data, const char *name, size_t count, double *unit, Reason *why) {
    const double *value = data_array(data, name, count, why);
    if (!value) return 0;
    double square = 0.0;
    for (size_t i = 0; i < count; i++) {
        unit[i] = value[i];
        square += value[i] * value[i];
    }
    if (!(fabs(square - 1.0) < 1e-9)) return refuse(why, "%s is not of unit length", name);
    return 1;
}

static inline int read_direction(const Data *data, const char *name, double direction[3], Reason *why) {
    return read_unit(data, name, 3, direction, why);
}

static inline int read_axis_frame(const Data *data, double frame[4], Reason *why) {
    return read_unit(data, "axis_frame", 4, frame, why);
}

#endif
#endif
