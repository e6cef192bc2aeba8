/* An assembly of components with its master as one component: its structures, from data that orchestrator/run/as_one
   writes. Nothing in them is trusted where it is an index. */

#ifndef FANFOLD_ASSEMBLY_MODEL_H
#define FANFOLD_ASSEMBLY_MODEL_H

#include <stdint.h>
#include <stdio.h>

#include "alike.h"
#include "instance.h"

enum { FITTED = 4, RING = 6, SNAPSHOTS = 3 };

/* What follows from the tolerance: the largest, smallest and first steps (s) of the scene, at its start and after events,
   the tolerance below which they shrink, what iterations leave of the tolerance and at most, what a step may err by, and
   powers of the tolerance above that limit, of the coupling's order and of the second. */
enum {
    LARGEST_STEP, SMALLEST_STEP, START_STEP, REFERENCE_TOLERANCE, ITERATED, LEAST_ITERATED, MOST_ITERATED,
    ALLOWED_SHARE, LOOSE, LOOSE_AT_ORDER_2, OF_TOLERANCE
};

/* An input of the assembly: releases a participant (is_release), or latches a line. */
typedef struct {
    size_t is_release, line;
    Place release;
} Command;

/* Rates and accelerations of a driven base: its participant, the place of the rates of its accelerations among the inputs
   of that and of the others in the state, and of the DRIVES numbers among the assembly's inputs. */
typedef struct {
    size_t is_there, participant, change, rate[2], acceleration[2], first;
} DrivenFrame;

enum { BASE_RATES = 6, DRIVES = 12 };

/* Of a load's peak: where its numbers stand among what is recorded, and whether they add up or are components. */
typedef struct {
    size_t is_sum, count;
    const size_t *place;
} Peak;

/* first_parameter, first_input: by participant, among those of all. Numbers of a run that a saved state holds lie in one
   array `standing`, but for the states and inputs of participants. Parameters: those that the host has set last
   (wanted), those of them that the run knows of (applied), and those that participants have (in_force). A run starts from the states, inputs and wrenches at rest, where the scene has a
   preload; otherwise these are NULL.

   A component's state: OUTER numbers, see below, applied parameters, inputs, peaks, rows of the ring (time, segment,
   recorded, channels), and snapshots in slots: serial, time, standing, states, inputs. `stands` tells whether all
   this is that of the state numbered `serial`; run_serial numbers what the run itself has come to. driven_step,
   longest_step (s): the last one that the base was driven over, and the longest, 0 before. meets_rates: whether the base
   has the rates given to it at a step's end. */
typedef struct {
    Master master;
    Instance **instance;
    SavedState **saved;
    double **input;
    size_t *first_parameter, *first_input;
    Command *command;
    Peak *peak;
    const size_t *flag; /* (flags,) places of observations that are 0 or 1 */
    DrivenFrame driven;
    NotedSteps noted;
    double *standing, *scalars, *in_force, *wanted, *applied, *inputs, *peaks, *ring, *snapshot;
    const double *rest_states, *rest_inputs, *rest_wrenches, *by_tolerance;
    size_t participants, flags, commands, inputs_count, peak_count, row_size, standing_size, snapshot_size, parameter_count, input_count;
    size_t rows, snapshots, newest, states;
    double time, serial, run_serial, last_run, peak_time, last_row_time, target, driven_step, longest_step;
    int stands, at_event, meets_rates;
    char said[512];
} Assembly;

/* Numbers that come first in a state. */
enum { AT_TIME, AT_SERIAL, AT_RUN, AT_SNAPSHOTS, AT_NEWEST, AT_ROWS, AT_PEAK_TIME, AT_DRIVEN, AT_LONGEST, AT_STEPS, AT_REJECTED, AT_EVENT, OUTER };
/* Whether a communication point is an event, which the run has gone through without going on; what is read there is what
   was before the event or what came out of it. */
enum { NO_EVENT, BEFORE_EVENT, AFTER_EVENT };

/* Numbers of the master that are in no array. */
enum { SCALARS = 40 };

/* Whole numbers of the data as they are used. */
static const size_t *whole_numbers(const Data *data, const char *name, size_t *count, Memory *memory, Reason *why) {
    const double *numbers = data_any(data, name, count, why);
    size_t *found = numbers ? allocate(memory, (*count + 1) * sizeof(size_t)) : NULL;
    for (size_t i = 0; found && i < *count; i++) {
        if (!(numbers[i] >= 0.0 && numbers[i] < 1e9)) {
            refuse(why, "the assembly's %s are no whole numbers", name);
            return NULL;
        }
        found[i] = (size_t)numbers[i];
    }
    return found;
}

