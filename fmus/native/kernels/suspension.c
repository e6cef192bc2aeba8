/* Suspension: a spring that only pulls, along the line between two points: the twin of components/suspension.py. */

#include "relative.h"
#include "workless.h"

/* State: centre line from the upper to the lower port, heat, mean rates of two steps, wrenches of both ports and their
   slopes. */
enum { SPAN = 0, HEAT = 3, SLIDE = 4, WRENCH = 8, SLOPES = 20, STATES = 32 };

enum { STIFFNESS, PRELOAD, PRELOAD_LENGTH, DAMPING, END_WEIGHT, ORDER, PARAMETERS };

enum { OBSERVATIONS = 4, PAIR_SIZE = 2 * WRENCH_SIZE };

typedef struct Suspension {
    int endpoint, paired; /* paired: forces are of order 4; those of static solutions are not */
    size_t impulse, moments, places[PARAMETERS];
    double preload_length, damping, end_weight;
    Law spring;
} Suspension;

/* Centre line of an instant, its length and rate of change. */
typedef struct Instant {
    Vector3 span;
    real length, rate;
} Instant;

static inline Instant suspension_instant(const real *u) {
    Instant line;
    line.span = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    line.length = vector_norm(line.span);
    line.rate = vector_dot(vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7)), line.span) / line.length;
    return line;
}

/* Tension of an instant; damping never pushes, and a slack spring has none. */
static inline real tension_of(const Suspension *suspension, real elongation, real rate) {
    real elastic = -law_value(&suspension->spring, elongation);
    if (!(value_of(elastic) > 0.0)) return 0.0;
    return above(elastic + suspension->damping * rate, 0.0);
}

/* Wrenches on both ports from the force on the lower one. */
static inline void store_force(Vector3 force, real *wrench) {
    for (int i = 0; i < 2 * WRENCH_SIZE; i++) wrench[i] = 0.0;
    vector_store(vector_scaled(-1.0, force), wrench);
    vector_store(force, wrench + WRENCH_SIZE);
}

/* Mean force of the lengths at both ends along the mean of the line; adds to the heat. */
static inline Vector3 mean_force(const Suspension *suspension, Vector3 old, const Instant *now, double h, real *heat) {
    const Law *spring = &suspension->spring;
    real length = vector_norm(old);
    real before = length - suspension->preload_length, after = now->length - suspension->preload_length;
    real rate = (now->length - length) / h;
    real plain = law_mean_force(spring, before, after);
    real elastic = -(plain + law_end_force(spring, before, after, suspension->end_weight));
    real tension = above(elastic + suspension->damping * taut_share(spring, before, after) * rate, 0.0);
    *heat += (tension + plain) * (now->length - length);
    return vector_scaled(-tension / (length + now->length), vector_add(old, now->span));
}

/* Load on the length at order 4; damping never turns the mean tension into a push. */
static inline MeanLoad length_load(const Suspension *suspension, const StepMotion *m) {
    const Law *spring = &suspension->spring;
    real elastic = -workless_law(spring, 0.0, m, 0.0).force, change = m->end - m->start;
    real damping = suspension->damping * taut_share(spring, m->start, m->end);
    if (value_of(change) < 0.0 && value_of(elastic * m->h) < value_of(-damping * change))
        damping = above(elastic, 0.0) * m->h / -change;
    return workless_law(spring, damping, m, 0.0);
}

