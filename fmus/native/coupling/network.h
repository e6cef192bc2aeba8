/* Participants joined port to port, and what they exchange in one sweep. */

#ifndef FANFOLD_NETWORK_H
#define FANFOLD_NETWORK_H

#include <float.h>

#include "blocks.h"
#include "participant.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* A port of a body and the port of a connection that it meets. place: first row, in the order of elimination, of its
   wrench or of the unknown of a rigid body. */
typedef struct {
    size_t body, body_port, connection, connection_port, place;
} Link;

/* A matrix like Participant.turned, and the axes (3, 3) of the participant's first port when the matrix was made. */
typedef struct {
    const double *matrix, *axes;
} JacobianBlock;

/* Convergence limits of a correction of wrenches: `relative` times the largest force plus `force` (N), and the largest
   torque plus `torque` (N.m). residual: residuals below this many tolerances show that a larger correction is
   round-off, as between joints that constrain a loop more than once. */
typedef struct {
    double relative, force, torque, residual;
} Tolerance;

#define ROUND_OFF (8.0 * DBL_EPSILON)

enum { POINTS = 3, ENERGIES = 5 };
/* The order of `Energies` in orchestrator/cosim/energy_balance.py. */
enum { KINETIC, POTENTIAL, DISSIPATED, NUMERICAL, SUPPLIED };

/* A load that is judged relative to an energy of its own: that of a connection that an event made stiff, along an axis
   fixed in one of its ports, in the rows [row, row + 3) of the unknowns. weight: 1 / (2 x effective inertia x that
   energy). */
typedef struct {
    size_t connection, port, row;
    double axis[3], weight;
} Watched;

/* Mean wrenches (POINTS, size) of the last accepted steps and their mid-step times, the newest last; slopes as rates
   per second. */
typedef struct {
    size_t count;
    double times[POINTS];
    double *values;
} History;

/* All that a coupled step works on; bodies come before connections. Arrays have `size` rows, except: steps (most,
   size), squares (most,), product and gathered (work space: a connection's rows by a body's columns), watched
   (watched_count,), observations (those of all participants in order, then a zero), energies (ENERGIES,), energy_rows
   (ENERGIES, participants; places of the energies among the observations). parts: by connection, its port, its port
   again, and port of the body at the first port (once for a rigid body), without bodies that never move. */
typedef struct {
    size_t participants, bodies, links, size;
    Width width;
    Participant *participant;
    const Link *link;
    const JacobianBlock *mobility, *stiffness;
    const Part *parts;
    double *wrenches, *accepted, *law, *residual, *scale, *round_off, *steps, *squares, *product, *gathered, *bend;
    double *noise;
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

/* Calls of a participant that can fail, in the order of FAILURES in orchestrator/cosim/fmu.py. */
enum { RESTORE, SET, STEP, GET, FINITE, SAVE, OBSERVE, OBSERVED };

/* These functions return 1, or 0 if a participant fails; `network_fail` notes which one, in which call. */
int network_fail(Network *n, size_t participant, size_t call, int status);
/* Whether the participant that failed last fails for good, whatever is tried. */
static inline int is_fatal(const Network *n) { return n->failed_status >= FMI_FATAL; }
/* Restore one participant and step it. */
int network_step_one(Network *n, size_t participant);
/* Restore and step all participants over h (s) from a time (s): bodies under the wrenches, then connections over the
   resulting motions. Their wrenches go to `law`. */
int network_sweep(Network *n, double time, double h);
/* Restore all participants, and pass the motions of bodies to connections. */
int network_restore(Network *n);
/* Save the states of all participants. */
int network_save(Network *n);
/* Read the observations of all participants at the present inputs, and add up their energies. */
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
