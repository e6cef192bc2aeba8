/* A run with its events: what orchestrator/cosim/master.py and cosimulation.py do, where all participants are in one
   binary. Nothing here allocates; assembly_data.h makes these structures. */

#ifndef FANFOLD_MASTER_H
#define FANFOLD_MASTER_H

#include <stdio.h>

#include "latch_up.h"
#include "scheme.h"

enum { CHANNELS = 7, FREQUENCY_SEARCH = 6, EVENT_SEARCH = 40, TELLING_STEPS = 2 };
#define LEAST_LATCH_SHARE 1e-3
#define LEAST_KINETIC 1e-17 /* J, see orchestrator/cosim/energy_guard.py */
#define LONGEST_SWING 0.02 /* s, over which a latched wing swings as a whole */
#define EVENT_TOLERANCE 1e-11
#define TO_CONVERGE (1.0 / 1024.0)
#define EVENT_REACHED 1e-9 /* s, what sums of step sizes may leave */

/* An input or parameter of a participant. */
typedef struct {
    size_t participant, place;
} Place;

/* hinge: its participants; is_kinematic: latched by an impulse. Numbers that are part of a saved state: pending, sensor
   (which of the hinges), released (hinges,), latch_time (s; negative before), latch_rate (rad/s just before latch-up, 0
   until then), stiffened. */
typedef struct {
    size_t hinges, is_kinematic;
    const size_t *hinge;
    double *pending, *sensor, *released, *latch_time, *latch_rate;
    StiffenedLine *stiffened;
} HingeLine;

/* A stop or contact: its participant, and where its penetration is observed. Numbers that are part of a saved state:
   before, waits (whether nothing has struck it), struck (with all that was struck with it). */
typedef struct {
    size_t participant;
    const double *place;
    double *before, *waits;
    StiffenedLine *struck;
} Strike;

/* A value for a parameter: `place` among those of all participants. */
typedef struct {
    size_t participant, place;
    double value;
} Setting;

/* time (s): not a number where a condition is waited for, see Crossing. releases: commands; latches: lines. pending is
   part of a saved state. */
typedef struct {
    double time;
    Crossing condition;
    size_t releases, latches, settings;
    const Place *release;
    const size_t *latch;
    const Setting *setting;
    double *pending;
} Event;

typedef struct Master Master;

/* command: places of inputs by what they command, all participants that have it; latch_distance, latch_command,
   angular_rate: by participant, where it has them, otherwise no place. row: takes rows as they come; parameters (all,): in force, part of a
   saved state; steps, rejected, happened: counts. segment: stretch between events that steps are in; event_time (s): of the
   last event or latch-up, negative before, is_crossed: whether a distance was to be met for it; tried (s): size of the step that ended last, before anything crossed in it;
   stalled: correction, over the largest wrench, that may be left; repeats: whether steps stand that are made as others
   were. roughness (corrections,): of loads, between `note_roughness` and `smooth`, else zeros. */
struct Master {
    Network network;
    Loop loop;
    StepSizes sizes;
    ErrorEstimate error;
    EnergyGuard guard;
    Rules rules;
    Solver solver;
    HingeLine *line;
    Event *event;
    Strike *strike;
    Crossing *crossing, *striking;
    Watched *watched;
    double *roughness;
    const Place *impulse;
    const size_t *latch_distance, *latch_command, *angular_rate;
    void (*row)(void *taker, double time, double segment, const double *values);
    int (*set_parameter)(void *taker, size_t participant, size_t place, double value);
    void *taker;
    const char **link_name, **event_name;
    double *row_values, *energy_start, *before_lines, *before_events;
    double start_step, usual_relative, driving_energy, segment, held_segment, event_time, is_crossed, tried, stalled;
    size_t lines, events, strikes, impulses, steps, rejected, happened, repeats, untold, between;
    char said[512];
};

/* Of `pending`: it waits; it acts at this instant; it locks with another; it passed its latch in an impulse; an event
   latches it. */
#define WAITING 1.0
#define REACHED 2.0
#define LOCKING 3.0
#define PASSED 4.0
#define COMMANDED 5.0

static int is_pending_condition(const Event *e) { return *e->pending && isnan(e->time); }

