/* Rigid and modal bodies: the equations of components/body.py, where the theory is told.

   State: position of the centre of mass, quaternion, linear and angular momentum (world axes), angular
   velocity (body axes), dissipated energy, modal coordinates, modal momenta. The dynamic step iterates on
   the angular velocity of mid-step by the rule of the Python component, so that the iterates agree. */

#include <string.h>

#include "frames.h"
#include "inertia.h"
#include "kernel.h"
#include "oscillators.h"
#include "real.h"

enum { POSITION = 0, ORIENTATION = 3, MOMENTUM = 7, SPIN = 10, OMEGA = 13, HEAT = 16, MODES = 17 };
enum { WRENCH = 6, MOTION = 13 };

#define MAX_ITERATIONS 12
#define MAX_SLOPE_ITERATIONS 40
#define ANGLE_TOLERANCE 1e-12
#define SLOPE_TOLERANCE 1e-12
#define STATIC_ITERATIONS 3

/* B of the modal coordinates it was last evaluated for: a state is asked for it several times. */
typedef struct {
    int known;
    void *eta, *b;
} Remembered;

typedef struct {
    size_t ports, modes, padded_modes, coordinates; /* coordinates: 3 a port, padded */
    double mass, center_of_mass[3];
    InertiaCoupling coupling;
    Oscillators oscillators;
    double *damping_ratio;    /* before the scale */
    double *arms;             /* 3 a port */
    double *port_orientation; /* 4 a port */
    double *shapes_by_port;   /* 2 coordinates rows of modes: translations, then rotations */
    double *shapes_by_mode;   /* modes rows of 2 coordinates */
    size_t at_position, at_orientation, at_velocity, at_angular_velocity, at_gravity, at_damping, at_static;
    double start_position[3], start_orientation[4], start_velocity[3], start_angular_velocity[3];
    double gravity[3], damping_scale;
    int quasi_static;
    Remembered at_start, at_end, at_end_complex;
    void *work, *work_complex;
} Body;

/* Working memory of one number type. Vectors over modes are padded, with zeros. */
typedef struct {
    real *eta_start, *pi_start, *eta_mean, *rate_mean, *rate_start;
    real *eta, *pi, *pi_mean, *force, *port_force, *drag;
    real *wrenches;   /* 2 coordinates: forces and torques conjugate to the modes, body axes */
    real *deflection; /* 2 coordinates: of the ports, and their turns */
    real *rates;      /* 2 coordinates: the same for the modal rates */
    real *arms;       /* coordinates */
    CouplingScratch coupling;
} Work;

#define WORK_BY_MODE 11
#define WORK_BY_PORT 7
#define WORK_OF_COUPLING 12
/* `split` holds values and slopes, at most 6 modes or 2 coordinates of sums and as many weights */
#define WORK_SPLIT(modes, coordinates) (2 * (7 * (modes) + 4 * (coordinates)))

/* The working memory, cut out of its block. */
static inline Work work_of(const Body *body) {
#ifdef FANFOLD_COMPLEX
    real *next = body->work_complex;
#else
    real *next = body->work;
#endif
    size_t n = body->padded_modes, l = body->coordinates;
    Work work;
    work.eta_start = next;
    work.pi_start = next + n;
    work.eta_mean = next + 2 * n;
    work.rate_mean = next + 3 * n;
    work.rate_start = next + 4 * n;
    work.eta = next + 5 * n;
    work.pi = next + 6 * n;
    work.pi_mean = next + 7 * n;
    work.force = next + 8 * n;
    work.port_force = next + 9 * n;
    work.drag = next + 10 * n;
    next += WORK_BY_MODE * n;
    work.wrenches = next;
    work.deflection = next + 2 * l;
    work.rates = next + 4 * l;
    work.arms = next + 6 * l;
    next += WORK_BY_PORT * l;
    work.coupling.quadratic = next;
    work.coupling.b = next + 6 * n;
    work.coupling.b_rate = next + 9 * n;
    work.coupling.split = (double *)(next + WORK_OF_COUPLING * n);
    return work;
}

/* Held wrenches of all ports, world axes, and their sums. */
typedef struct {
    const real *wrenches;
    Vector3 force, torque;
} Load;

