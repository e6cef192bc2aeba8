/* Communication steps one after the other until something happens: size, solution, error, location of events. */

#include "coupling.h"

#include <math.h>

#include "local_error.h"
#include "prediction.h"
#include "scheme.h"

enum { EVENT_SEARCH = 40 };
#define EVENT_TOLERANCE 1e-11 /* distance at which an event is met */
#define LONGEST_CALL 0.03     /* s of wall time, after which a report is due */

/* How an attempt at a step ends, other than by what `coupling_advance` returns. */
enum { MADE = STOPPED_SHORT + 1, REJECTED };

static int are_sizes_given(const Coupling *c) { return c->request.plan || c->request.fixed_step > 0.0; }

static double next_break(const Coupling *c) { return fmin(c->law_time, c->request.event_time); }

/* Size of the next step. No tiny step remains at the end, as it would cost accuracy. */
static double next_size(const Coupling *c) {
    const double remaining = fmin(c->request.until, next_break(c)) - c->progress.time;
    const double h = c->request.plan                ? c->request.plan[c->progress.made]
                     : c->request.fixed_step > 0.0 ? c->request.fixed_step / (double)c->divided.parts
                                            : size_now(&c->sizes);
    if (remaining < STRETCHED * h) return remaining;
    return !are_sizes_given(c) && remaining < SHARED * h ? 0.5 * remaining : h;
}

static int stop_short(Coupling *c, int failure) {
    coupling_fails(c, failure);
    return STOPPED_SHORT;
}

/* After a failed attempt: set a smaller size, at least a share of the smallest one. failure: what to report where there
   is none. A planned size is the caller's: `of_plan` is returned. */
static int reject(Coupling *c, double share, int of_plan, int failure) {
    if (failure == OF_PARTICIPANT && is_fatal(&c->network)) return stop_short(c, failure);
    if (c->request.plan) {
        coupling_fails(c, failure);
        return of_plan;
    }
    const int is_left = c->request.fixed_step > 0.0 ? divide_step(&c->divided) : shrink_size(&c->sizes, share);
    if (!is_left) return stop_short(c, failure);
    c->progress.rejected++;
    return REJECTED;
}

static int failure_of(int status) { return status == REFUSED ? OF_PARTICIPANT : OF_STEP; }

/* Whether the step just observed strikes a stop or contact that waits. */
static int is_struck(const Strike *s) { return *s->waits != 0.0 && s->before < 0.0 && *s->place >= 0.0; }

/* Judge the loads of all that the present step has struck from now on. Returns how many there are, negative if a
   participant fails. */
static int judge_struck(Coupling *c, double h) {
    static const Slope free_of_load;
    Stiffening found[MOST_STRUCK];
    Slope pushing;
    Strike *first = NULL;
    size_t count = 0;
    int struck = 0;
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++) {
        if (!is_struck(s)) continue;
        *s->waits = 0.0;
        struck++;
        if (count == MOST_STRUCK) continue;
        if (!slope_of(&c->solver, s->participant, c->progress.time, h, &pushing)) return -1;
        if (!stiffening_of(&c->network, s->participant, &free_of_load, &pushing, h, found + count)) continue;
        count++;
        coupling_forget_struck(c, s->participant);
        if (!first) first = s;
    }
    if (!first) return struck;
    first->struck->hinges = (double)count;
    for (size_t i = 0; i < count; i++) first->struck->hinge[i] = found[i];
    note_whole_swing(&c->solver, c->progress.time, c->sizes.largest, first->struck, c->room);
    coupling_watch_loads(c);
    return struck;
}

/* Accept or reject the solved step. */
static int judge_step(Coupling *c, double h) {
    const Network *n = &c->network;
    if (!guard_allows(&c->guard, n->energies, h, c->limit.jump)) {
        const int rejected = reject(c, 1.0, TOO_LONG, OF_STEP);
        if (rejected != STOPPED_SHORT) return rejected;
        c->progress.failure = NO_FAILURE;
        guard_gives_in(&c->guard, n->energies);
    }
    if (are_sizes_given(c)) {
        step_stood(&c->divided);
        return MADE;
    }
    const int struck = judge_struck(c, h);
    if (struck < 0) return stop_short(c, OF_PARTICIPANT);
    const double square = struck ? 0.0 : error_square(&c->network, c->progress.time + 0.5 * h, h, c->limit.energy);
    /* a step that strikes is made once more, with the load of what it strikes in its error */
    if (!struck && (isnan(square) || judge_error(&c->sizes, sqrt(square) / c->limit.allowed))) return MADE;
    c->progress.rejected++;
    return REJECTED;
}

/* Number of the first distance that falls through zero in a step h (s), by linear interpolation; negative for none. Of
   simultaneous ones it is the first in order. */
static ptrdiff_t first_crossed(const Coupling *c, double h) {
    ptrdiff_t best = -1;
    double best_time = h;
    for (size_t k = 0; k < c->crossings; k++) {
        if (c->pending[k] == 0.0) continue;
        const double before = c->crossing[k].before, after = distance_of(c->crossing + k);
        const double time = h * before / (before - after);
        if (after <= 0.0 && 0.0 < before && (best < 0 ? time <= h : time < best_time)) {
            best = (ptrdiff_t)k;
            best_time = time;
        }
    }
    return best;
}