static double *sensed(const Master *m, const HingeLine *line) {
    const size_t sensor = line->hinge[(size_t)*line->sensor];
    return m->network.participant[sensor].output + m->latch_distance[sensor];
}

/* Lists of what may come within a step, lines first. */
static void tell_events(Master *m) {
    Loop *l = &m->loop;
    l->crossing = m->crossing;
    l->crossings = 0;
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending)
            m->crossing[l->crossings++] = (Crossing){sensed(m, m->line + i), 0.0, -1.0, m->before_lines[i]};
    l->lines = l->crossings;
    l->strike = m->striking;
    l->strikes = 0;
    for (const Strike *s = m->strike; s < m->strike + m->strikes; s++)
        if (*s->waits) m->striking[l->strikes++] = (Crossing){s->place, 0.0, 1.0, -*s->before};
    l->event_time = INFINITY;
    for (size_t i = 0; i < m->events; i++) {
        if (is_pending_condition(m->event + i)) {
            m->crossing[l->crossings] = m->event[i].condition;
            m->crossing[l->crossings++].before = m->before_events[i];
        } else if (*m->event[i].pending) {
            l->event_time = fmin(l->event_time, m->event[i].time);
        }
    }
}

/* Take back how far they were after the last accepted step. */
static void take_events(Master *m) {
    const Crossing *c = m->crossing;
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending) m->before_lines[i] = (c++)->before;
    for (size_t i = 0; i < m->events; i++)
        if (is_pending_condition(m->event + i)) m->before_events[i] = (c++)->before;
    c = m->striking;
    for (const Strike *s = m->strike; s < m->strike + m->strikes; s++)
        if (*s->waits) *s->before = -(c++)->before;
}

/* Note how far all are and the next time to end a step at. */
static void watch_all(Master *m) {
    tell_events(m);
    watch(&m->loop);
    take_events(m);
}

static int observe_all(Master *m) { return coupling_observe(&m->network); }

static void channels_of(const Master *m, double h, double iterations, double *channels) {
    const double *found = m->network.energies, *start = m->energy_start;
    channels[0] = h;
    channels[1] = iterations;
    channels[2] = found[KINETIC] + found[POTENTIAL];
    channels[3] = found[DISSIPATED] - start[DISSIPATED];
    channels[4] = found[NUMERICAL] - start[NUMERICAL];
    channels[5] = found[SUPPLIED] - start[SUPPLIED];
    channels[6] = balance_of(found) - balance_of(start);
}

/* Hand on the rows that the loop has let go. */
static void hand_on_rows(Master *m) {
    RowBlock *r = &m->loop.rows;
    for (size_t i = 0; i < r->count; i++)
        m->row(m->taker, r->times[i], m->held_segment, r->values + i * (r->columns + r->channels));
    if (r->count) m->held_segment = m->segment;
    r->count = 0;
}

/* A row that stands as it is, of what was observed last. */
static void add_row(Master *m, double time, double h) {
    RowBlock *r = &m->loop.rows;
    if (r->held) hand_on_held(r);
    r->held = 0;
    hand_on_rows(m);
    for (size_t i = 0; i < r->columns; i++) m->row_values[i] = m->network.observations[r->recorded[i]];
    channels_of(m, h, 0.0, m->row_values + r->columns);
    m->row(m->taker, time, m->between ? -m->segment - 0.5 : m->segment + 0.5, m->row_values);
    m->held_segment = m->segment;
}

static void command_all(Master *m, double value) {
    for (size_t i = 0; i < m->impulses; i++)
        m->network.participant[m->impulse[i].participant].input[m->impulse[i].place] = value;
}

static void command_latches(Master *m, const HingeLine *line, double value) {
    for (size_t i = 0; i < line->hinges; i++)
        if (!line->released[i])
            m->network.participant[line->hinge[i]].input[m->latch_command[line->hinge[i]]] = value;
}

/* Go to the grid size at or below a size (s); not stirred: errors of the first steps count like others. */
static void restart_sizes(Master *m, double size, int stirred) {
    StepSizes *s = &m->sizes;
    const double levels = -floor(log(size / s->largest) / log(m->rules.ratio) + 1e-9);
    s->level = levels > 0.0 ? (ptrdiff_t)levels : 0;
    size_changed(&m->loop, m->rules.after_growth);
    if (!stirred) s->stirred = 0;
}

