/* What a body tells where it is the spacecraft: part of body.c, the twin of components/body_parts/interface.py. Its state,
   behind all else: quaternion and rate one step earlier, and the record of port_loads.h. */

#ifndef FANFOLD_BODY_INTERFACE_H
#define FANFOLD_BODY_INTERFACE_H

#include "body_model.h"
#include "port_loads.h"

enum { ORIENTATION_BEFORE = 4, MOTION_BEFORE = 7, ATTITUDE_AND_RATE = 6 };

static inline size_t interface_begin(const Body *body) {
    return X_MODAL_AMPLITUDE + 2 * body->modes + WRENCH_SIZE * body->ports;
}

static inline size_t interface_states(const Body *body) { return MOTION_BEFORE + port_loads_record(body->ports); }

static inline size_t interface_told(const Body *body) { return ATTITUDE_AND_RATE + port_loads_told(body->ports); }

static inline void store_interface(const Body *body, const double *x, const real *u, double h, real *x_next) {
    const size_t begin = interface_begin(body), wrenches = WRENCH_SIZE * body->ports;
    const double *record = x + begin + MOTION_BEFORE;
    const int impulse = value_of(u[wrenches]) > 0.5;
    for (size_t i = 0; i < ORIENTATION_BEFORE; i++) x_next[begin + i] = x[X_ORIENTATION + i];
    for (size_t i = 0; i < 3; i++) x_next[begin + ORIENTATION_BEFORE + i] = x[X_ANGULAR_VELOCITY + i];
    store_port_loads(body->ports, record, u, u + wrenches + 1, h, impulse, x_next + begin + MOTION_BEFORE);
}

#ifndef FANFOLD_COMPLEX

/* Takes off the sum of all loads what accelerates bodies that the base carries; see components/body_parts/carried.py. */
static inline void leave_carried(const double *shares, const double rate[3], double load[WRENCH_SIZE]) {
    const double whole[CARRIED_COLUMNS] = {
        load[0], load[1], load[2], load[3], load[4], load[5],
        rate[0] * rate[0], rate[0] * rate[1], rate[0] * rate[2], rate[1] * rate[1], rate[1] * rate[2], rate[2] * rate[2],
    };
    for (size_t i = 0; i < WRENCH_SIZE; i++) {
        load[i] = 0.0;
        for (size_t j = 0; j < CARRIED_COLUMNS; j++) load[i] += shares[CARRIED_COLUMNS * i + j] * whole[j];
    }
}

/* Attitude as the rotation vector of the quaternion as it is, continuous over a full turn, rate in body axes, loads. */
static inline void observe_interface(const Body *body, const double *x, const double *u, double *z) {
    const double *q = x + X_ORIENTATION, *before = x + interface_begin(body);
    const double half = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double factor = half < 1e-8 ? 2.0 : 2.0 * atan2(half, q[0]) / half;
    double axes[9], axes_before[9];
    rotation_matrix(quaternion_of(q), axes);
    memcpy(axes_before, axes, sizeof axes);
    if (before[0] != 0.0 || before[1] != 0.0 || before[2] != 0.0 || before[3] != 0.0)
        rotation_matrix(quaternion_normalized(quaternion_of(before)), axes_before);
    for (size_t i = 0; i < 3; i++) z[i] = factor * q[1 + i];
    memcpy(z + 3, x + X_ANGULAR_VELOCITY, 3 * sizeof(double));
    const double *record = before + MOTION_BEFORE;
    double *now = z + ATTITUDE_AND_RATE;
    observe_port_loads(body->ports, body->origin_arms, record, u, axes, axes_before, now);
    if (body->has_carried) {
        leave_carried(body->carried, x + X_ANGULAR_VELOCITY, now);
        if (tells_earlier(record))
            leave_carried(body->carried, before + ORIENTATION_BEFORE, earlier_loads(body->ports, now));
    }
    leave_outside(body->ports, body->outside, body->origin_arms, now);
}

#endif

#endif