static const size_t *counted_numbers(const Data *data, const char *name, size_t count, Memory *memory, Reason *why) {
    size_t found = 0;
    const size_t *numbers = whole_numbers(data, name, &found, memory, why);
    if (numbers && found != count) {
        refuse(why, "the assembly has %lu numbers for %s; it takes %lu", (unsigned long)found, name,
               (unsigned long)count);
        return NULL;
    }
    return numbers;
}

/* The sentence of a participant that failed last. */
static void note_sentence(void *host, Status status, const char *sentence) {
    Assembly *a = host;
    if (status > STATUS_WARNING) snprintf(a->said, sizeof a->said, "%s", sentence);
}

static int set_real_of(void *c, const unsigned *references, size_t count, const double *values) {
    return instance_set(c, references, count, values);
}
static int get_real_of(void *c, const unsigned *references, size_t count, double *values) {
    return instance_get(c, references, count, values);
}
static int do_step_of(void *c, double time, double h, int keep) {
    (void)keep;
    return instance_step(c, time, h);
}
static int get_state_of(void *c, void **state) { return instance_save(c, (SavedState **)state); }
static int set_state_of(void *c, void *state) { return instance_restore(c, state); }
static int free_state_of(void *c, void **state) {
    (void)c;
    return instance_forget((SavedState **)state);
}
static int derivative_of(void *c, const unsigned *unknowns, size_t unknown_count, const unsigned *knowns, size_t count,
                         const double *seed, double *result) {
    return instance_derivative(c, unknowns, unknown_count, knowns, count, seed, result);
}
static int port_stiffness_of(void *c, size_t ports, double *matrix) {
    return instance_port_stiffness(c, ports, matrix);
}

static const unsigned *references_from(size_t first, size_t count, Memory *memory) {
    unsigned *found = allocate(memory, (count + 1) * sizeof(unsigned));
    for (size_t i = 0; found && i < count; i++) found[i] = (unsigned)(first + i);
    return found;
}

/* One participant: its instance, and how it is called. numbers: inputs and outputs exchanged, ports, where slopes and
   moments begin, whether it never moves. */
static int create_participant(Assembly *a, const Data *data, size_t i, const size_t *numbers, Memory *memory,
                              Reason *why) {
    char entry[40];
    size_t size = 0;
    snprintf(entry, sizeof entry, "part:%lu", (unsigned long)i);
    const char *bytes = data_bytes(data, entry, &size);
    snprintf(entry, sizeof entry, "name:%lu", (unsigned long)i);
    const char *name = data_text(data, entry);
    if (!bytes || !name) return refuse(why, "the assembly's participant %lu is missing", (unsigned long)i + 1);
    Instance *instance = a->instance[i] = instance_create_inside(name, bytes, size, note_sentence, a);
    if (!instance) return refuse(why, "%s", a->said);
    Participant *p = a->master.network.participant + i;
    const Sizes *sizes = &instance->sizes;
    if (numbers[0] > sizes->inputs || numbers[1] > sizes->outputs)
        return refuse(why, "the assembly exchanges more with %s than that has", name);
    *p = (Participant){.component = instance,
                       .set_real = set_real_of,
                       .get_real = get_real_of,
                       .do_step = do_step_of,
                       .get_state = get_state_of,
                       .set_state = set_state_of,
                       .free_state = free_state_of,
                       .derivative = derivative_of,
                       .port_stiffness = port_stiffness_of,
                       .input_references = references_from(instance->ends[0], sizes->inputs, memory),
                       .output_references = references_from(instance->ends[1], sizes->outputs, memory),
                       .observation_references = references_from(instance->ends[2], sizes->observations, memory),
                       .inputs = numbers[0],
                       .outputs = numbers[1],
                       .observations = sizes->observations,
                       .overwrites_state = 1,
                       .ports = numbers[2],
                       .slopes = numbers[3],
                       .moments = numbers[4]};
    a->input[i] = p->input = allocate(memory, (sizes->inputs + 1) * sizeof(double));
    p->output = allocate(memory, (sizes->outputs + 1) * sizeof(double));
    p->saved = (void **)(a->saved + i);
    const size_t turned = a->master.network.width.wrench * a->master.network.width.coordinates * p->ports * p->ports;
    p->turned = numbers[5] ? NULL : allocate(memory, (turned + 1) * sizeof(double));
    if (!p->input_references || !p->output_references || !p->observation_references || !p->input || !p->output ||
        !(numbers[5] || p->turned))
        return refuse(why, "no memory for %s", name);
    memcpy(p->input, instance->start + instance->ends[0], sizes->inputs * sizeof(double));
    return 1;
}

