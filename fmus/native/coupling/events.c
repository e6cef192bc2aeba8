/* What events change: impulses, jumps of loads, latch-ups, releases. */

#include "coupling.h"

#include <math.h>
#include <string.h>

#include "local_error.h"
#include "prediction.h"
#include "scheme.h"
#include "system.h"

#define LEAST_LATCH_SHARE 1e-3 /* share of the whole energy at which a light part that latches or strikes counts */

double instant_of(double size) { return fmin(INSTANT, INSTANT_SHARE * size); }

/* Forget the matrices of an instant, also of bodies where these are the first ones: by differences, they are too rough to
   be scaled to steps. */
static void forget_instant(Coupling *c, double after) {
    c->solver.jacobians.once_h == after ? forget_all(&c->solver) : forget_stiffnesses(&c->solver);
}

/* Solve a step in which nothing moves, from the wrenches accepted last. */
static int solve_instant(Coupling *c, double after) {
    const int status = solve(&c->solver, c->progress.time, after, c->network.accepted);
    c->progress.solved = (size_t)is_solved(c, status);
    return (int)c->progress.solved;
}

int coupling_note_roughness(Coupling *c, double after) {
    Network *n = &c->network;
    if (c->untold) return 1; /* the event that acted first at this instant has noted it */
    if (!network_restore(n)) return coupling_fails(c, OF_PARTICIPANT);
    if (solve_instant(c, after)) {
        if (!network_observe(n)) return coupling_fails(c, OF_PARTICIPANT);
        rows_note_roughness(&c->rows, n, c->progress.time, c->position);
    }
    if (!network_restore(n)) return coupling_fails(c, OF_PARTICIPANT);
    forget_instant(c, after);
    return 1;
}

/* Observe participants an instant later, or where they stand if that step cannot be solved. */
static int observe_after(Coupling *c, double after) {
    Network *n = &c->network;
    if (!network_restore(n)) return 0;
    const int solved = solve_instant(c, after);
    return (solved || network_restore(n)) && network_observe(n);
}

int coupling_record_jump(Coupling *c, double after, int others) {
    Network *n = &c->network;
    if (!observe_after(c, after)) return coupling_fails(c, OF_PARTICIPANT);
    if (!c->progress.solved) rows_forget_roughness(&c->rows);
    c->untold = (size_t)others;
    if (!others) {
        rows_smooth(&c->rows, n);
        guard_accepts(&c->guard, n->energies);
        rows_add(&c->rows, n, c->progress.time + after, after, 0.0, c->segment + 0.5);
    }
    if (!network_restore(n)) return coupling_fails(c, OF_PARTICIPANT);
    forget_instant(c, after);
    return 1;
}

/* Three instants after the start have this distance: joints hardly move in them, and shorter ones are round-off. */
#define AFTER_START 1e-8 /* s */
/* Weights of their values in the parabola through them at the start. */
static const double parabola[] = {3.0, -3.0, 1.0};

/* Observe t = 0. Loads that connections bring to bodies are on a parabola through instants after it: bodies know them
   from steps alone, and the friction of a light line grows to its full value within microseconds. */
static int observe_start(Coupling *c) {
    Network *n = &c->network;
    const Rows *r = &c->rows;
    enum { INSTANTS = sizeof parabola / sizeof *parabola };
    int found = 1;
    if (!network_save(n)) return 0;
    memset(c->rows.bring, 0, r->bringing * sizeof(double));
    for (size_t k = 0; k < INSTANTS && found; k++) {
        if (!observe_after(c, (double)(k + 1) * AFTER_START)) return 0;
        found = (int)c->progress.solved;
        for (size_t i = 0; i < r->bringing; i++) r->bring[i] += parabola[k] * n->observations[r->brought[i]];
    }
    if (!network_restore(n) || !network_observe(n)) return 0;
    forget_all(&c->solver);
    for (size_t i = 0; i < r->bringing && found; i++) n->observations[r->brought[i]] = r->bring[i];
    return 1;
}

int coupling_record_start(Coupling *c) {
    Network *n = &c->network;
    if (!observe_start(c)) return coupling_fails(c, OF_PARTICIPANT);
    rows_add(&c->rows, n, 0.0, 0.0, 0.0, c->segment + 0.5);
    begin_guard(&c->guard, n->energies);
    const double stored = fabs(n->energies[KINETIC] + n->energies[POTENTIAL]);
    c->limit.energy = fmax(LEAST_STORED_SHARE * stored, fmax(c->driving_energy, LEAST_ENERGY));
    restart_sizes(&c->sizes, c->start_step, 1);
    return coupling_save(c);
}

