/* The linear system of a coupled step. */

#include "system.h"

#include <string.h>

#include "dense_lu.h"

/* m, least size of positions that are rounded: bodies reach beyond their ports, which may lie in the origin */
#define LEAST_REACH 1.0

/* Turn a matrix (rows, columns) of 3-vectors by 3-vectors from the axes in which it was made to those of `motion`; of
   every `period` rows only the first `used`. */
static INLINE void turn(const JacobianBlock *block, const double *motion, size_t rows, size_t columns, size_t period,
                        size_t used, double *restrict turned) {
    double now[9], t[9];
    const double *before = block->axes;
    axes_of(motion, now);
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            t[3 * i + j] = now[3 * i] * before[3 * j] + now[3 * i + 1] * before[3 * j + 1] +
                           now[3 * i + 2] * before[3 * j + 2];
    for (size_t row = 0; row < rows; row += 3) {
        if (row % period >= used) continue;
        const double *a = block->matrix + row * columns, *b = a + columns, *c = b + columns;
        for (size_t i = 0; i < 3; i++) {
            double *restrict out = turned + (row + i) * columns;
            const double t0 = t[3 * i], t1 = t[3 * i + 1], t2 = t[3 * i + 2];
            for (size_t j = 0; j < columns; j++) out[j] = t0 * a[j] + t1 * b[j] + t2 * c[j];
            for (size_t j = 0; j < columns; j += 3) {
                const double p = out[j], q = out[j + 1], r = out[j + 2];
                out[j] = p * t[0] + q * t[1] + r * t[2];
                out[j + 1] = p * t[3] + q * t[4] + r * t[5];
                out[j + 2] = p * t[6] + q * t[7] + r * t[8];
            }
        }
    }
}

/* Turn the mobility of a body to its present orientation: of each port's coordinates the first `used`. */
static INLINE void turn_body(Network *n, size_t body, size_t used) {
    const Participant *p = n->participant + body;
    turn(n->mobility + body, p->output, n->width.coordinates * p->ports, n->width.wrench * p->ports,
         n->width.coordinates, used, p->turned);
}

/* How many of a port's coordinates affect wrenches: all, or all but the rates. */
static INLINE size_t coordinates_used(const Network *n) {
    const Width width = n->width;
    for (size_t i = n->bodies; i < n->participants; i++) {
        const size_t ports = n->participant[i].ports;
        const double *rates = n->stiffness[i - n->bodies].matrix + width.coordinates - RATES;
        for (size_t k = 0; k < width.wrench * ports * ports; k++, rates += width.coordinates)
            for (size_t j = 0; j < RATES; j++)
                if (rates[j] != 0.0) return width.coordinates; /* NaN as well */
    }
    return width.coordinates - RATES;
}

/* Largest of the numbers [first, last) of a port's motion, over the ports of all connections. */
static INLINE double largest_of_ports(const Network *n, size_t first, size_t last) {
    double largest = 0.0;
    for (size_t i = n->bodies; i < n->participants; i++)
        for (size_t port = 0; port < n->participant[i].ports; port++)
            for (size_t k = first; k < last; k++)
                largest = fmax(largest, fabs(n->participant[i].input[MOTION * port + k]));
    return largest;
}

/* Largest value of a coordinate; ports agree no better than its rounding. */
static INLINE double size_of(const Network *n, size_t coordinate, double rate) {
    if (coordinate < POSE) return coordinate < 3 ? n->reach : 1.0;
    return coordinate < n->width.coordinates - RATES ? rate * n->h : rate;
}

/* Compute the wrenches that the rounding of a connection's motions causes. */
static INLINE void note_round_off(Network *n, const Participant *p, double rate) {
    const Width width = n->width;
    for (size_t row = 0; row < width.wrench * p->ports; row++) {
        const double *stiffness = p->turned + row * width.coordinates * p->ports;
        double sum = 0.0;
        for (size_t port = 0; port < p->ports; port++, stiffness += width.coordinates)
            for (size_t k = 0; k < width.coordinates; k++) sum += fabs(stiffness[k]) * size_of(n, k, rate);
        n->round_off[width.wrench * p->links[row / width.wrench] + row % width.wrench] = ROUND_OFF * sum;
    }
}

