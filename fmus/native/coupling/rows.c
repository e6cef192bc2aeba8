/* Rows of results before they are recorded. */

#include "rows.h"

#include <math.h>
#include <string.h>

enum { TELLING_STEPS = 2 }; /* after an event, after which means of steps show the load at the end of the last one */

static size_t width_of_row(const Rows *r) { return r->columns + CHANNELS + r->signals; }

static void note_channels(const Rows *r, const double *found, double h, double iterations, double *channels) {
    const double *start = r->start;
    channels[0] = h;
    channels[1] = iterations;
    channels[2] = found[KINETIC] + found[POTENTIAL];
    channels[3] = found[DISSIPATED] - start[DISSIPATED];
    channels[4] = found[NUMERICAL] - start[NUMERICAL];
    channels[5] = found[SUPPLIED] - start[SUPPLIED];
    channels[6] = balance_of(found) - balance_of(start);
    memcpy(channels + CHANNELS, r->signal, r->signals * sizeof(double));
}

/* Room for a row. Its time is no earlier than that of the last one: the row of the instant after an event lies behind
   the event, where another event may follow at once. */
static double *next_row(Rows *r, double time, double segment) {
    r->times[r->count] = r->last_time = fmax(time, r->last_time);
    r->segments[r->count] = segment;
    return r->values + r->count++ * width_of_row(r);
}

static void take_observations(const Rows *r, const double *observations, double *row) {
    for (size_t i = 0; i < r->columns; i++) row[i] = observations[r->recorded[i]];
}

void rows_release(Rows *r) {
    if (!r->held) return;
    double *row = next_row(r, r->held_time, r->held_segment);
    take_observations(r, r->held_observations, row);
    memcpy(row + r->columns, r->held_channels, (CHANNELS + r->signals) * sizeof(double));
    r->held = 0;
}

void rows_hold(Rows *r, const Network *n, double time, double h, double segment, int continues) {
    for (size_t i = 0; continues && i < r->corrections; i++)
        r->held_observations[r->corrected[2 * i + 1]] = n->observations[r->corrected[2 * i]];
    rows_release(r);
    memcpy(r->held_observations, n->observations, r->observations * sizeof(double));
    note_channels(r, n->energies, h, (double)n->iteration, r->held_channels);
    r->held_time = time;
    r->held_segment = segment;
    r->held = 1;
}

void rows_add(Rows *r, const Network *n, double time, double h, double iterations, double segment) {
    rows_release(r);
    double *row = next_row(r, time, segment);
    take_observations(r, n->observations, row);
    note_channels(r, n->energies, h, iterations, row + r->columns);
}

void rows_note_roughness(Rows *r, const Network *n, double time, size_t steps) {
    for (size_t i = 0; i < r->corrections && r->held && r->held_time == time; i++) {
        const size_t place = r->corrected[2 * i + 1];
        if (steps >= TELLING_STEPS) r->roughness[i] = n->observations[place] - r->held_observations[place];
        else r->held_observations[place] = n->observations[place];
    }
}

void rows_forget_roughness(Rows *r) { memset(r->roughness, 0, r->corrections * sizeof(double)); }

void rows_smooth(Rows *r, Network *n) {
    for (size_t i = 0; i < r->corrections; i++) {
        double *load = n->observations + r->corrected[2 * i + 1];
        if (*load != 0.0) *load -= r->roughness[i];
    }
    rows_forget_roughness(r);
}