/* Participants with their ports, what they share, and where each one's numbers are among those of all. */
static int create_participants(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    enum { COLUMNS = 6 };
    Network *n = &a->master.network;
    size_t links = 0, most = 0, all = 0, *first_link;
    const size_t *table = counted_numbers(data, "participants", COLUMNS * n->participants, memory, why);
    const size_t *port_links = whole_numbers(data, "port_links", &links, memory, why);
    if (!table || !port_links) return 0;
    const size_t count = n->participants;
    a->participants = count;
    a->instance = allocate(memory, (count + 1) * sizeof *a->instance);
    a->saved = allocate(memory, (count + 1) * sizeof *a->saved);
    a->input = allocate(memory, (count + 1) * sizeof *a->input);
    a->first_parameter = allocate(memory, (count + 1) * sizeof(size_t));
    a->first_input = allocate(memory, (count + 1) * sizeof(size_t));
    n->participant = allocate(memory, (count + 1) * sizeof *n->participant);
    first_link = allocate(memory, (count + 1) * sizeof(size_t));
    if (!a->instance || !a->saved || !a->input || !a->first_parameter || !a->first_input || !n->participant ||
        !first_link)
        return refuse(why, "no memory for %lu participants", (unsigned long)count);
    for (size_t i = 0; i < count; i++) {
        if (!create_participant(a, data, i, table + COLUMNS * i, memory, why)) return 0;
        const Instance *instance = a->instance[i];
        a->first_parameter[i + 1] = a->first_parameter[i] + instance->sizes.parameters;
        a->first_input[i + 1] = a->first_input[i] + instance->sizes.inputs;
        a->states += instance->states;
        first_link[i + 1] = first_link[i] + n->participant[i].ports;
        most = instance->sizes.outputs > most ? instance->sizes.outputs : most;
        all += instance->sizes.observations;
    }
    if (links != first_link[count] || links != 2 * n->links)
        return refuse(why, "the assembly links %lu ports of %lu", (unsigned long)links, (unsigned long)first_link[count]);
    for (size_t i = 0; i < links; i++)
        if (port_links[i] >= n->links) return refuse(why, "the assembly has no link %lu", (unsigned long)port_links[i]);
    n->observations = allocate(memory, (all + 2) * sizeof(double));
    a->master.solver.jacobians.slope = allocate(memory, (most + n->size + 1) * sizeof(double));
    if (!n->observations || !a->master.solver.jacobians.slope) return refuse(why, "no memory for observations");
    double *observation = n->observations;
    for (size_t i = 0; i < count; i++) {
        n->participant[i].links = port_links + first_link[i];
        n->participant[i].observation = observation;
        observation += n->participant[i].observations;
    }
    return 1;
}

/* Whether all of `count` indices, each `apart` from the next, are below `end`. */
static int are_below(const size_t *indices, size_t count, size_t apart, size_t end) {
    for (size_t i = 0; i < count; i++)
        if (indices[i * apart] >= end) return 0;
    return 1;
}

/* Whether indices [0, count] rise to `end`. */
static int rise_to(const size_t *begin, size_t count, size_t end) {
    for (size_t i = 0; i < count; i++)
        if (begin[i] > begin[i + 1]) return 0;
    return begin[count] == end;
}

/* Whether every block lies within the groups and the room of the matrix, the first ones on its diagonal. */
static int are_within(const Matrix *m) {
    if (m->block_count < m->groups) return 0;
    for (size_t k = 0; k < m->block_count; k++) {
        const MatrixBlock *block = m->blocks + k;
        if (block->row_group >= m->groups || block->column_group >= m->groups) return 0;
        const size_t rows = m->begin[block->row_group + 1] - m->begin[block->row_group];
        const size_t columns = m->begin[block->column_group + 1] - m->begin[block->column_group];
        if (block->first > columns || block->columns > columns - block->first || block->offset > m->length ||
            rows * block->columns > m->length - block->offset)
            return 0;
        if (k < m->groups && (block->row_group != k || block->column_group != k || block->columns != rows)) return 0;
    }
    return 1;
}

/* Pairs of a block below and one right of the diagonal, each of which has a target. */
static size_t pairs_of(const Matrix *m) {
    size_t pairs = 0;
    for (size_t k = 0; k < m->groups; k++)
        pairs += (m->lower_begin[k + 1] - m->lower_begin[k]) * (m->upper_begin[k + 1] - m->upper_begin[k]);
    return pairs;
}

