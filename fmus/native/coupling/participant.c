/* Interface Jacobians of participants from their directional derivatives. */

#include "participant.h"

#include <string.h>

Width width_of(int with_slopes) {
    return with_slopes ? (Width){2 * WRENCH, POSE + MOMENTS + RATES} : (Width){WRENCH, POSE + RATES};
}

/* Derivatives of a body's outputs by one of its inputs, as a column of its mobility. */
static void note_mobility(const Participant *p, Width width, const double *slope, double *column) {
    const size_t columns = width.wrench * p->ports;
    for (size_t port = 0; port < p->ports; port++) {
        const double *d = slope + MOTION * port, *q = p->output + MOTION * port + 3, *dq = d + 3;
        double *out = column + width.coordinates * port * columns;
        double *rates = out + (width.coordinates - RATES) * columns;
        for (size_t k = 0; k < 3; k++) {
            const size_t a = 1 + (k + 1) % 3, b = 1 + (k + 2) % 3;
            out[k * columns] = d[k];
            /* rotation vector: twice the vector part of dq times the conjugate of q */
            out[(3 + k) * columns] = 2.0 * (q[0] * dq[k + 1] - dq[0] * q[k + 1] - dq[a] * q[b] + dq[b] * q[a]);
        }
        for (size_t k = 0; k < RATES; k++) rates[k * columns] = d[7 + k];
        for (size_t k = POSE; k + RATES < width.coordinates; k++)
            out[k * columns] = p->moments ? slope[p->moments + MOMENTS * port + k - POSE] : 0.0;
    }
}

int participant_mobility(const Participant *p, Width width, double *matrix, double *slope) {
    const double seed = 1.0;
    for (size_t column = 0; column < width.wrench * p->ports; column++) {
        const size_t port = column / width.wrench, k = column % width.wrench;
        const size_t input = k < WRENCH ? WRENCH * port + k : p->slopes + WRENCH * port + k - WRENCH;
        if (k >= WRENCH && !p->slopes)
            memset(slope, 0, p->outputs * sizeof(double));
        else {
            const int status = p->derivative(p->component, p->output_references, p->outputs,
                                             p->input_references + input, 1, &seed, slope);
            if (status > FMI_WARNING) return status;
        }
        note_mobility(p, width, slope, matrix + column);
    }
    return 0;
}

/* What a coordinate of a port's motion changes in the inputs of a connection: `count` of them from `start` on. */
typedef struct {
    size_t start, count;
    double seed[4];
} Displacement;

static Displacement displacement(const Participant *p, Width width, size_t port, size_t k) {
    Displacement found = {MOTION * port + k, 1, {1.0, 0.0, 0.0, 0.0}};
    if (k >= width.coordinates - RATES) {
        found.start = MOTION * port + 7 + k - (width.coordinates - RATES);
    } else if (k >= POSE) {
        found.start = p->moments + MOMENTS * port + k - POSE;
        found.count = p->moments ? 1 : 0;
    } else if (k >= 3) { /* half of the rotation vector (a pure quaternion) times q */
        const double *q = p->input + MOTION * port + 3;
        const size_t i = k - 3, a = (i + 1) % 3, b = (i + 2) % 3;
        found.start = MOTION * port + 3;
        found.count = 4;
        found.seed[0] = -0.5 * q[1 + i];
        found.seed[1 + i] = 0.5 * q[0];
        found.seed[1 + a] = -0.5 * q[1 + b];
        found.seed[1 + b] = 0.5 * q[1 + a];
    }
    return found;
}

int participant_stiffness_at_once(const Participant *p, Width width, double *matrix) {
    return p->port_stiffness && p->slopes && p->moments && width.wrench == 2 * WRENCH &&
           p->port_stiffness(p->component, p->ports, matrix) <= FMI_WARNING;
}

int participant_stiffness(const Participant *p, Width width, double *matrix, double *slope) {
    const size_t columns = width.coordinates * p->ports;
    if (participant_stiffness_at_once(p, width, matrix)) return 0;
    for (size_t column = 0; column < columns; column++) {
        const Displacement by = displacement(p, width, column / width.coordinates, column % width.coordinates);
        memset(slope, 0, p->outputs * sizeof(double));
        if (by.count) {
            const int status = p->derivative(p->component, p->output_references, p->outputs,
                                             p->input_references + by.start, by.count, by.seed, slope);
            if (status > FMI_WARNING) return status;
        }
        for (size_t port = 0; port < p->ports; port++) {
            double *out = matrix + width.wrench * port * columns + column;
            for (size_t k = 0; k < WRENCH; k++) out[k * columns] = slope[WRENCH * port + k];
            for (size_t k = WRENCH; k < width.wrench; k++)
                out[k * columns] = p->slopes ? slope[p->slopes + WRENCH * port + k - WRENCH] : 0.0;
        }
    }
    return 0;
}
