/* Participants joined port to port, and what goes to and fro between them in one sweep. */

#ifndef FANFOLD_NETWORK_H
#define FANFOLD_NETWORK_H

#include <float.h>

#include "blocks.h"
#include "participant.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* A port of a body and the port of a connection that it meets; place: its rows, or those of its rigid body, in the order of
   elimination. */
typedef struct {
    size_t body, body_port, connection, connection_port, place;
} Link;

/* A matrix like Participant.turned, and the axes (3, 3) of the participant's first port when it was made. */
typedef struct {
    const double *matrix, *axes;
} JacobianBlock;

/* Convergence limits of the correction of wrenches: relative to the largest force and torque, and to these. residual:
   below this many tolerances a larger correction is round-off, as between joints that constrain a loop more than once. */
typedef struct {
    double relative, force, torque, residual;
} Tolerance;

#define ROUND_OFF (8.0 * DBL_EPSILON)

enum { POINTS = 3, ENERGIES = 5 };
/* The order of `Energies` in orchestrator/cosim/energy_balance.py. */
enum { KINETIC, POTENTIAL, DISSIPATED, NUMERICAL, SUPPLIED };

/* A load along an axis fixed in a port of a connection that an event made stiff: what it may err, in the rows [row, row +
   3) of the unknown, is judged beside an energy of its own. weight: 1 over twice the effective inertia times that
   energy. */
typedef struct {
    size_t connection, port, row;
    double axis[3], weight;
} Watched;

/* Mean wrenches (POINTS, size) of the last accepted steps at their mid-step times, the newest last; slopes as rates,
   per second. */
typedef struct {
    size_t count;
    double times[POINTS];
    double *values;
} History;

/* All that a coupled step works on. Bodies come before connections. Arrays have `size` rows but: steps (most, size),
   squares (most,), product with room for a connection's rows over a body's columns, gathered for a wrench over them, watched (watched_count,),
   observations of all participants in order and a zero, energies (ENERGIES,), energy_rows (ENERGIES, participants): where
   observations hold them. parts: by connection, its ports, its ports again, the
   ports of the first port's body, of a rigid one once; without bodies that never move. */
typedef struct {
    size_t participants, bodies, links, size;
    Width width;
    Participant *participant;
    const Link *link;
    const JacobianBlock *mobility, *stiffness;
    const Part *parts;
    double *wrenches, *accepted, *law, *residual, *scale, *round_off, *steps, *squares, *product, *gathered, *bend, *noise;
    double *observations, *energies;
    const size_t *energy_rows;
    const Watched *watched;
    size_t watched_count;
    Tolerance tolerance;
    Matrix matrix;
    History history;
    double time, h, last, correction, seconds, reach; /* reach (m): largest coordinate of a port */
    size_t iteration, kept, halved, halvings, endured, sweeps, worst_row, singular, failed, failed_call;
    int failed_status;
} Network;

/* What a participant can fail in, in the order of FAILURES in orchestrator/cosim/fmu.py. */
enum { RESTORE, SET, STEP, GET, FINITE, SAVE, OBSERVE, OBSERVED };

/* Functions that return 1, or 0 where a participant fails: who failed in what is noted. */
int network_fail(Network *n, size_t participant, size_t call, int status);
/* Whether the participant that failed last will do so whatever is tried. */
static inline int is_fatal(const Network *n) { return n->failed_status >= FMI_FATAL; }
/* One participant from its saved state through the step. */
int network_step_one(Network *n, size_t participant);
/* Bodies under the wrenches, then connections over the motions, all from their saved states over h from a time. */
int network_sweep(Network *n, double time, double h);
/* All participants back to their saved states, with the motions of those at the connections. */
int network_restore(Network *n);
/* Save the states of all. */
int network_save(Network *n);
/* Read the observations of all, for the present inputs, and sum up their energies. */
int network_observe(Network *n);

void network_give_motions(Network *n);
double balance_of(const double *energies);
double seconds_now(void);
int all_finite(const double *values, size_t size);

/* Rotation matrix (3, 3) of the unit quaternion of a port's motion. */
static INLINE void axes_of(const double *motion, double *axes) {
    const double w = motion[3], x = motion[4], y = motion[5], z = motion[6];
    axes[0] = 1.0 - 2.0 * (y * y + z * z), axes[1] = 2.0 * (x * y - w * z), axes[2] = 2.0 * (x * z + w * y);
    axes[3] = 2.0 * (x * y + w * z), axes[4] = 1.0 - 2.0 * (x * x + z * z), axes[5] = 2.0 * (y * z - w * x);
    axes[6] = 2.0 * (x * z - w * y), axes[7] = 2.0 * (y * z + w * x), axes[8] = 1.0 - 2.0 * (x * x + y * y);
}

static INLINE double dot(const double *a, const double *b, size_t size) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0; /* four sums at a time, which the processor overlaps */
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        s0 += a[i] * b[i];
        s1 += a[i + 1] * b[i + 1];
        s2 += a[i + 2] * b[i + 2];
        s3 += a[i + 3] * b[i + 3];
    }
    for (; i < size; i++) s0 += a[i] * b[i];
    return (s0 + s1) + (s2 + s3);
}

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
