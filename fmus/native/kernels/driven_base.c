/* Driven base: ports of a frame whose accelerations change at rates that are inputs, and what this motion takes; the
   twin of components/driven_base.py. */

#include "driven_base_layout.h"
#include "base_ports.h"
#include "frames.h"
#include "kernel.h"
#include "port_loads.h"

typedef struct {
    size_t ports;
    const double *arms, *orientations; /* 3 and 4 a port, in the frame */
} DrivenBase;

/* Rates, accelerations and how fast these change, of the frame or of its rotation. */
typedef struct {
    Vector3 rate, acceleration, change;
} Course;

/* Motion over a step about its middle. */
typedef struct {
    double h;
    Course shift, turn;
    Quaternion orientation;
} DrivenStep;

static inline const real *own_inputs(const DrivenBase *base, const real *u) { return u + WRENCH_SIZE * base->ports; }

static inline Vector3 arm_of(const DrivenBase *base, size_t port) {
    const double *arm = base->arms + 3 * port;
    return (Vector3){arm[0], arm[1], arm[2]};
}

/* What a rate adds up to in a time. */
static inline Vector3 way_of(Course c, double t) {
    const Vector3 found = vector_add(vector_scaled(t, c.rate), vector_scaled(0.5 * t * t, c.acceleration));
    return vector_add(found, vector_scaled(t * t * t / 6.0, c.change));
}

static inline Vector3 acceleration_after(Course c, double t) {
    return vector_add(c.acceleration, vector_scaled(t, c.change));
}

/* The same course from a time on. */
static inline Course course_after(Course c, double t) {
    const Vector3 gain = vector_add(vector_scaled(t, c.acceleration), vector_scaled(0.5 * t * t, c.change));
    return (Course){vector_add(c.rate, gain), acceleration_after(c, t), c.change};
}

/* Rotation after a time under an angular velocity like that (Magnus, to t^4). */
static inline Quaternion turned_after(Course c, double t) {
    const Vector3 lean = vector_add(vector_scaled(t * t * t / 12.0, c.acceleration),
                                    vector_scaled(t * t * t * t / 24.0, c.change));
    return quaternion_exponential(vector_add(way_of(c, t), vector_cross(lean, c.rate)));
}

/* Displacement of a port from the middle to a time after it, free of the cancellation of positions. */
static inline Vector3 moved_after(const DrivenBase *base, size_t port, const DrivenStep *s, double t) {
    const Quaternion q = turned_after(s->turn, t);
    const Vector3 turn = {q.x, q.y, q.z};
    const Vector3 chord = vector_cross(turn, quaternion_rotate(s->orientation, arm_of(base, port)));
    return vector_add(vector_add(way_of(s->shift, t), vector_scaled(2.0 * q.w, chord)), vector_scaled(2.0, vector_cross(turn, chord)));
}

/* First moments of a port's velocity and angular velocity over a step. */
static inline void driven_moments(const DrivenBase *base, size_t port, const DrivenStep *s, Vector3 moments[2]) {
    const double arm = 0.5 * sqrt(0.6) * s->h, times[4] = {-0.5 * s->h, -arm, arm, 0.5 * s->h};
    const double weights[4] = {1.0, -5.0 / 9.0, -5.0 / 9.0, 1.0};
    moments[0] = (Vector3){0.0, 0.0, 0.0};
    for (int i = 0; i < 4; i++)
        moments[0] = vector_add(moments[0], vector_scaled(weights[i], moved_after(base, port, s, times[i])));
    moments[1] = vector_scaled(s->h * s->h / 6.0, s->turn.acceleration);
}

/* Work of the wrenches on the ports over a step that turns the frame by q. */
static inline real work_of_ports(const DrivenBase *base, const DrivenStep *s, Quaternion q, const real *u,
                                 const real *slopes) {
    /* what mean torques of connections do their work on, see `turn_between` in components/numerics/relative_motion.py */
    const real scale = 2.0 / q.w;
    const Vector3 turn = {scale * q.x, scale * q.y, scale * q.z};
    real work = 0.0;
    for (size_t k = 0; k < base->ports; k++) {
        Vector3 moments[2];
        driven_moments(base, k, s, moments);
        work += vector_dot(vector_of(u + WRENCH_SIZE * k), vector_subtract(moved_after(base, k, s, 0.5 * s->h),
                                                                           moved_after(base, k, s, -0.5 * s->h)));
        work += vector_dot(vector_of(u + WRENCH_SIZE * k + 3), turn);
        work += vector_dot(vector_of(slopes + WRENCH_SIZE * k), moments[0]);
        work += vector_dot(vector_of(slopes + WRENCH_SIZE * k + 3), moments[1]);
    }
    return work;
}

/* Force and torque of all ports about the frame's origin, axes of the frame. */
static inline void sum_loads(const DrivenBase *base, const real *u, Quaternion frame, Vector3 sums[2]) {
    const Quaternion back = quaternion_conjugate(frame);
    sums[0] = sums[1] = (Vector3){0.0, 0.0, 0.0};
    for (size_t k = 0; k < base->ports; k++, u += WRENCH_SIZE) {
        const Vector3 force = quaternion_rotate(back, vector_of(u)), torque = quaternion_rotate(back, vector_of(u + 3));
        sums[0] = vector_add(sums[0], force);
        sums[1] = vector_add(sums[1], vector_add(torque, vector_cross(arm_of(base, k), force)));
    }
}