/* Outcome of a step's iteration: angular velocity of mid-step, moment of the forces at the start, heat. */
typedef struct {
    Vector3 omega, moment_start;
    real heat;
} Turned;

int NAME(body_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why);
void NAME(body_outputs)(void *self, const real *x, const real *u, real *y);

static inline Vector3 matrix_times(const real a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[1] * v.y + a[2] * v.z,
        a[3] * v.x + a[4] * v.y + a[5] * v.z,
        a[6] * v.x + a[7] * v.y + a[8] * v.z,
    };
}

static inline Vector3 transposed_times(const real a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[3] * v.y + a[6] * v.z,
        a[1] * v.x + a[4] * v.y + a[7] * v.z,
        a[2] * v.x + a[5] * v.y + a[8] * v.z,
    };
}

static inline Vector3 constant_times(const double a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[1] * v.y + a[2] * v.z,
        a[3] * v.x + a[4] * v.y + a[5] * v.z,
        a[6] * v.x + a[7] * v.y + a[8] * v.z,
    };
}

static inline void matrix_product(const real a[9], const real b[9], real product[9]) {
    for (size_t i = 0; i < 9; i += 3)
        for (size_t j = 0; j < 3; j++) product[i + j] = a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
}

static inline Vector3 constant_vector(const double *v) { return (Vector3){v[0], v[1], v[2]}; }

static inline Load load_of(const Body *body, const real *u) {
    Load load = {u, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t k = 0; k < body->ports; k++) {
        load.force = vector_add(load.force, vector_of(u + WRENCH * k));
        load.torque = vector_add(load.torque, vector_of(u + WRENCH * k + 3));
    }
    return load;
}

/* Sum of the moments of the ports' forces on arms in the axes of rotation a. */
static inline Vector3 moment_of(const Body *body, const Load *load, const real *arms, const real a[9]) {
    Vector3 sum = {0.0, 0.0, 0.0};
    for (size_t k = 0; k < body->ports; k++)
        sum = vector_add(sum, vector_cross(matrix_times(a, vector_of(arms + 3 * k)),
                                           vector_of(load->wrenches + WRENCH * k)));
    return sum;
}

/* Arms of the ports of the body deformed by eta. */
static inline void deformed_arms(const Body *body, const real *eta, const Work *work) {
    size_t l = body->coordinates;
    rows_combined(body->shapes_by_mode, body->padded_modes, 2 * l, eta, work->deflection, work->coupling.split);
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
    rows_combined(body->shapes_by_port, 2 * l, body->padded_modes, work->wrenches, work->port_force,
                  work->coupling.split);
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
    size_t m = body->modes;
    memcpy(eta, x + MODES, m * sizeof(real));
    memcpy(pi, x + MODES + m, m * sizeof(real));
    for (size_t j = m; j < body->padded_modes; j++) eta[j] = pi[j] = 0.0;
}