/* Whether 6 x 6 (or fewer) parts lie within the matrix. */
static int are_parts_within(const Part *part, size_t count, size_t width, size_t length) {
    for (size_t i = 0; i < count; i++) {
        if (part[i].stride > length || part[i].offset > length) return 0;
        if ((width - 1) * part[i].stride + width > length - part[i].offset) return 0;
    }
    return 1;
}

/* Links, tables of the linear system, and all room of the network. */
static int create_network(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Network *n = &a->master.network;
    Matrix *m = &n->matrix;
    size_t groups = 0, blocks = 0, lower = 0, upper = 0, targets = 0, parts = 0, largest = 0;
    const size_t *link = counted_numbers(data, "links", 5 * n->links, memory, why);
    const size_t *length = counted_numbers(data, "matrix_length", 1, memory, why);
    m->begin = whole_numbers(data, "matrix_begin", &groups, memory, why);
    m->blocks = (const MatrixBlock *)whole_numbers(data, "matrix_blocks", &blocks, memory, why);
    m->lower = whole_numbers(data, "matrix_lower", &lower, memory, why);
    m->upper = whole_numbers(data, "matrix_upper", &upper, memory, why);
    m->targets = whole_numbers(data, "matrix_targets", &targets, memory, why);
    n->parts = (const Part *)whole_numbers(data, "matrix_parts", &parts, memory, why);
    if (!link || !length || !m->begin || !m->blocks || !m->lower || !m->upper || !m->targets || !n->parts || !groups)
        return 0;
    m->lower_begin = counted_numbers(data, "matrix_lower_begin", groups, memory, why);
    m->upper_begin = counted_numbers(data, "matrix_upper_begin", groups, memory, why);
    n->energy_rows = counted_numbers(data, "energy_rows", ENERGIES * n->participants, memory, why);
    if (!m->lower_begin || !m->upper_begin || !n->energy_rows) return 0;
    m->groups = groups - 1;
    m->block_count = blocks / 5;
    m->size = n->size;
    m->length = *length;
    if (!rise_to(m->begin, m->groups, n->size) || !rise_to(m->lower_begin, m->groups, lower) ||
        !rise_to(m->upper_begin, m->groups, upper) || !are_within(m) || pairs_of(m) != targets ||
        !are_below(m->targets, targets, 1, m->block_count) || !are_below(m->lower, lower, 1, m->block_count) ||
        !are_below(m->upper, upper, 1, m->block_count) ||
        !are_parts_within(n->parts, parts / 2, n->width.wrench, m->length) || !are_below(link, n->links, 5, n->bodies) ||
        !are_below(link + 2, n->links, 5, n->participants) || !are_below(link + 4, n->links, 5, n->size))
        return refuse(why, "the tables of the assembly's matrix are damaged");
    n->link = (const Link *)link;
    n->energy_kinds = ENERGIES;
    for (size_t i = 0; i < n->participants; i++) {
        const size_t rows = n->width.wrench * n->participant[i].ports;
        for (size_t k = 0; k < n->participants; k++) {
            const size_t room = rows * n->width.wrench * n->participant[k].ports;
            largest = room > largest ? room : largest;
        }
    }
    double **arrays[] = {&n->wrenches, &n->law, &n->residual, &n->scale, &n->round_off, &n->bend, &n->noise};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i] = allocate(memory, (n->size + 1) * sizeof(double));
        if (!*arrays[i]) return refuse(why, "no memory for %lu wrenches", (unsigned long)n->size);
    }
    n->steps = allocate(memory, (n->limits.most + 1) * n->size * sizeof(double));
    n->squares = allocate(memory, (n->limits.most + 1) * sizeof(double));
    n->product = allocate(memory, (largest + 1) * sizeof(double));
    n->energies = allocate(memory, ENERGIES * sizeof(double));
    m->values = allocate(memory, (m->length + 1) * sizeof(double));
    m->transposed = allocate(memory, (m->length + 1) * sizeof(double));
    m->ordered = allocate(memory, (n->size + 1) * sizeof(double));
    m->pivots = allocate(memory, (n->size + 1) * sizeof(size_t));
    if (!n->steps || !n->squares || !n->product || !n->energies || !m->values || !m->transposed || !m->ordered ||
        !m->pivots)
        return refuse(why, "no memory for a matrix of %lu numbers", (unsigned long)m->length);
    return 1;
}

