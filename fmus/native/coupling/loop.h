/* Plain steps of a run, one after the other: what orchestrator/cosim/master.py does while nothing happens that is not
   plain. It stops where something does, with the step at hand, for the master to go on from there.
   orchestrator/cosim/compiled_master.py fills these structures; nothing here allocates or is global. */

#ifndef FANFOLD_LOOP_H
#define FANFOLD_LOOP_H

#include "rows.h"
#include "system.h"
#include "prediction.h"

enum { TRIALS = 4 };

/* See orchestrator/cosim/stepping.py. */
typedef struct {
    double largest, smallest;
    size_t order;
    ptrdiff_t level, wait, stirred;
    double worst;
} StepSizes;

typedef struct {
    double allowed, resolved, energy;
} ErrorEstimate;

/* See orchestrator/cosim/energy_guard.py; powers: the newest last, trials: how many there are. */
typedef struct {
    double last[ENERGIES], kinetic, powers[TRIALS], power, rounding;
    size_t trials;
} EnergyGuard;

/* Numbers of step control and of the guard; their values stand in the same two files. */
typedef struct {
    double ratio, rejected, rejected_stirred, forget, growth_margin, least_error;
    ptrdiff_t stirred_steps, after_growth, after_shrinking, most_levels, most_growth, after_division;
    double share, rounded, steady, allowance;
    double time_rounding, break_reached, stretched, shared; /* of the master */
} Rules;

/* A distance that falls through zero where a line latches or a condition holds: (value - *place) / scale; rate: at
   which it fell over the last step. */
typedef struct {
    const double *place;
    double value, scale, before, rate;
} Crossing;

/* A run between two instants that something happens at. until, stop (s): its end, and after which step to pause;
   fixed_step (s): 0 for none; plan (planned,): sizes of the steps to make, NULL for none; crossings: those of lines,
   then those of conditions; strikes: of stops and contacts that nothing has struck, by how far they are from that; laws: places of times to breaks, the first of them, bolts, of hold-downs, whose next release
   is at release_time; steps (capacity,): sizes made; position: steps of the segment; parts, stood: of a fixed
   step, as in DividedStep of stepping.py; status: of the coupled step at hand. */
typedef struct {
    Network *network;
    StepSizes *sizes;
    ErrorEstimate *error;
    EnergyGuard *guard;
    const Rules *rules;
    Crossing *crossing, *strike;
    const double *const *law;
    const double *plan, *energy_start;
    double *steps;
    RowBlock rows;
    double time, until, stop, break_time, release_time, event_time, fixed_step, ready_step, h;
    size_t lines, crossings, strikes, laws, bolts, planned, capacity, made, position, parts, stood, rejected, wanted, status;
} Loop;

/* Why a loop stopped, in the order of Stop in orchestrator/cosim/implicit/native_solver.py. */
enum { PAUSED, STANDS, UNSOLVED, UNGUARDED, NEEDS_MATRICES, NEEDS_EVALUATION, FAILED };

static double size_now(const Loop *l) {
    return l->sizes->largest * pow(l->rules->ratio, (double)-l->sizes->level);
}

static void size_changed(const Loop *l, ptrdiff_t wait) {
    l->sizes->wait = wait;
    l->sizes->stirred = l->rules->stirred_steps;
    l->sizes->worst = 0.0;
}

/* Go down; 0 where that is below the smallest size. */
static int shrink(const Loop *l, ptrdiff_t levels) {
    l->sizes->level += levels;
    size_changed(l, l->rules->after_shrinking);
    return size_now(l) >= l->sizes->smallest;
}

static ptrdiff_t least(ptrdiff_t a, ptrdiff_t b) { return a < b ? a : b; }
static ptrdiff_t most(ptrdiff_t a, ptrdiff_t b) { return a > b ? a : b; }

/* Whether a step with this error (over what is allowed) stands; chooses the size of the next one. */
static int judge(const Loop *l, double error) {
    StepSizes *s = l->sizes;
    const Rules *r = l->rules;
    const double per_level = (double)(s->order + 1) * log(r->ratio);
    const int can_shrink = size_now(l) > 2.0 * s->smallest, stirred = s->stirred > 0;
    if (error > (stirred ? r->rejected_stirred : r->rejected) && can_shrink) {
        const double levels = ceil(log(error) / per_level);
        shrink(l, levels < (double)r->most_levels ? most(1, (ptrdiff_t)levels) : r->most_levels);
        return 0;
    }
    s->wait--;
    if (stirred) {
        s->stirred--;
        return 1;
    }
    s->worst = fmax(error, r->forget * s->worst);
    if (error > 1.0 && can_shrink) {
        shrink(l, 1);
    } else if (s->wait <= 0) {
        const ptrdiff_t room = (ptrdiff_t)floor(log(r->growth_margin / fmax(s->worst, r->least_error)) / per_level);
        if (room >= 1 && s->level > 0) {
            s->level = most(0, s->level - least(room, r->most_growth));
            size_changed(l, r->after_growth);
        }
    }
    return 1;
}

static double jump_of(const Loop *l) { return fabs(balance_of(l->network->energies) - balance_of(l->guard->last)); }

