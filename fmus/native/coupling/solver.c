/* The iteration of a coupled step. It allocates nothing and has no global state. */

#include "solver.h"

#include <math.h>
#include <string.h>

#include "convergence.h"
#include "prediction.h"
#include "system.h"

enum { MOST_DAMPED = 30 };
#define SAME_SIZE 1e-9 /* largest relative difference of sizes with the same matrices: rounding of sums of times */

/* Iterations after which slow contraction leads to a refresh: matrices are turned, then stiffnesses are evaluated anew,
   at last mobilities as well, which costs tens of sweeps. */
static const size_t refreshed[] = {2, 4, 8};
enum { TURNS, PROBES, PROBES_BODIES, REFRESHES };

void forget_stiffnesses(Solver *s) {
    jacobians_outdate(&s->jacobians);
    s->ready_step = NAN;
}

void forget_all(Solver *s) {
    jacobians_forget(&s->jacobians);
    s->ready_step = NAN;
}

/* Whether the matrices of a step size are factorised. */
static int is_ready(const Solver *s, double h) { return fabs(s->ready_step - h) <= SAME_SIZE * h; }

/* Factorise the matrices of the present step size. again: with new stiffnesses, and at the last stage new mobilities. 0
   if a participant fails. */
static int provide(Solver *s, int again) {
    Network *n = s->network;
    SizedJacobian *one = jacobian_of(n, &s->jacobians, n->h);
    s->ready_step = NAN;
    if (again) {
        one->has_stiffnesses = 0;
        one->bodies_outdated |= n->iteration == refreshed[PROBES_BODIES];
    }
    if (!use_jacobian(n, &s->jacobians, one)) return 0;
    s->ready_step = n->h;
    n->endured = 0;
    system_assemble(n);
    return 1;
}

/* The chord Newton correction in the units of `scale`. */
static void scaled_direction(Network *n, double *result) {
    system_direction(n, n->residual, result);
    if (n->iteration == 1) set_scale(n, result);
    for (size_t i = 0; i < n->size; i++) result[i] /= n->scale[i];
}

/* Broyden's update of a correction from the steps taken so far, without a matrix. */
static void update(const Network *n, double *result) {
    if (n->kept == 0) return;
    const double *step = n->steps;
    for (size_t k = 0; k + 1 < n->kept; k++, step += n->size) {
        const double share = dot(step, result, n->size) / n->squares[k];
        for (size_t i = 0; i < n->size; i++) result[i] += share * step[n->size + i];
    }
    const double slope = dot(step, result, n->size) / n->squares[n->kept - 1];
    const double factor = 1.0 / (1.0 - slope);
    if (slope < STEEPEST)
        for (size_t i = 0; i < n->size; i++) result[i] *= factor;
}

/* Add a step to the wrenches and keep it for Broyden's update. */
static int apply(Network *n, const double *step) {
    n->last = n->correction;
    n->squares[n->kept] = dot(step, step, n->size);
    n->kept++;
    for (size_t i = 0; i < n->size; i++) n->wrenches[i] += step[i] * n->scale[i];
    return GOES_ON;
}

/* Forget the steps by earlier matrices, and make one by the present ones. */
static int restart(Network *n) {
    n->kept = 0;
    scaled_direction(n, n->steps);
    return apply(n, n->steps);
}

/* Go back half of the step before; matrices are turned to the wrenches there. This is no iteration of its own. */
static int halve(Network *n) {
    const double *before = n->steps + (n->kept - 1) * n->size;
    for (size_t i = 0; i < n->size; i++) {
        n->steps[i] = 0.5 * before[i];
        n->wrenches[i] -= n->steps[i] * n->scale[i];
    }
    n->squares[0] = 0.25 * n->squares[n->kept - 1];
    n->kept = 1;
    n->last *= 0.5;
    n->halved = 1;
    n->halvings++;
    n->iteration--;
    return GOES_ON;
}

/* Refresh matrices where contraction is slow, by new evaluations only where that pays, and make a step. */
static int refresh(Solver *s, const double *step) {
    Network *n = s->network;
    size_t stage = 0;
    while (stage < REFRESHES && n->iteration != refreshed[stage]) stage++;
    if (stage == REFRESHES || !(n->correction > SLOW * n->last)) return apply(n, step);
    if (stage == TURNS) system_assemble(n);
    else if (!is_too_slow(n) && ++n->endured <= PATIENCE) return apply(n, step);
    else if (!provide(s, 1)) return REFUSED;
    return restart(n);
}

/* Compute the next wrenches from the residual, and decide whether the iteration ends. */
static int correct(Solver *s) {
    Network *n = s->network;
    double *step = n->steps + n->kept * n->size;
    const size_t halved = n->halved;
    n->halved = 0;
    if (halved) system_assemble(n);
    scaled_direction(n, step);
    if (!halved) update(n, step);
    n->correction = largest_of(step, n->size, &n->worst_row);
    if (n->correction <= 1.0) {
        if (!is_credible(n)) return NOT_CONVERGED;
        if (n->iteration == MOST_ITERATIONS || is_enough(n)) return CONVERGED;
        return halved ? restart(n) : apply(n, step); /* once more */
    }
    if (is_near(n) && is_within_round_off(n)) return CONVERGED;
    if (!isfinite(n->correction)) return NOT_CONVERGED;
    if (!halved && n->correction > DIVERGED * n->last) return NOT_CONVERGED;
    const int is_rough = n->correction * n->tolerance.relative > ROUGH_STEP;
    const int may_halve = n->iteration > refreshed[TURNS] && n->halvings < MOST_HALVINGS;
    if (is_rough && may_halve && overshoots(n, step)) return halve(n);
    return halved ? restart(n) : refresh(s, step);
}

