/* Neighbours of a run: the same network with parameters that differ a little, which follow its every step. What they
   differ by, over what their parameters differ by, are derivatives through all steps and events (internal numerical
   differentiation: H. G. Bock, Numerical treatment of inverse problems in chemical reaction kinetics, 1981). A
   neighbour takes its leader's step size, factors and residual, so that no error of steps or iterations is in the
   difference, and needs two or three sweeps a step. orchestrator/cosim/neighbours fills the structures. */

#ifndef FANFOLD_NEIGHBOURS_H
#define FANFOLD_NEIGHBOURS_H

#include "rows.h"
#include "system.h"

/* Correction over the largest difference from the leader that is small, and residual beyond rounding, which recorded
   loads of stiff joints are off by; correction over the largest wrench, what may be rounding of stiff joints, if a
   sweep makes no more than RATIO of it, and is taken for it FADES times as much a step later; sweeps at the most, and
   those after which factors are made anew; sweeps beyond two, over the neighbours, from which new factors pay; part of
   a correction that is taken at the least. */
#define NEIGHBOUR_SMALL 1e-6
#define NEIGHBOUR_LEFT 1e-6
#define NEIGHBOUR_ROUNDING 1e-9
#define NEIGHBOUR_RATIO 0.7
#define NEIGHBOUR_FADES 0.98
#define NEIGHBOUR_SWEEPS 100
#define NEIGHBOUR_REFRESHED 5
#define NEIGHBOUR_SLUGGISH 1
#define NEIGHBOUR_LEAST_SHARE 0.1

/* A step that the leader has solved: factors, and the wrenches it came to, from which guess, with which residual. */
typedef struct {
    Network *network;
    const double *guess, *wrenches, *residual;
} Led;

/* See Loop; time, h (s): of the neighbour, whose events come earlier or later than the leader's; of forces and
   torques: last: largest of the last correction, rounding: of those that further sweeps made no smaller, left: largest
   residual beyond rounding, share: part of a correction that is taken, as those that friction throws to and fro between
   both sides of a kink get no smaller as wholes; iterates: whether it goes on; astray: whether it did not get there. */
typedef struct {
    Network *network;
    const double *energy_start;
    RowBlock rows;
    double time, h, last[2], rounding[2], left[2], share;
    size_t iterates, astray;
} Neighbour;

/* Runs beside one: neighbour (count,), and room for what they are corrected by, (size, count) each. */
typedef struct {
    Neighbour *neighbour;
    double *changes, *ordered;
    size_t count, at, sluggish;
} Neighbours;

/* What the leader's residual leaves of a neighbour's, into a column of all. */
static void note_residual(Neighbour *b, const Led *led, double *column, size_t columns) {
    const Network *n = b->network;
    b->left[0] = b->left[1] = 0.0;
    for (size_t i = 0; i < n->size; i++) {
        column[i * columns] = n->law[i] - n->wrenches[i] - led->residual[i];
        b->left[i / 3 % 2] = fmax(b->left[i / 3 % 2], fabs(column[i * columns]) - led->network->round_off[i]);
    }
}

/* Largest of a correction, of a neighbour's difference from its leader, and of its wrenches: of forces and of torques. */
typedef struct {
    double change[2], difference[2], wrench[2];
} Sizes2;

static Sizes2 sizes_of(const Network *n, const Led *led, const double *column, size_t columns) {
    Sizes2 s = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    for (size_t i = 0; i < n->size; i++) {
        const size_t kind = i / 3 % 2;
        const double change = fabs(column[i * columns]);
        s.change[kind] = isfinite(change) ? fmax(s.change[kind], change) : INFINITY;
        s.difference[kind] = fmax(s.difference[kind], fabs(n->wrenches[i] - led->wrenches[i]));
        s.wrench[kind] = fmax(s.wrench[kind], fabs(n->wrenches[i]));
    }
    return s;
}

/* Whether a correction need not be taken: small, or rounding, which sweeps make no smaller. */
static int is_done(Neighbour *b, const Sizes2 *s, size_t kind) {
    const int little = b->left[kind] <= NEIGHBOUR_LEFT * s->difference[kind];
    if (s->change[kind] <= fmax(little ? NEIGHBOUR_SMALL * s->difference[kind] : 0.0, b->rounding[kind])) return 1;
    if (b->network->iteration <= 2 || s->change[kind] < NEIGHBOUR_RATIO * b->last[kind]) return 0;
    const double least = kind ? b->network->tolerance.torque : b->network->tolerance.force; /* of what rests there is none */
    if (!little && !(s->change[kind] <= NEIGHBOUR_ROUNDING * (least + s->wrench[kind]))) return 0;
    b->rounding[kind] = s->change[kind];
    return 1;
}

/* Take a correction, unless it need not be. */
static void take_correction(Neighbour *b, const Led *led, const double *column, size_t columns) {
    Network *n = b->network;
    const Sizes2 s = sizes_of(n, led, column, columns);
    const int forces = is_done(b, &s, 0), torques = is_done(b, &s, 1);
    b->astray = !(forces && torques) && n->iteration >= NEIGHBOUR_SWEEPS;
    b->iterates = !(forces && torques) && !b->astray;
    const double ratio = fmax(s.change[0] / b->last[0], s.change[1] / b->last[1]);
    if (n->iteration > 2 * NEIGHBOUR_REFRESHED && ratio > NEIGHBOUR_RATIO) /* factors have been made anew by then */
        b->share = fmax(0.5 * b->share, NEIGHBOUR_LEAST_SHARE);
    for (size_t kind = 0; kind < 2; kind++) {
        b->last[kind] = s.change[kind];
        if (!b->iterates) b->rounding[kind] *= NEIGHBOUR_FADES;
    }
    for (size_t i = 0; b->iterates && i < n->size; i++) n->wrenches[i] += b->share * column[i * columns];
}

/* Start a step h of a neighbour from its own guess, and what the leader's step made of the leader's. */
static void start_beside(Neighbour *b, const Led *led, double h) {
    Network *n = b->network;
    for (size_t i = 0; i < n->size; i++) n->wrenches[i] += led->wrenches[i] - led->guess[i];
    b->h = h;
    b->last[0] = b->last[1] = INFINITY;
    b->share = 1.0;
    b->iterates = 1;
    b->astray = 0;
    n->iteration = 0;
}

#endif
