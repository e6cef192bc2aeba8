/* Unilateral contact without friction between a point and a plane: the twin of components/contact.py. */

#include "relative.h"

/* State: normal, vector from the inboard to the outboard port, heat, wrenches of both ports, mean rates of two steps. */
enum { NORMAL = 0, ARM = 3, HEAT = 6, WRENCH = 7, SLIDE = 19, STATES = 23 };

enum {
    GAP, REFERENCE_FORCE, REFERENCE_PENETRATION, EXPONENT, DAMPING, FULL_DAMPING_PENETRATION, END_WEIGHT, PARAMETERS
};

#define NARROW 1e-3

typedef struct Contact {
    double direction[3];
    int endpoint;
    size_t impulse, places[PARAMETERS];
    double parameter[PARAMETERS];
} Contact;

/* Normal and vector from the inboard to the outboard port, world axes, penetration and its rate. */
typedef struct Place {
    Vector3 normal, arm;
    real penetration, rate;
} Place;

/* A positive number to a constant power. */
static inline real power_of(real base, double exponent) {
#ifdef FANFOLD_COMPLEX
    double value = pow(creal(base), exponent);
    return complex_of(value, cimag(base) * exponent * value / creal(base));
#else
    return pow(base, exponent);
#endif
}

static inline real not_below(real a, double least) { return value_of(a) > least ? a : least; }

static inline real not_above(real a, double most) { return value_of(a) < most ? a : most; }

/* Mean of max(s, 0)^exponent over s from start to end, exact also where they are close. */
static inline real mean_power(real start, real end, double exponent) {
    const int rising = value_of(start) < value_of(end);
    real low = rising ? start : end, high = rising ? end : start;
    if (value_of(high) <= 0.0) return 0.0;
    real width = value_of(low) > 0.0 ? (high - low) / (high + low) : 1.0;
    if (value_of(width) > NARROW) {
        double power = exponent + 1.0;
        real below = value_of(low) > 0.0 ? power_of(low, power) : 0.0;
        return (power_of(high, power) - below) / (power * (high - low));
    }
    /* binomial series of the mean about the middle; the next term is of the order of width^6 */
    real square = width * width;
    real fourth = 1.0 + (exponent - 2.0) * (exponent - 3.0) / 20.0 * square;
    real series = 1.0 + exponent * (exponent - 1.0) / 6.0 * square * fourth;
    return power_of(0.5 * (low + high), exponent) * series;
}

/* Mean over s from start to end of the cubic step 3 s^2 - 2 s^3, which is 0 below 0 and 1 above 1. */
static inline real mean_rise(real start, real end) {
    const int rising = value_of(start) < value_of(end);
    real low = rising ? start : end, high = rising ? end : start;
    if (value_of(high) <= 0.0) return 0.0;
    if (value_of(low) >= 1.0) return 1.0;
    real a = not_below(low, 0.0), b = not_above(high, 1.0);
    real rise = a * a + a * b + b * b - 0.5 * (a + b) * (a * a + b * b);
    if (value_of(a) == value_of(low) && value_of(b) == value_of(high)) return rise;
    return ((b - a) * rise + (high - b)) / (high - low);
}

static inline real pushing(real force) { return value_of(force) < 0.0 ? 0.0 : force; }

/* Force of the potential. */
static inline real elastic_force(const double *parameter, real penetration) {
    if (value_of(penetration) <= 0.0) return 0.0;
    real ratio = penetration / parameter[REFERENCE_PENETRATION];
    return parameter[REFERENCE_FORCE] * power_of(ratio, parameter[EXPONENT]);
}

/* Force of an instant, never pulling. */
static inline real contact_force(const double *parameter, real penetration, real rate) {
    real depth = penetration / parameter[FULL_DAMPING_PENETRATION];
    real damping = parameter[DAMPING] * mean_rise(depth, depth);
    return pushing(elastic_force(parameter, penetration) + damping * rate);
}

/* Mean over a step of the force of the potential, and of the whole force, which never pulls. */
typedef struct MeanForces {
    real elastic, whole;
} MeanForces;

static inline MeanForces mean_forces(const double *parameter, real before, real after, double h) {
    const double reference = parameter[REFERENCE_PENETRATION], full = parameter[FULL_DAMPING_PENETRATION];
    real elastic =
        parameter[REFERENCE_FORCE] * mean_power(before / reference, after / reference, parameter[EXPONENT]);
    real whole =
        elastic + parameter[DAMPING] * mean_rise(before / full, after / full) * ((after - before) / h);
    if (parameter[END_WEIGHT] != 0.5)
        whole += (parameter[END_WEIGHT] - 0.5) * (elastic_force(parameter, after) - elastic_force(parameter, before));
    return (MeanForces){elastic, pushing(whole)};
}

static inline Place contact_place(const Contact *contact, const real *u) {
    Vector3 direction = {contact->direction[0], contact->direction[1], contact->direction[2]};
    Place place;
    place.normal = quaternion_rotate(quaternion_of(u + 3), direction);
    place.arm = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    place.penetration = contact->parameter[GAP] - vector_dot(place.normal, place.arm);
    Vector3 apart = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7));
    place.rate = -vector_dot(place.normal, vector_subtract(apart, vector_cross(vector_of(u + 10), place.arm)));
    return place;
}