static void command_impulse(Coupling *c, double value) {
    for (size_t i = 0; i < c->impulses; i++)
        c->network.participant[c->impulse[i].participant].input[c->impulse[i].place] = value;
}

/* Solve the step of an impulse. */
static int solve_impulse(Coupling *c, double h) {
    Network *n = &c->network;
    const Tolerance usual = n->tolerance;
    const int persistent = c->solver.persistent;
    n->tolerance.relative = h == INSTANT ? IMPULSE_ITERATED : AGAIN_ITERATED;
    n->tolerance.residual = IMPULSE_RESIDUAL;
    c->solver.persistent = h == INSTANT;
    forget_stiffnesses(&c->solver);
    const int status = solve(&c->solver, c->progress.time, h, n->accepted);
    n->tolerance = usual;
    c->solver.persistent = persistent;
    return status;
}

static void note_passed(Coupling *c) {
    for (size_t k = 0; k < c->lines; k++)
        c->passed[k] = c->pending[k] != 0.0 && c->crossing[k].before > 0.0 && distance_of(c->crossing + k) <= 0.0;
}

int coupling_impulse(Coupling *c, double h) {
    Network *n = &c->network;
    memset(c->passed, 0, c->crossings * sizeof(double));
    command_impulse(c, 1.0);
    const int status = solve_impulse(c, h);
    c->progress.h = h;
    if (status != CONVERGED && h == INSTANT) return coupling_fails(c, status == REFUSED ? OF_PARTICIPANT : OF_STEP);
    if (status != CONVERGED && !network_restore(n)) return coupling_fails(c, OF_PARTICIPANT);
    if (status == CONVERGED) {
        c->progress.time += h;
        note_passed(c);
        if (!coupling_save(c)) return 0;
    }
    command_impulse(c, 0.0);
    forget_stiffnesses(&c->solver);
    return network_observe(n) || coupling_fails(c, OF_PARTICIPANT);
}

void coupling_record_impulse(Coupling *c) {
    Network *n = &c->network;
    guard_accepts(&c->guard, n->energies);
    c->untold = 0;
    rows_forget_roughness(&c->rows);
    rows_add(&c->rows, n, c->progress.time, AGAIN, 0.0, c->segment + 0.5);
}

/* Set an input of all hinges of a line; returns whether one of them was set before. */
static int command_hinges(Coupling *c, const HingeLine *line, const size_t *place, double value) {
    int was_set = 0;
    for (size_t i = 0; i < line->hinges; i++) {
        if (line->released[i]) continue;
        double *input = c->network.participant[line->hinge[i]].input + place[line->hinge[i]];
        was_set |= *input > 0.5;
        *input = value;
    }
    return was_set;
}

static void command_latches(Coupling *c, const HingeLine *line, double value) {
    (void)command_hinges(c, line, c->latch_command, value);
}

/* Stiffnesses of the hinges of a line under the present commands. */
static int slopes_of(Coupling *c, const HingeLine *line, double h, Slope *slopes) {
    for (size_t i = 0; i < line->hinges; i++)
        if (!line->released[i] && !slope_of(&c->solver, line->hinge[i], c->progress.time, h, slopes + i)) return 0;
    return 1;
}

/* Compute what the latches of a line stiffen. */
static int note_stiffened(Coupling *c, HingeLine *line, double h) {
    StiffenedLine *slow = line->stiffened;
    Slope *before = c->slopes, *after = before + c->most_hinges;
    if (!slopes_of(c, line, h, before)) return 0;
    command_latches(c, line, 1.0);
    if (!slopes_of(c, line, h, after)) return 0;
    command_latches(c, line, 0.0);
    slow->hinges = 0.0;
    for (size_t i = 0; i < line->hinges; i++)
        if (!line->released[i] && stiffening_of(&c->network, line->hinge[i], before + i, after + i, h,
                                                slow->hinge + (size_t)slow->hinges))
            slow->hinges += 1.0;
    return 1;
}

