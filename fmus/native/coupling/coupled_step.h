/* The inner loop of a coupled step over FMI 2.0 functions; see orchestrator/cosim/implicit/python_solver.py for the
   method and native_solver.py beside it for who fills these structures. Nothing here allocates or is global.

   orchestrator/cosim/native/coupling.c makes a library of its own of it, assembly.c the master inside of an FMU; each
   defines EXPORT before, for what it takes of the functions. */

#ifndef FANFOLD_COUPLED_STEP_H
#define FANFOLD_COUPLED_STEP_H

#include "loop.h"

#ifdef _WIN32
/* windows.h has names of its own for much that is here */
__declspec(dllimport) int __stdcall QueryPerformanceCounter(long long *count);
__declspec(dllimport) int __stdcall QueryPerformanceFrequency(long long *frequency);
#else
#include <time.h>
#endif

/* What a participant can fail in, in the order of FAILURES in orchestrator/cosim/fmu.py. */
enum { RESTORE, SET, STEP, GET, FINITE, SAVE, OBSERVE, OBSERVED };
/* How an iteration ends, in the order of Status in orchestrator/cosim/implicit/native_solver.py. */
enum { CONVERGED, NOT_CONVERGED, REFUSED, NOT_FINITE, WANTS_MATRICES, WANTS_EVALUATION, GOES_ON };

static double seconds_now(void) {
#ifdef _WIN32
    long long count, frequency;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&frequency);
    return (double)count / (double)frequency;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

static double sum_of(const double *values, size_t size) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        s0 += values[i];
        s1 += values[i + 1];
        s2 += values[i + 2];
        s3 += values[i + 3];
    }
    for (; i < size; i++) s0 += values[i];
    return (s0 + s1) + (s2 + s3);
}

/* The sum of finite numbers may overflow. */
static int all_finite(const double *values, size_t size) {
    if (isfinite(sum_of(values, size))) return 1;
    for (size_t i = 0; i < size; i++)
        if (!isfinite(values[i])) return 0;
    return 1;
}

/* One participant from its saved state through the step. */
static int step_one(Network *n, size_t i) {
    const Participant *p = n->participant + i;
    int status = p->set_state(p->component, *p->saved);
    if (status > FMI_WARNING) return fail(n, i, RESTORE, status);
    status = p->set_real(p->component, p->input_references, p->inputs, p->input);
    if (status > FMI_WARNING) return fail(n, i, SET, status);
    status = p->do_step(p->component, n->time, n->h, 0);
    if (status > FMI_WARNING) return fail(n, i, STEP, status);
    status = p->get_real(p->component, p->output_references, p->outputs, p->output);
    if (status > FMI_WARNING) return fail(n, i, GET, status);
    return all_finite(p->output, p->outputs) ? 1 : fail(n, i, FINITE, 0);
}

static int step_all(Network *n, size_t first, size_t last) {
    const double begin = seconds_now();
    int fine = 1;
    for (size_t i = first; i < last && fine; i++) fine = step_one(n, i);
    n->seconds += seconds_now() - begin;
    return fine;
}

/* Copy `count` numbers that ports hold beside the rest, where both sides have them. */
static void carry(double *to, size_t to_first, size_t to_port, const double *from, size_t from_first, size_t from_port,
                  size_t count) {
    if (to_first && from_first)
        memcpy(to + to_first + count * to_port, from + from_first + count * from_port, count * sizeof(double));
}

static void give_wrenches(Network *n) {
    const double *wrench = n->wrenches;
    for (const Link *l = n->link; l < n->link + n->links; l++, wrench += n->width.wrench) {
        const Participant *body = n->participant + l->body;
        memcpy(body->input + WRENCH * l->body_port, wrench, WRENCH * sizeof(double));
        carry(body->input, body->slopes, l->body_port, wrench, WRENCH, 0, WRENCH);
    }
}

static void give_motions(Network *n) {
    for (const Link *l = n->link; l < n->link + n->links; l++) {
        const Participant *body = n->participant + l->body, *connection = n->participant + l->connection;
        memcpy(connection->input + MOTION * l->connection_port, body->output + MOTION * l->body_port,
               MOTION * sizeof(double));
        carry(connection->input, connection->moments, l->connection_port, body->output, body->moments, l->body_port,
              MOMENTS);
    }
}

