/* What connections have in common: data, wrench mode and order, mean wrenches, the table of their functions. The twin of
   components/contract/connection.py. A kernel includes its layout header before this one. */

#ifndef FANFOLD_CONNECTION_H
#define FANFOLD_CONNECTION_H

#include <string.h>

#include "relative.h"

/* The first member of every connection: its parameters by place; `paired`: wrenches are of order 4. `ports`: their
   number where it varies. */
typedef struct Connection {
    int endpoint, paired;
    size_t ports;
    double p[PARAMETERS];
} Connection;

static inline int commanded(const real *u, int input) { return value_of(u[input]) > 0.5; }

#ifndef MOMENTS /* the number of ports varies, and laws are of order 4 */

/* Where the own inputs begin, after which come the first moments. */
static inline const real *own_inputs(const Connection *connection, const real *u) {
    return u + MOTION_SIZE * connection->ports;
}

/* Numbers of the wrenches on all ports, and of the state, which ends with these and their slopes. */
static inline size_t wrenches_size(const Connection *connection) { return WRENCH_SIZE * connection->ports; }
static inline size_t states_size(const Connection *connection) { return STATES + 2 * wrenches_size(connection); }

/* Gives the mean wrenches of all ports and their slopes; 0 in end-point mode, which has none. */
static inline int gives_means(const Connection *connection, const real *x, real *y) {
    if (connection->endpoint) return 0;
    for (size_t i = 0; i < 2 * wrenches_size(connection); i++) y[i] = x[X_WRENCH + i];
    return 1;
}

#else

/* Own outputs come between the wrenches and their slopes, which only laws of order 4 have. */
enum { WRENCHES = MOMENTS ? MOMENTS : OUTPUTS };

/* Gives the mean wrenches of all ports and, at order 4, their slopes; 0 in end-point mode, which has none. */
static inline int gives_means(const Connection *connection, const real *x, real *y) {
    if (connection->endpoint) return 0;
    for (int i = 0; i < WRENCHES; i++) y[i] = x[X_WRENCH + i];
#if MOMENTS
    for (int i = 0; i < MOMENTS; i++) y[OUTPUTS + i] = x[X_SLOPES + i];
#endif
    return 1;
}

#endif

#ifndef FANFOLD_COMPLEX

/* A connection of `bytes` in its mode; NULL and a sentence where there is none. */
static inline Connection *connection_of(const Data *data, Memory *memory, size_t bytes, Reason *why) {
    Connection *connection = allocate(memory, bytes);
    if (!connection) {
        refuse(why, "there is no memory for a component of kind " KIND);
        return NULL;
    }
    return read_choice(data, "endpoint", 1, &connection->endpoint, why) ? connection : NULL;
}

#ifndef MOMENTS

/* A connection of `bytes` with so many ports, with what all read from their data; NULL and a sentence where there is
   none. */
static inline void *create_connection(const Data *data, const Sizes *sizes, Memory *memory, size_t bytes, size_t ports,
                                      size_t *states, Reason *why) {
    Connection *connection = connection_of(data, memory, bytes, why);
    if (!connection) return NULL;
    connection->ports = ports;
    *states = states_size(connection);
    size_t wrenches = wrenches_size(connection), moments = connection->endpoint ? 0 : wrenches;
    const Sizes own = {
        PARAMETERS, MOTION_SIZE * ports + OWN_INPUTS + moments, wrenches + OWN_OUTPUTS + moments, OBSERVATIONS,
    };
    return check_sizes(KIND, sizes, &own, why) ? connection : NULL;
}

#else

/* A connection of `bytes`, with what all read from their data; NULL and a sentence where there is none. */
static inline void *create_connection(const Data *data, const Sizes *sizes, Memory *memory, size_t bytes,
                                      size_t *states, Reason *why) {
    Connection *connection = connection_of(data, memory, bytes, why);
    *states = STATES;
    if (!connection) return NULL;
    size_t moments = connection->endpoint ? 0 : MOMENTS;
    const size_t observations = OBSERVATIONS + (connection->endpoint ? 0 : LAGGED_LOADS);
    const Sizes own = {PARAMETERS, INPUTS + moments, OUTPUTS + moments, observations};
    return check_sizes(KIND, sizes, &own, why) ? connection : NULL;
}

#endif

/* Takes the parameters over. */
static inline int prepare_connection(void *self, const double *p, double order, Reason *why) {
    Connection *connection = self;
    memcpy(connection->p, p, sizeof connection->p);
    connection->paired = order == 4.0 && !connection->endpoint;
    if (order == 2.0 || order == 4.0) return 1;
    return refuse(why, "order = %g; it must be 2 or 4", order);
}

static inline size_t connection_continuous(const void *self, size_t *places) {
    static const size_t own[] = CONTINUOUS_PLACES;
    (void)self;
    if (places) memcpy(places, own, CONTINUOUS * sizeof *own);
    return CONTINUOUS;
}

#define DECLARE_COMPLEX(name)                                                                                      \
    int name##_step_complex(void *, const double *, const double complex *, double, double complex *, Reason *);   \
    void name##_outputs_complex(void *, const double complex *, const double complex *, double complex *);         \
    int name##_rates_complex(void *, const double complex *, const double complex *, const double complex *,       \
                             double complex *, Reason *);

/* The table of a connection's functions; `made` is the prefix of the one that makes it. */
#define CONNECTION_FUNCTIONS(name, made)                                                                           \
    .kind = KIND, .layout = LAYOUT_DIGEST, .create = made##_create, .prepare = name##_prepare,                     \
    .initial = name##_initial, .step = name##_step_real, .outputs = name##_outputs_real, .observe = name##_observe, \
    .step_complex = name##_step_complex, .outputs_complex = name##_outputs_complex,                                \
    .continuous = connection_continuous, .rates = name##_rates_real, .rates_complex = name##_rates_complex

#endif
#endif
