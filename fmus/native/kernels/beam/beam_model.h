/* What a beam is made of: part of beam.c. */

#ifndef FANFOLD_BEAM_MODEL_H
#define FANFOLD_BEAM_MODEL_H

#include <string.h>

#include "beam_layout.h"
#include "frames.h"
#include "kernel.h"
#include "matrices.h"
#include "port_sizes.h"

enum { NODE = 6, BLOCK = NODE * NODE };

/* Strains of an element and what they are made of: components/beam_parts/elements.py. e: less those at rest. */
typedef struct {
    double s[3], k[3], y, c, d, g, e[6];
} Strains;

/* Divided differences over a step of c and d, their derivatives by the end, and the derivatives of c and d there. */
typedef struct {
    double c, d, c_by_end, d_by_end, slope_c, slope_d;
} Differences;

/* Nodes at an instant and between them: directors (rotation matrices, 9 a node), spans (3 an element), strains. */
typedef struct {
    double *directors, *spans;
    Strains *strains;
} Shape;

/* Factors of a chain of blocks: of the nodes, triangular with pivots, and what couples a node to the next and back. */
typedef struct {
    double *nodes, *next, *back;
    unsigned short *pivots;
} Factors;

/* What a step started from and how its iteration ended; `known` while a step of the same start has the same. */
typedef struct {
    int known;
    double h, *x, *u;
} Key;

typedef struct {
    size_t nodes, ports, states;
    double length, line_mass, stiffness[6];
    double *lengths, *rest;        /* of elements: 1 and 6 */
    double *inertia, *weights;     /* of nodes: 3 and 1 */
    double *positions, *turns;     /* of nodes at rest: 3 and 4, construction frame */
    double *pivots, *ratios;       /* of the elimination of the mass matrix */
    size_t *port_nodes;
    double *port_arms, *port_turns; /* 3 and 4 a port, axes of the section */
    double start_position[3], start_orientation[4], start_velocity[3], start_angular_velocity[3];
    double gravity[3], damping;
    double *start_displacements, *start_rotations; /* of nodes, construction frame */
    Shape start, end;
    double *travel, *turn, *quaternions, *spins; /* of nodes: spins are angular momenta at the start, world axes */
    double *stresses, *changes; /* of elements, 6 each: means over a step, changes of strains over it */
    double *loads, *residual, *next, *inputs;
    Factors predicted, renewed; /* at the start's uniform motion; where an iteration stands */
    Key start_of_factors, end_of_step;
} Beam;

/* Where the parts of the state lie. */
static inline size_t place_of_position(const Beam *beam) { (void)beam; return X_POSITION; }
static inline size_t place_of_orientation(const Beam *beam) { return X_POSITION + 3 * beam->nodes; }
static inline size_t place_of_velocity(const Beam *beam) { return X_POSITION + 7 * beam->nodes; }
static inline size_t place_of_rate(const Beam *beam) { return X_POSITION + 10 * beam->nodes; }
static inline size_t states_of(size_t nodes) { return X_POSITION + 13 * nodes; }

#endif
