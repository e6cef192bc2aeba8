/* Model exchange of bodies: the equations of motion as rates. Belongs to body.c, of either number type.

   Continuous states are the state without the angular velocity, which follows from the rest. */

#ifndef FANFOLD_BODY_EXCHANGE_H
#define FANFOLD_BODY_EXCHANGE_H

#include "body_modes.h"

enum { HEAT_RATE = 13, MODE_RATES = 14 };

void NAME(body_complete)(void *self, real *x);
int NAME(body_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why);

/* A quaternion of unit length, and the angular velocity that belongs to the momenta. */
void NAME(body_complete)(void *self, real *x) {
    Body *body = self;
    LocalWork stack;
    Work work = work_of(body, &stack);
    Quaternion q = quaternion_normalized(quaternion_of(x + X_ORIENTATION));
    real a[9], inertia[6];
    quaternion_store(q, x + X_ORIENTATION);
    rotation_matrix(q, a);
    load_modes(body, x, work.eta, work.pi);
    copied(body->coupling.inertia, 6, inertia);
    evaluate_coupling(body, work.eta, &work.coupling, inertia);
    if (body->modes) {
        deflect(body, work.eta, &work);
        remember_end(body, &work, inertia);
    }
    vector_store(solved(body, inertia, &work.coupling, transposed_times(a, vector_of(x + X_SPIN)), work.pi), x + X_ANGULAR_VELOCITY);
}

/* Rates of modal coordinates, momenta and heat; leaves the arms of the deformed body behind. */
static inline void exchange_modal_rates(Body *body, const real *x, const Load *load, const real a[9],
                                        const Work *work, real *rates) {
    size_t m = body->modes, n = body->padded_modes, l = body->coordinates;
    const double *frequency = body->oscillators.frequency, *ratio = body->oscillators.damping_ratio;
    real inertia[6], heat = 0.0;
    Vector3 omega = vector_of(x + X_ANGULAR_VELOCITY);
    load_modes(body, x, work->eta_mean, work->pi);
    memcpy(work->rate_mean, work->pi, n * sizeof(real));
    evaluate_coupling(body, work->eta_mean, &work->mid, inertia);
    if (body->coupling.full) {
        modal_rate(n, omega, work->mid.b, work->pi, work->rate_mean);
        gyroscopic_of(&body->coupling, work->rate_mean, work->mid.b_rate, &work->mid);
    }
    deformed_arms(body, work->eta_mean, work);
    if (body->second_order) hold_pairs(body, work);
    coupled_forces(body, omega, omega, (Vector3){0.0, 0.0, 0.0}, work);
    if (body->forms) {
        hold_tensions(body, work->eta_mean, work);
        subtract_held_gradient(body, work, work->force);
    }
    modal_force(body, load, a, a, work->deflection + l, work);
    for (size_t j = 0; j < m; j++) {
        real rate = work->rate_mean[j], friction = 2.0 * ratio[j] * frequency[j] * rate;
        heat += friction * rate;
        rates[MODE_RATES + body->order[j]] = rate;
        rates[MODE_RATES + m + body->order[j]] =
            work->force[j] + work->port_force[j] - friction - frequency[j] * frequency[j] * work->eta_mean[j];
    }
    rates[HEAT_RATE] = heat;
}

/* 1/2 q omega, and what brings a quaternion that a solver made longer or shorter back to unit length. */
static inline Quaternion exchange_turning(Quaternion q, Vector3 omega) {
    Quaternion turning = quaternion_multiply(q, (Quaternion){0.0, omega.x, omega.y, omega.z});
    real excess = 0.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (Quaternion){
        0.5 * turning.w + excess * q.w,
        0.5 * turning.x + excess * q.x,
        0.5 * turning.y + excess * q.y,
        0.5 * turning.z + excess * q.z,
    };
}

int NAME(body_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    Body *body = self;
    LocalWork stack;
    Work work = work_of(body, &stack);
    Load load = load_of(body, u);
    real a[9];
    rotation_matrix(quaternion_of(x + X_ORIENTATION), a);
    rates[HEAT_RATE] = 0.0;
    if (body->modes)
        exchange_modal_rates(body, x, &load, a, &work, rates);
    else
        undeformed_arms(body, &work);
    Vector3 weight = vector_scaled(body->mass, constant_vector(body->gravity));
    vector_store(vector_scaled(1.0 / body->mass, vector_of(x + X_MOMENTUM)), rates + X_POSITION);
    quaternion_store(exchange_turning(quaternion_of(raw + X_ORIENTATION), vector_of(x + X_ANGULAR_VELOCITY)), rates + X_ORIENTATION);
    vector_store(vector_add(load.mean.force, weight), rates + X_MOMENTUM);
    vector_store(vector_add(moment_of(body, &load, work.arms, a), load.mean.torque), rates + X_SPIN);
    return 1;
}

#ifndef FANFOLD_COMPLEX

void body_complete_complex(void *self, double complex *x);
int body_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                       double complex *rates, Reason *why);

static size_t body_continuous(const void *self, size_t *places) {
    const Body *body = self;
    size_t count = MODE_RATES + 2 * body->modes;
    for (size_t i = 0; places && i < count; i++) places[i] = i < X_ANGULAR_VELOCITY ? i : i + (X_HEAT - HEAT_RATE);
    return count;
}

#endif
#endif
