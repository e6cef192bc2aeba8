/* What happens when in one FMU of a scene. */

#include "sequence.h"

#include <math.h>
#include <string.h>

#include "scheme.h"

#define EVENT_REACHED 1e-9 /* s, what sums of step sizes may leave */

/* Values of `pending`: it waits; it acts at this instant; it locks together with another line; it passed its latch in
   an impulse; an event latches it. */
#define WAITING 1.0
#define ACTS 2.0
#define LOCKING 3.0
#define PASSED 4.0
#define COMMANDED 5.0

void hand_on_rows(Sequence *s) {
    Rows *r = &s->coupling.rows;
    const size_t width = r->columns + CHANNELS + r->signals;
    for (size_t i = 0; i < r->count; i++) s->row(s->taker, r->times[i], r->segments[i], r->values + i * width);
    r->count = 0;
}

static double instant_now(const Sequence *s) { return instant_of(size_now(&s->coupling.sizes)); }

/* Whether lines or events are still to act at this instant. */
static int others_act(const Sequence *s) {
    const Coupling *c = &s->coupling;
    for (size_t k = 0; k < c->lines; k++)
        if (c->pending[k] == ACTS || c->pending[k] == COMMANDED || c->pending[k] == PASSED) return 1;
    for (const Event *e = s->event; e < s->event + s->events; e++)
        if (*e->pending == ACTS) return 1;
    return 0;
}

static int record_jump(Sequence *s, double after) {
    if (!coupling_record_jump(&s->coupling, after, others_act(s))) return 0;
    hand_on_rows(s);
    return 1;
}

/* Write the row of this instant where an event left it to a later one that did not write it. */
static int record_untold(Sequence *s) { return !s->coupling.untold || record_jump(s, instant_now(s)); }

/* Make an impulse, and mark lines that pass their latches in it and do not act at this instant anyway. */
static int make_impulse(Sequence *s, double h) {
    Coupling *c = &s->coupling;
    if (!coupling_impulse(c, h)) return 0;
    for (size_t k = 0; k < c->lines; k++)
        if (c->passed[k] && c->pending[k] == WAITING) c->pending[k] = PASSED;
    return 1;
}

/* Note the rate at which a line latches. */
static void note_latch_rate(Sequence *s, size_t line) {
    const Coupling *c = &s->coupling;
    const size_t sensor = c->line[line].hinge[(size_t)*c->line[line].sensor];
    s->latch_rate[line] = fabs(c->network.observations[s->angular_rate[sensor]]);
}

/* Let the other kinematic lines with a mark lock together with the present one. */
static void join_locks(Sequence *s, double mark) {
    Coupling *c = &s->coupling;
    for (size_t k = 0; k < c->lines; k++)
        if (c->pending[k] == mark && c->line[k].is_kinematic) {
            c->pending[k] = LOCKING;
            note_latch_rate(s, k);
        }
}

/* Engage a line and those that lock with it. Returns the size (s) of the next step, 0 for a failure. */
static double engage(Sequence *s, size_t line) {
    Coupling *c = &s->coupling;
    double size = coupling_engage(c, line, 1);
    s->latch_time[line] = c->progress.time;
    for (size_t k = 0; k < c->lines; k++)
        if (c->pending[k] == LOCKING) {
            c->pending[k] = 0.0;
            s->latch_time[k] = c->progress.time;
            size = fmin(size, coupling_engage(c, k, 1));
        }
    return size;
}

/* Engage all latches of a line. A kinematic line loses its relative rate in an impulse, with others of its mark. */
static int latch_line(Sequence *s, size_t line, double mark) {
    Coupling *c = &s->coupling;
    const int is_kinematic = c->line[line].is_kinematic != 0;
    c->pending[line] = 0.0;
    if (!network_observe(&c->network)) return 0;
    note_latch_rate(s, line);
    if (is_kinematic) join_locks(s, mark);
    /* bushings leave the joints rates of the order H^2; the latch must meet joints that move as such */
    if (is_kinematic ? !make_impulse(s, INSTANT) : !coupling_note_roughness(c, instant_now(s))) return 0;
    const double size = engage(s, line);
    if (size == 0.0) return 0;
    forget_stiffnesses(&c->solver);
    if (is_kinematic) {
        /* a lock would ring with the rate that an impulse leaves */
        if (!make_impulse(s, INSTANT) || !make_impulse(s, AGAIN)) return 0;
        coupling_record_impulse(c);
        hand_on_rows(s);
    } else if (!record_jump(s, instant_of(size))) return 0;
    coupling_restart(c, size);
    for (size_t k = 0; k < c->lines; k++)
        if (c->pending[k] == PASSED && !latch_line(s, k, PASSED)) return 0;
    return 1;
}

