/* Making a beam from data that are not trusted: part of beam.c. */

#ifndef FANFOLD_BEAM_DATA_H
#define FANFOLD_BEAM_DATA_H

#include "beam_model.h"

#define MOST_NODES 4096
#define MOST_PORTS 1024

/* A copy of an array of the data whose numbers are finite and, where wanted, positive; NULL and a sentence otherwise. */
static double *copied(const Data *data, const char *name, size_t count, int positive, Memory *memory, Reason *why) {
    const double *values = data_array(data, name, count, why);
    if (!values) return NULL;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]) || (positive && !(values[i] > 0.0))) {
            refuse(why, "the beam's data have %g as a value of %s", values[i], name);
            return NULL;
        }
    double *copy = allocate(memory, (count + 1) * sizeof(double));
    if (copy)
        memcpy(copy, values, count * sizeof(double));
    else
        refuse(why, "no memory for a beam");
    return copy;
}

/* Numbers of nodes and of ports, from the sizes of two arrays. */
static int read_sizes(Beam *beam, const Data *data, const Sizes *sizes, Reason *why) {
    size_t lengths = 0, ports = 0;
    if (!data_any(data, "lengths", &lengths, why) || !data_any(data, "port_nodes", &ports, why)) return 0;
    if (lengths < 1 || lengths >= MOST_NODES || ports > MOST_PORTS)
        return refuse(why, "the beam's data have %lu elements and %lu ports; there can be 1 to %d and at most %d",
                      (unsigned long)lengths, (unsigned long)ports, MOST_NODES - 1, MOST_PORTS);
    beam->nodes = lengths + 1;
    beam->ports = ports;
    beam->states = states_of(beam->nodes);
    const size_t observations = OBSERVATIONS + 7 * beam->nodes + 6 * lengths;
    const Sizes own = {PARAMETERS + 6 * beam->nodes, WRENCH_SIZE * ports, MOTION_SIZE * ports, observations};
    return check_sizes(KIND, sizes, &own, why);
}

static int read_arrays(Beam *beam, const Data *data, Memory *memory, Reason *why) {
    const size_t nodes = beam->nodes, elements = nodes - 1, ports = beam->ports;
    const double *stiffness, *line_mass, *at;
    if (!(beam->lengths = copied(data, "lengths", elements, 1, memory, why)) ||
        !(beam->rest = copied(data, "rest", 6 * elements, 0, memory, why)) ||
        !(beam->inertia = copied(data, "inertia", 3 * nodes, 1, memory, why)) ||
        !(beam->positions = copied(data, "positions", 3 * nodes, 0, memory, why)) ||
        !(beam->turns = copied(data, "orientations", 4 * nodes, 0, memory, why)) ||
        !(beam->port_arms = copied(data, "port_arms", 3 * ports, 0, memory, why)) ||
        !(beam->port_turns = copied(data, "port_turns", 4 * ports, 0, memory, why)) ||
        !(stiffness = copied(data, "stiffness", 6, 1, memory, why)) ||
        !(line_mass = copied(data, "line_mass", 1, 1, memory, why)) ||
        !(at = copied(data, "port_nodes", ports, 0, memory, why)))
        return 0;
    memcpy(beam->stiffness, stiffness, sizeof beam->stiffness);
    beam->line_mass = *line_mass;
    for (size_t m = 0; m < elements; m++) beam->length += beam->lengths[m];
    if (!(beam->port_nodes = allocate(memory, (ports + 1) * sizeof(size_t))))
        return refuse(why, "no memory for a beam");
    for (size_t k = 0; k < ports; k++) {
        if (!(at[k] >= 0.0 && at[k] < (double)nodes))
            return refuse(why, "the beam's data have a port at node %g of %lu", at[k], (unsigned long)nodes);
        beam->port_nodes[k] = (size_t)at[k];
    }
    return 1;
}