/* The modes at the start of a step: coordinates, momenta, rates. No derivative enters here. */
static inline void start_modes(Body *body, const double *x, const Work *work) {
    size_t m = body->modes, n = body->padded_modes;
    for (size_t j = 0; j < n; j++) {
        work->eta_start[j] = j < m ? x[MODES + j] : 0.0;
        work->pi_start[j] = j < m ? x[MODES + m + j] : 0.0;
        work->eta_mean[j] = work->eta_start[j];
        work->rate_mean[j] = work->pi_start[j];
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

#ifdef FANFOLD_COMPLEX

#define ITERATIONS MAX_SLOPE_ITERATIONS

/* Whether slopes have come to rest relative to the largest of them. */
static inline int slopes_converged(const real *last, const real *next, size_t count) {
    double change = 0.0, largest = 0.0;
    for (size_t i = 0; i < count; i++) {
        change = fmax(change, fabs(cimag(next[i]) - cimag(last[i])));
        largest = fmax(largest, fabs(cimag(next[i])));
    }
    return change <= SLOPE_TOLERANCE * largest;
}

#else

#define ITERATIONS MAX_ITERATIONS

static inline int slopes_converged(const real *last, const real *next, size_t count) {
    (void)last, (void)next, (void)count;
    return 1;
}

#endif

/* Whether an iteration has come to rest; never with values that are not finite. */
static inline int converged(Vector3 last, Vector3 next, double h) {
    const real before[3] = {last.x, last.y, last.z}, after[3] = {next.x, next.y, next.z};
    for (size_t i = 0; i < 3; i++)
        if (!(h * fabs(value_of(after[i] - before[i])) < ANGLE_TOLERANCE)) return 0;
    return slopes_converged(before, after, 3);
}

/* Rotations of mid-step and of the end of the step, turned from the start by half a step twice. */
static inline void turn_on(const real a_start[9], Vector3 omega, double h, real a_mid[9], real a_end[9]) {
    real half[9];
    rotation_matrix(quaternion_exponential(vector_scaled(0.5 * h, omega)), half);
    matrix_product(a_start, half, a_mid);
    matrix_product(a_mid, half, a_end);
}

/* Angular momentum of mid-step, body axes. */
static inline Vector3 momentum_of_mid_step(const double *x, const Load *load, Vector3 moment_start,
                                           Vector3 moment_end, double h, const real a_mid[9]) {
    Vector3 moment = vector_add(vector_mean(moment_start, moment_end), load->torque);
    return transposed_times(a_mid, vector_add(constant_vector(x + SPIN), vector_scaled(0.5 * h, moment)));
}

/* Angular velocity of mid-step, iterated on the moments of the forces at both ends. */
static inline Turned turned_rigid(const Body *body, const double *x, const Load *load, double h,
                                  const real a_start[9], const Work *work) {
    real a_mid[9], a_end[9];
    undeformed_arms(body, work);
    Turned turned = {constant_vector(x + OMEGA), moment_of(body, load, work->arms, a_start), 0.0};
    for (int i = 0, done = 0; i < ITERATIONS && !done; i++) {
        turn_on(a_start, turned.omega, h, a_mid, a_end);
        Vector3 moment_end = moment_of(body, load, work->arms, a_end);
        Vector3 momentum = momentum_of_mid_step(x, load, turned.moment_start, moment_end, h, a_mid);
        Vector3 next = constant_times(body->coupling.inverse, momentum);
        done = converged(turned.omega, next, h);
        turned.omega = next;
    }
    return turned;
}

/* The same with modes: their exact propagation under the forces of mid-step is part of the iteration. */
static inline Turned turned_flexible(Body *body, const double *x, const Load *load, double h,
                                     const real a_start[9], const Work *work) {
    size_t n = body->padded_modes, l = body->coordinates;
    const Propagator *prop = oscillators_propagator(&body->oscillators, h);
    real a_mid[9], a_end[9], a_mean[9], inertia[6] = {0.0};
    real *turns_start = work->rates + l, *turns = work->rates;
    start_modes(body, x, work);
    deformed_arms(body, work->eta_start, work);
    for (size_t i = 0; i < l; i++) turns[i] = turns_start[i] = work->deflection[l + i];
    Turned turned = {constant_vector(x + OMEGA), moment_of(body, load, work->arms, a_start), 0.0};
    for (int i = 0, done = 0; i < ITERATIONS && !done; i++) {
        turn_on(a_start, turned.omega, h, a_mid, a_end);
        for (size_t e = 0; e < 9; e++) a_mean[e] = 0.5 * (a_start[e] + a_end[e]);
        couple(body, turned.omega, work, inertia);
        modal_force(body, load, a_mean, a_mid, turns, work);
        propagate(prop, n, work);
        deformed_arms(body, work->eta, work);
        for (size_t e = 0; e < l; e++) turns[e] = 0.5 * (turns_start[e] + work->deflection[l + e]);
        Vector3 moment_end = moment_of(body, load, work->arms, a_end);
        Vector3 momentum = momentum_of_mid_step(x, load, turned.moment_start, moment_end, h, a_mid);
        Vector3 next = solved(body, inertia, momentum, work->pi_mean, work);
        done = converged(turned.omega, next, h);
        turned.omega = next;
    }
    turned.heat = dissipated(prop, body->oscillators.compliance, n, work);
    return turned;
}

static inline void store_modes(const Body *body, const real *eta, const real *pi, real *x) {
    size_t m = body->modes;
    memcpy(x + MODES, eta, m * sizeof(real));
    memcpy(x + MODES + m, pi, m * sizeof(real));
}

/* One step under wrenches held in world axes. */
static inline void dynamic_step(Body *body, const double *x, const real *u, double h, real *x_next) {
    Work work = work_of(body);
    Load load = load_of(body, u);
    Quaternion q = {x[ORIENTATION], x[ORIENTATION + 1], x[ORIENTATION + 2], x[ORIENTATION + 3]};
    real a_start[9], a_end[9];
    rotation_matrix(q, a_start);
    Turned turned = body->modes ? turned_flexible(body, x, &load, h, a_start, &work)
                                : turned_rigid(body, x, &load, h, a_start, &work);
    Vector3 weight = constant_vector(body->gravity);
    Vector3 pull = vector_add(load.force, vector_scaled(body->mass, weight));
    Vector3 momentum = vector_add(constant_vector(x + MOMENTUM), vector_scaled(h, pull));
    Vector3 travel = vector_scaled(0.5 * h / body->mass, vector_add(constant_vector(x + MOMENTUM), momentum));
    Quaternion half_turn = quaternion_exponential(vector_scaled(0.5 * h, turned.omega));
    q = quaternion_normalized(quaternion_multiply(q, quaternion_multiply(half_turn, half_turn)));
    rotation_matrix(q, a_end);
    Vector3 moment = vector_mean(turned.moment_start, moment_of(body, &load, work.arms, a_end));
    Vector3 spin = vector_add(constant_vector(x + SPIN), vector_scaled(h, vector_add(moment, load.torque)));
    vector_store(momentum, x_next + MOMENTUM);
    vector_store(vector_add(constant_vector(x + POSITION), travel), x_next + POSITION);
    quaternion_store(q, x_next + ORIENTATION);
    vector_store(spin, x_next + SPIN);
    x_next[HEAT] = x[HEAT] + turned.heat;
    store_modes(body, work.eta, work.pi, x_next);
    vector_store(angular_velocity(body, transposed_times(a_end, spin), &work), x_next + OMEGA);
}

/* One implicit step of the gradient flow that static equilibrium iterates: at rest before and after. */
static inline void static_step(Body *body, const double *x, const real *u, double h, real *x_next) {
    Work work = work_of(body);
    Load load = load_of(body, u);
    size_t n = body->padded_modes, l = body->coordinates;
    const Quaternion start = {x[ORIENTATION], x[ORIENTATION + 1], x[ORIENTATION + 2], x[ORIENTATION + 3]};
    Quaternion q = start;
    real a[9];
    rotation_matrix(q, a);
    undeformed_arms(body, &work);
    for (size_t i = 0; i < 2 * l; i++) work.deflection[i] = 0.0;
    for (size_t j = 0; j < n; j++) work.pi[j] = 0.0;
    for (int i = 0; i < STATIC_ITERATIONS; i++) {
        if (n) {
            modal_force(body, &load, a, a, work.deflection + l, &work);
            for (size_t j = 0; j < n; j++) work.eta[j] = body->oscillators.compliance[j] * work.port_force[j];
            deformed_arms(body, work.eta, &work);
        }
        Vector3 moment = vector_add(moment_of(body, &load, work.arms, a), load.torque);
        Vector3 turn = constant_times(body->coupling.inverse, transposed_times(a, moment));
        q = quaternion_normalized(quaternion_multiply(start, quaternion_exponential(vector_scaled(h * h, turn))));
        rotation_matrix(q, a);
    }
    for (size_t i = 0; i < MODES; i++) x_next[i] = 0.0;
    quaternion_store(q, x_next + ORIENTATION);
    Vector3 pull = vector_add(vector_scaled(1.0 / body->mass, load.force), constant_vector(body->gravity));
    vector_store(vector_add(constant_vector(x + POSITION), vector_scaled(h * h, pull)), x_next + POSITION);
    x_next[HEAT] = x[HEAT];
    store_modes(body, work.eta, work.pi, x_next);
}

int NAME(body_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    Body *body = self;
    (void)why;
    if (body->quasi_static)
        static_step(body, x, u, h, x_next);
    else
        dynamic_step(body, x, u, h, x_next);
    return 1;
}

/* Deflections, turns and their rates at the ports; zeros for a rigid body. */
static inline void deform_ports(Body *body, const real *x, Vector3 omega, const Work *work) {
    size_t n = body->padded_modes, l = body->coordinates;
    if (!n) return; /* allocated as zeros, and never written without modes */
    const real *rate = work->pi;
    load_modes(body, x, work->eta, work->pi);
    if (body->coupling.full) {
        modal_rate(n, omega, gyroscopic_at(body, work->eta, work), work->pi, work->rate_mean);
        rate = work->rate_mean;
    }
    rows_combined_twice(body->shapes_by_mode, n, 2 * l, work->eta, rate, work->deflection, work->rates,
                        work->coupling.split);
}

/* Pose and velocity of every port, world axes. */
void NAME(body_outputs)(void *self, const real *x, const real *u, real *y) {
    Body *body = self;
    (void)u;
    Work work = work_of(body);
    size_t l = body->coordinates;
    Quaternion q = quaternion_of(x + ORIENTATION);
    Vector3 position = vector_of(x + POSITION), omega = vector_of(x + OMEGA);
    Vector3 velocity = vector_scaled(1.0 / body->mass, vector_of(x + MOMENTUM));
    real a[9];
    rotation_matrix(q, a);
    deform_ports(body, x, omega, &work);
    for (size_t k = 0; k < body->ports; k++, y += MOTION) {
        const double *own = body->port_orientation + 4 * k;
        Vector3 turn = vector_of(work.deflection + l + 3 * k), twist = vector_of(work.rates + l + 3 * k);
        Vector3 arm = vector_add(constant_vector(body->arms + 3 * k), vector_of(work.deflection + 3 * k));
        Vector3 once = vector_cross(turn, twist), twice = vector_cross(turn, once);
        Vector3 rate_of_turn = vector_add(vector_add(omega, twist),
                                          vector_add(vector_scaled(0.5, once), vector_scaled(1.0 / 6.0, twice)));
        Vector3 relative = vector_add(vector_cross(omega, arm), vector_of(work.rates + 3 * k));
        Quaternion local = {own[0], own[1], own[2], own[3]};
        if (body->modes) local = quaternion_multiply(quaternion_exponential(turn), local);
        vector_store(vector_add(position, matrix_times(a, arm)), y);
        quaternion_store(quaternion_multiply(q, local), y + 3);
        vector_store(vector_add(velocity, matrix_times(a, relative)), y + 7);
        vector_store(matrix_times(a, rate_of_turn), y + 10);
    }
}

#include "body_exchange.h"

#ifndef FANFOLD_COMPLEX

#define MOST_MODES 1024
#define MOST_PORTS 1024

int body_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why);
void body_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

/* The array of that name with `count` finite numbers. */
static const double *finite_array(const Data *data, const char *name, size_t count, Reason *why) {
    const double *values = data_array(data, name, count, why);
    for (size_t i = 0; values && i < count; i++)
        if (!isfinite(values[i])) {
            refuse(why, "the body's data have a value of %s that is not finite", name);
            return NULL;
        }
    return values;
}

/* Copies `count` finite numbers. */
static int copy_array(const Data *data, const char *name, size_t count, double *place, Reason *why) {
    const double *values = finite_array(data, name, count, why);
    if (!values) return 0;
    memcpy(place, values, count * sizeof(double));
    return 1;
}

/* Numbers of ports and of modes, from the sizes of two arrays. */
static int read_sizes(Body *body, const Data *data, const Sizes *sizes, Reason *why) {
    size_t arms = 0, modes = 0;
    if (!data_any(data, "arms", &arms, why) || !data_any(data, "frequency", &modes, why)) return 0;
    if (arms % 3 != 0 || arms / 3 > MOST_PORTS)
        return refuse(why, "the body's data have %lu numbers for arms; it takes 3 a port, for at most %d ports",
                      (unsigned long)arms, MOST_PORTS);
    if (modes > MOST_MODES)
        return refuse(why, "the body's data have %lu modes; there can be at most %d", (unsigned long)modes,
                      MOST_MODES);
    body->ports = arms / 3;
    body->modes = modes;
    body->padded_modes = padded(modes);
    body->coordinates = padded(arms);
    if (sizes->inputs != WRENCH * body->ports || sizes->outputs != MOTION * body->ports ||
        sizes->observations != 16 + modes)
        return refuse(why, "the body's variables do not fit its %lu ports and %lu modes", (unsigned long)body->ports,
                      (unsigned long)modes);
    return 1;
}

static int remembered_allocate(Remembered *remembered, size_t bytes, Memory *memory) {
    remembered->eta = allocate(memory, bytes);
    remembered->b = allocate(memory, 3 * bytes);
    return remembered->eta && remembered->b;
}

static int allocate_all(Body *body, Memory *memory, Reason *why) {
    size_t n = body->padded_modes, l = body->coordinates, mode = (n + 1) * sizeof(double);
    size_t numbers = WORK_BY_MODE * n + WORK_BY_PORT * l + WORK_OF_COUPLING * n + WORK_SPLIT(n, l) + 1;
    size_t triangle = body->coupling.full ? triangle_size(n) * sizeof(double) : 1;
    InertiaCoupling *coupling = &body->coupling;
    body->damping_ratio = allocate(memory, mode);
    body->arms = allocate(memory, (l + 1) * sizeof(double));
    body->port_orientation = allocate(memory, (4 * body->ports + 1) * sizeof(double));
    body->shapes_by_port = allocate(memory, 2 * l * mode);
    body->shapes_by_mode = allocate(memory, 2 * l * mode);
    coupling->slope = allocate(memory, 6 * mode);
    coupling->quadratic = allocate(memory, 6 * triangle);
    coupling->gyroscopic = allocate(memory, 3 * triangle);
    body->work = allocate(memory, numbers * sizeof(double));
    body->work_complex = allocate(memory, numbers * sizeof(double complex));
    if (!body->damping_ratio || !body->arms || !body->port_orientation || !body->shapes_by_port ||
        !body->shapes_by_mode || !coupling->slope || !coupling->quadratic || !coupling->gyroscopic || !body->work ||
        !body->work_complex || !oscillators_allocate(&body->oscillators, n, memory) ||
        !remembered_allocate(&body->at_start, mode, memory) || !remembered_allocate(&body->at_end, mode, memory) ||
        !remembered_allocate(&body->at_end_complex, 2 * mode, memory))
        return refuse(why, "no memory for a body of %lu modes", (unsigned long)body->modes);
    return 1;
}

static int read_mass(Body *body, const Data *data, Reason *why) {
    if (!copy_array(data, "mass", 1, &body->mass, why)) return 0;
    if (!(body->mass > 0.0)) return refuse(why, "mass is %g kg; it must be positive", body->mass);
    return copy_array(data, "center_of_mass", 3, body->center_of_mass, why) &&
           copy_array(data, "inertia", 6, body->coupling.inertia, why) &&
           copy_array(data, "inverse_inertia", 9, body->coupling.inverse, why);
}

static int read_oscillators(Body *body, const Data *data, Reason *why) {
    Oscillators *oscillators = &body->oscillators;
    if (!copy_array(data, "frequency", body->modes, oscillators->frequency, why) ||
        !copy_array(data, "damping_ratio", body->modes, body->damping_ratio, why))
        return 0;
    for (size_t j = 0; j < body->modes; j++) {
        double frequency = oscillators->frequency[j];
        if (!(frequency > 0.0))
            return refuse(why, "every mode must have a positive frequency; remove the rigid modes first");
        if (!(body->damping_ratio[j] >= 0.0)) return refuse(why, "modal damping ratios must not be negative");
        oscillators->compliance[j] = 1.0 / (frequency * frequency);
    }
    return 1;
}

/* Shapes of one kind (ports, 3, modes), stored by port and by mode from coordinate `first` on. */
static int read_shapes(Body *body, const Data *data, const char *name, size_t first, Reason *why) {
    size_t n = body->padded_modes, m = body->modes, length = 2 * body->coordinates;
    const double *shapes = finite_array(data, name, 3 * body->ports * m, why);
    if (!shapes) return 0;
    for (size_t i = 0; i < 3 * body->ports; i++)
        for (size_t j = 0; j < m; j++)
            body->shapes_by_port[(first + i) * n + j] = body->shapes_by_mode[j * length + first + i] =
                shapes[i * m + j];
    return 1;
}

static int read_ports(Body *body, const Data *data, Reason *why) {
    return copy_array(data, "arms", 3 * body->ports, body->arms, why) &&
           copy_array(data, "port_orientation", 4 * body->ports, body->port_orientation, why) &&
           read_shapes(body, data, "translation", 0, why) &&
           read_shapes(body, data, "rotation", body->coordinates, why);
}

static int read_level(Body *body, const Data *data, Reason *why) {
    double varies = 0.0, full = 0.0;
    if (!copy_array(data, "inertia_varies", 1, &varies, why) || !copy_array(data, "full_coupling", 1, &full, why))
        return 0;
    body->coupling.modes = body->padded_modes;
    body->coupling.varies = body->modes && varies != 0.0;
    body->coupling.full = body->coupling.varies && full != 0.0;
    return 1;
}

static int read_coupling(Body *body, const Data *data, Reason *why) {
    InertiaCoupling *coupling = &body->coupling;
    size_t m = body->modes, n = body->padded_modes;
    if (!coupling->varies) return 1;
    const double *slope = finite_array(data, "slope", 6 * m, why);
    if (!slope) return 0;
    for (size_t p = 0; p < 6; p++) memcpy(coupling->slope + p * n, slope + p * m, m * sizeof(double));
    if (!coupling->full) return 1;
    const double *tensors = finite_array(data, "tensors", 9 * m * m, why);
    if (!tensors) return 0;
    triangles_pack(tensors, 6, 1.0, m, coupling->quadratic);
    triangles_pack(tensors + 6 * m * m, 3, -1.0, m, coupling->gyroscopic);
    return 1;
}

/* Offset of a parameter that lies within the parameters. */
static int find(const Data *data, const Sizes *sizes, const char *name, size_t size, size_t *place, Reason *why) {
    long offset = data_offset(data, "parameter", name, size, why);
    if (offset < 0) return 0;
    *place = (size_t)offset;
    if (*place > sizes->parameters || size > sizes->parameters - *place)
        return refuse(why, "parameter %s lies outside of the parameters", name);
    return 1;
}

static int find_parameters(Body *body, const Data *data, const Sizes *sizes, Reason *why) {
    return find(data, sizes, "initial_position", 3, &body->at_position, why) &&
           find(data, sizes, "initial_orientation", 4, &body->at_orientation, why) &&
           find(data, sizes, "initial_velocity", 3, &body->at_velocity, why) &&
           find(data, sizes, "initial_angular_velocity", 3, &body->at_angular_velocity, why) &&
           find(data, sizes, "gravity", 3, &body->at_gravity, why) &&
           find(data, sizes, "damping_scale", 1, &body->at_damping, why) &&
           find(data, sizes, "quasi_static", 1, &body->at_static, why);
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Body *body = allocate(memory, sizeof *body);
    if (!body) {
        refuse(why, "no memory for a body");
        return NULL;
    }
    body->damping_scale = -1.0; /* none yet */
    if (!read_sizes(body, data, sizes, why) || !read_level(body, data, why) || !allocate_all(body, memory, why) ||
        !read_mass(body, data, why) || !read_oscillators(body, data, why) || !read_ports(body, data, why) ||
        !read_coupling(body, data, why) || !find_parameters(body, data, sizes, why))
        return NULL;
    *states = MODES + 2 * body->modes;
    return body;
}

static int prepare(void *self, const double *p, Reason *why) {
    Body *body = self;
    const double *q = p + body->at_orientation;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), scale = p[body->at_damping];
    if (!(fabs(length - 1.0) <= 1e-6))
        return refuse(why, "initial_orientation has length %g; a quaternion must have length 1", length);
    memcpy(body->start_position, p + body->at_position, sizeof body->start_position);
    memcpy(body->start_orientation, q, sizeof body->start_orientation);
    memcpy(body->start_velocity, p + body->at_velocity, sizeof body->start_velocity);
    memcpy(body->start_angular_velocity, p + body->at_angular_velocity, sizeof body->start_angular_velocity);
    memcpy(body->gravity, p + body->at_gravity, sizeof body->gravity);
    body->quasi_static = p[body->at_static] >= 0.5;
    if (scale == body->damping_scale) return 1;
    body->damping_scale = scale;
    for (size_t j = 0; j < body->modes; j++) body->oscillators.damping_ratio[j] = body->damping_ratio[j] * scale;
    oscillators_forget(&body->oscillators);
    return 1;
}