/* One step: the mean tension of the lengths at both ends along the mean of the line. */
int NAME(suspension_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Suspension *suspension = self;
    (void)why;
    Instant now = suspension_instant(u);
    Vector3 old = {x[SPAN], x[SPAN + 1], x[SPAN + 2]}, force, slope = {0.0, 0.0, 0.0};
    real length = vector_norm(old), rate = (now.length - length) / h, heat = 0.0;
    int impulse = !(value_of(u[suspension->impulse]) < 0.5);
    if (suspension->paired && !impulse) {
        const real *moments = u + suspension->moments;
        double preload = suspension->preload_length;
        Line line = line_between(old, now.span, 2.0 / (length + now.length));
        real moment = line_moment(&line, vector_subtract(vector_of(moments + WRENCH_SIZE), vector_of(moments)));
        StepMotion motion = {length - preload, now.length - preload, h, 0.0, 0.0, 0.0, moment};
        MeanLoad load = length_load(suspension, &motion);
        force = line_force(&line, -load.force, -load.slope);
        slope = vector_scaled(load.slope * line.scale, line.mean);
        heat = load.heat;
        store_mid_step_start(rate + 3.0 * moment / h, x_next + SLIDE);
    } else {
        force = mean_force(suspension, old, &now, h, &heat);
        if (impulse)
            store_mid_step_start(now.rate, x_next + SLIDE);
        else
            store_mid_step_after(x + SLIDE, rate, h, x_next + SLIDE);
    }
    vector_store(now.span, x_next + SPAN);
    x_next[HEAT] = x[HEAT] + heat;
    store_force(force, x_next + WRENCH);
    store_force(slope, x_next + SLOPES);
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
void NAME(suspension_outputs)(void *self, const real *x, const real *u, real *y) {
    const Suspension *suspension = self;
    if (!suspension->endpoint) {
        for (int i = 0; i < PAIR_SIZE; i++) {
            y[i] = x[WRENCH + i];
            y[PAIR_SIZE + i] = x[SLOPES + i];
        }
        return;
    }
    Instant now = suspension_instant(u);
    real tension = tension_of(suspension, now.length - suspension->preload_length, now.rate);
    store_force(vector_scaled(-tension / now.length, now.span), y);
}

/* Heat of the end-point tension. */
int NAME(suspension_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Suspension *suspension = self;
    (void)raw, (void)x, (void)why;
    Instant now = suspension_instant(u);
    real elongation = now.length - suspension->preload_length;
    real damping = tension_of(suspension, elongation, now.rate) + law_value(&suspension->spring, elongation);
    rates[0] = damping * now.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

int suspension_rates_complex(void *self, const double complex *raw, const double complex *x,
                             const double complex *u, double complex *rates, Reason *why);
int suspension_step_complex(void *self, const double *x, const double complex *u, double h,
                            double complex *x_next, Reason *why);
void suspension_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [STIFFNESS] = {"stiffness", 1}, [PRELOAD] = {"preload", 1},       [PRELOAD_LENGTH] = {"preload_length", 1},
    [DAMPING] = {"damping", 1},     [END_WEIGHT] = {"end_weight", 1}, [ORDER] = {"order", 1},
};

static void *suspension_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Suspension *suspension = allocate(memory, sizeof *suspension);
    if (!suspension) {
        refuse(why, "there is no memory for a suspension");
        return NULL;
    }
    *states = STATES;
    if (!read_choice(data, "endpoint", 1, &suspension->endpoint, why)) return NULL;
    size_t pairs = suspension->endpoint ? 0 : PAIR_SIZE;
    int usable = check_sizes("suspension", sizes, 2 * MOTION_SIZE + 1 + pairs, PAIR_SIZE + pairs, OBSERVATIONS, why) &&
                 find_moments(data, "upper.velocity_moment", suspension->endpoint ? 0 : 2, sizes,
                              &suspension->moments, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, suspension->places, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &suspension->impulse, why);
    return usable ? suspension : NULL;
}

static int suspension_prepare(void *self, const double *p, Reason *why) {
    Suspension *suspension = self;
    const size_t *place = suspension->places;
    int fourth = 0;
    if (!read_order(p[place[ORDER]], &fourth, why)) return 0;
    suspension->spring = strand_law(p[place[STIFFNESS]], p[place[PRELOAD]]);
    suspension->preload_length = p[place[PRELOAD_LENGTH]];
    suspension->damping = p[place[DAMPING]];
    suspension->end_weight = p[place[END_WEIGHT]];
    suspension->paired = fourth && suspension->end_weight == 0.5 && !suspension->endpoint;
    return 1;
}

/* At the place of the inputs. */
static int suspension_initial(void *self, const double *u, double *x, Reason *why) {
    (void)self;
    Instant now = suspension_instant(u);
    if (now.length == 0.0)
        return refuse(why, "the ports of the suspension are at one point; it hangs along no line");
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    vector_store(now.span, x + SPAN);
    store_mid_step_start(now.rate, x + SLIDE);
    return 1;
}

/* Length and tension at the communication point, and energies. */
static void suspension_observe(void *self, const double *x, const double *u, double *z) {
    const Suspension *suspension = self;
    Instant now = suspension_instant(u);
    double elongation = now.length - suspension->preload_length;
    z[0] = now.length;
    z[1] = tension_of(suspension, elongation, suspension->endpoint ? now.rate : mid_step_now(x + SLIDE));
    z[2] = law_potential(&suspension->spring, elongation);
    z[3] = x[HEAT];
}

static size_t suspension_continuous(const void *self, size_t *places) {
    (void)self;
    if (places) places[0] = HEAT;
    return 1;
}

const Kernel suspension_kernel = {
    .kind = "suspension",
    .create = suspension_create,
    .prepare = suspension_prepare,
    .initial = suspension_initial,
    .step = suspension_step_real,
    .outputs = suspension_outputs_real,
    .observe = suspension_observe,
    .step_complex = suspension_step_complex,
    .outputs_complex = suspension_outputs_complex,
    .continuous = suspension_continuous,
    .rates = suspension_rates_real,
    .rates_complex = suspension_rates_complex,
};

#endif
