/* The modes of a body: their forces, rates and propagation, and what couples them to its rotation: part of body.c,
   of either number type. */

#ifndef FANFOLD_BODY_MODES_H
#define FANFOLD_BODY_MODES_H

#include "body_model.h"

/* Arms of the ports of the body deformed by eta. */
static inline void deformed_arms(const Body *body, const real *eta, const Work *work) {
    size_t l = body->coordinates;
    rows_combined(body->shapes, body->padded_modes, 2 * l, eta, work->deflection, work->coupling.split);
    for (size_t i = 0; i < 3 * body->ports; i++) work->arms[i] = body->arms[i] + work->deflection[i];
}

static inline void undeformed_arms(const Body *body, const Work *work) {
    for (size_t i = 0; i < 3 * body->ports; i++) work->arms[i] = body->arms[i];
}

/* Generalised forces of the load: Phi^T A^T f + Psi^T Jl(turn)^T A^T tau; `turns` are those of the ports. */
static inline void modal_force(const Body *body, const Load *load, const real a_force[9],
                               const real a_torque[9], const real *turns, const Work *work) {
    size_t l = body->coordinates;
    for (size_t k = 0; k < body->ports; k++) {
        const real *wrench = load->wrenches + WRENCH * k;
        Vector3 torque = transposed_times(a_torque, vector_of(wrench + 3)), turn = vector_of(turns + 3 * k);
        Vector3 once = vector_cross(turn, torque), twice = vector_cross(turn, once);
        Vector3 conjugate = vector_add(vector_subtract(torque, vector_scaled(0.5, once)),
                                       vector_scaled(1.0 / 6.0, twice));
        vector_store(transposed_times(a_force, vector_of(wrench)), work->wrenches + 3 * k);
        vector_store(conjugate, work->wrenches + l + 3 * k);
    }
    for (size_t i = 3 * body->ports; i < l; i++) work->wrenches[i] = work->wrenches[l + i] = 0.0;
    rows_projected(body->shapes, body->padded_modes, 2 * l, work->wrenches, work->port_force, work->coupling.split);
}

static inline int recalled(const Remembered *remembered, const real *eta, size_t modes) {
    return remembered->known && memcmp(remembered->eta, eta, modes * sizeof(real)) == 0;
}

static inline void remember(Remembered *remembered, const real *eta, const real *b, size_t modes) {
    memcpy(remembered->eta, eta, modes * sizeof(real));
    memcpy(remembered->b, b, 3 * modes * sizeof(real));
    remembered->known = 1;
}

/* What is remembered of the state that the last step led to. */
static inline Remembered *end_of(Body *body) {
#ifdef FANFOLD_COMPLEX
    return &body->at_end_complex;
#else
    return &body->at_end;
#endif
}

/* B at eta, remembered or evaluated. */
static inline const real *gyroscopic_at(Body *body, const real *eta, const Work *work) {
    size_t n = body->padded_modes;
    if (recalled(end_of(body), eta, n)) return end_of(body)->b;
#ifndef FANFOLD_COMPLEX
    if (recalled(&body->at_start, eta, n)) return body->at_start.b;
#endif
    gyroscopic_of(&body->coupling, eta, work->coupling.b, &work->coupling);
    return work->coupling.b;
}

/* Rates eta' = pi - B^T omega from modal momenta. */
FANFOLD_VECTORISED static void modal_rate(size_t n, Vector3 omega, const real *restrict b, const real *restrict pi,
                                          real *restrict rate) {
    for (size_t j = 0; j < n; j++)
        rate[j] = pi[j] - (omega.x * b[j] + omega.y * b[n + j] + omega.z * b[2 * n + j]);
}

/* Copies the modal part of a state, and zeros behind it. */
static inline void load_modes(const Body *body, const real *x, real *eta, real *pi) {
    const unsigned short *order = body->order;
    const real *momenta = x + MODES + body->modes;
    for (size_t j = 0; j < body->modes; j++) {
        eta[j] = x[MODES + order[j]];
        pi[j] = momenta[order[j]];
    }
    for (size_t j = body->modes; j < body->padded_modes; j++) eta[j] = pi[j] = 0.0;
}

static inline void store_modes(const Body *body, const real *eta, const real *pi, real *x) {
    const unsigned short *order = body->order;
    real *momenta = x + MODES + body->modes;
    for (size_t j = 0; j < body->modes; j++) {
        x[MODES + order[j]] = eta[j];
        momenta[order[j]] = pi[j];
    }
}

