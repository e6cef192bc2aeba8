/* Neighbours of a run: the same network with parameters that differ a little, which follow its every step. What they
   differ by, over what their parameters differ by, are derivatives through all steps and events (internal numerical
   differentiation: H. G. Bock, Numerical treatment of inverse problems in chemical reaction kinetics, 1981). A
   neighbour takes its leader's step size, factors and residual, so that no error of steps or iterations is in the
   difference, and needs two or three sweeps a step. orchestrator/cosim/neighbours fills the structures. */

#ifndef FANFOLD_NEIGHBOURS_H
#define FANFOLD_NEIGHBOURS_H

#include "rows.h"
#include "system.h"

/* Correction of the difference from the leader, over its largest, that is small; sweeps at most; what a sweep makes of
   a correction at the least, beyond which it is rounding; sweeps beyond two, over the neighbours, from which new factors
   pay. */
#define NEIGHBOUR_SMALL 3e-5
#define NEIGHBOUR_SWEEPS 12
#define NEIGHBOUR_ROUNDED 0.7
#define NEIGHBOUR_SLUGGISH 1
#define NEIGHBOUR_ROUGH 1e-3
#define NEIGHBOUR_FADES 0.99

/* A step that the leader has solved: factors, and the wrenches it came to, from which guess, with which residual. */
typedef struct {
    const Network *network;
    const double *guess, *wrenches, *residual;
} Led;

/* See Loop; time, h (s): of the neighbour, whose events come earlier or later than the leader's; last: size of its last
   correction, rounding: of those that further sweeps made no smaller; iterates: whether it goes on. */
typedef struct {
    Network *network;
    const double *energy_start;
    RowBlock rows;
    double time, h, last, rounding;
    size_t iterates;
} Neighbour;

/* Runs beside one: neighbour (count,), and room for what they are corrected by, (size, count) each. */
typedef struct {
    Neighbour *neighbour;
    double *changes, *ordered;
    size_t count, at, sluggish;
} Neighbours;

/* What the leader's residual leaves of a neighbour's, into a column of all. */
static void note_residual(const Network *n, const Led *led, double *column, size_t columns) {
    for (size_t i = 0; i < n->size; i++) column[i * columns] = n->law[i] - n->wrenches[i] - led->residual[i];
}

/* Size of a correction over the largest difference from the leader, of forces and of torques; infinite where one is not
   finite. */
static double correction_size(const Network *n, const Led *led, const double *column, size_t columns) {
    double largest[2] = {0.0, 0.0}, size = 0.0;
    for (size_t i = 0; i < n->size; i++)
        largest[i / 3 % 2] = fmax(largest[i / 3 % 2], fabs(n->wrenches[i] - led->wrenches[i]));
    for (size_t i = 0; i < n->size; i++) {
        const double change = fabs(column[i * columns]);
        if (!isfinite(change)) return INFINITY;
        if (change != 0.0) size = fmax(size, change / largest[i / 3 % 2]);
    }
    return size;
}

/* Take a correction, where it is not small and more than rounding. */
static void take_correction(Neighbour *b, const Led *led, const double *column, size_t columns) {
    Network *n = b->network;
    n->correction = correction_size(n, led, column, columns);
    const int rounded = n->iteration > 2 && !(n->correction < NEIGHBOUR_ROUNDED * b->last);
    b->rounding = rounded && n->correction < NEIGHBOUR_ROUGH ? fmax(b->rounding, n->correction) : NEIGHBOUR_FADES * b->rounding;
    b->iterates = n->correction > fmax(NEIGHBOUR_SMALL, b->rounding) && !rounded && n->iteration < NEIGHBOUR_SWEEPS;
    b->last = n->correction;
    for (size_t i = 0; b->iterates && i < n->size; i++) n->wrenches[i] += column[i * columns];
}

/* Start a step h of a neighbour from its own guess, and what the leader's step made of the leader's. */
static void start_beside(Neighbour *b, const Led *led, double h) {
    Network *n = b->network;
    for (size_t i = 0; i < n->size; i++) n->wrenches[i] += led->wrenches[i] - led->guess[i];
    b->h = h;
    b->last = INFINITY;
    b->iterates = 1;
    n->iteration = 0;
}

#endif