/* Room for the matrices of as many step sizes as are kept. */
static int create_jacobians(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Network *n = &a->master.network;
    Jacobians *j = &a->master.solver.jacobians;
    const size_t *constant = counted_numbers(data, "constant_mobility", n->bodies, memory, why);
    unsigned char *constants = allocate(memory, n->bodies + 1);
    size_t largest = n->size;
    j->first = allocate(memory, (n->participants + 1) * sizeof(size_t));
    if (!constant || !constants || !j->first) return 0;
    for (size_t i = 0; i < n->bodies; i++) constants[i] = (unsigned char)constant[i];
    j->constant = constants;
    for (size_t i = 0; i < n->participants; i++) {
        const size_t size = block_size(n, i) + 9;
        j->first[i + 1] = j->first[i] + size;
        largest = size > largest ? size : largest;
    }
    j->length = j->first[n->participants];
    j->guess = allocate(memory, (largest + 1) * sizeof(double));
    j->kept = allocate(memory, (largest + 1) * sizeof(double));
    if (!j->guess || !j->kept) return refuse(why, "no memory for matrices");
    for (SizedJacobian *one = j->sizes; one < j->sizes + KEPT_SIZES; one++) {
        one->numbers = allocate(memory, (j->length + 1) * sizeof(double));
        JacobianBlock *block = allocate(memory, (n->participants + 1) * sizeof *block);
        if (!one->numbers || !block) return refuse(why, "no memory for matrices of %lu numbers", (unsigned long)j->length);
        for (size_t i = 0; i < n->participants; i++) {
            const double *first = one->numbers + j->first[i];
            block[i] = (JacobianBlock){first, first + block_size(n, i)};
        }
        one->mobility = block;
        one->stiffness = block + n->bodies;
    }
    return 1;
}

/* Places in what follows one after the other: a count, then as many numbers, and so on. */
typedef struct {
    const size_t *numbers;
    size_t left;
} Reader;

static size_t next_number(Reader *r) { return r->left ? (r->left--, *r->numbers++) : 0; }

static const size_t *next_numbers(Reader *r, size_t count) {
    const size_t *found = r->numbers;
    if (count > r->left) return NULL;
    r->left -= count;
    r->numbers += count;
    return found;
}

/* Lines: hinges, whether kinematic, whether it latches, sensor; then the participants of the hinges. */
static int create_lines(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Master *m = &a->master;
    const Network *n = &m->network;
    Reader r = {NULL, 0};
    size_t all = 0;
    r.numbers = whole_numbers(data, "lines", &r.left, memory, why);
    m->latch_distance = counted_numbers(data, "latch_distance", n->participants, memory, why);
    m->latch_command = counted_numbers(data, "latch_command", n->participants, memory, why);
    m->angular_rate = counted_numbers(data, "angular_rate", n->participants, memory, why);
    if (!r.numbers || !m->latch_distance || !m->latch_command || !m->angular_rate) return 0;
    for (size_t i = 0; i < n->participants; i++) all += n->participant[i].observations;
    m->lines = next_number(&r);
    if (m->lines > n->participants) return refuse(why, "the assembly's hinge lines are damaged");
    m->line = allocate(memory, (m->lines + 1) * sizeof *m->line);
    if (!m->line) return refuse(why, "no memory for hinge lines");
    for (HingeLine *line = m->line; line < m->line + m->lines; line++) {
        line->hinges = next_number(&r);
        line->is_kinematic = next_number(&r);
        line->hinge = line->hinges <= MOST_HINGES ? next_numbers(&r, line->hinges) : NULL;
        if (!line->hinge || !line->hinges) return refuse(why, "a hinge line has 1 to %d hinges", MOST_HINGES);
        for (size_t i = 0; i < line->hinges; i++) {
            const size_t hinge = line->hinge[i];
            if (hinge < n->bodies || hinge >= n->participants || n->participant[hinge].ports != HINGE_PORTS ||
                m->latch_distance[hinge] >= n->participant[hinge].outputs ||
                m->latch_command[hinge] >= n->participant[hinge].inputs || m->angular_rate[hinge] >= all)
                return refuse(why, "a hinge line has no hinge %lu", (unsigned long)hinge);
        }
    }
    return 1;
}

/* Stops and contacts: participant, and place of its penetration among all observations; room to judge their loads and
   those of lines. */
