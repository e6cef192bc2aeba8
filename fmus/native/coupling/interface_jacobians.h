/* Interface Jacobians of a network by step size, kept as long as they hold, and steps solved with them: what
   orchestrator/cosim/implicit/interface_jacobian.py and solver.py do. */

#ifndef FANFOLD_INTERFACE_JACOBIANS_H
#define FANFOLD_INTERFACE_JACOBIANS_H

#include "coupled_step.h"

enum { KEPT_SIZES = 12, MOST_DAMPED = 30 };

/* The matrices of one step size h (s), 0 where there are none; last_use: when they were asked for, as counted. */
typedef struct {
    double h;
    size_t last_use;
    int has_mobilities, has_stiffnesses, bodies_outdated;
    JacobianBlock *mobility, *stiffness;
    double *numbers; /* of all blocks, matrix before axes, bodies first */
} SizedJacobian;

/* constant: by body, whether its mobility holds wherever it is; slope: room for the outputs of any participant; first:
   where the block of each participant begins among the numbers of a step size, `length` long. */
typedef struct {
    SizedJacobian sizes[KEPT_SIZES];
    const unsigned char *constant;
    double *slope, *guess, *kept;
    size_t *first;
    size_t length, uses;
} Jacobians;

/* What solves steps: the loop with its network, and the matrices. persistent: whether a slow damped iteration is made
   before giving up. */
typedef struct {
    Loop *loop;
    Jacobians jacobians;
    int persistent;
} Solver;

static void forget_stiffnesses(Solver *s) {
    for (size_t i = 0; i < KEPT_SIZES; i++) s->jacobians.sizes[i].has_stiffnesses = 0;
    s->loop->ready_step = NAN;
}

static void forget_all(Solver *s) {
    forget_stiffnesses(s);
    for (size_t i = 0; i < KEPT_SIZES; i++) {
        SizedJacobian *one = s->jacobians.sizes + i;
        one->h = 0.0;
        one->last_use = 0;
        one->has_mobilities = one->bodies_outdated = 0;
    }
    s->jacobians.uses = 0;
}

static size_t block_size(const Network *n, size_t participant) {
    const size_t ports = n->participant[participant].ports;
    return n->width.wrench * n->width.coordinates * ports * ports;
}

/* Mobilities of a step of nearly this size: an event is searched for by steps that differ little. */
static void take_alike(const Network *n, Jacobians *j, SizedJacobian *to) {
    for (size_t i = 0; i < KEPT_SIZES; i++) {
        const SizedJacobian *from = j->sizes + i;
        if (from == to || !from->has_mobilities || !(fabs(from->h - to->h) < 1e-2 * to->h)) continue;
        memcpy(to->numbers, from->numbers, j->first[n->bodies] * sizeof(double));
        to->has_mobilities = 1;
        return;
    }
}

/* Those of a step size, in place of those used least where it is new. */
static SizedJacobian *jacobian_of(Solver *s, double h) {
    Jacobians *j = &s->jacobians;
    SizedJacobian *found = j->sizes;
    for (SizedJacobian *one = j->sizes; one < j->sizes + KEPT_SIZES && found->h != h; one++)
        if (one->h == h || one->last_use < found->last_use) found = one;
    if (found->h != h) {
        found->h = h;
        found->has_mobilities = found->has_stiffnesses = found->bodies_outdated = 0;
        take_alike(s->loop->network, j, found);
    }
    found->last_use = ++j->uses;
    return found;
}

/* One block about the step just made; 0 where the participant cannot. */
static int fill_block(Network *n, Jacobians *j, size_t i, double *numbers) {
    const Participant *p = n->participant + i;
    const int is_body = i < n->bodies;
    axes_of(is_body ? p->output : p->input, numbers + block_size(n, i));
    const int status = is_body ? mobility_of(p, n->width, numbers, j->slope) : stiffness_of(p, n->width, numbers, j->slope);
    return status <= FMI_WARNING || fail(n, i, STEP, status);
}

static int fill_mobilities(Solver *s, SizedJacobian *one) {
    Network *n = s->loop->network;
    Jacobians *j = &s->jacobians;
    for (size_t i = 0; i < n->bodies; i++)
        if (!(one->has_mobilities && j->constant[i]) && !fill_block(n, j, i, one->numbers + j->first[i])) return 0;
    one->has_mobilities = 1;
    one->bodies_outdated = 0;
    return 1;
}

static int fill_stiffnesses(Solver *s, SizedJacobian *one) {
    Network *n = s->loop->network;
    for (size_t i = n->bodies; i < n->participants; i++)
        if (!fill_block(n, &s->jacobians, i, one->numbers + s->jacobians.first[i])) return 0;
    return one->has_stiffnesses = 1;
}

/* Have the matrices of a step in use; again: others than those it has. 0 where a participant cannot tell. */
static int provide(Solver *s, double h, int again) {
    Network *n = s->loop->network;
    SizedJacobian *one = jacobian_of(s, h);
    s->loop->ready_step = NAN;
    if (again) {
        one->has_stiffnesses = 0;
        one->bodies_outdated |= n->iteration == n->limits.refreshed[2];
    }
    if ((!one->has_mobilities || one->bodies_outdated) && !fill_mobilities(s, one)) return 0;
    if (!one->has_stiffnesses && !fill_stiffnesses(s, one)) return 0;
    n->mobility = one->mobility;
    n->stiffness = one->stiffness;
    s->loop->ready_step = h;
    return 1;
}

