/* One step of a body: part of body.c, of either number type. The dynamic step iterates on the angular velocity of
   mid-step by the rule of the Python component, so that the iterates agree. */

#ifndef FANFOLD_BODY_STEP_H
#define FANFOLD_BODY_STEP_H

#include "body_interface.h"
#include "body_turn.h"

#define MAX_ITERATIONS 40
#define ANGLE_TOLERANCE 1e-13
#define DEFLECTION_TOLERANCE 1e-14 /* energies of bending follow from deflections that are small angles themselves */
#define ANGLE_ROUNDING 1e-9
#define SLOPE_TOLERANCE 1e-12
#define SLOW 0.1 /* contraction of an iteration, from which on its matrix is made anew */

#ifdef FANFOLD_COMPLEX

/* Largest change of slopes over the largest of them; infinite where one is not finite. */
static inline double slope_change(const real *last, const real *next, size_t count) {
    double change = 0.0, largest = 0.0;
    for (size_t i = 0; i < count; i++) {
        change = fmax(change, fabs(cimag(next[i]) - cimag(last[i])));
        largest = fmax(largest, fabs(cimag(next[i])));
    }
    return change > 0.0 ? change / largest : 0.0;
}

/* Derivatives are those of a step that has been made. */
#define REFUSING 0

#else

#define REFUSING 1

static inline double slope_change(const real *last, const real *next, size_t count) {
    (void)last, (void)next, (void)count;
    return 0.0;
}

#endif

/* Whether an iteration changes the turn of a step by less than an angle (rad); never with values that are not finite. */
static inline int turned_less(Vector3 last, Vector3 next, double h, double angle) {
    const Vector3 change = vector_subtract(next, last);
    const double turn[3] = {value_of(change.x), value_of(change.y), value_of(change.z)};
    for (size_t i = 0; i < 3; i++)
        if (!(h * fabs(turn[i]) < angle)) return 0;
    return 1;
}

/* Whether an iteration has come to rest. */
static inline int converged(Vector3 last, Vector3 next, double h) {
    const real before[3] = {last.x, last.y, last.z}, after[3] = {next.x, next.y, next.z};
    return turned_less(last, next, h, ANGLE_TOLERANCE) && slope_change(before, after, 3) <= SLOPE_TOLERANCE;
}

/* Rotations of mid-step and of the end of the step, turned from the start by half a step twice. */
static inline void turn_on(const real a_start[9], Vector3 omega, double h, real a_mid[9], real a_end[9]) {
    real half[9];
    rotation_matrix(quaternion_exponential(vector_scaled(0.5 * h, omega)), half);
    matrix_product(a_start, half, a_mid);
    matrix_product(a_mid, half, a_end);
}

/* Angular momentum at the end of a step, body axes there. */
static inline Vector3 momentum_at_end(const double *x, Vector3 moment, double h, const real a_end[9]) {
    return transposed_times(a_end, vector_add(constant_vector(x + X_SPIN), vector_scaled(h, moment)));
}

/* Mean angular velocity, iterated on the moments of the forces at both ends; whether one is found. */
static inline int turn_rigid(Body *body, const double *x, const Load *load, double h, Axes *axes,
                              const Work *work, Turned *turned) {
    const double *inverse = body->coupling.inverse;
    const Vector3 start = constant_vector(x + X_ANGULAR_VELOCITY), momentum_start = constant_vector(x + X_SPIN);
    Vector3 momentum;
    for (size_t i = 0; i < 6; i++) turned->inertia_end[i] = body->coupling.inertia[i];
    undeformed_arms(body, work);
    turned->omega = start;
    turned->moments_start = moments_at(body, load, work->arms, axes->start, work->arms_start);
    int done = 0, found = 0;
    for (int i = 0; i < MAX_ITERATIONS && !done; i++) {
        turn_on(axes->start, turned->omega, h, axes->mid, axes->end);
        Course moments_end = moments_at(body, load, work->arms, axes->end, work->arms_end);
        Course moment = moment_over(load, &turned->moments_start, &moments_end);
        momentum = momentum_at_end(x, moment.mean, h, axes->end);
        turned->end = constant_times(inverse, momentum);
        Vector3 bend = constant_times(inverse, vector_scaled(h / 6.0, transposed_times(axes->mid, moment.slope)));
        Vector3 mean = vector_subtract(vector_mean(start, turned->end), bend);
        Vector3 next = newton_turn(body, load, axes, work, turned, momentum, moment.slope, h, mean);
        done = converged(turned->omega, next, h);
        found = turned_less(turned->omega, next, h, ANGLE_ROUNDING);
        turned->omega = next;
    }
    turned->change = vector_subtract(momentum, transposed_times(axes->start, momentum_start));
    turned->heat = 0.0;
    return found || !REFUSING;
}