static int create_strikes(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Master *m = &a->master;
    const Network *n = &m->network;
    size_t numbers = 0, all = 0;
    const size_t *number = whole_numbers(data, "strikes", &numbers, memory, why);
    if (!number) return 0;
    m->strikes = numbers / 2;
    m->strike = allocate(memory, (m->strikes + 1) * sizeof *m->strike);
    m->striking = allocate(memory, (m->strikes + 1) * sizeof *m->striking);
    m->watched = allocate(memory, (m->lines + m->strikes + 1) * MOST_HINGES * sizeof *m->watched);
    if (!m->strike || !m->striking || !m->watched) return refuse(why, "no memory for stops and contacts");
    for (size_t i = 0; i < n->participants; i++) all += n->participant[i].observations;
    for (size_t i = 0; i < m->strikes; i++) {
        const size_t participant = number[2 * i], place = number[2 * i + 1];
        if (participant < n->bodies || participant >= n->participants ||
            n->participant[participant].ports != HINGE_PORTS || place >= all)
            return refuse(why, "the assembly's stops and contacts are damaged");
        m->strike[i].participant = participant;
        m->strike[i].place = n->observations + place;
    }
    return 1;
}

/* An input of a participant, exchanged in every sweep. */
static int place_holds(const Network *n, Place at) {
    return at.participant < n->participants && at.place < n->participant[at.participant].inputs;
}

/* Events: releases, latches, settings; then the releases, latches and settings. Beside them times, conditions and
   values. */
static int create_events(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Master *m = &a->master;
    Network *n = &m->network;
    Reader r = {NULL, 0};
    size_t values = 0, impulses = 0;
    r.numbers = whole_numbers(data, "events", &r.left, memory, why);
    const double *value = data_any(data, "event_values", &values, why);
    const size_t *impulse = whole_numbers(data, "impulses", &impulses, memory, why);
    if (!r.numbers || !value || !impulse) return 0;
    m->impulse = (const Place *)impulse;
    m->impulses = impulses / 2;
    for (size_t i = 0; i < m->impulses; i++)
        if (!place_holds(n, m->impulse[i])) return refuse(why, "the assembly's impulses are damaged");
    m->events = next_number(&r);
    m->event = allocate(memory, (m->events + 1) * sizeof *m->event);
    m->crossing = allocate(memory, (m->events + m->lines + 1) * sizeof *m->crossing);
    if (m->events > r.left + 1 || !m->event || !m->crossing) return refuse(why, "no memory for events");
    const double *end = value + values, *observed = n->observations;
    size_t all = 0;
    for (size_t i = 0; i < n->participants; i++) all += n->participant[i].observations;
    for (Event *e = m->event; e < m->event + m->events; e++) {
        const size_t place = next_number(&r);
        e->releases = next_number(&r);
        e->latches = next_number(&r);
        e->settings = next_number(&r);
        e->release = (const Place *)next_numbers(&r, 2 * e->releases);
        e->latch = next_numbers(&r, e->latches);
        const size_t *set = next_numbers(&r, 2 * e->settings);
        Setting *setting = allocate(memory, (e->settings + 1) * sizeof *setting);
        if (!e->release || !e->latch || !set || !setting || place > all || (size_t)(end - value) < 3 + e->settings)
            return refuse(why, "the assembly's events are damaged");
        e->time = value[0];
        e->condition = (Crossing){observed + place, value[1], value[2], 0.0};
        value += 3;
        for (size_t i = 0; i < e->releases; i++)
            if (!place_holds(n, e->release[i])) return refuse(why, "an event of the assembly releases nothing");
        if (!are_below(e->latch, e->latches, 1, m->lines)) return refuse(why, "an event latches no line");
        for (size_t i = 0; i < e->settings; i++) {
            setting[i] = (Setting){set[2 * i], set[2 * i + 1], *value++};
            if (setting[i].participant >= n->participants ||
                setting[i].place >= a->instance[setting[i].participant]->sizes.parameters)
                return refuse(why, "an event of the assembly sets nothing");
        }
        e->setting = setting;
    }
    return 1;
}

/* Whether a driven frame has all its places; its inputs come behind the commands. */
static int drives(const Assembly *a, const Sizes *sizes) {
    const DrivenFrame *d = &a->driven;
    if (d->participant >= a->participants || sizes->inputs < DRIVES || d->first != sizes->inputs - DRIVES) return 0;
    const Instance *instance = a->instance[d->participant];
    int fit = d->change + 6 <= instance->sizes.inputs;
    for (size_t i = 0; i < 2; i++)
        fit &= d->rate[i] + 3 <= instance->states && d->acceleration[i] + 3 <= instance->states;
    return fit;
}

