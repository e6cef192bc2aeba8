/* Parts of the coupling, for tests: each on data of its own, or of a coupling that a master has under way.

   A handle of `Coupling` in Python is an address of a `Coupling` here, as both are compiled from the same headers. */

#include <stdlib.h>

#include "advance.c"
#include "latch_up.c"
#include "local_error.c"
#include "convergence.h"
#include "rows.h"
#include "system.h"

#define EXPORT __attribute__((visibility("default")))

/* Step sizes. */
EXPORT StepSizes *new_sizes(double largest, double smallest, size_t order, double start) {
    StepSizes *s = calloc(1, sizeof *s);
    s->largest = largest, s->smallest = smallest, s->order = order;
    restart_sizes(s, start, 1);
    return s;
}
EXPORT double present_size(const StepSizes *s) { return size_now(s); }
EXPORT int judge(StepSizes *s, double error) { return judge_error(s, error); }

/* Parts of a step. */
EXPORT int divide(SubdividedStep *d) { return divide_step(d); }
EXPORT void stood(SubdividedStep *d) { step_stood(d); }

/* The balance of energy. */
EXPORT EnergyGuard *new_guard(const double *energies) {
    EnergyGuard *g = calloc(1, sizeof *g);
    begin_guard(g, energies);
    return g;
}
EXPORT int allows(EnergyGuard *g, const double *energies, double h, double share) {
    return guard_allows(g, energies, h, share);
}
EXPORT void gives_in(EnergyGuard *g, const double *energies) { guard_gives_in(g, energies); }
EXPORT void accepts(EnergyGuard *g, const double *energies) { guard_accepts(g, energies); }

EXPORT void discard(void *made) { free(made); }

/* Whether an iteration with these corrections is too slow with so many iterations left. */
EXPORT int too_slow(double correction, double last, size_t left) {
    Network n = {.correction = correction, .last = last, .iteration = MOST_ITERATIONS - left};
    return is_too_slow(&n);
}

/* What happens at the end of a step h from distances before and after it: a number in `first`, and those `reached`. */
EXPORT ptrdiff_t crossed(size_t count, const double *before, const double *after, double h, double *reached) {
    Coupling c = {.crossings = count, .reached = reached, .pending = malloc(count * sizeof(double))};
    c.crossing = calloc(count, sizeof *c.crossing);
    for (size_t k = 0; k < count; k++) {
        c.crossing[k] = (Crossing){after + k, 0.0, -1.0, before[k], 0.0};
        c.pending[k] = 1.0;
    }
    const ptrdiff_t first = first_crossed(&c, h);
    for (size_t k = 0; k < count; k++) {
        c.crossing[k].rate = (before[k] - after[k]) / h;
        c.crossing[k].before = after[k];
    }
    note_reached(&c, first, h);
    free(c.crossing);
    free(c.pending);
    return first;
}

/* Wrenches (steps, size) of steps h (steps,) that begin one after the other at 0, as a network of one port without bodies
   remembers them; all but the last were accepted. predicted (size,): for the last. bends (size,): of the last. How much errors
   of the wrenches grow in it, not a number for too few steps. */
EXPORT double followed(int with_slopes, size_t steps, const double *h, const double *wrenches, double *predicted,
                       double *bends) {
    double past[POINTS * 2 * WRENCH] = {0.0}, present[2 * WRENCH], accepted[2 * WRENCH] = {0.0}, end = 0.0;
    Network n = {.width = width_of(with_slopes), .wrenches = present, .accepted = accepted, .bend = bends};
    n.size = n.width.wrench;
    n.history.values = past;
    for (size_t k = 0; k + 1 < steps; k++, end += h[k - 1]) {
        memcpy(present, wrenches + k * n.size, n.size * sizeof(double));
        history_add(&n, end + 0.5 * h[k], h[k]);
    }
    memcpy(present, wrenches + (steps - 1) * n.size, n.size * sizeof(double));
    predict(&n, end + 0.5 * h[steps - 1], h[steps - 1], predicted);
    const double square = error_square(&n, end + 0.5 * h[steps - 1], h[steps - 1], 1.0);
    return isnan(square) ? square : bend(&n, end + 0.5 * h[steps - 1], h[steps - 1]);
}

/* Rows: of three recorded observations the first is corrected by the fourth, which is not; no channel but those of the scene. */
enum { COUNT = 4, RECORDED = 3, ROOM = 8 };
typedef struct {
    Rows rows;
    Network network;
    double observations[COUNT], held[COUNT], channels[CHANNELS], energies[ENERGIES], start[ENERGIES];
    double times[ROOM], segments[ROOM], values[ROOM * (RECORDED + CHANNELS)], roughness;
    size_t recorded[RECORDED], corrected[2];
} Table;
EXPORT Table *new_table(int corrects) {
    Table *t = calloc(1, sizeof *t);
    for (size_t i = 0; i < RECORDED; i++) t->recorded[i] = i;
    t->corrected[0] = COUNT - 1;
    t->network.observations = t->observations;
    t->network.energies = t->energies;
    t->rows = (Rows){.held_observations = t->held, .held_channels = t->channels, .times = t->times, .values = t->values,
                     .segments = t->segments, .start = t->start, .roughness = &t->roughness, .last_time = -INFINITY,
                     .recorded = t->recorded, .corrected = t->corrected, .observations = COUNT, .columns = RECORDED,
                     .corrections = corrects ? 1 : 0, .room = ROOM};
    return t;
}
EXPORT void observe(Table *t, const double *observations) {
    memcpy(t->observations, observations, sizeof t->observations);
}
EXPORT double observed(const Table *t) { return t->observations[0]; }
EXPORT void hold(Table *t, double time, int continues) { rows_hold(&t->rows, &t->network, time, 0.1, 0.0, continues); }
EXPORT void add(Table *t, double time) { rows_add(&t->rows, &t->network, time, 0.1, 0.0, 0.0); }
EXPORT void hand_on(Table *t) { rows_release(&t->rows); }
EXPORT void note_roughness(Table *t, double time, size_t steps) {
    rows_note_roughness(&t->rows, &t->network, time, steps);
}
EXPORT void smooth(Table *t) { rows_smooth(&t->rows, &t->network); }
/* Rows so far, each a time and what is recorded of observations. */
EXPORT size_t table(const Table *t, double *rows) {
    for (size_t k = 0; k < t->rows.count; k++, rows += 1 + RECORDED) {
        rows[0] = t->times[k];
        memcpy(rows + 1, t->values + k * (RECORDED + CHANNELS), RECORDED * sizeof(double));
    }
    return t->rows.count;
}

