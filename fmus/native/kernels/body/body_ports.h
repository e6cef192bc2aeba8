/* Poses and velocities of a body's ports: part of body.c, of either number type. */

#ifndef FANFOLD_BODY_PORTS_H
#define FANFOLD_BODY_PORTS_H

#include "body_modes.h"

/* Deflections, turns and their rates at the ports; zeros for a rigid body. */
static inline void deform_ports(Body *body, const real *x, Vector3 omega, const Work *work) {
    size_t n = body->padded_modes, l = body->coordinates;
    const real *rate = work->pi;
    if (!n) {
        for (size_t i = 0; i < 2 * l; i++) work->deflection[i] = work->rates[i] = 0.0;
        return;
    }
    load_modes(body, x, work->eta, work->pi);
    const Remembered *known = known_at(body, work->eta);
    if (body->coupling.full) {
        modal_rate(n, omega, gyroscopic_at(body, known, work->eta, work), work->pi, work->rate_mean);
        rate = work->rate_mean;
    }
    if (known)
        memcpy(work->deflection, known->deflection, 2 * l * sizeof(real));
    else
        deflect(body, work->eta, work);
    rows_combined(body->shapes, n, 2 * l, rate, work->rates, work->coupling.split);
    if (body->second_order) {
        const Pairs pairs = pairs_of(body, work);
        pairs_combined(body, &pairs, known ? known->pairs : pairs.end, rate, 1.0, work->rates);
    }
}

void NAME(body_outputs)(void *self, const real *x, const real *u, real *y);

/* Pose and velocity of every port, world axes. */
void NAME(body_outputs)(void *self, const real *x, const real *u, real *y) {
    Body *body = self;
    (void)u;
    LocalWork stack;
    Work work = work_of(body, &stack);
    size_t l = body->coordinates;
    Quaternion q = quaternion_of(x + X_ORIENTATION);
    Vector3 position = vector_of(x + X_POSITION), omega = vector_of(x + X_ANGULAR_VELOCITY);
    Vector3 velocity = vector_scaled(1.0 / body->mass, vector_of(x + X_MOMENTUM));
    real a[9];
    rotation_matrix(q, a);
    deform_ports(body, x, omega, &work);
    for (size_t k = 0; k < body->ports; k++, y += MOTION_SIZE) {
        const double *own = body->port_orientation + 4 * k;
        Vector3 turn = vector_of(work.deflection + l + 3 * k), twist = vector_of(work.rates + l + 3 * k);
        Vector3 arm = vector_add(constant_vector(body->arms + 3 * k), vector_of(work.deflection + 3 * k));
        Vector3 rate_of_turn = vector_add(omega, twist_of(turn, twist));
        Vector3 relative = vector_add(vector_cross(omega, arm), vector_of(work.rates + 3 * k));
        Quaternion local = {own[0], own[1], own[2], own[3]};
        if (body->modes) local = quaternion_multiply(quaternion_exponential(turn), local);
        vector_store(vector_add(position, matrix_times(a, arm)), y);
        quaternion_store(quaternion_multiply(q, local), y + 3);
        vector_store(vector_add(velocity, matrix_times(a, relative)), y + 7);
        vector_store(matrix_times(a, rate_of_turn), y + 10);
    }
    const real *moments = x + X_MODAL_AMPLITUDE + 2 * body->modes;
    for (size_t i = 0; i < WRENCH_SIZE * body->ports; i++) y[i] = moments[i];
}

#endif