/* A step too short for motion, beside steps of now. */
static double instant_now(const Master *m) { return fmin(INSTANT, INSTANT_SHARE * size_now(&m->loop)); }

static void begin_segment(Master *m) {
    if (m->loop.position) m->segment += 1.0;
    m->loop.position = 0;
    if (!m->loop.rows.held) m->held_segment = m->segment;
}

static void renew(Master *m) {
    coupling_restart(&m->network);
    if (m->start_step < size_now(&m->loop)) restart_sizes(m, m->start_step, 0);
    begin_segment(m);
}

static void watch_line(Master *m, const StiffenedLine *line) {
    const double whole = m->error.energy, energy = sqrt(whole * fmax(line->energy, LEAST_LATCH_SHARE * whole));
    Network *n = &m->network;
    if (line->hinges) n->watched_count += watch_loads(n, line, energy, m->watched + n->watched_count);
}

/* Judge the torques of latched lines and what struck stops push with, from now on. */
static void watch_lines(Master *m) {
    m->network.watched = m->watched;
    m->network.watched_count = 0;
    for (const HingeLine *line = m->line; line < m->line + m->lines; line++) watch_line(m, line->stiffened);
    for (const Strike *s = m->strike; s < m->strike + m->strikes; s++) watch_line(m, s->struck);
}

/* The same after an event, which may have changed what strikes them. */
static void judge_loads(Master *m) {
    watch_lines(m);
    for (const Strike *s = m->strike; s < m->strike + m->strikes; s++) {
        *s->waits = 1.0;
        *s->before = *s->place;
    }
}

/* Judge a connection's load no more, as one that was struck. */
static void forget_struck(Master *m, size_t participant) {
    for (Strike *s = m->strike; s < m->strike + m->strikes; s++)
        for (size_t i = 0; i < (size_t)s->struck->hinges; i++)
            if (s->struck->hinge[i].connection == (double)participant) s->struck->hinges = 0.0;
}

/* A sentence of a step that does not converge at any size, unless a participant has said one. */
static int say_failure(Master *m, double h) {
    const Network *n = &m->network;
    if (!m->said[0])
        snprintf(m->said, sizeof m->said,
                 "the step of %.3g s from t = %.6f s does not converge: the wrench of %s still changes by %.3g times its "
                 "tolerance; loosen the tolerance or check that connection's stiffness", h, m->loop.time,
                 m->link_name[n->worst_row / n->width.wrench], n->correction);
    return 0;
}

/* Whether an iteration has ended well: converged, or at what it is allowed to leave. */
static int is_solved(const Master *m, int status) {
    const Network *n = &m->network;
    return status == CONVERGED || (status == NOT_CONVERGED && n->correction * n->tolerance.relative <= m->stalled);
}

/* Before an event acts, an instant on: what loads of an instant are off those that steps tell, so that `record_jump` tells
   what the event makes of them, and no more. */
static int note_roughness(Master *m) {
    Network *n = &m->network;
    const RowBlock *r = &m->loop.rows;
    if (m->untold) return 1; /* that of what acted first at this instant */
    if (!restore_all(n)) return 0;
    if (is_solved(m, solve(&m->solver, instant_now(m), n->accepted))) {
        if (!observe_all(m)) return 0;
        /* one step alone since the last event tells loads by means from before that: there the instant is right */
        const int tells = m->loop.position >= TELLING_STEPS;
        for (size_t i = 0; i < r->corrections && r->held && r->held_time == m->loop.time; i++) {
            const size_t place = r->corrected[2 * i + 1];
            if (tells) m->roughness[i] = n->observations[place] - r->held_observations[place];
            else r->held_observations[place] = n->observations[place];
        }
    }
    if (!restore_all(n)) return 0;
    forget_all(&m->solver);
    return 1;
}

/* Loads of the instant after an event are those before it and its jump; one of zero is that of a joint that let go. */
static void smooth(Master *m) {
    const RowBlock *r = &m->loop.rows;
    for (size_t i = 0; i < r->corrections; i++) {
        double *load = m->network.observations + r->corrected[2 * i + 1];
        if (*load != 0.0) *load -= m->roughness[i];
        m->roughness[i] = 0.0;
    }
}

