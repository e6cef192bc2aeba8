/* A coupling from tables; every index in them is checked. */

#include "tables.h"

#include <math.h>
#include <string.h>

#include "convergence.h"
#include "dense_lu.h"
#include "system.h"

const size_t *whole_numbers(const Data *data, const char *name, size_t *count, Memory *memory, Reason *why) {
    const double *numbers = data_any(data, name, count, why);
    size_t *found = numbers ? allocate(memory, (*count + 1) * sizeof(size_t)) : NULL;
    for (size_t i = 0; found && i < *count; i++) {
        if (!(numbers[i] >= 0.0 && numbers[i] < 1e9)) {
            refuse(why, "the tables' %s are no whole numbers", name);
            return NULL;
        }
        found[i] = (size_t)numbers[i];
    }
    return found;
}

const size_t *counted_numbers(const Data *data, const char *name, size_t count, Memory *memory, Reason *why) {
    size_t found = 0;
    const size_t *numbers = whole_numbers(data, name, &found, memory, why);
    if (numbers && found != count) {
        refuse(why, "the tables have %lu numbers for %s; they take %lu", (unsigned long)found, name,
               (unsigned long)count);
        return NULL;
    }
    return numbers;
}

size_t next_number(Reader *r) { return r->left ? (r->left--, *r->numbers++) : 0; }

const size_t *next_numbers(Reader *r, size_t count) {
    const size_t *found = r->numbers;
    if (count > r->left) return NULL;
    r->left -= count;
    r->numbers += count;
    return found;
}

int are_below(const size_t *indices, size_t count, size_t apart, size_t end) {
    for (size_t i = 0; i < count; i++)
        if (indices[i * apart] >= end) return 0;
    return 1;
}

int is_input(const Network *n, Place at) {
    return at.participant < n->participants && at.place < n->participant[at.participant].inputs;
}

/* How many observations all participants have. */
static size_t all_observations(const Network *n) {
    size_t all = 0;
    for (size_t i = 0; i < n->participants; i++) all += n->participant[i].observations;
    return all;
}

/* Room for so many numbers; a sentence where there is none. */
static double *room_for(size_t count, Memory *memory, Reason *why) {
    double *found = allocate(memory, (count + 1) * sizeof(double));
    if (!found) refuse(why, "no memory for %lu numbers", (unsigned long)count);
    return found;
}

/* Sizes of the network, and numbers of the scene. */
static int read_sizes(Coupling *c, const Data *data, size_t count, Reason *why) {
    enum { OF_NETWORK = 4, OF_SCENE = 3, OF_TOLERANCE = 6 };
    Network *n = &c->network;
    const double *sizes = data_array(data, "network", OF_NETWORK, why), *own = data_array(data, "scene", OF_SCENE, why);
    c->by_tolerance = data_array(data, "by_tolerance", OF_TOLERANCE, why);
    if (!sizes || !own || !c->by_tolerance) return 0;
    for (size_t i = 0; i < OF_NETWORK; i++)
        if (!(sizes[i] >= 0.0 && sizes[i] < 1e6)) return refuse(why, "the tables of the network are damaged");
    n->participants = (size_t)sizes[0];
    n->bodies = (size_t)sizes[1];
    n->links = (size_t)sizes[2];
    n->width = width_of(sizes[3] == 4.0);
    n->size = n->width.wrench * n->links;
    if (n->bodies > n->participants || n->participants != count)
        return refuse(why, "the tables of the network are damaged");
    n->tolerance = (Tolerance){0.0, own[0], own[1], 0.0};
    c->sizes.order = (size_t)sizes[3];
    c->driving_energy = own[2];
    return 1;
}

/* Create a participant. numbers: how many inputs and outputs are exchanged, ports, where slopes and moments begin,
   whether it never moves, and whether it moves as a rigid body. */