/* Undeformed, placed and moving as the initial parameters say. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    const Body *body = self;
    const double *j = body->coupling.inertia;
    const double inertia[9] = {j[0], j[3], j[4], j[3], j[1], j[5], j[4], j[5], j[2]};
    double a[9];
    (void)u, (void)why;
    Quaternion q = quaternion_normalized(quaternion_of(body->start_orientation));
    rotation_matrix(q, a);
    Vector3 omega = transposed_times(a, vector_of(body->start_angular_velocity));
    memset(x, 0, (MODES + 2 * body->modes) * sizeof(double));
    vector_store(vector_add(vector_of(body->start_position), matrix_times(a, vector_of(body->center_of_mass))),
                 x + POSITION);
    quaternion_store(q, x + ORIENTATION);
    vector_store(vector_scaled(body->mass, vector_of(body->start_velocity)), x + MOMENTUM);
    vector_store(omega, x + OMEGA);
    vector_store(matrix_times(a, matrix_times(inertia, omega)), x + SPIN);
    return 1;
}

/* Energies of the modes: half of rate times momentum, and of strain. */
static void modal_energies(Body *body, const double *x, double *kinetic, double *strain) {
    Work work = work_of(body);
    const double *rate = work.pi, *frequency = body->oscillators.frequency;
    load_modes(body, x, work.eta, work.pi);
    if (body->coupling.full) {
        modal_rate(body->padded_modes, vector_of(x + OMEGA), gyroscopic_at(body, work.eta, &work), work.pi,
                   work.rate_mean);
        rate = work.rate_mean;
    }
    *kinetic = *strain = 0.0;
    for (size_t j = 0; j < body->modes; j++) {
        *kinetic += 0.5 * rate[j] * work.pi[j];
        *strain += 0.5 * (frequency[j] * work.eta[j]) * (frequency[j] * work.eta[j]);
    }
}