/* Whether lines or events are still to act at this instant. */
static int others_act(const Master *m) {
    for (size_t i = 0; i < m->lines; i++) {
        const double pending = *m->line[i].pending;
        if (pending == REACHED || pending == COMMANDED || pending == PASSED) return 1;
    }
    for (size_t i = 0; i < m->events; i++)
        if (*m->event[i].pending == REACHED) return 1;
    return 0;
}

/* A row with what an event makes of loads, from a step too short for motion, which is then taken back. Where others are
   to act at this instant the row is left to the last of them: what is between them lasts no time. */
static int record_jump(Master *m, double after, void (*forget)(Solver *)) {
    Network *n = &m->network;
    if (!restore_all(n)) return 0;
    const int solved = is_solved(m, solve(&m->solver, after, n->accepted));
    if (!solved) memset(m->roughness, 0, m->loop.rows.corrections * sizeof(double));
    if ((!solved && !restore_all(n)) || !observe_all(m)) return 0;
    m->untold = (size_t)others_act(m);
    if (!m->untold) {
        smooth(m);
        note_energies(&m->loop);
        add_row(m, m->loop.time + after, after);
    }
    if (!restore_all(n)) return 0;
    forget(&m->solver);
    return 1;
}

/* The row of an instant that was left to what then had none of its own. */
static int record_untold(Master *m) {
    return !m->untold || record_jump(m, instant_now(m), forget_all);
}

/* A vanishing step h (s) in which every joint takes away the rates that it does not allow. Lines that pass their latches
   in it, of which no step tells, are marked. */
static int make_impulse(Master *m, double h) {
    Network *n = &m->network;
    Solver *s = &m->solver;
    const Tolerance usual = n->tolerance;
    command_all(m, 1.0);
    n->tolerance.relative = h == INSTANT ? IMPULSE_ITERATED : AGAIN_ITERATED;
    n->tolerance.residual = IMPULSE_RESIDUAL;
    s->persistent = h == INSTANT;
    forget_stiffnesses(s);
    const int status = solve(s, h, n->accepted);
    n->tolerance = usual;
    s->persistent = 0;
    if (status != CONVERGED) {
        if (h == INSTANT) return say_failure(m, h);
        /* what little it was to take stays */
        m->said[0] = '\0';
        if (!restore_all(n)) return 0;
        command_all(m, 0.0);
        forget_stiffnesses(s);
        return 1;
    }
    m->loop.time += h;
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending == WAITING && m->before_lines[i] > 0.0 && *sensed(m, m->line + i) <= 0.0)
            *m->line[i].pending = PASSED;
    if (!coupling_save(n)) return 0;
    watch_all(m);
    command_all(m, 0.0);
    forget_stiffnesses(s);
    if (!observe_all(m)) return 0;
    note_energies(&m->loop);
    /* joints without their rates and no lock yet, and a lock that still moves, are states of no wing: outputs pass by them */
    m->between = h == INSTANT;
    add_row(m, m->loop.time, h);
    m->between = 0;
    m->untold = 0;
    memset(m->roughness, 0, m->loop.rows.corrections * sizeof(double));
    return 1;
}

/* How a latched line swings as a whole, and the step (s) that tells: the longest that does, and that no participant
   refuses. */
static double note_whole_swing(Master *m, StiffenedLine *line) {
    double size = fmin(m->sizes.largest, LONGEST_SWING);
    line->frequency = line->decay = line->energy = 0.0;
    for (size_t i = 0; i < FREQUENCY_SEARCH; i++) {
        if (linearize(&m->solver, size)) note_swing(&m->solver, size, line);
        if (fastest_of(line) > 0.0) break;
        size *= 0.5;
    }
    return size;
}