static int allocate_shape(Shape *shape, size_t nodes, Memory *memory) {
    shape->directors = allocate(memory, 9 * nodes * sizeof(double));
    shape->spans = allocate(memory, 3 * nodes * sizeof(double));
    shape->strains = allocate(memory, nodes * sizeof(Strains));
    return shape->directors && shape->spans && shape->strains;
}

static int allocate_factors(Factors *factors, size_t nodes, Memory *memory) {
    factors->nodes = allocate(memory, BLOCK * nodes * sizeof(double));
    factors->next = allocate(memory, BLOCK * nodes * sizeof(double));
    factors->back = allocate(memory, BLOCK * nodes * sizeof(double));
    factors->pivots = allocate(memory, NODE * nodes * sizeof *factors->pivots);
    return factors->nodes && factors->next && factors->back && factors->pivots;
}

static int allocate_key(Key *key, const Beam *beam, Memory *memory) {
    key->x = allocate(memory, beam->states * sizeof(double));
    key->u = allocate(memory, (WRENCH_SIZE * beam->ports + 1) * sizeof(double));
    return key->x && key->u;
}

static int allocate_work(Beam *beam, Memory *memory, Reason *why) {
    const size_t vectors = 3 * beam->nodes * sizeof(double), motions = NODE * beam->nodes * sizeof(double);
    beam->weights = allocate(memory, beam->nodes * sizeof(double));
    beam->pivots = allocate(memory, beam->nodes * sizeof(double));
    beam->ratios = allocate(memory, beam->nodes * sizeof(double));
    beam->start_displacements = allocate(memory, vectors);
    beam->start_rotations = allocate(memory, vectors);
    beam->travel = allocate(memory, vectors);
    beam->turn = allocate(memory, vectors);
    beam->spins = allocate(memory, vectors);
    beam->quaternions = allocate(memory, 4 * beam->nodes * sizeof(double));
    beam->stresses = allocate(memory, motions);
    beam->changes = allocate(memory, motions);
    beam->loads = allocate(memory, motions);
    beam->residual = allocate(memory, motions);
    beam->next = allocate(memory, beam->states * sizeof(double));
    beam->inputs = allocate(memory, (WRENCH_SIZE * beam->ports + 1) * sizeof(double));
    if (!beam->weights || !beam->pivots || !beam->ratios || !beam->travel || !beam->turn || !beam->spins || !beam->start_displacements || !beam->start_rotations ||
        !beam->quaternions || !beam->stresses || !beam->changes || !beam->loads || !beam->residual || !beam->next || !beam->inputs ||
        !allocate_shape(&beam->start, beam->nodes, memory) || !allocate_shape(&beam->end, beam->nodes, memory) ||
        !allocate_factors(&beam->predicted, beam->nodes, memory) ||
        !allocate_factors(&beam->renewed, beam->nodes, memory) ||
        !allocate_key(&beam->start_of_factors, beam, memory) || !allocate_key(&beam->end_of_step, beam, memory))
        return refuse(why, "no memory for a beam of %lu nodes", (unsigned long)beam->nodes);
    return 1;
}

/* Elimination of the mass matrix, and its sums of rows. */
static void eliminate_mass(Beam *beam) {
    for (size_t n = 0; n < beam->nodes; n++) {
        const double after = n + 1 < beam->nodes ? beam->line_mass * beam->lengths[n] : 0.0;
        const double earlier = n > 0 ? beam->line_mass * beam->lengths[n - 1] : 0.0;
        beam->weights[n] = 0.5 * (after + earlier);
        beam->pivots[n] = (after + earlier) / 3.0;
        if (n > 0) beam->pivots[n] -= beam->ratios[n - 1] * earlier / 6.0;
        beam->ratios[n] = after / 6.0 / beam->pivots[n];
    }
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Beam *beam = allocate(memory, sizeof *beam);
    if (!beam) {
        refuse(why, "no memory for a beam");
        return NULL;
    }
    if (!read_sizes(beam, data, sizes, why) || !read_arrays(beam, data, memory, why) ||
        !allocate_work(beam, memory, why))
        return NULL;
    eliminate_mass(beam);
    *states = beam->states;
    return beam;
}

#endif