/* By what slopes put the mean of the angular velocities at both ends above that over the step, with their share in the
   modes, whose slopes of ports give way to all of them. */
static inline Vector3 bend_of(const Body *body, Vector3 moment_slope, double h, const real a_mid[9],
                              const real inertia[6], const Work *work) {
    Vector3 turning = solved(body, inertia, &work->mid, transposed_times(a_mid, moment_slope), work->slope);
    if (body->coupling.full) subtract_drag(body->padded_modes, turning, work->mid.b, work->slope);
    return vector_scaled(h / 6.0, turning);
}

/* Takes the modes of second order over a step on by what Newton's correction adds to their forces and slopes. */
static inline void propagate_change(const Body *body, const Propagator *prop, int sloped, const Work *work,
                                    const real *slope_before) {
    const double sixth = prop->h / 6.0;
    for (size_t s = 0; s < body->second_order; s++) {
        const size_t j = body->second_place[s];
        const real force = work->port_force[j], slope = sloped ? work->slope[j] - slope_before[s] : 0.0;
        const real travel = prop->b1[j] * force + prop->c1[j] * slope, gain = prop->a12[j] * force + prop->c2[j] * slope;
        work->force[j] += force;
        work->eta[j] += travel;
        work->pi[j] += gain;
        work->eta_mean[j] += 0.5 * travel;
        work->rate_mean[j] += 0.5 * gain - sixth * slope;
    }
}

/* The modes over a step whose forces depend on where they end, by Newton's iteration; anew: with a matrix of here. */
static inline void propagate_corrected(const Body *body, const Propagator *prop, int sloped, int anew, const Work *work) {
    const size_t n = body->padded_modes;
    for (size_t j = 0; j < n; j++) work->port_force[j] = 0.0;
    if (!body->forms) {
        const Pairs pairs = pairs_of(body, work);
        for (size_t s = 0; s < pairs.count; s++) pairs.slope[s] = work->slope[body->second_place[s]];
        correct_forces(body, prop->b1, sloped ? prop->c1 : NULL, 0.5, anew, work, work->port_force, work->slope);
        propagate_change(body, prop, sloped, work, pairs.slope);
        return;
    }
    moments_of_momenta(&body->oscillators, prop, n, work);
    correct_stretching_forces(body, prop, sloped, work, work->port_force, work->slope);
    propagate(prop, n, work);
    moments_of_momenta(&body->oscillators, prop, n, work);
}

/* The same with modes: their exact propagation under the forces of mid-step is part of the iteration. Whether it has found
   an end where forces depend on it. */