static int create_participant(Network *n, size_t i, const Participant *given, const size_t *numbers, Memory *memory,
                              Reason *why) {
    Participant *p = n->participant + i;
    if (numbers[0] > given->inputs || numbers[1] > given->outputs)
        return refuse(why, "the tables exchange more with participant %lu than that has", (unsigned long)i + 1);
    *p = *given;
    p->inputs = numbers[0];
    p->outputs = numbers[1];
    p->ports = numbers[2];
    p->slopes = numbers[3];
    p->moments = numbers[4];
    const int is_body = i < n->bodies;
    const size_t wrenches = WRENCH * p->ports, motions = MOTION * p->ports, moments = MOMENTS * p->ports;
    if ((is_body ? wrenches : motions) > p->inputs || (is_body ? motions : wrenches) > p->outputs ||
        (p->slopes && p->slopes + wrenches > (is_body ? p->inputs : p->outputs)) ||
        (p->moments && p->moments + moments > (is_body ? p->outputs : p->inputs)))
        return refuse(why, "participant %lu has no room for its ports", (unsigned long)i + 1);
    const Width width = n->width;
    const int never_moves = numbers[5] != 0, is_rigid = numbers[6] != 0;
    p->turned = never_moves ? NULL : room_for(width.wrench * width.coordinates * p->ports * p->ports, memory, why);
    p->rigid = is_rigid ? room_for((width.wrench + width.coordinates) * width.wrench * p->ports, memory, why) : NULL;
    return (never_moves || p->turned) && (!is_rigid || p->rigid);
}

