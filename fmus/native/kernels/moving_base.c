/* Moving base: ports that follow prescribed motions together, a shift and a turn, and the loads that this takes; the
   twin of components/moving_base.py. */

#include "moving_base_layout.h"
#include "base_ports.h"
#include "frames.h"
#include "kernel.h"
#include "motion_law.h"
#include "port_loads.h"

typedef struct {
    size_t ports;
    double pivot[3], own_pivot[3], shift_axis[3], turn_axis[3]; /* the pivot in the world and in the frame */
    double frame[4];                                            /* orientation where the laws are zero */
    const double *arms, *orientations, *outside; /* 3, 4 and 1 a port, in the frame; from outside acts what has a flag */
    MotionLaw translation, rotation;
} MovingBase;

static inline const real *own_inputs(const MovingBase *base, const real *u) { return u + WRENCH_SIZE * base->ports; }

static inline Vector3 along(const double axis[3], real size) {
    return (Vector3){size * axis[0], size * axis[1], size * axis[2]};
}

/* Orientation of the frame after a turn. */
static inline Quaternion frame_after(const MovingBase *base, real turn) {
    const Quaternion frame = {base->frame[0], base->frame[1], base->frame[2], base->frame[3]};
    return quaternion_multiply(quaternion_exponential(along(base->turn_axis, turn)), frame);
}

static inline Quaternion turned_by(const MovingBase *base, real clock) {
    return frame_after(base, motion_value(&base->rotation, clock));
}

/* The pivot after its shift. */
static inline Vector3 shifted_pivot(const MovingBase *base, real clock) {
    const Vector3 shift = along(base->shift_axis, motion_value(&base->translation, clock));
    return (Vector3){base->pivot[0] + shift.x, base->pivot[1] + shift.y, base->pivot[2] + shift.z};
}

/* Position of a port. */
static inline Vector3 place_of(const MovingBase *base, size_t port, real clock, Quaternion turned) {
    const double *arm = base->arms + 3 * port;
    return vector_add(shifted_pivot(base, clock), quaternion_rotate(turned, (Vector3){arm[0], arm[1], arm[2]}));
}

/* Displacement of a port from one time to another, free of the cancellation of positions. */
static inline Vector3 displacement(const MovingBase *base, size_t port, double before, double after) {
    const double *arm = base->arms + 3 * port;
    const double start = value_of(motion_value(&base->rotation, before));
    const double end = value_of(motion_value(&base->rotation, after));
    const Quaternion between = frame_after(base, 0.5 * (start + end));
    const Vector3 chord = along(base->turn_axis, 2.0 * sin(0.5 * (end - start)));
    const double first = value_of(motion_value(&base->translation, before));
    const Vector3 shift = along(base->shift_axis, value_of(motion_value(&base->translation, after)) - first);
    return vector_add(shift, vector_cross(chord, quaternion_rotate(between, (Vector3){arm[0], arm[1], arm[2]})));
}

/* First moments of a port's velocity and angular velocity over a step: positions against that in the middle, whose own
   weights cancel. */
static inline void moments_of(const MovingBase *base, size_t port, double before, double clock, Vector3 moments[2]) {
    const double middle = 0.5 * (before + clock), arm = 0.5 * sqrt(0.6) * (clock - before);
    const double times[4] = {before, middle - arm, middle + arm, clock};
    const double weights[4] = {1.0, -5.0 / 9.0, -5.0 / 9.0, 1.0};
    moments[0] = moments[1] = (Vector3){0.0, 0.0, 0.0};
    if (before == clock) return;
    for (int i = 0; i < 4; i++)
        moments[0] = vector_add(moments[0], vector_scaled(weights[i], displacement(base, port, middle, times[i])));
    moments[1] = along(base->turn_axis, motion_rate_moment(&base->rotation, before, clock));
}

