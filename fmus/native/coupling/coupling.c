/* The state of a coupling: its start, the distances of what may happen, and all numbers to save. */

#include "coupling.h"

#include <math.h>
#include <string.h>

#include "prediction.h"

/* The order of `by_tolerance` in orchestrator/cosim/tables.py: largest, smallest and first step (s) of the scene,
   tolerance of iterations over that of the run, and bounds of the former. */
enum { LARGEST_STEP, SMALLEST_STEP, START_STEP, ITERATED, LEAST_ITERATED, MOST_ITERATED };
#define REFERENCE_TOLERANCE 1e-4 /* for which the step sizes of the scene are meant */
#define ALLOWED_SHARE (12.0 * 0.0025)
/* Jump of the balance of energy over the energy in motion: good steps of any length leave 2.5e-5 or less at the reference
   tolerance, spurious roots up to 1. */
#define LEAST_JUMP 1e-4

void coupling_take_tolerance(Coupling *c, double tolerance) {
    const double *by = c->by_tolerance, ratio = tolerance / REFERENCE_TOLERANCE;
    /* sizes by errors are proportional to this: errors of a run are to h^order */
    const double longer = pow(ratio, 1.0 / (double)c->sizes.order);
    /* below the reference, bounds are proportional to the root, as the error of rotations is to h^2 */
    const double share = fmin(longer, sqrt(ratio));
    c->network.tolerance.relative = fmin(fmax(by[ITERATED] * tolerance, by[LEAST_ITERATED]), by[MOST_ITERATED]);
    c->sizes.largest = share * by[LARGEST_STEP];
    c->sizes.smallest = share * by[SMALLEST_STEP];
    c->start_step = fmin(share * by[START_STEP], c->sizes.largest);
    /* the error of a step is to h^(order + 1), so that with it errors of the run are proportional to the tolerance */
    c->limit.allowed = ALLOWED_SHARE * tolerance * longer;
    c->limit.resolved = ALLOWED_SHARE * tolerance * sqrt(ratio);
    c->limit.jump = LEAST_JUMP * fmax(1.0, share * share);
}

int coupling_fails(Coupling *c, int failure) {
    const Network *n = &c->network;
    Progress *p = &c->progress;
    p->failure = (size_t)failure;
    p->participant = n->failed;
    p->call = n->failed_call;
    p->status = n->failed_status;
    p->worst_row = n->worst_row;
    p->iterations = n->iteration;
    p->correction = n->correction;
    return 0;
}

int is_solved(const Coupling *c, int status) {
    const Network *n = &c->network;
    return status == CONVERGED || (status == NOT_CONVERGED && n->correction * n->tolerance.relative <= c->stalled);
}

void coupling_aim_sensors(Coupling *c) {
    for (size_t k = 0; k < c->lines; k++) {
        const size_t sensor = c->line[k].hinge[(size_t)*c->line[k].sensor];
        c->crossing[k].place = c->network.participant[sensor].output + c->latch_distance[sensor];
    }
}

int coupling_start(Coupling *c) {
    Network *n = &c->network;
    memset(&c->progress, 0, sizeof c->progress);
    c->divided = (SubdividedStep){1, 0};
    c->stalled = 0.0;
    c->segment = 0.0;
    c->position = c->repeats = c->untold = c->rows.held = c->rows.count = 0;
    c->rows.last_time = -INFINITY;
    n->watched_count = 0;
    history_clear(n);
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++) {
        *s->waits = 1.0;
        s->struck->hinges = 0.0;
    }
    for (size_t k = 0; k < c->lines; k++) {
        *c->line[k].sensor = c->line[k].stiffened->hinges = 0.0;
        memset(c->line[k].released, 0, c->line[k].hinges * sizeof(double));
    }
    coupling_aim_sensors(c);
    memcpy(n->wrenches, n->accepted, n->size * sizeof(double));
    forget_all(&c->solver);
    if (!network_observe(n)) return coupling_fails(c, OF_PARTICIPANT);
    memcpy(c->rows.start, n->energies, ENERGIES * sizeof(double));
    return 1;
}

void coupling_watch(Coupling *c) {
    double form = INFINITY, release = INFINITY;
    for (Crossing *one = c->crossing; one < c->crossing + c->crossings; one++) one->before = distance_of(one);
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++) s->before = *s->place;
    for (size_t i = 0; i < c->laws; i++) form = fmin(form, *c->law[i]);
    for (size_t i = 0; i < c->bolts; i++) release = fmin(release, *c->law[i]);
    c->law_time = c->progress.time + form;
    c->release_time = c->progress.time + release;
}

