/* The modes of a body: their forces, rates and propagation, and what couples them to its rotation: part of body.c,
   of either number type. */

#ifndef FANFOLD_BODY_MODES_H
#define FANFOLD_BODY_MODES_H

#include "body_second_order.h"

/* Deflections of the ports of the body deformed by eta. */
static inline void deflect(const Body *body, const real *eta, const Work *work) {
    size_t l = body->coordinates;
    rows_combined(body->shapes, body->padded_modes, 2 * l, eta, work->deflection, work->coupling.split);
    if (body->second_order) deflect_to_second_order(body, eta, work, work->deflection);
}

/* The same, and the arms of the ports. */
static inline void deformed_arms(const Body *body, const real *eta, const Work *work) {
    deflect(body, eta, work);
    for (size_t i = 0; i < 3 * body->ports; i++) work->arms[i] = body->arms[i] + work->deflection[i];
}

static inline void undeformed_arms(const Body *body, const Work *work) {
    for (size_t i = 0; i < 3 * body->ports; i++) work->arms[i] = body->arms[i];
}

/* Jl(turn) rate: angular velocity of a port that turned by a rotation vector, from the rate of this. */
static inline Vector3 twist_of(Vector3 turn, Vector3 rate) {
    Vector3 once = vector_cross(turn, rate), twice = vector_cross(turn, once);
    return vector_add(rate, vector_add(vector_scaled(0.5, once), vector_scaled(1.0 / 6.0, twice)));
}

/* Jl(turn)^T torque: what does work on the modal rates. */
static inline Vector3 conjugate_torque(Vector3 turn, Vector3 torque) {
    Vector3 once = vector_cross(turn, torque), twice = vector_cross(turn, once);
    return vector_add(vector_subtract(torque, vector_scaled(0.5, once)), vector_scaled(1.0 / 6.0, twice));
}

/* Generalised forces of the mean load: Phi^T A^T f + Psi^T Jl(turn)^T A^T tau; `turns` are those of the ports. */
static inline void modal_force(const Body *body, const Load *load, const real a_force[9],
                               const real a_torque[9], const real *turns, const Work *work) {
    size_t l = body->coordinates;
    for (size_t k = 0; k < body->ports; k++) {
        const real *wrench = load->wrenches + WRENCH_SIZE * k;
        Vector3 torque = transposed_times(a_torque, vector_of(wrench + 3));
        vector_store(transposed_times(a_force, vector_of(wrench)), work->wrenches + 3 * k);
        vector_store(conjugate_torque(vector_of(turns + 3 * k), torque), work->wrenches + l + 3 * k);
    }
    for (size_t i = 3 * body->ports; i < l; i++) work->wrenches[i] = work->wrenches[l + i] = 0.0;
    rows_projected(body->shapes, body->padded_modes, 2 * l, work->wrenches, work->port_force, work->coupling.split);
    if (body->second_order) {
        const Pairs pairs = pairs_of(body, work);
        pairs_projected(body, &pairs, pairs.mid, work->wrenches, NULL, work->port_force, NULL);
    }
}

/* Means and slopes of the generalised forces over a step, at the turns of its middle. A changing wrench on a shape that
   turns on has a mean as well. */
static inline void modal_forces(const Body *body, const Load *load, const real a_start[9], const real a_mid[9],
                                const real a_end[9], const real *turns, const Work *work) {
    size_t l = body->coordinates;
    real a_mean[9], turned[9], *wrenches = work->wrenches, *slopes = work->slope_wrenches;
    for (size_t e = 0; e < 9; e++) a_mean[e] = 0.5 * (a_start[e] + a_end[e]);
    if (!load->sloped) {
        modal_force(body, load, a_mean, a_mid, turns, work);
        return;
    }
    for (size_t e = 0; e < 9; e++) turned[e] = (1.0 / 6.0) * (a_end[e] - a_start[e]);
    for (size_t k = 0; k < body->ports; k++) {
        const real *wrench = load->wrenches + WRENCH_SIZE * k, *slope = load->slopes + WRENCH_SIZE * k;
        Vector3 force_slope = vector_of(slope), torque_slope = vector_of(slope + 3), turn = vector_of(turns + 3 * k);
        Vector3 force = vector_add(transposed_times(a_mean, vector_of(wrench)), transposed_times(turned, force_slope));
        Vector3 torque =
            vector_add(transposed_times(a_mid, vector_of(wrench + 3)), transposed_times(turned, torque_slope));
        vector_store(force, wrenches + 3 * k);
        vector_store(conjugate_torque(turn, torque), wrenches + l + 3 * k);
        vector_store(transposed_times(a_mean, force_slope), slopes + 3 * k);
        vector_store(conjugate_torque(turn, transposed_times(a_mid, torque_slope)), slopes + l + 3 * k);
    }
    for (size_t i = 3 * body->ports; i < l; i++)
        wrenches[i] = wrenches[l + i] = slopes[i] = slopes[l + i] = 0.0;
    rows_projected_twice(body->shapes, body->padded_modes, 2 * l, wrenches, slopes, work->port_force, work->slope,
                         work->coupling.split);
    if (body->second_order) {
        const Pairs pairs = pairs_of(body, work);
        pairs_projected(body, &pairs, pairs.mid, wrenches, slopes, work->port_force, work->slope);
    }
}

