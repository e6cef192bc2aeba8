/* Unilateral contact without friction between a point and a plane: the twin of components/contact.py. */

#include "contact_layout.h"
#include "connection.h"

typedef struct Contact {
    Connection base;
    double direction[3];
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
static inline real elastic_force(const double *p, real penetration) {
    if (value_of(penetration) <= 0.0) return 0.0;
    real ratio = penetration / p[P_REFERENCE_PENETRATION];
    return p[P_REFERENCE_FORCE] * power_of(ratio, p[P_EXPONENT]);
}

/* Force of an instant, never pulling. */
static inline real contact_force(const double *p, real penetration, real rate) {
    real depth = penetration / p[P_FULL_DAMPING_PENETRATION];
    real damping = p[P_DAMPING] * mean_rise(depth, depth);
    return pushing(elastic_force(p, penetration) + damping * rate);
}

/* Mean over a step of the force of the potential, and of the whole force, which never pulls. */
typedef struct MeanForces {
    real elastic, whole;
} MeanForces;

static inline MeanForces mean_forces(const double *p, real before, real after, double h) {
    const double reference = p[P_REFERENCE_PENETRATION], full = p[P_FULL_DAMPING_PENETRATION];
    real elastic =
        p[P_REFERENCE_FORCE] * mean_power(before / reference, after / reference, p[P_EXPONENT]);
    real whole =
        elastic + p[P_DAMPING] * mean_rise(before / full, after / full) * ((after - before) / h);
    return (MeanForces){elastic, pushing(whole)};
}

static inline Place contact_place(const Contact *contact, const real *u) {
    Vector3 direction = {contact->direction[0], contact->direction[1], contact->direction[2]};
    Place place;
    place.normal = quaternion_rotate(quaternion_of(u + 3), direction);
    place.arm = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    place.penetration = contact->base.p[P_GAP] - vector_dot(place.normal, place.arm);
    Vector3 apart = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7));
    place.rate = -vector_dot(place.normal, vector_subtract(apart, vector_cross(vector_of(u + 10), place.arm)));
    return place;
}

/* One step: the mean force from the penetrations at both ends, and the heat it makes. */
int NAME(contact_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Contact *contact = self;
    (void)why;
    const double *n = x + X_NORMAL, *r = x + X_ARM;
    Vector3 old_normal = {n[0], n[1], n[2]}, old_arm = {r[0], r[1], r[2]};
    Place now = contact_place(contact, u);
    real before = contact->base.p[P_GAP] - vector_dot(old_normal, old_arm), after = now.penetration;
    MeanForces mean = mean_forces(contact->base.p, before, after, h);
    vector_store(now.normal, x_next + X_NORMAL);
    vector_store(now.arm, x_next + X_ARM);
    x_next[X_HEAT] = x[X_HEAT] + (mean.whole - mean.elastic) * (after - before);
    /* with both means the work on the ports is the force times the change of penetration */
    store_pair(vector_scaled(mean.whole, vector_mean(old_normal, now.normal)), (Vector3){0.0, 0.0, 0.0},
               vector_mean(old_arm, now.arm), x_next + X_WRENCH);
    store_mid_step_after(x + X_RATE, (after - before) / h, h, x_next + X_RATE);
    if (commanded(u, U_IMPULSE)) store_mid_step_start(now.rate, x_next + X_RATE);
    return 1;
}

/* Wrenches on both ports. */
void NAME(contact_outputs)(void *self, const real *x, const real *u, real *y) {
    const Contact *contact = self;
    if (gives_means(&contact->base, x, y)) return;
    Place now = contact_place(contact, u);
    real force = contact_force(contact->base.p, now.penetration, now.rate);
    store_pair(vector_scaled(force, now.normal), (Vector3){0.0, 0.0, 0.0}, now.arm, y);
}

/* Heat of the end-point force. */
int NAME(contact_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Contact *contact = self;
    (void)raw, (void)x, (void)why;
    Place now = contact_place(contact, u);
    real force = contact_force(contact->base.p, now.penetration, now.rate);
    rates[0] = (force - elastic_force(contact->base.p, now.penetration)) * now.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(contact)

static void *contact_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Contact *contact = create_connection(data, sizes, memory, sizeof *contact, states, why);
    return contact && read_direction(data, "normal", contact->direction, why) ? contact : NULL;
}

static int contact_prepare(void *self, const double *p, Reason *why) {
    return prepare_connection(self, p, 2.0, why);
}

/* At the pose of the inputs. */
static int contact_initial(void *self, const double *u, double *x, Reason *why) {
    const Contact *contact = self;
    (void)why;
    Place now = contact_place(contact, u);
    memset(x, 0, STATES * sizeof *x);
    vector_store(now.normal, x + X_NORMAL);
    vector_store(now.arm, x + X_ARM);
    store_mid_step_start(now.rate, x + X_RATE);
    return 1;
}

/* Penetration and force at the communication point, energies. */
static void contact_observe(void *self, const double *x, const double *u, double *z) {
    const Contact *contact = self;
    const double *p = contact->base.p;
    Place now = contact_place(contact, u);
    double felt = contact->base.endpoint ? now.rate : mid_step_now(x + X_RATE);
    z[Z_PENETRATION] = now.penetration;
    z[Z_CONTACT_FORCE] = contact_force(p, now.penetration, felt);
    z[Z_POTENTIAL_ENERGY] = elastic_force(p, now.penetration) * fmax(now.penetration, 0.0) / (p[P_EXPONENT] + 1.0);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    z[Z_IN_CONTACT] = now.penetration >= 0.0 ? 1.0 : 0.0;
}

const Kernel contact_kernel = {CONNECTION_FUNCTIONS(contact, contact)};

#endif
