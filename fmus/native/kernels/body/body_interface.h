/* What a body tells where it is the spacecraft: part of body.c, the twin of components/body_parts/interface.py. Its state,
   behind all else: the quaternion one step earlier, and the record of port_loads.h. */

#ifndef FANFOLD_BODY_INTERFACE_H
#define FANFOLD_BODY_INTERFACE_H

#include "body_model.h"
#include "port_loads.h"

enum { ORIENTATION_BEFORE = 4, ATTITUDE_AND_RATE = 6 };

static inline size_t interface_begin(const Body *body) {
    return X_MODAL_AMPLITUDE + 2 * body->modes + WRENCH_SIZE * body->ports;
}

static inline size_t interface_states(const Body *body) { return ORIENTATION_BEFORE + port_loads_record(body->ports); }

static inline size_t interface_told(const Body *body) { return ATTITUDE_AND_RATE + port_loads_told(body->ports); }

static inline void store_interface(const Body *body, const double *x, const real *u, double h, real *x_next) {
    const size_t begin = interface_begin(body), wrenches = WRENCH_SIZE * body->ports;
    const double *record = x + begin + ORIENTATION_BEFORE;
    const int impulse = value_of(u[wrenches]) > 0.5;
    for (size_t i = 0; i < ORIENTATION_BEFORE; i++) x_next[begin + i] = x[X_ORIENTATION + i];
    store_port_loads(body->ports, record, u, u + wrenches + 1, h, impulse, x_next + begin + ORIENTATION_BEFORE);
}

#ifndef FANFOLD_COMPLEX

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
    observe_port_loads(body->ports, body->origin_arms, before + ORIENTATION_BEFORE, u, axes, axes_before,
                       z + ATTITUDE_AND_RATE);
}

#endif

#endif