/* A step (s), h at the most, that resolves how a latched line starts, from how it swings in a size (s). */
static double resolving(Master *m, const StiffenedLine *line, double size, double h) {
    StiffenedLine found = *line;
    for (size_t i = 0; i < FREQUENCY_SEARCH && fastest_of(&found) * size >= 2.0; i++) {
        size = fmax(1.0 / fastest_of(&found), 0.1 * size);
        if (!linearize(&m->solver, size)) break;
        note_swing(&m->solver, size, &found);
    }
    const double wanted = cbrt(m->error.resolved);
    return fastest_of(&found) * h > wanted ? wanted / fastest_of(&found) : h;
}

/* Slopes of the hinges of a line under the commands of now. */
static int slopes_of(Master *m, const HingeLine *line, double h, Slope *slopes) {
    for (size_t i = 0; i < line->hinges; i++)
        if (!line->released[i] && !slope_of(&m->solver, line->hinge[i], h, slopes + i)) return 0;
    return 1;
}

/* Latch a line; the step (s) to go on with, 0 for a failure. */
static double engage(Master *m, HingeLine *line) {
    Slope before[MOST_HINGES], after[MOST_HINGES];
    StiffenedLine *slow = line->stiffened;
    double h = size_now(&m->loop);
    if (line->is_kinematic) {
        command_latches(m, line, 1.0);
        return fmin(h, m->start_step);
    }
    if (!slopes_of(m, line, h, before)) return 0.0;
    command_latches(m, line, 1.0);
    if (!slopes_of(m, line, h, after)) return 0.0;
    command_latches(m, line, 0.0);
    slow->hinges = 0.0;
    for (size_t i = 0; i < line->hinges; i++)
        if (!line->released[i] && stiffening_of(&m->network, line->hinge[i], before + i, after + i, h,
                                                slow->hinge + (size_t)slow->hinges))
            slow->hinges += 1.0;
    if (slow->hinges) {
        const double size = note_whole_swing(m, slow);
        judge_loads(m);
        if (fastest_of(slow) > 0.0) h = resolving(m, slow, size, h);
    }
    command_latches(m, line, 1.0);
    return fmin(h, m->start_step);
}

/* Take note of the time and the rate at which a line latches. */
static void note_latch_up(Master *m, HingeLine *line) {
    *line->latch_time = m->loop.time;
    *line->latch_rate = fabs(m->network.observations[m->angular_rate[line->hinge[(size_t)*line->sensor]]]);
}

/* Have others that lock at this instant do so with a line: those with the same mark. */
static void join_locks(Master *m, double mark) {
    for (HingeLine *other = m->line; other < m->line + m->lines; other++)
        if (*other->pending == mark && other->is_kinematic) {
            *other->pending = LOCKING;
            note_latch_up(m, other);
        }
}

/* Engage those that lock with a line; the step (s) to go on with, 0 for a failure. */
static double engage_joined(Master *m, double size) {
    for (HingeLine *other = m->line; other < m->line + m->lines; other++)
        if (*other->pending == LOCKING) {
            *other->pending = 0.0;
            size = fmin(size, engage(m, other));
        }
    return size;
}

/* Engage all latches of a line; a kinematic one takes the relative rate away in an impulse, with others of its mark. */
static int latch_line(Master *m, HingeLine *line, double mark) {
    *line->pending = 0.0;
    if (!observe_all(m)) return 0;
    note_latch_up(m, line);
    if (line->is_kinematic) join_locks(m, mark);
    /* bushings leave the joints rates of the order H^2; the latch must meet joints that move as such */
    if (line->is_kinematic ? !make_impulse(m, INSTANT) : !note_roughness(m)) return 0;
    const double size = engage_joined(m, engage(m, line));
    if (size == 0.0) return 0;
    forget_stiffnesses(&m->solver);
    if (line->is_kinematic) {
        /* a lock would ring with the rate that an impulse leaves */
        if (!make_impulse(m, INSTANT) || !make_impulse(m, AGAIN)) return 0;
    } else if (!record_jump(m, fmin(INSTANT, INSTANT_SHARE * size), forget_all)) return 0;
    coupling_restart(&m->network);
    restart_sizes(m, size, 0);
    begin_segment(m);
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending == PASSED && !latch_line(m, m->line + i, PASSED)) return 0;
    return 1;
}