/* Commands from outside, in the order of the inputs: kind (1: releases), participant and place, or line. */
static int create_commands(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    const size_t *driven = counted_numbers(data, "driven", 8, memory, why);
    if (!driven) return 0;
    a->driven = (DrivenFrame){driven[0], driven[1], driven[2], {driven[3], driven[4]}, {driven[5], driven[6]}, driven[7]};
    if (a->driven.is_there && !drives(a, sizes)) return refuse(why, "the assembly drives what it has not");
    const size_t drives = a->driven.is_there ? DRIVES : 0;
    const size_t *table = counted_numbers(data, "commands", 3 * (sizes->inputs - drives), memory, why);
    a->inputs_count = sizes->inputs;
    a->commands = sizes->inputs - drives;
    a->command = allocate(memory, (a->commands + 1) * sizeof *a->command);
    if (!table || !a->command) return 0;
    for (size_t i = 0; i < a->commands; i++, table += 3) {
        a->command[i] = (Command){table[0], table[0] ? 0 : table[1], {table[1], table[2]}};
        if (table[0] ? !place_holds(&a->master.network, a->command[i].release) : table[1] >= a->master.lines)
            return refuse(why, "the assembly's input %lu commands nothing", (unsigned long)i + 1);
    }
    return 1;
}

/* Peaks: how many; then of each whether it is a sum, how many numbers, and their places. */
static int create_peaks(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    Reader r = {NULL, 0};
    r.numbers = whole_numbers(data, "peaks", &r.left, memory, why);
    if (!r.numbers) return 0;
    a->peak_count = next_number(&r);
    a->peak = a->peak_count <= sizes->outputs ? allocate(memory, (a->peak_count + 1) * sizeof *a->peak) : NULL;
    if (!a->peak) return refuse(why, "the assembly's peaks are damaged");
    for (Peak *peak = a->peak; peak < a->peak + a->peak_count; peak++) {
        peak->is_sum = next_number(&r);
        peak->count = next_number(&r);
        peak->place = next_numbers(&r, peak->count);
        if (!peak->place || !are_below(peak->place, peak->count, 1, sizes->observations))
            return refuse(why, "the assembly's peaks are damaged");
    }
    return 1;
}

/* Where rows go and what is recorded; numbers of step control and of the iteration. */
static int create_loop(Assembly *a, const Data *data, const Sizes *sizes, Memory *memory, Reason *why) {
    Master *m = &a->master;
    Loop *l = &m->loop;
    RowBlock *r = &l->rows;
    size_t corrected = 0, laws = 0, all = 0;
    const size_t *bolts = counted_numbers(data, "bolts", 1, memory, why);
    r->columns = sizes->observations;
    r->channels = CHANNELS;
    r->recorded = counted_numbers(data, "recorded", r->columns, memory, why);
    r->corrected = whole_numbers(data, "corrected", &corrected, memory, why);
    const Place *law = (const Place *)whole_numbers(data, "laws", &laws, memory, why);
    for (size_t i = 0; i < m->network.participants; i++) all += m->network.participant[i].observations;
    a->flag = whole_numbers(data, "flags", &a->flags, memory, why);
    if (!a->flag) return 0;
    if (!are_below(a->flag, a->flags, 1, r->columns)) return refuse(why, "the assembly's flags are damaged");
    if (!r->recorded || !r->corrected || !law || !bolts) return 0;
    if (*bolts > laws / 2) return refuse(why, "the assembly's hold-downs are damaged");
    if (!are_below(r->recorded, r->columns, 1, all) || !are_below(r->corrected, corrected, 1, all) ||
        !are_below(m->network.energy_rows, ENERGIES * m->network.participants, 1, all + 1))
        return refuse(why, "the assembly records what it has not");
    r->observations = all;
    r->corrections = corrected / 2;
    m->roughness = allocate(memory, (r->corrections + 1) * sizeof(double));
    if (!m->roughness) return 0;
    a->row_size = 2 + r->columns + CHANNELS;
    r->times = allocate(memory, 4 * sizeof(double));
    r->values = allocate(memory, 4 * a->row_size * sizeof(double));
    m->row_values = allocate(memory, a->row_size * sizeof(double));
    l->steps = allocate(memory, 4 * sizeof(double));
    const double **places = allocate(memory, (laws / 2 + 1) * sizeof *places);
    if (!r->times || !r->values || !m->row_values || !l->steps || !places) return refuse(why, "no memory for rows");
    for (size_t i = 0; i < laws / 2; i++) {
        if (law[i].participant >= m->network.participants ||
            law[i].place >= m->network.participant[law[i].participant].outputs)
            return refuse(why, "the assembly's motion laws are damaged");
        places[i] = m->network.participant[law[i].participant].output + law[i].place;
    }
    l->law = places;
    l->laws = laws / 2;
    l->bolts = *bolts;
    l->network = &m->network;
    l->sizes = &m->sizes;
    l->error = &m->error;
    l->guard = &m->guard;
    l->rules = &m->rules;
    l->capacity = 1;
    l->stop = l->until = INFINITY;
    return 1;
}