static void take_wrenches(Network *n) {
    double *law = n->law;
    for (const Link *l = n->link; l < n->link + n->links; l++, law += n->width.wrench) {
        const Participant *connection = n->participant + l->connection;
        memcpy(law, connection->output + WRENCH * l->connection_port, WRENCH * sizeof(double));
        carry(law, WRENCH, 0, connection->output, connection->slopes, l->connection_port, WRENCH);
    }
}

static int sweep(Network *n) {
    n->sweeps++;
    give_wrenches(n);
    if (!step_all(n, 0, n->bodies)) return 0;
    give_motions(n);
    if (!step_all(n, n->bodies, n->participants)) return 0;
    take_wrenches(n);
    return 1;
}

/* What a correction of 1 means for every row, for wrenches of the size of `wrenches + change`. */
static void set_scale(Network *n, const double *change) {
    double largest[2] = {0.0, 0.0};
    for (size_t i = 0; i < n->size; i++)
        largest[i / 3 % 2] = fmax(largest[i / 3 % 2], fabs(n->wrenches[i] + change[i]));
    const Tolerance *t = &n->tolerance;
    for (size_t i = 0; i < n->size; i++)
        n->scale[i] = t->relative * (i / 3 % 2 ? t->torque + largest[1] : t->force + largest[0]);
}

/* The chord Newton correction in the units of `scale`. */
static void scaled_direction(Network *n, double *result) {
    direction(n, n->residual, result);
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
    if (slope < n->limits.steepest)
        for (size_t i = 0; i < n->size; i++) result[i] *= factor;
}

/* Largest component and its row; infinite where one is not finite. */
static double largest_of(const double *values, size_t size, size_t *row) {
    double largest = -1.0;
    for (size_t i = 0; i < size; i++) {
        if (!isfinite(values[i])) {
            *row = i;
            return INFINITY;
        }
        if (fabs(values[i]) > largest) {
            largest = fabs(values[i]);
            *row = i;
        }
    }
    return fmax(largest, 0.0);
}

/* Whether residuals are rounding: of motions times stiffness, and of the largest wrench itself, or as small as is asked. */
static int within_round_off(const Network *n) {
    const double wrenches = fmax(n->tolerance.residual, n->limits.round_off / n->tolerance.relative);
    for (size_t i = 0; i < n->size; i++)
        if (!(fabs(n->residual[i]) <= n->round_off[i] + wrenches * n->scale[i])) return 0;
    return 1;
}

/* Whether wrenches like these can leave this residual; matrices of a motion gone astray correct nothing. */
static int is_credible(const Network *n) {
    size_t row;
    const double wrench = 1.0 + largest_of(n->wrenches, n->size, &row);
    return largest_of(n->residual, n->size, &row) <= n->limits.credible * wrench;
}

/* Whether residuals are as small as the accuracy asked of the recorded loads, or as rounding lets them be.

   A stiff joint turns a small correction into a residual that is large beside it. */
static int agrees(const Network *n) {
    for (size_t i = 0; i < n->size; i++)
        if (!(fabs(n->residual[i]) <= fmax(n->limits.agreed * n->scale[i], n->round_off[i]))) return 0;
    return 1;
}

/* Whether all corrections to come, which shrink like the last, add up to less than 1: slow ones may not. */
static int leaves_little(const Network *n) {
    return n->last == 0.0 || n->correction <= 1.0 - n->correction / n->last;
}

/* Keep the step and take it. */
static int apply(Network *n, const double *step) {
    n->last = n->correction;
    n->squares[n->kept] = dot(step, step, n->size);
    n->kept++;
    for (size_t i = 0; i < n->size; i++) n->wrenches[i] += step[i] * n->scale[i];
    return GOES_ON;
}

/* Forget the steps taken with the matrices before, and take one with the present ones. */
static int restart(Network *n) {
    n->kept = 0;
    scaled_direction(n, n->steps);
    return apply(n, n->steps);
}

