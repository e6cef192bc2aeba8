/* A network of FMUs as the native solver sees it; orchestrator/cosim/implicit/native_solver.py fills these structures. */

#ifndef FANFOLD_NETWORK_H
#define FANFOLD_NETWORK_H

#include "blocks.h"
#include "participant.h"

/* A port of a body and the port of a connection that it meets; place: its rows in the order of elimination. */
typedef struct {
    size_t body, body_port, connection, connection_port, place;
} Link;

/* A matrix like Participant.turned, and the axes (3, 3) of the participant's first port when it was made. */
typedef struct {
    const double *matrix, *axes;
} JacobianBlock;

/* Numbers of the iteration, see cosim/implicit/convergence.py; no_load: see
   cosim/implicit/local_error.py; refreshed: iterations that may refresh matrices. */
typedef struct {
    double slow, diverged, steepest, round_off, near, credible, agreed, overshot, rough, least_reach,
        no_load;
    size_t patience, most, halvings, refreshed[3];
} Limits;

typedef struct {
    double relative, force, torque, residual;
} Tolerance;

enum { POINTS = 3 };

/* A rotation about an axis fixed in a port of a connection that an event made stiff: what the torque about it, the
   rows [row, row + 3) of the unknown, may err is judged beside an energy of its own. weight: 1 over twice the
   effective inertia times that energy. */
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

/* Bodies come before connections. Arrays have `size` rows but: steps (most, size), squares (most,), product
   with room for a connection's rows over a body's columns, watched (watched_count,), observations of all participants
   in order and a zero, energies (energy_kinds,), energy_rows (energy_kinds, participants): where observations hold
   them. */
typedef struct {
    size_t participants, bodies, links, size;
    Width width;
    Participant *participant;
    const Link *link;
    const JacobianBlock *mobility, *stiffness;
    const Part *parts; /* by connection, its ports, its ports again, the ports of the first port's body */
    double *wrenches, *accepted, *law, *residual, *scale, *round_off, *steps, *squares, *product, *bend, *noise;
    double *observations;
    const size_t *energy_rows;
    double *energies;
    const Watched *watched;
    size_t energy_kinds, watched_count;
    Limits limits;
    Tolerance tolerance;
    Matrix matrix;
    History history;
    double time, h, last, correction, seconds, reach; /* reach (m): largest coordinate of a port */
    size_t iteration, kept, halved, halvings, endured, sweeps, worst_row, singular, failed, failed_call;
    int failed_status;
} Network;

/* Take note of who failed in what; 0. */
static int fail(Network *n, size_t participant, size_t call, int status) {
    n->failed = participant;
    n->failed_call = call;
    n->failed_status = status;
    return 0;
}

#endif