double coupling_engage(Coupling *c, size_t number, int judged) {
    HingeLine *line = c->line + number;
    StiffenedLine *slow = line->stiffened;
    double h = size_now(&c->sizes);
    if (judged && !line->is_kinematic) { /* a lock cannot be resolved */
        if (!note_stiffened(c, line, h)) return coupling_fails(c, OF_PARTICIPANT);
        if (slow->hinges) {
            const double size = note_whole_swing(&c->solver, c->progress.time, c->sizes.largest, slow, c->room);
            coupling_judge_loads(c);
            if (fastest_of(slow) > 0.0)
                h = resolving_step(&c->solver, c->progress.time, slow, size, h, cbrt(c->limit.resolved), c->room);
        }
    }
    command_latches(c, line, 1.0);
    return fmin(h, c->start_step);
}

/* Watch the loads of a stiff part, weighted by the geometric mean of its energy and the whole energy. */
static void watch_one(Coupling *c, const StiffenedLine *line) {
    Network *n = &c->network;
    const double whole = c->limit.energy, energy = sqrt(whole * fmax(line->energy, LEAST_LATCH_SHARE * whole));
    if (line->hinges) n->watched_count += watch_loads(n, line, energy, c->watched + n->watched_count);
}

void coupling_watch_loads(Coupling *c) {
    c->network.watched = c->watched;
    c->network.watched_count = 0;
    for (const HingeLine *line = c->line; line < c->line + c->lines; line++) watch_one(c, line->stiffened);
    for (const Strike *s = c->strike; s < c->strike + c->strikes; s++) watch_one(c, s->struck);
}

void coupling_judge_loads(Coupling *c) {
    coupling_watch_loads(c);
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++) {
        *s->waits = 1.0;
        s->before = *s->place;
    }
}

void coupling_forget_struck(Coupling *c, size_t participant) {
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++)
        for (size_t i = 0; i < (size_t)s->struck->hinges; i++)
            if (s->struck->hinge[i].connection == (double)participant) s->struck->hinges = 0.0;
}

void coupling_release(Coupling *c, size_t participant) {
    coupling_forget_struck(c, participant);
    for (size_t k = 0; k < c->lines; k++) {
        HingeLine *line = c->line + k;
        size_t left = 0, first = 0;
        for (size_t i = line->hinges; i-- > 0;) {
            if (line->hinge[i] == participant) {
                line->released[i] = 1.0;
                line->stiffened->hinges = 0.0;
            }
            if (!line->released[i]) left++, first = i;
        }
        if (left == 0) c->pending[k] = 0.0;
        else if (line->released[(size_t)*line->sensor]) *line->sensor = (double)first;
    }
    coupling_aim_sensors(c);
}

int coupling_unlatch(Coupling *c, size_t number, int open) {
    HingeLine *line = c->line + number;
    const int was_open = command_hinges(c, line, c->unlatch_command, open);
    if (!open) {
        for (size_t i = 0; i < line->hinges && was_open; i++)
            if (!line->released[i]) c->pending[number] = 1.0;
        return 0;
    }
    c->pending[number] = line->stiffened->hinges = 0.0;
    return command_hinges(c, line, c->latch_command, 0.0);
}

int coupling_supply(Coupling *c, double before) {
    if (!network_observe(&c->network)) return coupling_fails(c, OF_PARTICIPANT);
    c->rows.start[SUPPLIED] -= balance_of(c->network.energies) - before;
    return 1;
}

void coupling_begin_segment(Coupling *c) {
    if (c->position) c->segment += 1.0;
    c->position = 0;
}

void coupling_renew(Coupling *c, double known) {
    const double size = fmax(c->start_step, known);
    history_clear(&c->network);
    if (size < size_now(&c->sizes)) restart_sizes(&c->sizes, size, 0);
    coupling_begin_segment(c);
}

void coupling_restart(Coupling *c, double size) {
    history_clear(&c->network);
    restart_sizes(&c->sizes, size, 0);
    coupling_begin_segment(c);
}

double coupling_step_after_jump(Coupling *c, double h, const double *change) {
    Network *n = &c->network;
    const SizedJacobian *known = nearest_mobilities(&c->solver.jacobians, h);
    if (!known) return 0.0;
    n->mobility = known->mobility;
    system_turn_bodies(n);
    const double ratio = h / known->h, square = work_of(n, change) * ratio * ratio / c->limit.energy;
    return h * share_that_fits(&c->limit, square);
}