/* Chord Newton from the present wrenches. */
static int iterate(Solver *s, double h) {
    Network *n = s->loop->network;
    int status = coupling_iterate(n, s->loop->time, h, s->loop->ready_step == h);
    while (status == WANTS_MATRICES || status == WANTS_EVALUATION) {
        const int again = status == WANTS_EVALUATION;
        if (!provide(s, h, again)) return REFUSED;
        status = coupling_resume(n, again);
    }
    if (status == REFUSED) s->loop->ready_step = NAN;
    return status;
}

/* Residual of the present wrenches; 0 where a participant refuses them. */
static int residual_of(Solver *s, double h) {
    Network *n = s->loop->network;
    if (!coupling_sweep(n, s->loop->time, h)) return 0;
    for (size_t i = 0; i < n->size; i++) n->residual[i] = n->law[i] - n->wrenches[i];
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

/* Go along a correction as far as the next one, by the same matrices, is smaller; whether there is a residual. */
static int search_along(Solver *s, double h, const double *step, double size) {
    Network *n = s->loop->network;
    double *start = s->jacobians.kept, *next = n->steps;
    int fine = 0;
    memcpy(start, n->wrenches, n->size * sizeof(double));
    for (double share = 1.0; share > 1e-3; share *= 0.5) {
        for (size_t i = 0; i < n->size; i++) n->wrenches[i] = start[i] + share * step[i];
        fine = residual_of(s, h);
        if (!fine) continue;
        direction(n, n->residual, next);
        if (scaled_size(n, next) <= (1.0 - 0.25 * share) * size) break;
    }
    return fine;
}

/* Newton with all matrices of the present wrenches, each correction halved until it makes progress. */
static int iterate_damped(Solver *s, double h) {
    Network *n = s->loop->network;
    double *step = s->jacobians.slope;
    int fine = residual_of(s, h);
    for (n->iteration = 1; n->iteration <= MOST_DAMPED && fine; n->iteration++) {
        SizedJacobian *one = jacobian_of(s, h);
        one->has_mobilities = one->has_stiffnesses = 0;
        if (!provide(s, h, 0)) return REFUSED;
        assemble(n);
        step = s->jacobians.guess;
        direction(n, n->residual, step);
        set_scale(n, step);
        n->correction = scaled_size(n, step);
        if (n->correction <= 1.0) return is_credible(n) ? CONVERGED : NOT_CONVERGED;
        if (n->correction * n->tolerance.relative <= n->limits.near && within_round_off(n)) return CONVERGED;
        fine = search_along(s, h, step, n->correction);
    }
    return NOT_CONVERGED;
}

/* What a first iteration from a guess came to, or where it did not converge, what others come to. guess: no array of
   the network that iterations write. */
static int insist(Solver *s, int status, double h, const double *guess) {
    Network *n = s->loop->network;
    if (status == CONVERGED) return status;
    forget_stiffnesses(s);
    jacobian_of(s, h)->bodies_outdated = 1;
    const int is_near = status == NOT_CONVERGED && n->correction * n->tolerance.relative <= n->limits.near;
    if (!is_near) memcpy(n->wrenches, guess, n->size * sizeof(double));
    status = iterate(s, h);
    if (status == CONVERGED || !s->persistent) return status;
    memcpy(n->wrenches, guess, n->size * sizeof(double));
    return iterate_damped(s, h);
}

/* The wrenches of the step from the saved states; participants end stepped when it converges. */
static int solve(Solver *s, double h, const double *guess) {
    Network *n = s->loop->network;
    memcpy(n->wrenches, guess, n->size * sizeof(double));
    return insist(s, iterate(s, h), h, guess);
}

/* The same from what the steps before lead to expect. */
static int solve_predicted(Solver *s, double h) {
    double *guess = s->jacobians.kept;
    coupling_predict(s->loop->network, s->loop->time + 0.5 * h, h, guess);
    return solve(s, h, guess);
}

/* Plain steps of the loop; why they stopped. */
static int follow(Solver *s) {
    Loop *l = s->loop;
    l->wanted = l->made = 0;
    int stop = coupling_follow(l);
    while (stop == NEEDS_MATRICES || stop == NEEDS_EVALUATION) {
        if (!provide(s, l->h, stop == NEEDS_EVALUATION)) {
            l->status = REFUSED;
            return UNSOLVED;
        }
        stop = coupling_follow(l);
    }
    if (stop == UNSOLVED && l->status == REFUSED) l->ready_step = NAN;
    return stop;
}

/* Have the matrices of a step h in use, about the wrenches accepted last; participants end stepped. */
static int linearize(Solver *s, double h) {
    Network *n = s->loop->network;
    memcpy(n->wrenches, n->accepted, n->size * sizeof(double));
    if (!coupling_sweep(n, s->loop->time, h)) return 0;
    jacobian_of(s, h)->has_stiffnesses = 0;
    if (!provide(s, h, 0)) return 0;
    assemble(n);
    return 1;
}

/* Take all participants back to their saved states, with the motions of those at the connections. */
static int restore_all(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        int status = p->set_state(p->component, *p->saved);
        if (status > FMI_WARNING) return fail(n, i, RESTORE, status);
        status = p->get_real(p->component, p->output_references, p->outputs, p->output);
        if (status > FMI_WARNING) return fail(n, i, GET, status);
    }
    give_motions(n);
    return 1;
}

#endif