int go_on(Sequence *s, const size_t *latch, size_t latches) {
    Coupling *c = &s->coupling;
    forget_stiffnesses(&c->solver);
    for (size_t i = 0; i < latches; i++)
        if (c->pending[latch[i]]) c->pending[latch[i]] = COMMANDED;
    if (!record_jump(s, instant_now(s))) return 0;
    coupling_watch(c);
    for (size_t i = 0; i < latches; i++)
        if (c->pending[latch[i]] == COMMANDED && !latch_line(s, latch[i], COMMANDED)) return 0;
    if (!record_untold(s)) return 0;
    coupling_judge_loads(c);
    coupling_renew(c, 0.0);
    return 1;
}

void release_one(Sequence *s, const Place *release) {
    s->coupling.network.participant[release->participant].input[release->place] = 1.0;
    coupling_release(&s->coupling, release->participant);
}

void unlatch_line(Sequence *s, size_t line, int open) {
    if (coupling_unlatch(&s->coupling, line, open)) s->unlatch_time[line] = s->coupling.progress.time;
}

/* Let an event act at this instant. */
static int happen(Sequence *s, Event *event) {
    Coupling *c = &s->coupling;
    if (!coupling_note_roughness(c, instant_now(s))) return 0;
    *event->pending = 0.0;
    s->happened++;
    for (size_t i = 0; i < event->releases; i++) release_one(s, event->release + i);
    for (size_t i = 0; i < event->unlatches; i++) unlatch_line(s, event->unlatch[2 * i], (int)event->unlatch[2 * i + 1]);
    if (!network_observe(&c->network)) return 0;
    const double before = balance_of(c->network.energies);
    for (size_t i = 0; i < event->settings; i++) {
        const Setting *one = event->setting + i;
        if (!s->set_parameter(s->taker, one->participant, one->place, one->value)) return 0;
    }
    return coupling_supply(c, before) && go_on(s, event->latch, event->latches);
}

Event *due_event(Sequence *s) {
    for (Event *e = s->event; e < s->event + s->events; e++) {
        if (!*e->pending) continue;
        if (e->crossing ? distance_of(e->crossing) <= 0.0 : e->time <= s->coupling.progress.time + EVENT_REACHED)
            return e;
    }
    return NULL;
}

/* Let all act that was reached, first what ended the step; what an earlier event has released does not act. */
static int let_act(Sequence *s, size_t first) {
    Coupling *c = &s->coupling;
    int fine = 1;
    for (size_t k = 0; k < c->crossings; k++)
        if (c->reached[k]) c->pending[k] = ACTS;
    for (size_t i = 0; fine && i <= c->crossings; i++) {
        const size_t k = i ? i - 1 : first;
        if (c->pending[k] != ACTS) continue;
        if (k < c->lines) fine = latch_line(s, k, ACTS);
        for (Event *e = s->event; k >= c->lines && e < s->event + s->events; e++)
            if (e->crossing == c->crossing + k) fine = happen(s, e);
    }
    return fine && record_untold(s);
}

/* Go on after a break of a law; where a hold-down lets go, with a row of the jump of loads. */
static int pass_break(Sequence *s) {
    if (s->coupling.progress.lets_go) {
        forget_stiffnesses(&s->coupling.solver);
        if (!record_jump(s, instant_now(s))) return 0;
    }
    coupling_renew(&s->coupling, 0.0);
    return 1;
}

int take_turn(Sequence *s) {
    Coupling *c = &s->coupling;
    Event *due = due_event(s);
    if (due) {
        s->event_time = c->progress.time;
        s->is_crossed = due->crossing != NULL;
        return happen(s, due);
    }
    c->request.event_time = INFINITY;
    for (const Event *e = s->event; e < s->event + s->events; e++)
        if (*e->pending && !e->crossing) c->request.event_time = fmin(c->request.event_time, e->time);
    const int stop = coupling_advance(c);
    s->steps += c->progress.made;
    s->rejected += c->progress.rejected;
    hand_on_rows(s);
    if (stop == REACHED) {
        s->event_time = c->progress.time;
        s->is_crossed = 1.0;
        return let_act(s, (size_t)c->progress.crossed);
    }
    if (stop == BROKE) return due_event(s) || pass_break(s);
    return stop == PAUSED;
}

const Event *begin_run(Sequence *s, int *fine) {
    Coupling *c = &s->coupling;
    s->event_time = -1.0;
    s->is_crossed = 0.0;
    s->steps = s->rejected = 0;
    c->request.pause_time = -INFINITY; /* a turn is a step */
    *fine = coupling_start(c);
    for (size_t k = 0; k < c->crossings; k++) c->pending[k] = WAITING;
    for (size_t k = 0; k < c->lines; k++) s->latch_time[k] = s->unlatch_time[k] = -1.0;
    for (Event *e = s->event; e < s->event + s->events; e++) {
        *e->pending = WAITING;
        if (*fine && e->crossing && distance_of(e->crossing) <= 0.0) return e;
    }
    *fine = *fine && coupling_record_start(c);
    hand_on_rows(s);
    return NULL;
}