/* Where a coupling has its request: that of the library in use, if it was built from these headers. */
EXPORT Request *request_of(Coupling *c) { return &c->request; }

/* How many numbers the matrix of a participant has. */
EXPORT size_t matrix_size(const Coupling *c, size_t participant) { return block_size(&c->network, participant); }

/* The matrix of a participant over a step h under the wrenches accepted last, and its axes behind it; differences: whatever
   derivatives it gives. 0 where it cannot. */
EXPORT int matrix_of(Coupling *c, size_t participant, double h, int differences, double *numbers) {
    Network *n = &c->network;
    Participant *p = n->participant + participant;
    Derivative *const derivative = p->derivative;
    memcpy(n->wrenches, n->accepted, n->size * sizeof(double));
    if (!network_sweep(n, c->progress.time, h)) return 0;
    if (differences) p->derivative = NULL;
    const int fine = fill_block(n, &c->solver.jacobians, participant, numbers);
    p->derivative = derivative;
    return fine;
}

/* Have the matrices of a step h; outdate: as after a step that did not converge. */
EXPORT int use(Coupling *c, double h, int outdate) {
    SizedJacobian *one = jacobian_of(&c->network, &c->solver.jacobians, h);
    if (outdate) one->has_stiffnesses = 0, one->bodies_outdated = 1;
    return network_sweep(&c->network, c->progress.time, h) && use_jacobian(&c->network, &c->solver.jacobians, one);
}

/* Correction (size,) for a residual (size,) by matrices of all participants, axes behind each, at the ports' present poses. */
EXPORT void correct(Coupling *c, double *matrices, const double *residual, double *result) {
    Network *n = &c->network;
    JacobianBlock *blocks = malloc(n->participants * sizeof *blocks);
    for (size_t i = 0; i < n->participants; i++) {
        const size_t size = block_size(n, i);
        blocks[i] = (JacobianBlock){matrices, matrices + size};
        matrices += size + 9;
    }
    n->mobility = blocks;
    n->stiffness = blocks + n->bodies;
    network_give_motions(n);
    system_assemble(n);
    system_direction(n, residual, result);
    free(blocks);
}

/* What a line that was latched became: frequency, decay and energy, then the axis of each of its hinges; how many. */
EXPORT size_t stiffened(const Coupling *c, size_t line, double *numbers) {
    const StiffenedLine *found = c->line[line].stiffened;
    numbers[0] = found->frequency, numbers[1] = found->decay, numbers[2] = found->energy;
    for (size_t i = 0; i < (size_t)found->hinges; i++) memcpy(numbers + 3 + 3 * i, found->hinge[i].axis, 3 * sizeof(double));
    return (size_t)found->hinges;
}

/* What pushes at a connection that was struck: the first of its wrench's components, stiffness, and frequency with all that
   moves along. 0 where it is no stiffer than free. */
EXPORT int struck(Coupling *c, size_t connection, double h, double *numbers) {
    static const Slope free_of_load;
    struct {
        StiffenedLine line;
        Stiffening found;
    } stop = {.line = {.hinges = 1.0}};
    Slope pushing;
    if (!linearize(&c->solver, c->progress.time, h) || !slope_of(&c->solver, connection, c->progress.time, h, &pushing) ||
        !stiffening_of(&c->network, connection, &free_of_load, &pushing, h, stop.line.hinge))
        return 0;
    note_swing(&c->solver, h, &stop.line, c->room);
    numbers[0] = stop.found.first, numbers[1] = stop.found.stiffness, numbers[2] = stop.line.frequency;
    return 1;
}

/* How fast a line starts in a step h where everything is displaced so many times as far. */
EXPORT double fastest_displaced(Coupling *c, size_t line, double h, double factor) {
    Network *n = &c->network;
    linearize(&c->solver, c->progress.time, h);
    for (size_t i = 0; i < n->bodies; i++)
        for (size_t k = 0; n->participant[i].turned && k < block_size(n, i); k++) n->participant[i].turned[k] *= factor;
    note_swing(&c->solver, h, c->line[line].stiffened, c->room);
    return fastest_of(c->line[line].stiffened);
}

/* One step of a size: solve it, the square of its error beside an energy, take it as made. */
EXPORT int solve_one(Coupling *c, double h) { return solve_predicted(&c->solver, c->progress.time, h) == CONVERGED; }
EXPORT double square_of_error(Coupling *c, double h, double energy) {
    return error_square(&c->network, c->progress.time + 0.5 * h, h, energy);
}
EXPORT int accept_one(Coupling *c, double h) { return network_observe(&c->network) && accept(c, h); }