/* Whether the present contraction does not get there in the iterations that are left. */
static int too_slow(const Network *n) {
    return n->correction * pow(n->correction / n->last, (double)(n->limits.most - n->iteration)) > 1.0;
}

/* Whether a correction takes back the step before without being smaller. */
static int overshoots(const Network *n, const double *step) {
    if (n->kept == 0 || !(n->correction >= n->limits.overshot * n->last)) return 0;
    const double *before = n->steps + (n->kept - 1) * n->size;
    const double back = -dot(before, step, n->size);
    const double length = sqrt(n->squares[n->kept - 1] * dot(step, step, n->size));
    return back > n->limits.overshot * length;
}

/* Go back half of the step before, where matrices are made anew; no iteration of its own. */
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

/* From residual and factors to the next wrenches. */
static int correct(Network *n) {
    double *step = n->steps + n->kept * n->size;
    const size_t halved = n->halved;
    n->halved = 0;
    if (halved) assemble(n);
    scaled_direction(n, step);
    if (!halved) update(n, step);
    n->correction = largest_of(step, n->size, &n->worst_row);
    if (n->correction <= 1.0) {
        if (!is_credible(n)) return NOT_CONVERGED;
        if (n->iteration == n->limits.most) return CONVERGED;
        if (leaves_little(n) && (n->last <= 1.0 || agrees(n))) return CONVERGED;
        return halved ? restart(n) : apply(n, step); /* once more */
    }
    const double relative = n->correction * n->tolerance.relative;
    const int near = relative <= n->limits.near;
    if (near && within_round_off(n)) return CONVERGED;
    if (!isfinite(n->correction)) return NOT_CONVERGED;
    if (!halved && n->correction > n->limits.diverged * n->last) return NOT_CONVERGED;
    const int may_halve = n->iteration > n->limits.refreshed[0] && n->halvings < n->limits.halvings;
    if (relative > n->limits.rough && may_halve && overshoots(n, step)) return halve(n);
    if (halved) return restart(n);
    for (size_t k = 0; k < 3; k++)
        if (n->iteration == n->limits.refreshed[k] && n->correction > n->limits.slow * n->last) {
            if (k > 0) return too_slow(n) || ++n->endured > n->limits.patience ? WANTS_EVALUATION : apply(n, step);
            assemble(n);
            return restart(n);
        }
    return apply(n, step);
}

/* Sweeps and corrections until there is something to tell. */
static int proceed(Network *n, int ready) {
    while (n->iteration < n->limits.most) {
        n->iteration++;
        if (!sweep(n)) return REFUSED;
        for (size_t i = 0; i < n->size; i++) n->residual[i] = n->law[i] - n->wrenches[i];
        if (!isfinite(largest_of(n->residual, n->size, &n->worst_row))) {
            n->correction = INFINITY;
            return NOT_FINITE;
        }
        if (!ready) return WANTS_MATRICES;
        const int status = correct(n);
        if (status != GOES_ON) return status;
    }
    return NOT_CONVERGED;
}

/* Bodies under the wrenches, then connections over the motions, all from their saved states; 1 or 0. */
EXPORT int coupling_sweep(Network *n, double time, double h) {
    n->time = time;
    n->h = h;
    return sweep(n);
}

/* Iterate from the present wrenches; ready: matrices for h are assembled. */
EXPORT int coupling_iterate(Network *n, double time, double h, int ready) {
    n->time = time;
    n->h = h;
    n->iteration = n->kept = n->halved = n->halvings = 0;
    n->last = n->correction = INFINITY;
    return proceed(n, ready);
}

/* Go on with the matrices that the iteration wanted; again: it had others before. */
EXPORT int coupling_resume(Network *n, int again) {
    n->endured = 0;
    assemble(n);
    const int status = again ? restart(n) : correct(n);
    return status == GOES_ON ? proceed(n, 1) : status;
}

/* Assemble and factorise from the present matrices and motions. */
EXPORT void coupling_assemble(Network *n) { assemble(n); }

/* Chord Newton correction for a residual. */
EXPORT void coupling_direction(const Network *n, const double *residual, double *result) {
    direction(n, residual, result);
}