/* Lines go on with those of their hinges that are not released; without any they have no latch, and are not judged. */
static void release_from_lines(Master *m, size_t participant) {
    forget_struck(m, participant);
    for (HingeLine *line = m->line; line < m->line + m->lines; line++) {
        size_t left = 0, first = 0;
        for (size_t i = line->hinges; i-- > 0;) {
            if (line->hinge[i] == participant) {
                line->released[i] = 1.0;
                line->stiffened->hinges = 0.0;
            }
            if (!line->released[i]) left++, first = i;
        }
        if (left == 0) *line->pending = 0.0;
        else if (line->released[(size_t)*line->sensor]) *line->sensor = (double)first;
    }
}

/* What is set meanwhile changes energies from outside: take note of the balance before. */
static int balance_before(Master *m, double *balance) {
    if (!observe_all(m)) return 0;
    *balance = balance_of(m->network.energies);
    return 1;
}

static int supply(Master *m, double before) {
    if (!observe_all(m)) return 0;
    m->energy_start[SUPPLIED] -= balance_of(m->network.energies) - before;
    return 1;
}

/* Go on after something jumped: latches that were commanded with it engage at once. */
static int go_on(Master *m, const size_t *latch, size_t latches) {
    forget_all(&m->solver);
    for (size_t i = 0; i < latches; i++)
        if (*m->line[latch[i]].pending) *m->line[latch[i]].pending = COMMANDED;
    if (!record_jump(m, instant_now(m), forget_all)) return 0;
    watch_all(m);
    for (size_t i = 0; i < latches; i++)
        if (*m->line[latch[i]].pending == COMMANDED && !latch_line(m, m->line + latch[i], COMMANDED)) return 0;
    if (!record_untold(m)) return 0;
    judge_loads(m);
    renew(m);
    return 1;
}

static void release_one(Master *m, const Place *release) {
    m->network.participant[release->participant].input[release->place] = 1.0;
    release_from_lines(m, release->participant);
}

/* Let an event act at this instant. */
static int happen(Master *m, Event *event) {
    double before = 0.0;
    if (!note_roughness(m)) return 0;
    *event->pending = 0.0;
    m->happened++;
    for (size_t i = 0; i < event->releases; i++) release_one(m, event->release + i);
    if (!balance_before(m, &before)) return 0;
    for (size_t i = 0; i < event->settings; i++) {
        const Setting *s = event->setting + i;
        if (!m->set_parameter(m->taker, s->participant, s->place, s->value)) return 0;
    }
    return supply(m, before) && go_on(m, event->latch, event->latches);
}

/* An event whose time has come, or whose condition holds. */
static Event *due_event(Master *m) {
    for (Event *e = m->event; e < m->event + m->events; e++) {
        if (!*e->pending) continue;
        if (isnan(e->time) ? distance(&e->condition) <= 0.0 : e->time <= m->loop.time + EVENT_REACHED) return e;
    }
    return NULL;
}

/* What fell through zero first in the step just made. */
static const Crossing *first_crossed(const Master *m, double h) {
    const Crossing *best = NULL;
    double best_time = h;
    for (const Crossing *c = m->crossing; c < m->crossing + m->loop.crossings; c++) {
        const double after = distance(c), time = h * c->before / (c->before - after);
        if (after <= 0.0 && 0.0 < c->before && (best ? time < best_time : time <= h)) {
            best = c;
            best_time = time;
        }
    }
    return best;
}

/* Step size at which a crossing is reached, by the Illinois variant of the false position; participants end there.
   0 where a step does not converge. */
static double find_crossing(Master *m, const Crossing *c, double h) {
    double low = 0.0, high = h, at_low = c->before, at_high = distance(c), trial = h;
    int side = 0;
    for (size_t i = 0; i < EVENT_SEARCH; i++) {
        trial = (at_low * high - at_high * low) / (at_low - at_high);
        trial = fmin(fmax(trial, low + 1e-3 * (high - low)), high);
        if (!is_solved(m, solve_predicted(&m->solver, trial))) return 0.0;
        if (c >= m->crossing + m->loop.lines && !observe_all(m)) return 0.0;
        const double value = distance(c);
        if (fabs(value) < EVENT_TOLERANCE || high - low < 1e-12) return trial;
        if (value > 0.0) {
            low = trial, at_low = value;
            if (side == 1) at_high *= 0.5;
            side = 1;
        } else {
            high = trial, at_high = value;
            if (side == -1) at_low *= 0.5;
            side = -1;
        }
    }
    return trial;
}

