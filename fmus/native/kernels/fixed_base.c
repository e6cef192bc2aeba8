/* Fixed base: ports that never move, whatever slopes their wrenches have, and the loads they carry; the equations of
   components/fixed_base.py */

#include "fixed_base_layout.h"
#include "base_ports.h"
#include "frames.h"
#include "kernel.h"
#include "port_loads.h"

typedef struct {
    size_t ports;
    const double *positions;    /* 3 a port, world axes */
    const double *arms;         /* the same from the reference point */
    const double *orientations; /* 4 a port */
    const double *outside;      /* 1 a port at which something from outside acts */
    const double *carried_weight; /* and its moment about the reference point */
} FixedBase;

static inline const real *own_inputs(const FixedBase *base, const real *u) { return u + WRENCH_SIZE * base->ports; }

/* Remembers the wrenches of the step. */
int NAME(fixed_base_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const FixedBase *base = self;
    const real *own = own_inputs(base, u);
    (void)why;
    store_port_loads(base->ports, x, u, own + OWN_INPUTS, h, value_of(own[U_IMPULSE]) > 0.5, x_next);
    return 1;
}

void NAME(fixed_base_outputs)(void *self, const real *x, const real *u, real *y) {
    const FixedBase *base = self;
    (void)x, (void)u;
    for (size_t k = 0; k < base->ports; k++, y += MOTION_SIZE) {
        for (size_t i = 0; i < 3; i++) y[i] = base->positions[3 * k + i];
        for (size_t i = 0; i < 4; i++) y[3 + i] = base->orientations[4 * k + i];
        for (size_t i = 7; i < MOTION_SIZE; i++) y[i] = 0.0;
    }
    for (size_t i = 0; i < WRENCH_SIZE * base->ports; i++) y[i] = 0.0;
}

/* There are no continuous states. */
int NAME(fixed_base_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    (void)self, (void)raw, (void)x, (void)u, (void)rates, (void)why;
    return 1;
}

#ifndef FANFOLD_COMPLEX

int fixed_base_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                             double complex *rates, Reason *why);

int fixed_base_step_complex(void *self, const double *x, const double complex *u, double h,
                            double complex *x_next, Reason *why);
void fixed_base_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static int read_ports(FixedBase *base, const Data *data, Memory *memory, Reason *why) {
    if (!read_base_ports(data, memory, &base->ports, &base->arms, &base->orientations, why)) return 0;
    base->positions = read_table_part(data, memory, "base", "positions", 3 * base->ports, why);
    if (!base->positions) return 0;
    base->outside = read_table_part(data, memory, "base", "outside", base->ports, why);
    if (!base->outside) return 0;
    base->carried_weight = read_table_part(data, memory, "base", "carried_weight", WRENCH_SIZE, why);
    return base->carried_weight != NULL;
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    FixedBase *base = allocate(memory, sizeof *base);
    if (!base) {
        refuse(why, "no memory for a base");
        return NULL;
    }
    if (!read_ports(base, data, memory, why)) return NULL;
    const size_t wrenches = WRENCH_SIZE * base->ports, motions = MOTION_SIZE * base->ports;
    const Sizes own = {PARAMETERS, wrenches + OWN_INPUTS + wrenches, motions + OWN_OUTPUTS + wrenches,
                       port_loads_told(base->ports)};
    if (!check_sizes("fixed base", sizes, &own, why)) return NULL;
    *states = port_loads_record(base->ports);
    return base;
}

static int prepare(void *self, const double *p, Reason *why) {
    (void)self, (void)p, (void)why;
    return 1;
}

/* No step yet. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    const FixedBase *base = self;
    (void)u, (void)why;
    memset(x, 0, port_loads_record(base->ports) * sizeof(double));
    return 1;
}

/* Loads now and one step earlier. */
static void observe(void *self, const double *x, const double *u, double *z) {
    static const double upright[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const FixedBase *base = self;
    observe_port_loads(base->ports, base->arms, x, u, upright, upright, z);
    double *earlier = earlier_loads(base->ports, z);
    for (size_t i = 0; i < WRENCH_SIZE; i++) {
        z[i] += base->carried_weight[i];
        if (tells_earlier(x)) earlier[i] += base->carried_weight[i];
    }
    leave_outside(base->ports, base->outside, base->arms, z);
}

static size_t no_continuous_states(const void *self, size_t *places) {
    (void)self, (void)places;
    return 0;
}

const Kernel fixed_base_kernel = {
    KIND,
    create,
    prepare,
    initial,
    fixed_base_step_real,
    fixed_base_outputs_real,
    observe,
    fixed_base_step_complex,
    fixed_base_outputs_complex,
    NULL,
    NULL,
    .continuous = no_continuous_states,
    .rates = fixed_base_rates_real,
    .rates_complex = fixed_base_rates_complex,
    .layout = LAYOUT_DIGEST,
};

#endif