static void note_residual(Network *n) {
    for (size_t i = 0; i < n->size; i++) n->residual[i] = n->law[i] - n->wrenches[i];
}

/* Chord Newton from the present wrenches. */
static int iterate(Solver *s, double time, double h) {
    Network *n = s->network;
    n->iteration = n->kept = n->halved = n->halvings = 0;
    n->last = n->correction = INFINITY;
    while (n->iteration < MOST_ITERATIONS) {
        n->iteration++;
        if (!network_sweep(n, time, h)) return REFUSED;
        note_residual(n);
        if (!isfinite(largest_of(n->residual, n->size, &n->worst_row))) {
            n->correction = INFINITY;
            return NOT_FINITE;
        }
        if (!is_ready(s, h) && !provide(s, 0)) return REFUSED;
        const int status = correct(s);
        if (status != GOES_ON) return status;
    }
    return NOT_CONVERGED;
}

/* Compute the residual of the present wrenches; 0 if a participant fails or returns values that are not finite. */
static int residual_of(Solver *s, double time, double h) {
    Network *n = s->network;
    if (!network_sweep(n, time, h)) return 0;
    note_residual(n);
    return all_finite(n->residual, n->size);
}

/* Largest component of a correction in the units of `scale`. */
static double scaled_size(Network *n, const double *correction) {
    double largest = 0.0;
    for (size_t i = 0; i < n->size; i++) {
        const double size = fabs(correction[i]) / n->scale[i];
        if (!(size <= largest)) largest = size, n->worst_row = i;
    }
    return largest;
}

/* Go along a correction, halved until the next one by the same matrices is smaller; whether there is a residual. */
static int search_along(Solver *s, double time, double h, const double *step, double size) {
    Network *n = s->network;
    double *start = s->start, *next = n->steps;
    int fine = 0;
    memcpy(start, n->wrenches, n->size * sizeof(double));
    for (double share = 1.0; share > 1e-3; share *= 0.5) {
        for (size_t i = 0; i < n->size; i++) n->wrenches[i] = start[i] + share * step[i];
        fine = residual_of(s, time, h);
        if (!fine) continue;
        system_direction(n, n->residual, next);
        if (scaled_size(n, next) <= (1.0 - 0.25 * share) * size) break;
    }
    return fine;
}

/* Newton's method with all matrices at the present wrenches, each correction halved until it makes progress. */
static int iterate_damped(Solver *s, double time, double h) {
    Network *n = s->network;
    double *step = s->step;
    int fine = residual_of(s, time, h);
    for (n->iteration = 1; n->iteration <= MOST_DAMPED && fine; n->iteration++) {
        SizedJacobian *one = jacobian_of(n, &s->jacobians, h);
        one->has_mobilities = one->has_stiffnesses = 0;
        s->jacobians.once_h = 0.0;
        if (!provide(s, 0)) return REFUSED;
        system_direction(n, n->residual, step);
        set_scale(n, step);
        n->correction = scaled_size(n, step);
        if (n->correction <= 1.0) return is_credible(n) ? CONVERGED : NOT_CONVERGED;
        if (is_near(n) && is_within_round_off(n)) return CONVERGED;
        fine = search_along(s, time, h, step, n->correction);
    }
    return fine ? NOT_CONVERGED : REFUSED;
}

/* Iterate in one way. If a participant refuses a step, its matrices are those of absurd wrenches. */
static int attempt(Solver *s, int (*way)(Solver *, double, double), double time, double h) {
    const int status = way(s, time, h);
    if (status == REFUSED) s->ready_step = NAN;
    return status;
}

int solve(Solver *s, double time, double h, const double *guess) {
    Network *n = s->network;
    memcpy(n->wrenches, guess, n->size * sizeof(double));
    int status = attempt(s, iterate, time, h);
    if (status == CONVERGED || (status == REFUSED && is_fatal(n))) return status;
    forget_stiffnesses(s);
    jacobian_of(n, &s->jacobians, h)->bodies_outdated = 1;
    if (status != NOT_CONVERGED || !is_near(n)) memcpy(n->wrenches, guess, n->size * sizeof(double));
    status = attempt(s, iterate, time, h);
    if (status == CONVERGED || !s->persistent) return status;
    memcpy(n->wrenches, guess, n->size * sizeof(double));
    return attempt(s, iterate_damped, time, h);
}

int solve_predicted(Solver *s, double time, double h) {
    double *guess = s->predicted;
    predict(s->network, time + 0.5 * h, h, guess);
    return solve(s, time, h, guess);
}

int linearize(Solver *s, double time, double h) {
    Network *n = s->network;
    memcpy(n->wrenches, n->accepted, n->size * sizeof(double));
    if (!network_sweep(n, time, h)) return 0;
    jacobian_of(n, &s->jacobians, h)->has_stiffnesses = 0;
    return provide(s, 0);
}