int coupling_save(Coupling *c) {
    if (!network_save(&c->network)) return coupling_fails(c, OF_PARTICIPANT);
    coupling_watch(c);
    return 1;
}

void coupling_exchange_scalars(Coupling *c, int write) {
    EnergyGuard *g = &c->guard;
    History *past = &c->network.history;
    Rows *r = &c->rows;
    double *place = c->scalars;
    double *doubles[] = {&c->progress.time, &c->sizes.worst,   &c->limit.energy,  &g->kinetic,     &g->power,
                         &g->rounding,      &c->segment,       &r->held_time,     &r->held_segment, &r->last_time,
                         past->times,       past->times + 1,   past->times + 2,   g->last,         g->last + 1,
                         g->last + 2,       g->last + 3,       g->last + 4,       g->powers,       g->powers + 1,
                         g->powers + 2,     g->powers + 3};
    size_t *counts[] = {&past->count, &g->trials,        &c->position,     &r->held,
                        &c->untold,   &c->divided.parts, &c->divided.made, &c->network.watched_count};
    ptrdiff_t *signs[] = {&c->sizes.level, &c->sizes.wait, &c->sizes.stirred};
    for (size_t i = 0; i < sizeof doubles / sizeof *doubles; i++, place++)
        write ? (void)(*place = *doubles[i]) : (void)(*doubles[i] = *place);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++, place++)
        write ? (void)(*place = (double)*counts[i]) : (void)(*counts[i] = (size_t)*place);
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++, place++)
        write ? (void)(*place = (double)*signs[i]) : (void)(*signs[i] = (ptrdiff_t)*place);
    place = c->scalars + SCALARS;
    for (Watched *w = c->watched; w < c->watched + c->network.watched_count; w++, place += OF_WATCHED) {
        const double numbers[OF_WATCHED] = {(double)w->connection, (double)w->port, (double)w->row, w->axis[0],
                                            w->axis[1],            w->axis[2],      w->weight};
        if (write) memcpy(place, numbers, sizeof numbers);
        else *w = (Watched){(size_t)place[0], (size_t)place[1], (size_t)place[2], {place[3], place[4], place[5]}, place[6]};
    }
    c->network.watched = c->watched;
}

/* Most loads that can be watched. */
static size_t most_watched(const Coupling *c) {
    size_t most = MOST_STRUCK * c->strikes;
    for (size_t k = 0; k < c->lines; k++) most += c->line[k].hinges;
    return most;
}

static size_t size_of_line(size_t hinges) {
    return (sizeof(StiffenedLine) + hinges * sizeof(Stiffening)) / sizeof(double);
}

size_t coupling_arrange(Coupling *c, double *first) {
    Network *n = &c->network;
    Rows *r = &c->rows;
    size_t used = 0;
#define TAKE(pointer, count) (pointer = first ? (void *)(first + used) : NULL, used += (count))
    TAKE(c->scalars, SCALARS + OF_WATCHED * most_watched(c));
    TAKE(n->accepted, n->size);
    TAKE(n->history.values, POINTS * n->size);
    TAKE(r->held_observations, r->observations);
    TAKE(r->held_channels, CHANNELS + r->signals);
    TAKE(r->roughness, r->corrections);
    TAKE(r->start, ENERGIES);
    TAKE(c->pending, c->crossings);
    for (HingeLine *line = c->line; line < c->line + c->lines; line++) {
        TAKE(line->sensor, 1);
        TAKE(line->released, line->hinges);
        TAKE(line->stiffened, size_of_line(line->hinges));
    }
    for (Strike *s = c->strike; s < c->strike + c->strikes; s++) {
        TAKE(s->waits, 1);
        TAKE(s->struck, size_of_line(MOST_STRUCK));
    }
#undef TAKE
    return used;
}

int coupling_stand(Coupling *c) {
    Network *n = &c->network;
    coupling_exchange_scalars(c, 0);
    memcpy(n->wrenches, n->accepted, n->size * sizeof(double));
    forget_all(&c->solver);
    coupling_aim_sensors(c);
    c->rows.count = 0;
    if (!network_restore(n) || !network_observe(n)) return coupling_fails(c, OF_PARTICIPANT);
    coupling_watch(c);
    return 1;
}
