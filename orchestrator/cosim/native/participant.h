/* An FMI 2.0 FMU as the engine sees it, and the derivatives of its last step in the coordinates of the ports. */

#ifndef FANFOLD_PARTICIPANT_H
#define FANFOLD_PARTICIPANT_H

#include <stddef.h>

enum { WRENCH = 6, POSE = 6, COORDINATES = 12, MOTION = 13 };
enum { FMI_WARNING = 1 };

typedef int SetReal(void *, const unsigned *, size_t, const double *);
typedef int GetReal(void *, const unsigned *, size_t, double *);
typedef int DoStep(void *, double, double, int);
typedef int GetState(void *, void **);
typedef int SetState(void *, void *);
typedef int FreeState(void *, void **);
typedef int Derivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, double *);

/* An FMU: its functions, its arrays, and the cell of its saved state; the links of its ports. */
typedef struct {
    void *component;
    SetReal *set_real;
    GetReal *get_real;
    DoStep *do_step;
    GetState *get_state;
    SetState *set_state;
    FreeState *free_state;
    Derivative *derivative;
    const unsigned *input_references, *output_references, *observation_references;
    size_t inputs, outputs, observations, overwrites_state;
    double *input, *output, *observation;
    void **saved;
    size_t ports;
    const size_t *links;
    double *turned; /* a body's mobility (12 ports, 6 ports), a connection's stiffness (6 ports, 12 ports);
                       NULL for a body that never moves */
} Participant;

/* Derivative of a body's motions (12 ports, 6 ports) by its wrenches over the step just made; FMI status. */
static int mobility_of(const Participant *p, double *matrix, double *slope) {
    const double seed = 1.0;
    const size_t columns = WRENCH * p->ports;
    for (size_t column = 0; column < columns; column++) {
        const int status = p->derivative(p->component, p->output_references, MOTION * p->ports,
                                         p->input_references + column, 1, &seed, slope);
        if (status > FMI_WARNING) return status;
        for (size_t port = 0; port < p->ports; port++) {
            const double *d = slope + MOTION * port, *q = p->output + MOTION * port + 3;
            double *out = matrix + COORDINATES * port * columns + column;
            for (size_t k = 0; k < 3; k++) {
                const double *dq = d + 3;
                const size_t a = 1 + (k + 1) % 3, b = 1 + (k + 2) % 3;
                out[k * columns] = d[k];
                /* rotation vector: twice the vector part of dq times the conjugate of q */
                out[(3 + k) * columns] =
                    2.0 * (q[0] * dq[k + 1] - dq[0] * q[k + 1] - dq[a] * q[b] + dq[b] * q[a]);
                out[(6 + k) * columns] = d[7 + k];
                out[(9 + k) * columns] = d[10 + k];
            }
        }
    }
    return 0;
}

/* Derivative of a connection's wrenches (6 ports, 12 ports) by its motions over the step just made; status. */
static int stiffness_of(const Participant *p, double *matrix, double *slope) {
    const size_t rows = WRENCH * p->ports, columns = COORDINATES * p->ports;
    for (size_t column = 0; column < columns; column++) {
        const size_t k = column % COORDINATES, first = column / COORDINATES * MOTION;
        const double *q = p->input + first + 3;
        double seed[4] = {1.0, 0.0, 0.0, 0.0};
        size_t start = first + (k < 3 ? k : k + 1), count = 1;
        if (k >= 3 && k < 6) { /* half of the rotation vector (a pure quaternion) times q */
            const size_t i = k - 3, a = (i + 1) % 3, b = (i + 2) % 3;
            start = first + 3;
            count = 4;
            seed[0] = -0.5 * q[1 + i];
            seed[1 + i] = 0.5 * q[0];
            seed[1 + a] = -0.5 * q[1 + b];
            seed[1 + b] = 0.5 * q[1 + a];
        }
        const int status = p->derivative(p->component, p->output_references, rows, p->input_references + start,
                                         count, seed, slope);
        if (status > FMI_WARNING) return status;
        for (size_t row = 0; row < rows; row++) matrix[row * columns + column] = slope[row];
    }
    return 0;
}

#endif