static inline int recalled(const Remembered *remembered, const real *eta, size_t modes) {
    return remembered->known && memcmp(remembered->eta, eta, modes * sizeof(real)) == 0;
}

/* What `work` holds of the body deformed by eta, as far as its level keeps it. */
static inline Remembered present_of(const Body *body, const real *eta, const real *inertia, const Work *work) {
    void *pairs = body->second_order ? pairs_of(body, work).end : NULL;
    return (Remembered){1, (void *)eta, work->coupling.quadratic, work->coupling.b, (void *)inertia, work->deflection, pairs};
}

static inline void remember(const Body *body, Remembered *remembered, const Remembered *present) {
    const size_t mode = body->padded_modes * sizeof(real), port = 2 * body->coordinates * sizeof(real);
    memcpy(remembered->eta, present->eta, mode);
    if (body->coupling.full) {
        memcpy(remembered->quadratic, present->quadratic, 6 * mode);
        memcpy(remembered->b, present->b, 3 * mode);
    }
    memcpy(remembered->inertia, present->inertia, 6 * sizeof(real));
    memcpy(remembered->deflection, present->deflection, port);
    if (body->second_order) memcpy(remembered->pairs, present->pairs, body->second_order * port);
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

/* What is remembered of eta, NULL for nothing. */
static inline const Remembered *known_at(Body *body, const real *eta) {
    if (recalled(end_of(body), eta, body->padded_modes)) return end_of(body);
#ifndef FANFOLD_COMPLEX
    if (recalled(&body->at_start, eta, body->padded_modes)) return &body->at_start;
#endif
    return NULL;
}

/* B at eta, of which this is remembered, or evaluated. */
static inline const real *gyroscopic_at(const Body *body, const Remembered *known, const real *eta, const Work *work) {
    if (known) return known->b;
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
    const real *momenta = x + X_MODAL_AMPLITUDE + body->modes;
    for (size_t j = 0; j < body->modes; j++) {
        eta[j] = x[X_MODAL_AMPLITUDE + order[j]];
        pi[j] = momenta[order[j]];
    }
    for (size_t j = body->modes; j < body->padded_modes; j++) eta[j] = pi[j] = 0.0;
}

static inline void store_modes(const Body *body, const real *eta, const real *pi, real *x) {
    const unsigned short *order = body->order;
    real *momenta = x + X_MODAL_AMPLITUDE + body->modes;
    for (size_t j = 0; j < body->modes; j++) {
        x[X_MODAL_AMPLITUDE + order[j]] = eta[j];
        momenta[order[j]] = pi[j];
    }
}

/* Products at eta in `at`, and J - B B^T, as far as the level keeps them. */
static inline void evaluate_coupling(const Body *body, const real *eta, const CouplingScratch *at, real inertia[6]) {
    const InertiaCoupling *coupling = &body->coupling;
    if (coupling->full) {
        quadratic_at(coupling, eta, at);
        gyroscopic_of(coupling, eta, at->b, at);
    }
    if (coupling->varies) inertia_at(coupling, eta, at, inertia);
}

/* Has what `work` holds of the end of a step remembered. */
static inline void remember_end(Body *body, const Work *work, const real inertia[6]) {
    const Remembered present = present_of(body, work->eta, inertia, work);
    remember(body, end_of(body), &present);
}

/* Has what the start of a step gives to all steps from there evaluated where it is not known. No derivative enters. */
void body_depart(Body *body, const double *eta, const double *momenta, const double *omega);

#ifndef FANFOLD_COMPLEX

/* Has the same of the start of a step remembered. */
static inline void remember_start(Body *body, const double *eta, const Work *work) {
    const Remembered *known = known_at(body, eta);
    if (known == &body->at_start) return;
    body->departure.known = 0;
    if (known) {
        remember(body, &body->at_start, known);
        return;
    }
    double inertia[6];
    memcpy(inertia, body->coupling.inertia, sizeof inertia);
    evaluate_coupling(body, eta, &work->coupling, inertia);
    deflect(body, eta, work);
    const Remembered present = present_of(body, eta, inertia, work);
    remember(body, &body->at_start, &present);
}

void body_depart(Body *body, const double *eta, const double *momenta, const double *omega) {
    const size_t size = body->padded_modes * sizeof(double);
    Departure *departure = &body->departure;
    LocalWork stack;
    const Work work = work_of(body, &stack);
    remember_start(body, eta, &work);
    if (departure->known && memcmp(departure->momenta, momenta, size) == 0 &&
        memcmp(departure->omega, omega, sizeof departure->omega) == 0)
        return;
    memcpy(departure->momenta, momenta, size);
    memcpy(departure->rates, momenta, size);
    memcpy(departure->omega, omega, sizeof departure->omega);
    if (body->coupling.full) {
        modal_rate(body->padded_modes, vector_of(omega), body->at_start.b, momenta, departure->rates);
        gyroscopic_of(&body->coupling, departure->rates, departure->b, &work.coupling);
    }
    departure->known = 1;
}

#endif

static inline void copied(const double *numbers, size_t count, real *out) {
    for (size_t i = 0; i < count; i++) out[i] = numbers[i];
}

/* The modes at the start of a step: coordinates, momenta, rates, no slope, turns of the ports, and the coupling, which
   stands for the whole step. No derivative enters here. */
static inline void start_modes(Body *body, const double *x, const Work *work, real *turns, real inertia[6]) {
    size_t m = body->modes, n = body->padded_modes, l = body->coordinates;
    const Remembered *start = &body->at_start;
    double *eta = work->coupling.split, *momenta = eta + n;
    for (size_t j = 0; j < n; j++) {
        eta[j] = j < m ? x[X_MODAL_AMPLITUDE + body->order[j]] : 0.0;
        momenta[j] = j < m ? x[X_MODAL_AMPLITUDE + m + body->order[j]] : 0.0;
        work->eta[j] = work->eta_start[j] = work->eta_mean[j] = eta[j];
        work->pi_start[j] = momenta[j];
        work->slope[j] = 0.0;
    }
    body_depart(body, eta, momenta, x + X_ANGULAR_VELOCITY);
    const double *deflection = start->deflection;
    for (size_t i = 0; i < 3 * body->ports; i++) work->arms[i] = body->arms[i] + deflection[i];
    copied(body->departure.rates, n, work->rate_mean);
    copied(deflection + l, l, turns);
    if (body->second_order) copied(start->pairs, body->second_order * 2 * l, pairs_of(body, work).mid);
    copied(start->inertia, 6, inertia);
    if (!body->coupling.full) return;
    copied(start->quadratic, 6 * n, work->mid.quadratic);
    copied(start->b, 3 * n, work->mid.b);
    copied(body->departure.b, 3 * n, work->mid.b_rate);
}

/* The modes over a step under their force, which the port forces join, and its slope, and the means the iteration needs. */
FANFOLD_VECTORISED static void propagate(const Propagator *prop, size_t n, const Work *work) {
    const real *restrict eta_start = work->eta_start, *restrict pi_start = work->pi_start;
    const real *restrict drag = work->drag, *restrict port_force = work->port_force, *restrict slope = work->slope;
    real *restrict force = work->force, *restrict eta = work->eta, *restrict pi = work->pi;
    real *restrict rate_start = work->rate_start;
    real *restrict eta_mean = work->eta_mean, *restrict rate_mean = work->rate_mean;
    const double *restrict a11 = prop->a11, *restrict a12 = prop->a12, *restrict a21 = prop->a21;
    const double *restrict a22 = prop->a22, *restrict b1 = prop->b1, *restrict c1 = prop->c1, *restrict c2 = prop->c2;
    const double sixth = prop->h / 6.0;
    for (size_t j = 0; j < n; j++) {
        real q = force[j] + port_force[j], v = pi_start[j] - drag[j], s = slope[j];
        real end = a11[j] * eta_start[j] + a12[j] * v + b1[j] * q + c1[j] * s;
        real end_rate = a21[j] * eta_start[j] + a22[j] * v + a12[j] * q + c2[j] * s;
        force[j] = q;
        rate_start[j] = v;
        eta[j] = end;
        pi[j] = end_rate + drag[j];
        eta_mean[j] = 0.5 * (eta_start[j] + end);
        rate_mean[j] = 0.5 * (v + end_rate) - sixth * s;
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

/* What slopes add to that. */
FANFOLD_VECTORISED static real dissipated_by_slopes(const Propagator *prop, const double *compliance, size_t n,
                                                    const Work *work) {
    real heat = 0.0;
    for (size_t j = 0; j < n; j++) {
        real z = work->eta_start[j] - compliance[j] * work->force[j], s = work->slope[j];
        heat += s * (prop->s1[j] * z + prop->s2[j] * work->rate_start[j] + prop->s3[j] * s);
    }
    return heat;
}

/* First moments over the step of the modal rates that drag leaves. */
FANFOLD_VECTORISED static void moments_of_momenta(const Oscillators *oscillators, const Propagator *prop, size_t n,
                                                  const Work *work) {
    const real *restrict eta_start = work->eta_start, *restrict force = work->force;
    const real *restrict rate_start = work->rate_start, *restrict slope = work->slope;
    const double *restrict w = oscillators->frequency, *restrict c1 = prop->c1, *restrict c2 = prop->c2;
    real *restrict moment = work->moment;
    for (size_t j = 0; j < n; j++)
        moment[j] = c1[j] * (w[j] * w[j] * eta_start[j] - force[j]) - c2[j] * rate_start[j] + prop->d[j] * slope[j];
}

/* y -= B^T v. */
FANFOLD_VECTORISED static void subtract_drag(size_t n, Vector3 v, const real *restrict b, real *restrict y) {
    for (size_t j = 0; j < n; j++) y[j] -= v.x * b[j] + v.y * b[n + j] + v.z * b[2 * n + j];
}

/* Coupling at the mean modal coordinates and rates of a step, from those at both ends, and J - B B^T there. */
static inline void couple_mean(const Body *body, const Work *work, real inertia[6]) {
    const InertiaCoupling *coupling = &body->coupling;
    const Remembered *start = &body->at_start;
    if (coupling->full) {
        coupling_mean(body->padded_modes, start->quadratic, start->b, &work->coupling, &work->mid);
        gyroscopic_of(coupling, work->rate_mean, work->mid.b_rate, &work->mid);
    }
    if (coupling->varies) inertia_at(coupling, work->eta_mean, &work->mid, inertia);
}

/* The quadratic forces of a step and its drag, as `coupling_forces` has them. */
static inline void coupled_forces(const Body *body, Vector3 start, Vector3 end, Vector3 bend, const Work *work) {
    const InertiaCoupling *coupling = &body->coupling;
    if (!coupling->varies) {
        for (size_t j = 0; j < body->padded_modes; j++) work->force[j] = work->drag[j] = 0.0;
        return;
    }
    coupling_forces(coupling, start, end, bend, &work->mid, work->force, work->drag);
}

/* Angular velocity from the momentum in body axes, whose part in the modes is B pi. */
static inline Vector3 solved(const Body *body, const real inertia[6], const CouplingScratch *at, Vector3 momentum,
                             const real *pi) {
    size_t n = body->padded_modes;
    if (!body->coupling.varies) return constant_times(body->coupling.inverse, momentum);
    if (body->coupling.full) momentum = vector_subtract(momentum, gyroscopic_times(at->b, pi, n));
    return solve_symmetric(inertia, momentum);
}

/* By what J - B B^T and B grow over a step: what of its change of momentum, body axes, does not turn the body on. B of the
   end, in the working memory, gives way to its growth. mean: of the angular velocities at both ends. */
static inline Vector3 less_growth(const Body *body, Vector3 change, Vector3 mean, const real inertia_end[6],
                                  const Work *work) {
    size_t n = body->padded_modes;
    if (!body->coupling.varies) return change;
    const double *inertia_start = body->at_start.inertia, *b_start = body->at_start.b;
    real growth[6];
    for (size_t p = 0; p < 6; p++) growth[p] = inertia_end[p] - inertia_start[p];
    change = vector_subtract(change, symmetric_times(growth, mean));
    if (!body->coupling.full) return change;
    for (size_t i = 0; i < 3 * n; i++) work->coupling.b[i] -= b_start[i];
    for (size_t j = 0; j < n; j++) work->rate_mean[j] += work->drag[j];
    return vector_subtract(change, gyroscopic_times(work->coupling.b, work->rate_mean, n));
}

/* First moments over a step: of the angular velocity (rad), which it returns, and of the modal rates. change: of the
   momentum in body axes; mean: of the angular velocities at both ends; inertia: at the mean modal coordinates. */
static inline Vector3 moments_over(const Body *body, const Propagator *prop, Vector3 change, Vector3 mean,
                                   const real inertia[6], const real inertia_end[6], const Work *work) {
    size_t n = body->padded_modes;
    double sixth = prop->h / 6.0;
    moments_of_momenta(&body->oscillators, prop, n, work);
    Vector3 torque = vector_scaled(sixth, less_growth(body, change, mean, inertia_end, work));
    Vector3 rate_moment = solved(body, inertia, &work->mid, torque, work->moment);
    if (body->coupling.full) {
        subtract_drag(n, rate_moment, work->mid.b, work->moment);
        subtract_drag(n, vector_scaled(sixth, mean), work->coupling.b, work->moment);
    }
    return rate_moment;
}

#endif