/* Follow the laws; remember the wrenches of the step and their work. */
int NAME(moving_base_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const MovingBase *base = self;
    const real *own = own_inputs(base, u), *slopes = own + OWN_INPUTS;
    (void)why;
    const double clock = x[X_CLOCK], after = value_of(own[U_HOLD]) > 0.5 ? clock : clock + h;
    /* what mean torques of connections do their work on, see `turn_between` in components/numerics/relative_motion.py */
    const double angle = value_of(motion_value(&base->rotation, after) - motion_value(&base->rotation, clock));
    const double turn = 2.0 * tan(0.5 * angle);
    real work = 0.0;
    for (size_t k = 0; k < base->ports; k++) {
        Vector3 moments[2], moved = displacement(base, k, clock, after);
        moments_of(base, k, clock, after, moments);
        work += vector_dot(vector_of(u + WRENCH_SIZE * k), moved);
        work += vector_dot(vector_of(u + WRENCH_SIZE * k + 3), along(base->turn_axis, turn));
        work += vector_dot(vector_of(slopes + WRENCH_SIZE * k), moments[0]);
        work += vector_dot(vector_of(slopes + WRENCH_SIZE * k + 3), moments[1]);
    }
    x_next[X_CLOCK] = after;
    x_next[X_PASSED] = after - clock;
    x_next[X_WORK] = x[X_WORK] - work;
    store_port_loads(base->ports, x + STATES, u, slopes, h, value_of(own[U_IMPULSE]) > 0.5, x_next + STATES);
    return 1;
}

/* Velocity and angular velocity of a port. */
static inline void rates_of(const MovingBase *base, size_t port, real clock, Vector3 rates[2]) {
    const double *arm = base->arms + 3 * port;
    Vector3 turned = quaternion_rotate(turned_by(base, clock), (Vector3){arm[0], arm[1], arm[2]});
    rates[0] = along(base->shift_axis, motion_rate(&base->translation, clock));
    rates[1] = along(base->turn_axis, motion_rate(&base->rotation, clock));
    rates[0] = vector_add(rates[0], vector_cross(rates[1], turned));
}

/* Motion by the laws, time to their next break, first moments of the last step. */
void NAME(moving_base_outputs)(void *self, const real *x, const real *u, real *y) {
    const MovingBase *base = self;
    (void)u;
    const real clock = x[X_CLOCK];
    const double last = value_of(clock), first = last - value_of(x[X_PASSED]);
    const Quaternion turned = turned_by(base, clock);
    real *own = y + MOTION_SIZE * base->ports, *slopes = own + OWN_OUTPUTS;
    for (size_t k = 0; k < base->ports; k++, y += MOTION_SIZE, slopes += WRENCH_SIZE) {
        const double *q = base->orientations + 4 * k;
        Vector3 rates[2], moments[2];
        rates_of(base, k, clock, rates);
        moments_of(base, k, first, last, moments);
        vector_store(place_of(base, k, clock, turned), y);
        quaternion_store(quaternion_multiply(turned, (Quaternion){q[0], q[1], q[2], q[3]}), y + 3);
        vector_store(rates[0], y + 7);
        vector_store(rates[1], y + 10);
        vector_store(moments[0], slopes);
        vector_store(moments[1], slopes + 3);
    }
    const real shift = motion_time_to_break(&base->translation, clock);
    const real turn = motion_time_to_break(&base->rotation, clock);
    own[Y_TIME_TO_BREAK] = value_of(shift) < value_of(turn) ? shift : turn;
}

/* Rate of the clock, and power of the motion. */
int NAME(moving_base_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const MovingBase *base = self;
    const int held = value_of(own_inputs(base, u)[U_HOLD]) > 0.5;
    (void)raw, (void)why;
    rates[0] = held ? 0.0 : 1.0;
    rates[1] = 0.0;
    for (size_t k = 0; k < base->ports && !held; k++) {
        Vector3 moving[2];
        rates_of(base, k, x[X_CLOCK], moving);
        rates[1] -= vector_dot(vector_of(u + WRENCH_SIZE * k), moving[0]);
        rates[1] -= vector_dot(vector_of(u + WRENCH_SIZE * k + 3), moving[1]);
    }
    return 1;
}

#ifndef FANFOLD_COMPLEX

int moving_base_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                             Reason *why);
void moving_base_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);
int moving_base_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                              double complex *rates, Reason *why);

static int read_part(const Data *data, const char *part, size_t count, double *numbers, Memory *memory, Reason *why) {
    const double *found = read_table_part(data, memory, "base", part, count, why);
    if (found) memcpy(numbers, found, count * sizeof *numbers);
    return found != NULL;
}