/* Where the frame stands still. */
static inline void stay(const double *x, real *x_next) {
    for (size_t i = 0; i < STATES; i++) x_next[i] = x[i];
    for (size_t i = 0; i < 4; i++) x_next[X_MIDDLE + i] = x[X_ORIENTATION + i];
    x_next[X_PASSED] = 0.0;
}

static inline Course course_of(const double *rate, const double *acceleration, const real *change) {
    return (Course){{rate[0], rate[1], rate[2]}, {acceleration[0], acceleration[1], acceleration[2]}, vector_of(change)};
}

/* Move on; remember the wrenches of the step and their work. */
int NAME(driven_base_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const DrivenBase *base = self;
    const real *own = own_inputs(base, u), *slopes = own + OWN_INPUTS;
    (void)why;
    store_port_loads(base->ports, x + STATES, u, slopes, h, value_of(own[U_IMPULSE]) > 0.5, x_next + STATES);
    stay(x, x_next);
    if (value_of(own[U_HOLD]) > 0.5) return 1;
    const Course shift = course_of(x + X_VELOCITY, x + X_ACCELERATION, own + U_ACCELERATION_RATE);
    const Course turn = course_of(x + X_ANGULAR_VELOCITY, x + X_ANGULAR_ACCELERATION, own + U_ANGULAR_ACCELERATION_RATE);
    const double *q = x + X_ORIENTATION, *p = x + X_POSITION;
    const Quaternion before = {q[0], q[1], q[2], q[3]};
    const DrivenStep s = {h, course_after(shift, 0.5 * h), course_after(turn, 0.5 * h),
                          quaternion_multiply(turned_after(turn, 0.5 * h), before)};
    const Quaternion after = quaternion_multiply(turned_after(s.turn, 0.5 * h), s.orientation);
    const Quaternion between = quaternion_multiply(after, quaternion_conjugate(before));
    const Course shift_after = course_after(shift, h), turn_after = course_after(turn, h);
    Vector3 sums[2];
    sum_loads(base, u, s.orientation, sums);
    for (size_t i = 0; i < 2; i++) {
        const double *impulse = x + X_IMPULSE + 3 * i; /* the angular one behind the other */
        const Vector3 before_it = {impulse[0], impulse[1], impulse[2]};
        vector_store(vector_add(before_it, vector_scaled(h, sums[i])), x_next + X_IMPULSE + 3 * i);
    }
    x_next[X_WORK] = x[X_WORK] - work_of_ports(base, &s, between, u, slopes);
    vector_store(vector_add((Vector3){p[0], p[1], p[2]}, way_of(shift, h)), x_next + X_POSITION);
    quaternion_store(after, x_next + X_ORIENTATION);
    vector_store(shift_after.rate, x_next + X_VELOCITY);
    vector_store(turn_after.rate, x_next + X_ANGULAR_VELOCITY);
    vector_store(shift_after.acceleration, x_next + X_ACCELERATION);
    vector_store(turn_after.acceleration, x_next + X_ANGULAR_ACCELERATION);
    quaternion_store(s.orientation, x_next + X_MIDDLE);
    vector_store(shift.change, x_next + X_LAST_RATE);
    vector_store(turn.change, x_next + X_LAST_ANGULAR_RATE);
    x_next[X_PASSED] = h;
    return 1;
}