/* One step: the mean force from the penetrations at both ends, and the heat it makes. */
int NAME(contact_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Contact *contact = self;
    (void)why;
    Vector3 old_normal = {x[NORMAL], x[NORMAL + 1], x[NORMAL + 2]};
    Vector3 old_arm = {x[ARM], x[ARM + 1], x[ARM + 2]};
    Place now = contact_place(contact, u);
    real before = contact->parameter[GAP] - vector_dot(old_normal, old_arm), after = now.penetration;
    MeanForces mean = mean_forces(contact->parameter, before, after, h);
    vector_store(now.normal, x_next + NORMAL);
    vector_store(now.arm, x_next + ARM);
    x_next[HEAT] = x[HEAT] + (mean.whole - mean.elastic) * (after - before);
    /* with both means the work on the ports is the force times the change of penetration */
    store_pair(vector_scaled(mean.whole, vector_mean(old_normal, now.normal)), (Vector3){0.0, 0.0, 0.0},
               vector_mean(old_arm, now.arm), x_next + WRENCH);
    if (value_of(u[contact->impulse]) < 0.5)
        store_mid_step_after(x + SLIDE, (after - before) / h, h, x_next + SLIDE);
    else
        store_mid_step_start(now.rate, x_next + SLIDE);
    return 1;
}

/* Wrenches on both ports. */
void NAME(contact_outputs)(void *self, const real *x, const real *u, real *y) {
    const Contact *contact = self;
    if (!contact->endpoint) {
        for (int i = 0; i < 2 * WRENCH_SIZE; i++) y[i] = x[WRENCH + i];
        return;
    }
    Place now = contact_place(contact, u);
    real force = contact_force(contact->parameter, now.penetration, now.rate);
    store_pair(vector_scaled(force, now.normal), (Vector3){0.0, 0.0, 0.0}, now.arm, y);
}

/* Heat of the end-point force. */
int NAME(contact_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Contact *contact = self;
    (void)raw, (void)x, (void)why;
    Place now = contact_place(contact, u);
    real force = contact_force(contact->parameter, now.penetration, now.rate);
    rates[0] = (force - elastic_force(contact->parameter, now.penetration)) * now.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

int contact_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                          double complex *rates, Reason *why);
int contact_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                         Reason *why);
void contact_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [GAP] = {"gap", 1},
    [REFERENCE_FORCE] = {"reference_force", 1},
    [REFERENCE_PENETRATION] = {"reference_penetration", 1},
    [EXPONENT] = {"exponent", 1},
    [DAMPING] = {"damping", 1},
    [FULL_DAMPING_PENETRATION] = {"full_damping_penetration", 1},
    [END_WEIGHT] = {"end_weight", 1},
};

static int read_direction(const Data *data, double direction[3], Reason *why) {
    const double *value = data_array(data, "normal", 3, why);
    if (!value) return 0;
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        direction[i] = value[i];
        square += value[i] * value[i];
    }
    if (!(fabs(square - 1.0) < 1e-9)) return refuse(why, "normal is not a direction of unit length");
    return 1;
}

static void *contact_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Contact *contact = allocate(memory, sizeof *contact);
    if (!contact) {
        refuse(why, "there is no memory for a contact");
        return NULL;
    }
    *states = STATES;
    int usable = check_sizes("contact", sizes, 2 * MOTION_SIZE + 1, 2 * WRENCH_SIZE, 5, why) &&
                 read_direction(data, contact->direction, why) &&
                 read_choice(data, "endpoint", 1, &contact->endpoint, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, contact->places, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &contact->impulse, why);
    return usable ? contact : NULL;
}

static int contact_prepare(void *self, const double *p, Reason *why) {
    Contact *contact = self;
    (void)why;
    for (int i = 0; i < PARAMETERS; i++) contact->parameter[i] = p[contact->places[i]];
    return 1;
}

/* At the pose of the inputs. */
static int contact_initial(void *self, const double *u, double *x, Reason *why) {
    const Contact *contact = self;
    (void)why;
    Place now = contact_place(contact, u);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    vector_store(now.normal, x + NORMAL);
    vector_store(now.arm, x + ARM);
    store_mid_step_start(now.rate, x + SLIDE);
    return 1;
}

/* Penetration and force at the communication point, energies. */
static void contact_observe(void *self, const double *x, const double *u, double *z) {
    const Contact *contact = self;
    const double *parameter = contact->parameter;
    Place now = contact_place(contact, u);
    double felt = contact->endpoint ? now.rate : mid_step_now(x + SLIDE);
    z[0] = now.penetration;
    z[1] = contact_force(parameter, now.penetration, felt);
    z[2] = elastic_force(parameter, now.penetration) * fmax(now.penetration, 0.0) / (parameter[EXPONENT] + 1.0);
    z[3] = x[HEAT];
    z[4] = now.penetration >= 0.0 ? 1.0 : 0.0;
}

static size_t contact_continuous(const void *self, size_t *places) {
    (void)self;
    if (places) places[0] = HEAT;
    return 1;
}

const Kernel contact_kernel = {
    "contact",       contact_create,       contact_prepare,         contact_initial, contact_step_real, contact_outputs_real,
    contact_observe, contact_step_complex, contact_outputs_complex, NULL,            NULL,
    .continuous = contact_continuous,
    .rates = contact_rates_real,
    .rates_complex = contact_rates_complex,
};

#endif