static inline int turn_flexible(Body *body, const double *x, const Load *load, double h, Axes *axes,
                                 const Work *work, Turned *turned) {
    size_t n = body->padded_modes, l = body->coordinates;
    const Propagator *prop = oscillators_propagator(&body->oscillators, h);
    const Vector3 start = constant_vector(x + X_ANGULAR_VELOCITY), momentum_start = constant_vector(x + X_SPIN);
    real *turns = work->rates;
    Vector3 momentum, bend = {0.0, 0.0, 0.0};
    double change = 0.0, before = 0.0, slope_of = 0.0, slope_before = 0.0; /* by iterations, of modes of second order */
    int done = 0, found = 0, sloped = load->sloped || body->forms; /* tension changes within a step */
    start_modes(body, x, work, turns, turned->inertia);
    memcpy(turned->inertia_end, turned->inertia, sizeof turned->inertia);
    const double *turns_start = (const double *)body->at_start.deflection + l;
    turned->omega = turned->end = start;
    turned->moments_start = moments_at(body, load, work->arms, axes->start, work->arms_start);
    Course moment = moment_over(load, &turned->moments_start, &turned->moments_start);
    if (body->forms) hold_tensions(body, work->eta_start, work);
    for (int i = 0; i < MAX_ITERATIONS && !done; i++) {
        turn_on(axes->start, turned->omega, h, axes->mid, axes->end);
        if (i > 0) couple_mean(body, work, turned->inertia);
        modal_forces(body, load, axes->start, axes->mid, axes->end, turns, work);
        if (body->second_order) memcpy(pairs_of(body, work).last, work->eta, n * sizeof(real));
        if (load->sloped) bend = bend_of(body, moment.slope, h, axes->mid, turned->inertia, work);
        coupled_forces(body, start, turned->end, bend, work);
        if (body->forms) {
            if (!load->sloped) memset(work->slope, 0, n * sizeof(real));
            add_tension_forces(body, pairs_of(body, work).last, work, work->force, work->slope);
        }
        propagate(prop, n, work);
        if (body->second_order)
            propagate_corrected(body, prop, load->sloped, i != 1 && !(i && change <= SLOW * before), work);
        if (body->forms) end_tensions(body, work->eta, work->moment, work);
        evaluate_coupling(body, work->eta, &work->coupling, turned->inertia_end);
        deformed_arms(body, work->eta, work);
        for (size_t e = 0; e < l; e++) turns[e] = 0.5 * (turns_start[e] + work->deflection[l + e]);
        if (body->second_order) average_pairs(body, work, turns);
        Course moments_end = moments_at(body, load, work->arms, axes->end, work->arms_end);
        moment = moment_over(load, &turned->moments_start, &moments_end);
        momentum = momentum_at_end(x, moment.mean, h, axes->end);
        turned->end = solved(body, turned->inertia_end, &work->coupling, momentum, work->pi);
        Vector3 mean = vector_subtract(vector_mean(start, turned->end), bend);
        Vector3 next = newton_turn(body, load, axes, work, turned, momentum, moment.slope, h, mean);
        done = converged(turned->omega, next, h);
        found = turned_less(turned->omega, next, h, ANGLE_ROUNDING);
        if (body->second_order) {
            before = change;
            change = modal_change(body, work);
            slope_before = slope_of;
            slope_of = slope_change(pairs_of(body, work).last, work->eta, n);
            found = found && settled(change, before, DEFLECTION_TOLERANCE);
            done = done && found && settled(slope_of, slope_before, SLOPE_TOLERANCE);
        }
        turned->omega = next;
    }
    remember_end(body, work, turned->inertia_end);
    turned->heat = dissipated(prop, body->oscillators.compliance, n, work);
    if (sloped) turned->heat += dissipated_by_slopes(prop, body->oscillators.compliance, n, work);
    turned->change = vector_subtract(momentum, transposed_times(axes->start, momentum_start));
    return found || !REFUSING;
}

/* First moments of velocity and angular velocity of every port, world axes, from those of the centre of mass and of
   the body: the transpose of what slopes do in a step. turn: a sixth of the rotation over the step. */
static inline void place_moments(const Body *body, Vector3 center, Vector3 rate_moment, Vector3 turn, const Work *work,
                                 real *moments) {
    const Vector3 at_end = vector_add(vector_scaled(0.5, rate_moment), turn);
    const Vector3 at_start = vector_subtract(vector_scaled(0.5, rate_moment), turn);
    for (size_t k = 0; k < body->ports; k++, moments += WRENCH_SIZE) {
        Vector3 start = vector_cross(at_start, vector_of(work->arms_start + 3 * k));
        Vector3 end = vector_cross(at_end, vector_of(work->arms_end + 3 * k));
        vector_store(vector_add(center, vector_add(start, end)), moments);
        vector_store(rate_moment, moments + 3);
    }
}

/* What the modes add to them: their own first moments, and a sixth of their change in axes that turn on. */
static inline void add_modal_moments(const Body *body, const Axes *axes, const Work *work, real *moments) {
    size_t l = body->coordinates;
    const double *deflection_start = body->at_start.deflection;
    real *moved = work->wrenches;
    rows_combined(body->shapes, body->padded_modes, 2 * l, work->moment, moved, work->coupling.split);
    if (body->second_order) {
        const Pairs pairs = pairs_of(body, work);
        pairs_combined(body, &pairs, pairs.mid, work->moment, 1.0, moved);
    }
    for (size_t k = 0; k < body->ports; k++, moments += WRENCH_SIZE) {
        const real *end = work->deflection + 3 * k;
        const double *start = deflection_start + 3 * k;
        Vector3 change = vector_scaled(1.0 / 6.0, vector_subtract(vector_of(end), constant_vector(start)));
        Vector3 half = vector_scaled(0.5, vector_of(moved + 3 * k)), turn = vector_of(work->rates + 3 * k);
        Vector3 turning = vector_scaled(1.0 / 6.0, vector_subtract(vector_of(end + l), constant_vector(start + l)));
        Vector3 twist = twist_of(turn, vector_of(moved + l + 3 * k)), twisted = twist_of(turn, turning);
        Vector3 velocity = vector_add(matrix_times(axes->end, vector_add(half, change)),
                                      matrix_times(axes->start, vector_subtract(half, change)));
        Vector3 turned = vector_subtract(matrix_times(axes->end, twisted), matrix_times(axes->start, twisted));
        vector_store(vector_add(vector_of(moments), velocity), moments);
        vector_store(vector_add(vector_of(moments + 3), vector_add(matrix_times(axes->mid, twist), turned)), moments + 3);
    }
}

