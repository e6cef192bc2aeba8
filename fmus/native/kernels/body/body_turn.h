/* Newton's correction of the angular velocity that a step turns a body by: the twin of components/body_parts/turn.py,
   which says why; part of body.c, of either number type. */

#ifndef FANFOLD_BODY_TURN_H
#define FANFOLD_BODY_TURN_H

#include "body_modes.h"

/* Rotations of a step. */
typedef struct {
    real start[9], mid[9], end[9];
} Axes;

/* Outcome of a step's iteration: angular velocity, the mean over the step and that of its end, and by what the momentum
   changed, body axes; moments on the arms of the start; J - B B^T at the mean modal coordinates and at the end; heat. */
typedef struct {
    Vector3 omega, end, change;
    Course moments_start;
    real inertia[6], inertia_end[6], heat;
} Turned;

/* a += scale times the matrix of the product v x. */
static inline void add_cross(double scale, Vector3 v, double a[9]) {
    const double x = scale * value_of(v.x), y = scale * value_of(v.y), z = scale * value_of(v.z);
    a[1] -= z, a[2] += y, a[3] += z;
    a[5] -= x, a[6] -= y, a[7] += x;
}

/* a += scale times by what the moment of a force on an arm changes with a turn of the arm, both in body axes. */
static inline void add_lever(double scale, Vector3 arm, Vector3 force, double a[9]) {
    const double s[3] = {value_of(arm.x), value_of(arm.y), value_of(arm.z)};
    const double f[3] = {value_of(force.x), value_of(force.y), value_of(force.z)};
    const double along = s[0] * f[0] + s[1] * f[1] + s[2] * f[2];
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 3; j++) a[3 * i + j] += scale * s[i] * f[j];
        a[3 * i + i] -= scale * along;
    }
}

/* a turned by what a change of the mean angular velocity v makes of the turn at the end of a step h: a times the right
   Jacobian of the rotation vector h v, as a series. */
static inline void at_end_of_turn(double h, Vector3 v, double a[9]) {
    const double t[3] = {h * value_of(v.x), h * value_of(v.y), h * value_of(v.z)};
    const double square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
    const double once = -0.5 + square / 24.0, twice = 1.0 / 6.0 - square / 120.0;
    double jacobian[9] = {0.0}, turned[9];
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 3; j++) jacobian[3 * i + j] = twice * t[i] * t[j];
        jacobian[3 * i + i] += 1.0 - twice * square;
    }
    add_cross(once * h, v, jacobian);
    for (size_t i = 0; i < 9; i++)
        turned[i] = a[i - i % 3] * jacobian[i % 3] + a[i - i % 3 + 1] * jacobian[3 + i % 3] +
                    a[i - i % 3 + 2] * jacobian[6 + i % 3];
    memcpy(a, turned, sizeof turned);
}

/* The solution of a 3x3 system, by cofactors. */
static inline Vector3 solve_general(const double a[9], Vector3 right) {
    const double cofactors[9] = {
        a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
        a[5] * a[6] - a[3] * a[8], a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
        a[3] * a[7] - a[4] * a[6], a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3],
    };
    const double scale = 1.0 / (a[0] * cofactors[0] + a[1] * cofactors[3] + a[2] * cofactors[6]);
    return vector_scaled(scale, constant_times(cofactors, right));
}

/* The mean angular velocity after one more iteration, from `mean`, what it would have to be for the end that the present
   one leads to. momentum: at the end, body axes; moment_slope: world axes. Arms at the end are those of `work`. */
static inline Vector3 newton_turn(const Body *body, const Load *load, const Axes *axes, const Work *work,
                                  const Turned *turned, Vector3 momentum, Vector3 moment_slope, double h, Vector3 mean) {
    static const unsigned char entry[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    const real *inertia = turned->inertia_end;
    double tangent[9] = {0.0};
    add_cross(-0.5 * h, momentum, tangent);
    for (size_t k = 0; k < body->ports; k++) {
        /* slopes change the mean moment and their own by turns that cancel */
        Vector3 force = transposed_times(axes->end, vector_of(load->wrenches + WRENCH_SIZE * k));
        add_lever(-0.25 * h * h, vector_of(work->arms + 3 * k), force, tangent);
    }
    at_end_of_turn(h, turned->omega, tangent);
    for (size_t i = 0; i < 9; i++) tangent[i] += value_of(inertia[entry[i]]);
    if (load->sloped) add_cross(h * h / 12.0, transposed_times(axes->mid, moment_slope), tangent);
    const Vector3 missing = vector_subtract(mean, turned->omega);
    return vector_add(turned->omega, solve_general(tangent, symmetric_times(inertia, missing)));
}

#endif