/* Motion of the ports, first moments of the last step. */
void NAME(driven_base_outputs)(void *self, const real *x, const real *u, real *y) {
    const DrivenBase *base = self;
    (void)u;
    const Quaternion frame = quaternion_of(x + X_ORIENTATION);
    const Vector3 position = vector_of(x + X_POSITION), velocity = vector_of(x + X_VELOCITY);
    const Vector3 rate = vector_of(x + X_ANGULAR_VELOCITY);
    const double h = value_of(x[X_PASSED]);
    const Course shift = {velocity, vector_of(x + X_ACCELERATION), vector_of(x + X_LAST_RATE)};
    const Course turn = {rate, vector_of(x + X_ANGULAR_ACCELERATION), vector_of(x + X_LAST_ANGULAR_RATE)};
    const DrivenStep s = {h, course_after(shift, -0.5 * h), course_after(turn, -0.5 * h),
                          quaternion_of(x + X_MIDDLE)};
    real *slopes = y + MOTION_SIZE * base->ports;
    for (size_t k = 0; k < base->ports; k++, y += MOTION_SIZE, slopes += WRENCH_SIZE) {
        const double *q = base->orientations + 4 * k;
        const Vector3 reach = quaternion_rotate(frame, arm_of(base, k));
        Vector3 moments[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
        if (h > 0.0) driven_moments(base, k, &s, moments);
        vector_store(vector_add(position, reach), y);
        quaternion_store(quaternion_multiply(frame, (Quaternion){q[0], q[1], q[2], q[3]}), y + 3);
        vector_store(vector_add(velocity, vector_cross(rate, reach)), y + 7);
        vector_store(rate, y + 10);
        vector_store(moments[0], slopes);
        vector_store(moments[1], slopes + 3);
    }
}

/* Rates of the frame's motion and of its accelerations, power of the motion, and loads in sum. */
int NAME(driven_base_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const DrivenBase *base = self;
    const real *own = own_inputs(base, u);
    const Quaternion frame = quaternion_of(x + X_ORIENTATION);
    const Vector3 velocity = vector_of(x + X_VELOCITY), rate = vector_of(x + X_ANGULAR_VELOCITY);
    real power = 0.0;
    (void)raw, (void)why;
    for (size_t i = 0; i < CONTINUOUS; i++) rates[i] = 0.0;
    if (value_of(own[U_HOLD]) > 0.5) return 1;
    for (size_t k = 0; k < base->ports; k++) {
        const Vector3 reach = quaternion_rotate(frame, arm_of(base, k));
        power += vector_dot(vector_of(u + WRENCH_SIZE * k), vector_add(velocity, vector_cross(rate, reach)));
        power += vector_dot(vector_of(u + WRENCH_SIZE * k + 3), rate);
    }
    vector_store(velocity, rates);
    quaternion_store(quaternion_multiply((Quaternion){0.0, 0.5 * rate.x, 0.5 * rate.y, 0.5 * rate.z}, frame), rates + 3);
    for (size_t i = 0; i < 6; i++) {
        rates[7 + i] = x[X_ACCELERATION + i]; /* both accelerations, one behind the other */
        rates[13 + i] = own[U_ACCELERATION_RATE + i];
    }
    rates[19] = -power;
    Vector3 sums[2];
    sum_loads(base, u, frame, sums);
    vector_store(sums[0], rates + 20);
    vector_store(sums[1], rates + 23);
    return 1;
}

#ifndef FANFOLD_COMPLEX

int driven_base_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                              double complex *rates, Reason *why);
int driven_base_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                             Reason *why);
void driven_base_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    DrivenBase *base = allocate(memory, sizeof *base);
    if (!base) {
        refuse(why, "no memory for a base");
        return NULL;
    }
    if (!read_base_ports(data, memory, &base->ports, &base->arms, &base->orientations, why)) return NULL;
    const size_t wrenches = WRENCH_SIZE * base->ports, motions = MOTION_SIZE * base->ports;
    const Sizes own = {PARAMETERS, wrenches + OWN_INPUTS + wrenches, motions + OWN_OUTPUTS + wrenches,
                       OBSERVATIONS + port_loads_told(base->ports)};
    if (!check_sizes("driven base", sizes, &own, why)) return NULL;
    *states = STATES + port_loads_record(base->ports);
    return base;
}

static int prepare(void *self, const double *p, Reason *why) {
    (void)self, (void)p, (void)why;
    return 1;
}

/* At rest. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    const DrivenBase *base = self;
    (void)u, (void)why;
    memset(x, 0, (STATES + port_loads_record(base->ports)) * sizeof(double));
    x[X_ORIENTATION] = x[X_MIDDLE] = 1.0;
    return 1;
}

/* Frame and work; loads now and one step earlier. */
static void observe(void *self, const double *x, const double *u, double *z) {
    const DrivenBase *base = self;
    double axes[9], axes_before[9];
    const Quaternion frame = quaternion_of(x + X_ORIENTATION);
    const Course turn = {vector_of(x + X_ANGULAR_VELOCITY), vector_of(x + X_ANGULAR_ACCELERATION),
                         vector_of(x + X_LAST_ANGULAR_RATE)};
    const Quaternion back = turned_after(turn, -x[X_PASSED]);
    vector_store(vector_of(x + X_POSITION), z + Z_FRAME_POSITION);
    quaternion_store(frame, z + Z_FRAME_ORIENTATION);
    z[Z_SUPPLIED_ENERGY] = x[X_WORK];
    memcpy(z + Z_INTERFACE_IMPULSE, x + X_IMPULSE, 6 * sizeof(double)); /* the angular one behind the other */
    rotation_matrix(frame, axes);
    rotation_matrix(quaternion_multiply(back, frame), axes_before);
    observe_port_loads(base->ports, base->arms, x + STATES, u, axes, axes_before, z + OBSERVATIONS);
}

static size_t continuous(const void *self, size_t *places) {
    static const size_t own[] = CONTINUOUS_PLACES;
    (void)self;
    if (places) memcpy(places, own, sizeof own);
    return CONTINUOUS;
}

const Kernel driven_base_kernel = {
    .kind = KIND,
    .create = create,
    .prepare = prepare,
    .initial = initial,
    .step = driven_base_step_real,
    .outputs = driven_base_outputs_real,
    .observe = observe,
    .step_complex = driven_base_step_complex,
    .outputs_complex = driven_base_outputs_complex,
    .continuous = continuous,
    .rates = driven_base_rates_real,
    .rates_complex = driven_base_rates_complex,
    .layout = LAYOUT_DIGEST,
};

#endif