static int smaller_step(Master *m, double share) {
    m->sizes.level += 2;
    size_changed(&m->loop, m->rules.after_shrinking);
    return size_now(&m->loop) >= m->sizes.smallest * share;
}

/* Have what the step at hand has struck judged from now on: the step is made once more; 0 where a participant refuses.
   struck: how many. */
static int take_strikes(Master *m, size_t *struck) {
    static const Slope free_of_load;
    StiffenedLine found = {0};
    Slope pushing;
    Strike *first = NULL;
    const Crossing *c = m->striking;
    *struck = 0;
    for (Strike *s = m->strike; s < m->strike + m->strikes; s++) {
        if (!*s->waits) continue;
        const Crossing *met = c++;
        if (!(met->before > 0.0 && distance(met) <= 0.0)) continue;
        *s->waits = 0.0;
        ++*struck;
        if (found.hinges == MOST_HINGES) continue;
        if (!slope_of(&m->solver, s->participant, m->loop.h, &pushing)) return 0;
        if (!stiffening_of(&m->network, s->participant, &free_of_load, &pushing, m->loop.h,
                           found.hinge + (size_t)found.hinges))
            continue;
        found.hinges += 1.0;
        forget_struck(m, s->participant);
        if (!first) first = s;
    }
    if (!first) return 1;
    *first->struck = found;
    note_whole_swing(m, first->struck);
    watch_lines(m);
    return 1;
}

/* Whether an insisted step stands: 1 accepted, 0 a smaller one is set, -1 nothing helps. */
static int see_to_unsolved(Master *m) {
    Loop *l = &m->loop;
    double *guess = m->solver.jacobians.kept;
    coupling_predict(&m->network, l->time + 0.5 * l->h, l->h, guess);
    if (!is_solved(m, (int)l->status) && !is_solved(m, insist(&m->solver, (int)l->status, l->h, guess))) {
        if (!smaller_step(m, TO_CONVERGE)) return say_failure(m, l->h) - 1;
        m->said[0] = '\0';
    } else {
        size_t struck = 0;
        if (!observe_all(m)) return -1;
        if (!m->repeats && has_struck(l) && !take_strikes(m, &struck)) return -1;
        if (!struck && (m->repeats || judge_step(l) == STANDS)) return 1;
    }
    m->rejected++;
    return 0;
}

/* Whether what fell by a step h falls through zero at the instant that ends it. */
static int is_reached(const Crossing *c, double h) {
    return c->before + c->rate * h > 0.0 && c->before <= c->rate * INSTANT;
}

/* Mark what is met at the instant that ends a step h. */
static void mark_reached(Master *m, double h) {
    size_t k = 0;
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending && is_reached(m->crossing + k++, h)) *m->line[i].pending = REACHED;
    for (size_t i = 0; i < m->events; i++)
        if (is_pending_condition(m->event + i) && is_reached(m->crossing + k++, h)) *m->event[i].pending = REACHED;
}

/* Let what is marked act, unless what came before it has let go of it. */
static int let_act(Master *m) {
    int fine = 1;
    for (size_t i = 0; fine && i < m->lines; i++)
        if (*m->line[i].pending == REACHED) fine = latch_line(m, m->line + i, REACHED);
    for (size_t i = 0; fine && i < m->events; i++)
        if (*m->event[i].pending == REACHED) fine = happen(m, m->event + i);
    return fine && record_untold(m);
}

/* Go on after a break of a law; where a hold-down lets go there, with what that makes of loads. */
static int pass_break(Master *m, int lets_go) {
    if (lets_go) {
        forget_all(&m->solver);
        if (!record_jump(m, instant_now(m), forget_all)) return 0;
    }
    renew(m);
    return 1;
}

