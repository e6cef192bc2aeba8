/* Rows of a run as they come from its steps: what orchestrator/cosim/rows.py does for those of the master in Python. */

#ifndef FANFOLD_ROWS_H
#define FANFOLD_ROWS_H

#include "network.h"

enum { ENERGIES = 5 };
/* The order of `Energies` in orchestrator/cosim/energy_balance.py. */
enum { KINETIC, POTENTIAL, DISSIPATED, NUMERICAL, SUPPLIED };

/* The row held back, and those that may be handed on, (capacity, columns + channels) with their times. recorded
   (columns,): places of what is recorded among the observations. Of corrected (corrections, 2) a held observation takes
   the value of the other now. */
typedef struct {
    double *held_observations, *held_scene, held_time;
    double *times, *values;
    const size_t *recorded, *corrected;
    size_t held, observations, columns, channels, corrections, count;
} RowBlock;

static double balance_of(const double *e) {
    return e[KINETIC] + e[POTENTIAL] + e[DISSIPATED] + e[NUMERICAL] - e[SUPPLIED];
}

static void hand_on_held(RowBlock *r) {
    double *row = r->values + r->count * (r->columns + r->channels);
    for (size_t i = 0; i < r->columns; i++) row[i] = r->held_observations[r->recorded[i]];
    memcpy(row + r->columns, r->held_scene, r->channels * sizeof(double));
    r->times[r->count++] = r->held_time;
}

/* Hold back the row of the step h accepted last, to `time`; start: energies at the start; continues: the row before
   comes right before, and takes what is known better now. */
static void hold_row(RowBlock *r, const Network *n, const double *start, double time, double h, int continues) {
    const double *found = n->energies;
    for (size_t i = 0; continues && i < r->corrections; i++)
        r->held_observations[r->corrected[2 * i + 1]] = n->observations[r->corrected[2 * i]];
    if (r->held) hand_on_held(r);
    memcpy(r->held_observations, n->observations, r->observations * sizeof(double));
    const double channels[] = {h,
                               (double)n->iteration,
                               found[KINETIC] + found[POTENTIAL],
                               found[DISSIPATED] - start[DISSIPATED],
                               found[NUMERICAL] - start[NUMERICAL],
                               found[SUPPLIED] - start[SUPPLIED],
                               balance_of(found) - balance_of(start)};
    memcpy(r->held_scene, channels, sizeof channels); /* signals stay as they are held */
    r->held_time = time;
    r->held = 1;
}

#endif