static int is_in_balance(const Loop *l) { return jump_of(l) <= l->rules->share * l->guard->kinetic; }

static double in_motion(const Loop *l) {
    double largest = l->guard->kinetic;
    for (size_t i = 0; i < ENERGIES; i++)
        largest = fmax(largest, fabs(l->network->energies[i] - l->guard->last[i]));
    return largest;
}

/* Whether a step h to the present energies, whose balance has jumped, stands all the same. */
static int allows(const Loop *l, double h) {
    EnergyGuard *g = l->guard;
    const double jump = jump_of(l);
    double all = 0.0, high, low;
    for (size_t i = 0; i < ENERGIES; i++) all += fabs(l->network->energies[i]);
    const double known = fmax(fmax(g->power * h, g->rounding), l->rules->rounded * all);
    if (!(jump > fmax(l->rules->share * in_motion(l), known))) return 1;
    memmove(g->powers, g->powers + 1, (TRIALS - 1) * sizeof(double));
    g->powers[TRIALS - 1] = jump / h;
    if (g->trials < TRIALS) g->trials++;
    high = low = g->powers[TRIALS - 1];
    for (size_t i = 0; i + 1 < TRIALS; i++) high = fmax(high, g->powers[i]), low = fmin(low, g->powers[i]);
    if (g->trials < TRIALS || !(high < l->rules->steady * low)) return 0;
    g->power = l->rules->allowance * high;
    return 1;
}

static void note_energies(const Loop *l) {
    memcpy(l->guard->last, l->network->energies, sizeof l->guard->last);
    l->guard->kinetic = fmax(l->guard->kinetic, l->network->energies[KINETIC]);
    l->guard->trials = 0;
}

static double distance(const Crossing *c) { return (c->value - *c->place) / c->scale; }

/* Whether a step h led past one of them. */
static int has_crossed(const Loop *l, double h) {
    for (const Crossing *c = l->crossing; c < l->crossing + l->crossings; c++) {
        const double after = distance(c);
        if (after <= 0.0 && 0.0 < c->before && h * c->before / (c->before - after) <= h) return 1;
    }
    return 0;
}

/* Whether a step has struck what nothing had struck. */
static int has_struck(const Loop *l) {
    for (const Crossing *c = l->strike; c < l->strike + l->strikes; c++)
        if (0.0 < c->before && distance(c) <= 0.0) return 1;
    return 0;
}

/* Note all distances and the next time to end a step at. */
static void watch(Loop *l) {
    double form = INFINITY, release = INFINITY;
    for (Crossing *c = l->crossing; c < l->crossing + l->crossings; c++) c->before = distance(c);
    for (Crossing *c = l->strike; c < l->strike + l->strikes; c++) c->before = distance(c);
    for (size_t i = 0; i < l->laws; i++) form = fmin(form, *l->law[i]);
    for (size_t i = 0; i < l->bolts; i++) release = fmin(release, *l->law[i]);
    l->release_time = l->time + release;
    l->break_time = fmin(l->time + form, l->event_time);
}

/* Whether a condition holds without having been passed. */
static int is_due(const Loop *l) {
    for (size_t i = l->lines; i < l->crossings; i++)
        if (l->crossing[i].before <= 0.0) return 1;
    return 0;
}

static double next_step(const Loop *l) {
    const double remaining = fmin(l->until, l->break_time) - l->time;
    const int controlled = !l->plan && l->fixed_step == 0.0;
    const double h = l->plan             ? l->plan[l->made]
                     : l->fixed_step > 0 ? l->fixed_step / (double)l->parts
                                         : size_now(l);
    if (remaining < l->rules->stretched * h) return remaining;
    if (!controlled) return h;
    return remaining < l->rules->shared * h ? 0.5 * remaining : h;
}

static void count_step(Loop *l, double h) {
    l->time += h;
    l->steps[l->made++] = h;
    l->position++;
    for (Crossing *c = l->crossing; c < l->crossing + l->crossings; c++) c->rate = (c->before - distance(c)) / h;
    watch(l);
    note_energies(l);
    hold_row(&l->rows, l->network, l->energy_start, l->time, h, l->sizes->order == 4 && l->position > 1);
    l->error->energy = fmax(l->error->energy, l->network->energies[KINETIC]);
}

/* Whether the converged step stands: STANDS, PAUSED for a smaller one, UNGUARDED where the master has to see to it. */
static int judge_step(Loop *l) {
    Network *n = l->network;
    const int controlled = !l->plan && l->fixed_step == 0.0;
    if (!is_in_balance(l)) {
        if (!controlled) return UNGUARDED;
        if (!allows(l, l->h)) {
            if (shrink(l, 2)) return PAUSED;
            l->guard->rounding = l->rules->allowance * jump_of(l);
        }
    }
    if (!controlled) {
        if (++l->stood >= (size_t)l->rules->after_division && l->parts > 1) {
            l->parts /= 2;
            l->stood = 0;
        }
        return STANDS;
    }
    if (has_struck(l)) return UNGUARDED;
    const double square = error_square(n, l->time + 0.5 * l->h, l->h, l->error->energy);
    return isnan(square) || judge(l, sqrt(square) / l->error->allowed) ? STANDS : PAUSED;
}

#endif