/* Accept the step at hand, which may end where something crosses, and let that act. */
static int end_step(Master *m) {
    Loop *l = &m->loop;
    const Crossing *crossed = first_crossed(m, l->h);
    if (crossed) {
        const double h = find_crossing(m, crossed, l->h);
        if (h == 0.0) {
            if (!smaller_step(m, 1.0)) return say_failure(m, l->h);
            m->said[0] = '\0';
            m->rejected++;
            return 1;
        }
        l->h = h;
        if (!observe_all(m)) return 0;
    }
    const size_t number = crossed ? (size_t)(crossed - m->crossing) : 0;
    const int is_break = l->time + l->h >= l->break_time - m->rules.break_reached;
    const int lets_go = l->time + l->h >= l->release_time - m->rules.break_reached;
    if (!coupling_accept(&m->network, l->time + 0.5 * l->h, l->h)) return 0;
    l->made = 0;
    count_step(l, l->h);
    m->steps++;
    take_events(m);
    hand_on_rows(m);
    if (!crossed) {
        return !is_break || due_event(m) || pass_break(m, lets_go);
    }
    size_t k = 0;
    m->event_time = l->time;
    m->is_crossed = 1.0;
    mark_reached(m, l->h);
    for (size_t i = 0; i < m->lines; i++)
        if (*m->line[i].pending && k++ == number) return latch_line(m, m->line + i, REACHED) && let_act(m);
    for (size_t i = 0; i < m->events; i++)
        if (is_pending_condition(m->event + i) && k++ == number) return happen(m, m->event + i) && let_act(m);
    return 1;
}

/* One turn of a run that goes to loop.until: an event, a step, or a step that has to be smaller; 0 with what was said. */
static int take_turn(Master *m) {
    Loop *l = &m->loop;
    Event *due = due_event(m);
    if (due) {
        m->event_time = l->time;
        m->is_crossed = isnan(due->time);
        return happen(m, due);
    }
    tell_events(m);
    l->rejected = 0;
    const int stop = follow(&m->solver);
    m->tried = l->h;
    m->steps += l->made;
    m->rejected += l->rejected;
    take_events(m);
    hand_on_rows(m);
    if (stop == FAILED) return 0;
    if (stop == PAUSED) return 1;
    if (stop == UNSOLVED || stop == UNGUARDED) {
        const int stands = see_to_unsolved(m);
        if (stands <= 0) return stands == 0;
    }
    return end_step(m);
}

/* Bring all participants, which are initialised and hold their first outputs, to the start of a run; wrenches: those
   that they are at rest under, NULL for none. */
static int begin_run(Master *m, const double *wrenches) {
    Network *n = &m->network;
    Loop *l = &m->loop;
    l->time = 0.0;
    m->event_time = -1.0;
    m->is_crossed = 0.0;
    m->stalled = 0.0;
    m->repeats = 0;
    l->position = l->made = l->wanted = l->rows.held = l->rows.count = 0;
    l->parts = 1;
    l->stood = 0;
    m->steps = m->rejected = 0;
    m->segment = m->held_segment = 0.0;
    m->said[0] = '\0';
    n->history.count = 0;
    n->watched_count = 0;
    for (const Strike *s = m->strike; s < m->strike + m->strikes; s++) {
        *s->waits = 1.0;
        s->struck->hinges = 0.0;
    }
    for (size_t i = 0; i < n->size; i++) n->accepted[i] = n->wrenches[i] = wrenches ? wrenches[i] : 0.0;
    forget_all(&m->solver);
    if (!observe_all(m)) return 0;
    memcpy(m->energy_start, n->energies, ENERGIES * sizeof(double));
    memset(&m->guard, 0, sizeof m->guard);
    m->guard.kinetic = LEAST_KINETIC;
    note_energies(l);
    for (Event *e = m->event; e < m->event + m->events; e++)
        if (isnan(e->time) && distance(&e->condition) <= 0.0) {
            snprintf(m->said, sizeof m->said, "the condition of event %s holds from the start",
                     m->event_name[e - m->event]);
            return 0;
        }
    add_row(m, 0.0, 0.0);
    if (!coupling_save(n)) return 0;
    watch_all(m);
    m->error.energy = fmax(1e-3 * fabs(n->energies[KINETIC] + n->energies[POTENTIAL]),
                           fmax(m->driving_energy, 1e-9));
    restart_sizes(m, m->start_step, 1);
    return 1;
}

#endif