/* Whether the wrenches on a body are unknowns themselves. */
static INLINE int is_flexible(const Participant *body) { return body->turned && !body->rigid; }

size_t unknowns_of(const Participant *body, Width width) {
    return !body->turned ? 0 : body->rigid ? width.wrench : width.wrench * body->ports;
}

/* The negative of the wrench at a rigid body's first port that each wrench on it amounts to, stored behind the
   motions. */
static INLINE double *gathered_by(const Participant *body, Width width) {
    return body->rigid + width.coordinates * width.wrench * body->ports;
}

/* Split the mobility of a rigid body into the product that system.h describes; room: for its wrenches (wrench,
   wrenches). 0 where the mobility of its first port is singular. */
static INLINE int split_mobility(const Participant *body, Width width, double *room) {
    const size_t wrench = width.wrench, columns = wrench * body->ports, rows = width.coordinates * body->ports;
    double own[4 * WRENCH * WRENCH], *gathered = gathered_by(body, width);
    size_t pivots[2 * WRENCH];
    for (size_t i = 0; i < rows; i++)
        memcpy(body->rigid + i * wrench, body->turned + i * columns, wrench * sizeof(double));
    memcpy(own, body->rigid, wrench * wrench * sizeof(double));
    memcpy(room, body->turned, wrench * columns * sizeof(double));
    if (!factorize(own, wrench, pivots)) return 0;
    solve_dense(own, wrench, pivots, room, columns);
    for (size_t j = 0; j < columns; j++)
        for (size_t i = 0; i < wrench; i++) gathered[j * wrench + i] = -room[i * columns + j];
    return 1;
}

/* Add derivatives of a port's wrench by the unknowns of a body to the matrix; returns the parts not used yet. */
static INLINE const Part *add_parts(double *values, const Part *part, const double *by, size_t down, size_t right,
                                    size_t columns, size_t wrench) {
    for (size_t first = 0; first < columns; first += wrench, part++)
        for (size_t i = 0; i < wrench; i++)
            for (size_t j = 0; j < wrench; j++)
                values[part->offset + i * part->stride + j] += by[i * down + (first + j) * right];
    return part;
}

/* Subtract stiffness x mobility of one connection; returns the parts of the matrix not used yet. */
static INLINE const Part *subtract_connection(Network *n, const Participant *p, size_t used, const Part *part) {
    const Width width = n->width;
    const size_t rows = width.wrench * p->ports, wrench = width.wrench;
    double *response = p->response;
    for (size_t port = 0; port < p->ports; port++) {
        const Link *l = n->link + p->links[port];
        const Participant *body = n->participant + l->body;
        const size_t columns = unknowns_of(body, width);
        if (!columns) continue;
        memset(n->product, 0, rows * columns * sizeof(double));
        subtract_product(n->product, columns, p->turned + width.coordinates * port, width.coordinates * p->ports,
                         (body->rigid ? body->rigid : body->turned) + width.coordinates * l->body_port * columns, columns,
                         rows, used, columns);
        for (size_t row = 0; row < p->ports; row++) {
            const Link *on = n->link + p->links[row];
            const Participant *carrier = n->participant + on->body;
            const double *by = n->product + row * wrench * columns;
            if (is_flexible(carrier)) {
                part = add_parts(n->matrix.values, part, by, columns, 1, columns, wrench);
                continue;
            }
            for (size_t j = 0; j < columns; j++)
                for (size_t i = 0; i < wrench; i++) response[j * wrench + i] = by[i * columns + j];
            if (carrier->turned) {
                memset(n->gathered, 0, columns * wrench * sizeof(double));
                subtract_product(n->gathered, wrench, response, wrench,
                                 gathered_by(carrier, width) + on->body_port * wrench * wrench, wrench, columns, wrench,
                                 wrench);
                part = add_parts(n->matrix.values, part, n->gathered, 1, wrench, columns, wrench);
            }
            response += columns * wrench;
        }
    }
    return part;
}