/* First moments over a step, from that of the velocity of the centre of mass. start: angular velocity there. */
static inline void store_moments(Body *body, const Turned *turned, Vector3 center, Vector3 start, double h,
                                 const Axes *axes, const Work *work, real *moments) {
    Vector3 rate_moment, turn = vector_scaled(h / 6.0, matrix_times(axes->mid, turned->omega));
    if (body->modes)
        rate_moment = moments_over(body, oscillators_propagator(&body->oscillators, h), turned->change,
                                   vector_mean(start, turned->end), turned->inertia, turned->inertia_end, work);
    else
        rate_moment = vector_scaled(h / 6.0, vector_subtract(turned->end, start));
    place_moments(body, center, matrix_times(axes->mid, rate_moment), turn, work, moments);
    if (body->modes) add_modal_moments(body, axes, work, moments);
}

/* One step under wrenches in world axes, linear in time. */
static inline int dynamic_step(Body *body, const double *x, const real *u, double h, real *x_next, Reason *why) {
    LocalWork stack;
    Work work = work_of(body, &stack);
    Load load = load_of(body, u);
    Quaternion q = {x[X_ORIENTATION], x[X_ORIENTATION + 1], x[X_ORIENTATION + 2], x[X_ORIENTATION + 3]};
    Axes axes;
    rotation_matrix(q, axes.start);
    Turned turned;
    if (!(body->modes ? turn_flexible : turn_rigid)(body, x, &load, h, &axes, &work, &turned))
        return refuse(why, "a step of %g s comes to no end in %d iterations of turn and deflection; take smaller steps or loads",
                      h, MAX_ITERATIONS);
    Vector3 weight = constant_vector(body->gravity);
    Vector3 push = vector_scaled(h, vector_add(load.mean.force, vector_scaled(body->mass, weight)));
    Vector3 momentum = vector_add(constant_vector(x + X_MOMENTUM), push);
    Vector3 travel = vector_scaled(0.5 * h / body->mass, vector_add(constant_vector(x + X_MOMENTUM), momentum));
    travel = vector_subtract(travel, vector_scaled(h * h / (6.0 * body->mass), load.slope.force));
    Quaternion half_turn = quaternion_exponential(vector_scaled(0.5 * h, turned.omega));
    q = quaternion_normalized(quaternion_multiply(q, quaternion_multiply(half_turn, half_turn)));
    rotation_matrix(q, axes.end);
    Course moments_end = moments_at(body, &load, work.arms, axes.end, work.arms_end);
    Course moment = moment_over(&load, &turned.moments_start, &moments_end);
    Vector3 spin = vector_add(constant_vector(x + X_SPIN), vector_scaled(h, moment.mean));
    vector_store(momentum, x_next + X_MOMENTUM);
    vector_store(vector_add(constant_vector(x + X_POSITION), travel), x_next + X_POSITION);
    quaternion_store(q, x_next + X_ORIENTATION);
    vector_store(spin, x_next + X_SPIN);
    x_next[X_HEAT] = x[X_HEAT] + turned.heat;
    store_modes(body, work.eta, work.pi, x_next);
    vector_store(turned.end, x_next + X_ANGULAR_VELOCITY);
    store_moments(body, &turned, vector_scaled(h / (6.0 * body->mass), push), constant_vector(x + X_ANGULAR_VELOCITY), h, &axes, &work,
                  x_next + X_MODAL_AMPLITUDE + 2 * body->modes);
    return 1;
}

int NAME(body_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why);

int NAME(body_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    Body *body = self;
    if (!dynamic_step(body, x, u, h, x_next, why))
        return 0;
    if (body->is_base) store_interface(body, x, u, h, x_next);
    return 1;
}

#endif