/* Repeat the step so that it ends where a distance is zero, by the Illinois variant of the false position; h: its size
   (s). Returns how the last solution ended. */
static int meet(Coupling *c, size_t crossed, double *h) {
    const Crossing *one = c->crossing + crossed;
    double low = 0.0, high = *h, at_low = one->before, at_high = distance_of(one);
    int side = 0, status = CONVERGED;
    for (size_t i = 0; i < EVENT_SEARCH; i++) {
        *h = (at_low * high - at_high * low) / (at_low - at_high);
        *h = fmin(fmax(*h, low + 1e-3 * (high - low)), high);
        status = solve_predicted(&c->solver, c->progress.time, *h);
        if (!is_solved(c, status)) return status;
        if (crossed >= c->lines && !network_observe(&c->network)) return REFUSED;
        const double value = distance_of(one);
        if (fabs(value) < EVENT_TOLERANCE || high - low < 1e-12) break;
        if (value > 0.0) {
            low = *h, at_low = value;
            if (side == 1) at_high *= 0.5;
            side = 1;
        } else {
            high = *h, at_high = value;
            if (side == -1) at_low *= 0.5;
            side = -1;
        }
    }
    return CONVERGED;
}

/* Mark what ended the step, and all else that falls through zero within an INSTANT. */
static void note_reached(Coupling *c, ptrdiff_t crossed, double h) {
    for (size_t k = 0; k < c->crossings; k++) {
        const Crossing *one = c->crossing + k;
        const int falls = one->before + one->rate * h > 0.0 && one->before <= one->rate * INSTANT;
        c->reached[k] = crossed >= 0 && c->pending[k] != 0.0 && (falls || (ptrdiff_t)k == crossed);
    }
    c->progress.crossed = crossed;
}

static int accept(Coupling *c, double h) {
    Network *n = &c->network;
    Progress *p = &c->progress;
    for (size_t i = 0; i < n->size; i++) n->accepted[i] = n->wrenches[i];
    history_add(n, p->time + 0.5 * h, h);
    if (!network_save(n)) return 0;
    p->lets_go = p->time + h >= c->release_time - BREAK_REACHED;
    p->time += h;
    c->steps[p->made++] = h;
    c->position++;
    for (Crossing *one = c->crossing; one < c->crossing + c->crossings; one++)
        one->rate = (one->before - distance_of(one)) / h;
    coupling_watch(c);
    guard_accepts(&c->guard, n->energies);
    rows_hold(&c->rows, n, p->time, h, c->segment, c->sizes.order == 4 && c->position > 1);
    c->limit.energy = fmax(c->limit.energy, n->energies[KINETIC]);
    return 1;
}

/* Attempt the next step. */
static int try_step(Coupling *c) {
    Network *n = &c->network;
    Progress *p = &c->progress;
    p->h = p->tried = next_size(c);
    int status = solve_predicted(&c->solver, p->time, p->h);
    if (!is_solved(c, status)) return reject(c, TO_CONVERGE, UNSOLVED, failure_of(status));
    if (!network_observe(n)) return stop_short(c, OF_PARTICIPANT);
    const int judged = c->repeats ? MADE : judge_step(c, p->h);
    if (judged != MADE) return judged;
    const ptrdiff_t crossed = first_crossed(c, p->h);
    if (crossed >= 0) {
        status = meet(c, (size_t)crossed, &p->h);
        if (!is_solved(c, status)) return reject(c, 1.0, UNSOLVED, failure_of(status));
        if (!network_observe(n)) return stop_short(c, OF_PARTICIPANT);
    }
    const int is_break = p->time + p->h >= next_break(c) - BREAK_REACHED;
    if (!accept(c, p->h)) return stop_short(c, OF_PARTICIPANT);
    note_reached(c, crossed, p->h);
    return crossed >= 0 ? REACHED : is_break ? BROKE : MADE;
}

/* Whether a condition is met though its distance has not fallen through zero. */
static int is_condition_met(const Coupling *c) {
    for (size_t k = c->lines; k < c->crossings; k++)
        if (c->pending[k] != 0.0 && c->crossing[k].before <= 0.0) return 1;
    return 0;
}

int coupling_advance(Coupling *c) {
    Progress *p = &c->progress;
    const double end = seconds_now() + LONGEST_CALL;
    p->made = p->rejected = 0;
    p->failure = NO_FAILURE;
    while (p->time < c->request.until - TIME_ROUNDING) {
        const int stop = try_step(c);
        if (stop < MADE) return stop;
        if (p->made + 1 >= c->rows.room || p->time >= c->request.pause_time || is_condition_met(c)) break;
        if ((c->request.plan && p->made == c->request.planned) || seconds_now() > end) break;
    }
    return PAUSED;
}

void coupling_give_in(Coupling *c) { guard_gives_in(&c->guard, c->network.energies); }