static int read_base(MovingBase *base, const Data *data, Memory *memory, Reason *why) {
    return read_base_ports(data, memory, &base->ports, &base->arms, &base->orientations, why) &&
           (base->outside = read_table_part(data, memory, "base", "outside", base->ports, why)) &&
           read_part(data, "pivot", 3, base->pivot, memory, why) &&
           read_part(data, "own_pivot", 3, base->own_pivot, memory, why) &&
           read_part(data, "frame", 4, base->frame, memory, why) &&
           read_part(data, "translation_axis", 3, base->shift_axis, memory, why) &&
           read_part(data, "rotation_axis", 3, base->turn_axis, memory, why) &&
           read_motion_law(data, memory, "translation", &base->translation, why) &&
           read_motion_law(data, memory, "rotation", &base->rotation, why);
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    MovingBase *base = allocate(memory, sizeof *base);
    if (!base) {
        refuse(why, "no memory for a base");
        return NULL;
    }
    if (!read_base(base, data, memory, why)) return NULL;
    const size_t wrenches = WRENCH_SIZE * base->ports, motions = MOTION_SIZE * base->ports;
    const Sizes own = {PARAMETERS, wrenches + OWN_INPUTS + wrenches, motions + OWN_OUTPUTS + wrenches,
                       OBSERVATIONS + port_loads_told(base->ports)};
    if (!check_sizes("moving base", sizes, &own, why)) return NULL;
    *states = STATES + port_loads_record(base->ports);
    return base;
}

static int prepare(void *self, const double *p, Reason *why) {
    (void)self, (void)p, (void)why;
    return 1;
}

/* At the start of the laws. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    const MovingBase *base = self;
    (void)u, (void)why;
    memset(x, 0, (STATES + port_loads_record(base->ports)) * sizeof(double));
    return 1;
}

/* Shift, turn, frame, work; loads now and one step earlier. */
static void observe(void *self, const double *x, const double *u, double *z) {
    const MovingBase *base = self;
    double axes[9], axes_before[9];
    z[Z_SHIFT] = motion_value(&base->translation, x[X_CLOCK]);
    z[Z_TURN] = motion_value(&base->rotation, x[X_CLOCK]);
    z[Z_SUPPLIED_ENERGY] = x[X_WORK];
    const Quaternion frame = turned_by(base, x[X_CLOCK]);
    const Vector3 reach = quaternion_rotate(frame, (Vector3){base->own_pivot[0], base->own_pivot[1], base->own_pivot[2]});
    vector_store(vector_subtract(shifted_pivot(base, x[X_CLOCK]), reach), z + Z_FRAME_POSITION);
    quaternion_store(frame, z + Z_FRAME_ORIENTATION);
    rotation_matrix(frame, axes);
    rotation_matrix(turned_by(base, x[X_CLOCK] - x[X_PASSED]), axes_before);
    observe_port_loads(base->ports, base->arms, x + STATES, u, axes, axes_before, z + OBSERVATIONS);
    leave_outside(base->ports, base->outside, base->arms, z + OBSERVATIONS);
}

static size_t continuous(const void *self, size_t *places) {
    static const size_t own[] = CONTINUOUS_PLACES;
    (void)self;
    if (places) memcpy(places, own, sizeof own);
    return CONTINUOUS;
}

static double time_to_break(void *self, const double *x, const double *u) {
    const MovingBase *base = self;
    const int stands = own_inputs(base, u)[U_HOLD] > 0.5;
    return fmin(motion_break(&base->translation, x[X_CLOCK], stands), motion_break(&base->rotation, x[X_CLOCK], stands));
}

const Kernel moving_base_kernel = {
    .kind = KIND,
    .create = create,
    .prepare = prepare,
    .initial = initial,
    .step = moving_base_step_real,
    .outputs = moving_base_outputs_real,
    .observe = observe,
    .step_complex = moving_base_step_complex,
    .outputs_complex = moving_base_outputs_complex,
    .continuous = continuous,
    .time_to_break = time_to_break,
    .rates = moving_base_rates_real,
    .rates_complex = moving_base_rates_complex,
    .layout = LAYOUT_DIGEST,
};

#endif