/* Pose of the construction frame, momenta, energies and modal coordinates. */
static void observe(void *self, const double *x, const double *u, double *z) {
    Body *body = self;
    double a[9], kinetic, strain;
    (void)u;
    rotation_matrix(quaternion_of(x + ORIENTATION), a);
    Vector3 position = vector_of(x + POSITION), momentum = vector_of(x + MOMENTUM), spin = vector_of(x + SPIN);
    modal_energies(body, x, &kinetic, &strain);
    kinetic += 0.5 * (vector_dot(momentum, momentum) / body->mass +
                      vector_dot(vector_of(x + OMEGA), transposed_times(a, spin)));
    vector_store(vector_subtract(position, matrix_times(a, vector_of(body->center_of_mass))), z);
    memcpy(z + 3, x + ORIENTATION, 4 * sizeof(double));
    memcpy(z + 7, x + MOMENTUM, 3 * sizeof(double));
    vector_store(vector_add(spin, vector_cross(position, momentum)), z + 10);
    z[13] = kinetic;
    z[14] = strain - body->mass * vector_dot(vector_of(body->gravity), position);
    z[15] = x[HEAT];
    memcpy(z + 16, x + MODES, body->modes * sizeof(double));
}

const Kernel body_kernel = {
    "body",  create,            prepare,              initial, body_step_real, body_outputs_real,
    observe, body_step_complex, body_outputs_complex, NULL,    NULL,
    .continuous = body_continuous,
    .complete = body_complete_real,
    .complete_complex = body_complete_complex,
    .rates = body_rates_real,
    .rates_complex = body_rates_complex,
};

#endif