/* Texts `group:0`, `group:1` and so on. */
static const char **texts_of(const Data *data, const char *group, size_t count, Memory *memory, Reason *why) {
    char entry[40];
    const char **found = allocate(memory, (count + 1) * sizeof *found);
    for (size_t i = 0; found && i < count; i++) {
        snprintf(entry, sizeof entry, "%s:%lu", group, (unsigned long)i);
        found[i] = data_text(data, entry);
        if (!found[i]) {
            refuse(why, "the assembly's %s %lu has no name", group, (unsigned long)i + 1);
            return NULL;
        }
    }
    return found;
}

/* Where a scene with preload starts from. */
static int read_rest(Assembly *a, const Data *data, Reason *why) {
    Reason absent;
    size_t count = 0;
    if (!data_any(data, "rest_states", &count, &absent)) return 1;
    a->rest_states = data_array(data, "rest_states", a->states, why);
    a->rest_inputs = a->rest_states ? data_array(data, "rest_inputs", a->first_input[a->participants], why) : NULL;
    a->rest_wrenches = a->rest_inputs ? data_array(data, "rest_wrenches", a->master.network.size, why) : NULL;
    return a->rest_wrenches != NULL;
}

static int read_names(Assembly *a, const Data *data, Memory *memory, Reason *why) {
    Master *m = &a->master;
    m->link_name = texts_of(data, "link", m->network.links, memory, why);
    m->event_name = m->link_name ? texts_of(data, "event", m->events, memory, why) : NULL;
    return m->event_name != NULL;
}

/* Numbers of the master, in the order of their structures. */
static int read_settings(Assembly *a, const Data *data, Reason *why) {
    enum { NETWORK = 5, OF_LIMITS = 17, OF_RULES = 20, OF_MASTER = 4 };
    Master *m = &a->master;
    Network *n = &m->network;
    const double *sizes = data_array(data, "network", NETWORK, why), *limit = data_array(data, "limits", OF_LIMITS, why);
    const double *rule = data_array(data, "rules", OF_RULES, why), *own = data_array(data, "master", OF_MASTER, why);
    if (!sizes || !limit || !rule || !own) return 0;
    for (size_t i = 0; i < NETWORK; i++)
        if (!(sizes[i] >= 0.0 && sizes[i] < 1e6)) return refuse(why, "the assembly's network is damaged");
    n->participants = (size_t)sizes[0];
    n->bodies = (size_t)sizes[1];
    n->links = (size_t)sizes[2];
    n->width = width_of(sizes[3] == 4.0);
    n->size = n->width.wrench * n->links;
    if (n->bodies > n->participants) return refuse(why, "the assembly's network is damaged");
    Limits *of = &n->limits;
    double *plain[] = {&of->slow,     &of->diverged, &of->steepest, &of->round_off, &of->near,
                       &of->credible, &of->agreed,   &of->overshot, &of->rough,     &of->least_reach,
                       &of->no_load};
    const size_t numbers = sizeof plain / sizeof *plain;
    size_t *whole[] = {&of->patience, &of->most, &of->halvings, of->refreshed, of->refreshed + 1, of->refreshed + 2};
    for (size_t i = 0; i < numbers; i++) *plain[i] = limit[i];
    for (size_t i = 0; i < 6; i++) {
        const double count = limit[numbers + i];
        if (!(count >= 0.0 && count < 1e3)) return refuse(why, "the assembly's limits are damaged");
        *whole[i] = (size_t)count;
    }
    Rules *r = &m->rules;
    *r = (Rules){rule[0],  rule[1],  rule[2],  rule[3],  rule[4],  rule[5],  (ptrdiff_t)rule[6],
                 (ptrdiff_t)rule[7],  (ptrdiff_t)rule[8],  (ptrdiff_t)rule[9],  (ptrdiff_t)rule[10],
                 (ptrdiff_t)rule[11], rule[12], rule[13], rule[14], rule[15], rule[16], rule[17], rule[18], rule[19]};
    n->tolerance = (Tolerance){0.0, own[0], own[1], 0.0};
    m->sizes.order = (size_t)own[2];
    m->driving_energy = own[3];
    a->by_tolerance = data_array(data, "by_tolerance", OF_TOLERANCE, why);
    return a->by_tolerance != NULL;
}

#endif