/* Wrenches that a step h with this mid-step time may start from: extrapolated, or those accepted last. */
EXPORT void coupling_predict(const Network *n, double middle, double h, double *result) {
    if (n->history.count)
        extrapolate(n, middle, h, n->history.count, result);
    else
        memcpy(result, n->accepted, n->size * sizeof(double));
}

/* See error_square. */
EXPORT double coupling_error_square(Network *n, double middle, double h, double energy) {
    return error_square(n, middle, h, energy);
}

/* Save the states of all; 1 or 0. */
EXPORT int coupling_save(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        if (*p->saved && !p->overwrites_state) {
            p->free_state(p->component, p->saved);
            *p->saved = NULL;
        }
        const int status = p->get_state(p->component, p->saved);
        if (status > FMI_WARNING) return fail(n, i, SAVE, status);
    }
    return 1;
}

/* Take the present wrenches for those of the step h with this mid-step time, and save the states; 1 or 0. */
EXPORT int coupling_accept(Network *n, double middle, double h) {
    memcpy(n->accepted, n->wrenches, n->size * sizeof(double));
    remember(n, middle, h);
    return coupling_save(n);
}

/* Forget the wrenches of steps before: something jumped. */
EXPORT void coupling_restart(Network *n) { n->history.count = 0; }

/* Read the observations of all, for the present inputs, and sum up their energies; 1 or 0. */
EXPORT int coupling_observe(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        int status = p->set_real(p->component, p->input_references, p->inputs, p->input);
        if (status > FMI_WARNING) return fail(n, i, SET, status);
        if (p->observations == 0) continue;
        status = p->get_real(p->component, p->observation_references, p->observations, p->observation);
        if (status > FMI_WARNING) return fail(n, i, OBSERVE, status);
        if (!all_finite(p->observation, p->observations)) return fail(n, i, OBSERVED, 0);
    }
    const size_t *row = n->energy_rows;
    for (size_t kind = 0; kind < n->energy_kinds; kind++) {
        n->energies[kind] = 0.0;
        for (size_t i = 0; i < n->participants; i++) n->energies[kind] += n->observations[*row++];
    }
    return 1;
}

/* Solve the next step of a run, or go on with the matrices that it wanted. */
static int solve_next(Loop *l) {
    Network *n = l->network;
    const int wanted = (int)l->wanted;
    l->wanted = PAUSED;
    if (wanted != PAUSED) {
        l->ready_step = l->h;
        return coupling_resume(n, wanted == NEEDS_EVALUATION);
    }
    l->h = next_step(l);
    coupling_predict(n, l->time + 0.5 * l->h, l->h, n->wrenches);
    return coupling_iterate(n, l->time, l->h, l->ready_step == l->h);
}

/* One plain step; PAUSED where there is nothing to tell of it. */
static int follow_step(Loop *l) {
    const int status = solve_next(l);
    l->status = (size_t)status;
    if (status == WANTS_MATRICES || status == WANTS_EVALUATION)
        return (int)(l->wanted = status == WANTS_MATRICES ? NEEDS_MATRICES : NEEDS_EVALUATION);
    if (status != CONVERGED) return UNSOLVED;
    if (!coupling_observe(l->network)) return FAILED;
    const int judged = judge_step(l);
    if (judged == PAUSED) l->rejected++;
    if (judged != STANDS) return judged;
    if (has_crossed(l, l->h) || l->time + l->h >= l->break_time - l->rules->break_reached) return STANDS;
    if (!coupling_accept(l->network, l->time + 0.5 * l->h, l->h)) return FAILED;
    count_step(l, l->h);
    return PAUSED;
}

/* Make plain steps until the end, until there is no room for more rows, or until one is not plain; why it stopped. */
EXPORT int coupling_follow(Loop *l) {
    while (l->wanted != PAUSED || l->time < l->until - l->rules->time_rounding) {
        const int status = follow_step(l);
        if (status != PAUSED) return status;
        if (l->made == l->capacity || l->time >= l->stop || is_due(l) || (l->plan && l->made == l->planned)) break;
    }
    return PAUSED;
}

#endif