VECTORISED void system_assemble(Network *n) {
    Matrix *m = &n->matrix;
    const Width width = n->width;
    const size_t used = coordinates_used(n);
    n->singular = 0;
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        if (!p->turned) continue; /* a body that never moves */
        if (i < n->bodies) turn_body(n, i, used);
        else if (!participant_stiffness_at_once(p, width, p->turned))
            turn(n->stiffness + i - n->bodies, p->input, width.wrench * p->ports, width.coordinates * p->ports, 1, 1,
                 p->turned);
        if (i < n->bodies && p->rigid) n->singular |= !split_mobility(p, width, n->product);
    }
    memset(m->values, 0, m->length * sizeof(double));
    for (size_t g = 0; g < m->groups; g++) {
        const size_t rows = m->begin[g + 1] - m->begin[g];
        for (size_t i = 0; i < rows; i++) m->values[m->blocks[g].offset + i * (rows + 1)] = 1.0;
    }
    const double rate = largest_of_ports(n, 7, MOTION);
    n->reach = fmax(LEAST_REACH, largest_of_ports(n, 0, 3));
    const Part *part = n->parts;
    for (size_t i = n->bodies; i < n->participants; i++) {
        note_round_off(n, n->participant + i, rate);
        part = subtract_connection(n, n->participant + i, used, part);
    }
    n->singular |= !factorize_blocks(m);
}

/* Add to a connection's wrenches, on bodies that are rigid or never move, what the unknowns cause. */
static INLINE void take_responses(const Network *n, const Participant *p, double *result) {
    const size_t wrench = n->width.wrench;
    const double *response = p->response;
    for (size_t port = 0; port < p->ports; port++) {
        const Link *l = n->link + p->links[port];
        const Participant *body = n->participant + l->body;
        const size_t columns = unknowns_of(body, n->width);
        const double *known = body->rigid ? n->matrix.ordered + l->place : result + wrench * body->links[0];
        for (size_t row = 0; row < p->ports && columns; row++) {
            if (is_flexible(n->participant + n->link[p->links[row]].body)) continue;
            subtract_row(result + wrench * p->links[row], known, response, wrench, columns, wrench);
            response += columns * wrench;
        }
    }
}

VECTORISED void system_direction(const Network *n, const double *residual, double *result) {
    if (n->singular) {
        memcpy(result, residual, n->size * sizeof(double));
        return;
    }
    const Matrix *m = &n->matrix;
    const size_t wrench = n->width.wrench;
    memset(m->ordered, 0, m->size * sizeof(double));
    for (const Participant *body = n->participant; body < n->participant + n->bodies; body++) {
        if (!body->turned || !body->ports) continue;
        const double *own = residual + wrench * body->links[0];
        if (body->rigid)
            subtract_row(m->ordered + n->link[body->links[0]].place, own, gathered_by(body, n->width), wrench,
                         wrench * body->ports, wrench);
        for (size_t port = 0; port < body->ports && !body->rigid; port++)
            memcpy(m->ordered + n->link[body->links[port]].place, own + wrench * port, wrench * sizeof(double));
    }
    solve_blocks(m, m->ordered);
    for (size_t i = 0; i < n->links; i++) {
        const int solved = is_flexible(n->participant + n->link[i].body);
        memcpy(result + wrench * i, solved ? m->ordered + n->link[i].place : residual + wrench * i,
               wrench * sizeof(double));
    }
    for (size_t i = n->bodies; i < n->participants; i++) take_responses(n, n->participant + i, result);
}

void system_turn_bodies(Network *n) {
    for (size_t i = 0; i < n->bodies; i++)
        if (n->participant[i].turned) turn_body(n, i, n->width.coordinates);
}