/* Create participants with their ports, and what they share. */
static int create_participants(Coupling *c, const Data *data, const Participant *given, Memory *memory, Reason *why) {
    enum { COLUMNS = 7 };
    Network *n = &c->network;
    size_t links = 0, most = 0, first = 0;
    const size_t *table = counted_numbers(data, "participants", COLUMNS * n->participants, memory, why);
    const size_t *port_links = whole_numbers(data, "port_links", &links, memory, why);
    n->participant = allocate(memory, (n->participants + 1) * sizeof *n->participant);
    if (!table || !port_links || !n->participant) return 0;
    for (size_t i = 0; i < n->participants; i++) {
        if (!create_participant(n, i, given + i, table + COLUMNS * i, memory, why)) return 0;
        const size_t room = given[i].inputs + given[i].outputs;
        most = room > most ? room : most;
        first += n->participant[i].ports;
    }
    if (links != first || links != 2 * n->links || !are_below(port_links, links, 1, n->links))
        return refuse(why, "the tables link %lu ports of %lu", (unsigned long)links, (unsigned long)first);
    n->observations = room_for(all_observations(n) + 1, memory, why);
    c->solver.jacobians.slope = room_for(most + n->size, memory, why);
    if (!n->observations || !c->solver.jacobians.slope) return 0;
    double *observation = n->observations;
    for (size_t i = 0; i < n->participants; i++) {
        Participant *p = n->participant + i;
        p->links = port_links;
        p->observation = observation;
        port_links += p->ports;
        observation += p->observations;
    }
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
        if (rows % CHUNK || block->columns % CHUNK) return 0;
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

/* How many parts of the matrix connections are added to. */
static size_t parts_of(const Network *n) {
    size_t parts = 0;
    for (const Participant *p = n->participant + n->bodies; p < n->participant + n->participants; p++)
        for (size_t i = 0; i < p->ports * p->ports; i++) {
            const Participant *row = n->participant + n->link[p->links[i / p->ports]].body;
            const Participant *column = n->participant + n->link[p->links[i % p->ports]].body;
            if (row->turned) parts += unknowns_of(column, n->width) / n->width.wrench;
        }
    return parts;
}

/* Whether links join ports that there are, and the unknowns of all bodies have rows. */
static int are_links_sound(const Network *n, size_t size) {
    for (const Link *l = n->link; l < n->link + n->links; l++) {
        if (l->body >= n->bodies || l->connection < n->bodies || l->connection >= n->participants) return 0;
        const Participant *body = n->participant + l->body, *connection = n->participant + l->connection;
        if (l->body_port >= body->ports || l->connection_port >= connection->ports) return 0;
        if (body->turned && l->place + n->width.wrench > size) return 0;
    }
    return 1;
}

/* Create links, tables of the linear system, and all arrays of the network. */
static int create_network(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    Network *n = &c->network;
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
    m->size = m->begin[m->groups];
    m->length = *length;
    if (m->size > n->size || !rise_to(m->begin, m->groups, m->size) || !rise_to(m->lower_begin, m->groups, lower) ||
        !rise_to(m->upper_begin, m->groups, upper) || !are_within(m) || pairs_of(m) != targets ||
        !are_below(m->targets, targets, 1, m->block_count) || !are_below(m->lower, lower, 1, m->block_count) ||
        !are_below(m->upper, upper, 1, m->block_count) ||
        !are_parts_within(n->parts, parts / 2, n->width.wrench, m->length))
        return refuse(why, "the tables of the matrix are damaged");
    n->link = (const Link *)link;
    if (!are_links_sound(n, m->size) || parts_of(n) != parts / 2)
        return refuse(why, "the tables of the matrix do not fit the network");
    for (size_t i = 0; i < n->participants; i++) {
        const size_t rows = n->width.wrench * n->participant[i].ports;
        for (size_t k = 0; k < n->participants; k++) {
            const size_t room = rows * n->width.wrench * n->participant[k].ports;
            largest = room > largest ? room : largest;
        }
    }
    for (Participant *p = n->participant + n->bodies; p < n->participant + n->participants; p++) {
        size_t unknowns = 0;
        for (size_t port = 0; port < p->ports; port++)
            unknowns += unknowns_of(n->participant + n->link[p->links[port]].body, n->width);
        p->response = room_for(unknowns * n->width.wrench * p->ports, memory, why);
        if (!p->response) return 0;
    }
    double **arrays[] = {&n->wrenches,  &n->law,  &n->residual, &n->scale,
                         &n->round_off, &n->bend, &n->noise,    &m->ordered};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (!(*arrays[i] = room_for(n->size, memory, why))) return 0;
    n->steps = room_for((MOST_ITERATIONS + 1) * n->size, memory, why);
    n->squares = room_for(MOST_ITERATIONS + 1, memory, why);
    n->product = room_for(largest, memory, why);
    n->gathered = room_for(largest, memory, why);
    n->energies = room_for(ENERGIES, memory, why);
    m->values = room_for(m->length, memory, why);
    m->transposed = room_for(m->length, memory, why);
    m->pivots = allocate(memory, (n->size + 1) * sizeof(size_t));
    return n->steps && n->squares && n->product && n->gathered && n->energies && m->values && m->transposed &&
           m->pivots;
}

enum { LEAST_KEPT_SIZES = 12, MOST_KEPT_SIZES = 64, MOST_KEPT_NUMBERS = 1 << 22 };

/* Room for the matrices of as many step sizes as are kept. */
static int create_jacobians(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    const Network *n = &c->network;
    Jacobians *j = &c->solver.jacobians;
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
    c->solver.network = &c->network;
    c->solver.predicted = room_for(n->size, memory, why);
    c->solver.start = room_for(largest, memory, why);
    c->solver.step = room_for(n->size, memory, why);
    if (!c->solver.predicted || !c->solver.start || !c->solver.step) return 0;
    const size_t fitting = MOST_KEPT_NUMBERS / (j->first[n->participants] + 1);
    j->kept = fitting < LEAST_KEPT_SIZES ? LEAST_KEPT_SIZES : fitting > MOST_KEPT_SIZES ? MOST_KEPT_SIZES : fitting;
    j->sizes = allocate(memory, j->kept * sizeof *j->sizes);
    j->once = room_for(j->first[n->bodies], memory, why);
    if (!j->sizes || !j->once) return 0;
    for (SizedJacobian *one = j->sizes; one < j->sizes + j->kept; one++) {
        one->numbers = room_for(j->first[n->participants], memory, why);
        JacobianBlock *block = allocate(memory, (n->participants + 1) * sizeof *block);
        if (!one->numbers || !block) return 0;
        for (size_t i = 0; i < n->participants; i++) {
            const double *first = one->numbers + j->first[i];
            block[i] = (JacobianBlock){first, first + block_size(n, i)};
        }
        one->mobility = block;
        one->stiffness = block + n->bodies;
    }
    return 1;
}

/* Whether a number is that of a connection with two ports. */
static int is_hinge(const Network *n, size_t number) {
    return number >= n->bodies && number < n->participants && n->participant[number].ports == HINGE_PORTS;
}

/* Create lines. Of each: how many hinges, whether it is kinematic, the participants of the hinges, the sensor first. */
static int create_lines(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    const Network *n = &c->network;
    Reader r = {NULL, 0};
    r.numbers = whole_numbers(data, "lines", &r.left, memory, why);
    c->latch_distance = counted_numbers(data, "latch_distance", n->participants, memory, why);
    c->latch_command = counted_numbers(data, "latch_command", n->participants, memory, why);
    c->unlatch_command = counted_numbers(data, "unlatch_command", n->participants, memory, why);
    if (!r.numbers || !c->latch_distance || !c->latch_command || !c->unlatch_command) return 0;
    c->lines = next_number(&r);
    c->most_hinges = MOST_STRUCK;
    if (c->lines > n->participants) return refuse(why, "the tables of hinge lines are damaged");
    c->line = allocate(memory, (c->lines + 1) * sizeof *c->line);
    if (!c->line) return refuse(why, "no memory for hinge lines");
    for (HingeLine *line = c->line; line < c->line + c->lines; line++) {
        line->hinges = next_number(&r);
        line->is_kinematic = next_number(&r);
        line->hinge = line->hinges <= n->participants ? next_numbers(&r, line->hinges) : NULL;
        if (!line->hinge || !line->hinges) return refuse(why, "the tables of hinge lines are damaged");
        c->most_hinges = line->hinges > c->most_hinges ? line->hinges : c->most_hinges;
        for (size_t i = 0; i < line->hinges; i++) {
            const size_t hinge = line->hinge[i];
            if (!is_hinge(n, hinge) || c->latch_distance[hinge] >= n->participant[hinge].outputs ||
                c->latch_command[hinge] >= n->participant[hinge].inputs ||
                c->unlatch_command[hinge] >= n->participant[hinge].inputs)
                return refuse(why, "a hinge line has no hinge %lu", (unsigned long)hinge);
        }
    }
    return 1;
}

/* Create conditions: places among observations, values, and what distances to them are divided by. */
static int create_crossings(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    size_t conditions = 0;
    const size_t *place = whole_numbers(data, "conditions", &conditions, memory, why);
    const double *value = place ? data_array(data, "condition_values", 2 * conditions, why) : NULL;
    c->crossings = c->lines + conditions;
    c->crossing = allocate(memory, (c->crossings + 1) * sizeof *c->crossing);
    c->reached = room_for(c->crossings, memory, why);
    c->passed = room_for(c->crossings, memory, why);
    if (!value || !c->crossing || !c->reached || !c->passed) return 0;
    if (!are_below(place, conditions, 1, all_observations(&c->network)))
        return refuse(why, "the tables of conditions are damaged");
    for (size_t k = 0; k < c->lines; k++) c->crossing[k].scale = -1.0;
    for (size_t k = 0; k < conditions; k++)
        c->crossing[c->lines + k] =
            (Crossing){c->network.observations + place[k], value[2 * k], value[2 * k + 1], 0.0, 0.0};
    return 1;
}

/* Create stops and contacts, of participants and places of penetrations among all observations, and arrays to judge
   their loads and those of lines. */
static int create_strikes(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    const Network *n = &c->network;
    size_t numbers = 0, most = 0;
    const size_t *number = whole_numbers(data, "strikes", &numbers, memory, why);
    if (!number) return 0;
    c->strikes = numbers / 2;
    c->strike = allocate(memory, (c->strikes + 1) * sizeof *c->strike);
    for (size_t k = 0; k < c->lines; k++) most += c->line[k].hinges;
    c->watched = allocate(memory, (most + MOST_STRUCK * c->strikes + 1) * sizeof *c->watched);
    c->slopes = allocate(memory, 2 * c->most_hinges * sizeof *c->slopes);
    c->room = room_for(3 * c->most_hinges * c->most_hinges, memory, why);
    if (!c->strike || !c->watched || !c->slopes || !c->room) return refuse(why, "no memory for loads that are judged");
    for (size_t i = 0; i < c->strikes; i++) {
        if (!is_hinge(n, number[2 * i]) || number[2 * i + 1] >= all_observations(n))
            return refuse(why, "the tables of stops and contacts are damaged");
        c->strike[i].participant = number[2 * i];
        c->strike[i].place = n->observations + number[2 * i + 1];
    }
    return 1;
}

/* Create commands of impulses, and times to breaks, first those of hold-downs. */
static int create_commands(Coupling *c, const Data *data, Memory *memory, Reason *why) {
    const Network *n = &c->network;
    size_t impulses = 0, laws = 0;
    c->impulse = (const Place *)whole_numbers(data, "impulses", &impulses, memory, why);
    const Place *law = (const Place *)whole_numbers(data, "laws", &laws, memory, why);
    const size_t *bolts = counted_numbers(data, "bolts", 1, memory, why);
    c->laws = laws / 2;
    c->law = allocate(memory, (c->laws + 1) * sizeof *c->law);
    if (!c->impulse || !law || !bolts || !c->law) return 0;
    c->impulses = impulses / 2;
    c->bolts = *bolts;
    for (size_t i = 0; i < c->impulses; i++)
        if (!is_input(n, c->impulse[i])) return refuse(why, "the tables of impulses are damaged");
    if (c->bolts > c->laws) return refuse(why, "the tables of hold-downs are damaged");
    for (size_t i = 0; i < c->laws; i++) {
        if (law[i].participant >= n->participants || law[i].place >= n->participant[law[i].participant].outputs)
            return refuse(why, "the tables of motion laws are damaged");
        c->law[i] = n->participant[law[i].participant].output + law[i].place;
    }
    return 1;
}

/* Create rows: places of what they contain, and arrays for them. */
static int create_rows(Coupling *c, const Data *data, size_t room, Memory *memory, Reason *why) {
    Rows *r = &c->rows;
    size_t corrected = 0;
    const size_t all = all_observations(&c->network), *signals = counted_numbers(data, "signals", 1, memory, why);
    r->recorded = whole_numbers(data, "recorded", &r->columns, memory, why);
    r->corrected = whole_numbers(data, "corrected", &corrected, memory, why);
    r->brought = whole_numbers(data, "brought", &r->bringing, memory, why);
    if (!signals || !r->recorded || !r->corrected || !r->brought) return 0;
    if (!are_below(r->recorded, r->columns, 1, all) || !are_below(r->corrected, corrected, 1, all) ||
        !are_below(r->brought, r->bringing, 1, all) ||
        !are_below(c->network.energy_rows, ENERGIES * c->network.participants, 1, all + 1) || *signals > 100000)
        return refuse(why, "the tables record what is not there");
    r->observations = all;
    r->corrections = corrected / 2;
    r->signals = *signals;
    r->room = room;
    r->times = room_for(room, memory, why);
    r->segments = room_for(room, memory, why);
    r->values = room_for(room * (r->columns + CHANNELS + r->signals), memory, why);
    r->signal = room_for(r->signals, memory, why);
    r->bring = room_for(r->bringing, memory, why);
    c->steps = room_for(room, memory, why);
    return r->times && r->segments && r->values && r->signal && r->bring && c->steps;
}

int coupling_create(Coupling *c, const Data *data, const Participant *given, size_t count, size_t room, Memory *memory,
                    Reason *why) {
    why->text[0] = '\0';
    const int fine = read_sizes(c, data, count, why) && create_participants(c, data, given, memory, why) &&
                     create_network(c, data, memory, why) && create_jacobians(c, data, memory, why) &&
                     create_lines(c, data, memory, why) && create_crossings(c, data, memory, why) &&
                     create_strikes(c, data, memory, why) && create_commands(c, data, memory, why) &&
                     create_rows(c, data, room, memory, why);
    if (!fine && !why->text[0]) refuse(why, "no memory for a coupling of %lu participants", (unsigned long)count);
    c->request.until = c->request.event_time = c->request.pause_time = INFINITY;
    return fine;
}