/* The modes at the start of a step: coordinates, momenta, rates. No derivative enters here. */
static inline void start_modes(Body *body, const double *x, const Work *work) {
    size_t m = body->modes, n = body->padded_modes;
    for (size_t j = 0; j < n; j++) {
        work->eta_mean[j] = work->eta_start[j] = j < m ? x[MODES + body->order[j]] : 0.0;
        work->rate_mean[j] = work->pi_start[j] = j < m ? x[MODES + m + body->order[j]] : 0.0;
    }
    if (!body->coupling.full) return;
#ifdef FANFOLD_COMPLEX
    const real *b = gyroscopic_at(body, work->eta_start, work);
#else
    if (!recalled(&body->at_start, work->eta_start, n))
        remember(&body->at_start, work->eta_start, gyroscopic_at(body, work->eta_start, work), n);
    const real *b = body->at_start.b;
#endif
    modal_rate(n, constant_vector(x + OMEGA), b, work->pi_start, work->rate_mean);
}

/* The modes over a step under their force, which the port forces join, and the means the iteration needs. */
FANFOLD_VECTORISED static void propagate(const Propagator *prop, size_t n, const Work *work) {
    const real *restrict eta_start = work->eta_start, *restrict pi_start = work->pi_start;
    const real *restrict drag = work->drag, *restrict port_force = work->port_force;
    real *restrict force = work->force, *restrict eta = work->eta, *restrict pi = work->pi;
    real *restrict rate_start = work->rate_start, *restrict pi_mean = work->pi_mean;
    real *restrict eta_mean = work->eta_mean, *restrict rate_mean = work->rate_mean;
    const double *restrict a11 = prop->a11, *restrict a12 = prop->a12, *restrict a21 = prop->a21;
    const double *restrict a22 = prop->a22, *restrict b1 = prop->b1;
    for (size_t j = 0; j < n; j++) {
        real q = force[j] + port_force[j], v = pi_start[j] - drag[j];
        real end = a11[j] * eta_start[j] + a12[j] * v + b1[j] * q;
        real end_rate = a21[j] * eta_start[j] + a22[j] * v + a12[j] * q;
        force[j] = q;
        rate_start[j] = v;
        eta[j] = end;
        pi[j] = end_rate + drag[j];
        pi_mean[j] = 0.5 * (pi_start[j] + pi[j]);
        eta_mean[j] = 0.5 * (eta_start[j] + end);
        rate_mean[j] = 0.5 * (v + end_rate);
    }
}

/* Energy turned into heat over the step. */
FANFOLD_VECTORISED static real dissipated(const Propagator *prop, const double *compliance, size_t n,
                                          const Work *work) {
    real heat = 0.0;
    for (size_t j = 0; j < n; j++) {
        real z = work->eta_start[j] - compliance[j] * work->force[j], v = work->rate_start[j];
        heat += prop->w11[j] * (z * z) + prop->w12[j] * (z * v) + prop->w22[j] * (v * v);
    }
    return heat;
}

/* B, J - B B^T and the quadratic forces at mid-step, as far as the level keeps them. */
static inline void couple(const Body *body, Vector3 omega, const Work *work, real inertia[6]) {
    const InertiaCoupling *coupling = &body->coupling;
    size_t n = body->padded_modes;
    if (!coupling->varies) {
        for (size_t j = 0; j < n; j++) work->force[j] = work->drag[j] = 0.0;
        return;
    }
    if (coupling->full) {
        quadratic_at(coupling, work->eta_mean, &work->coupling);
        gyroscopic_of(coupling, work->eta_mean, work->coupling.b, &work->coupling);
        gyroscopic_of(coupling, work->rate_mean, work->coupling.b_rate, &work->coupling);
    }
    inertia_at(coupling, work->eta_mean, &work->coupling, inertia);
    coupling_forces(coupling, omega, &work->coupling, work->force, work->drag);
}

/* Angular velocity from the momentum in body axes, whose part in the modes is B pi. */
static inline Vector3 solved(const Body *body, const real inertia[6], Vector3 momentum, const real *pi,
                             const Work *work) {
    size_t n = body->padded_modes;
    const real *b = work->coupling.b;
    if (!body->coupling.varies) return constant_times(body->coupling.inverse, momentum);
    if (body->coupling.full) {
        momentum.x -= dot_product(b, pi, n);
        momentum.y -= dot_product(b + n, pi, n);
        momentum.z -= dot_product(b + 2 * n, pi, n);
    }
    return solve_symmetric(inertia, momentum);
}

/* Angular velocity at the end of a step, from the momentum in body axes and the modes there. */
static inline Vector3 angular_velocity(Body *body, Vector3 momentum, const Work *work) {
    const InertiaCoupling *coupling = &body->coupling;
    size_t n = body->padded_modes;
    real inertia[6] = {0.0};
    if (coupling->full) {
        quadratic_at(coupling, work->eta, &work->coupling);
        gyroscopic_of(coupling, work->eta, work->coupling.b, &work->coupling);
        remember(end_of(body), work->eta, work->coupling.b, n);
    }
    if (coupling->varies) inertia_at(coupling, work->eta, &work->coupling, inertia);
    return solved(body, inertia, momentum, work->pi, work);
}

#endif
