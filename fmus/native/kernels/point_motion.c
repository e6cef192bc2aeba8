/* Prescribed motion of a point: the distance of two ports along a direction follows a motion law, through a spring: the
   twin of components/point_motion.py. */

#include "point_motion_layout.h"
#include "connection.h"
#include "motion_law.h"
#include "workless.h"

typedef struct PointMotion {
    Connection base;
    double axis_frame[4];
    MotionLaw law;
} PointMotion;

/* Frame of the direction on the inboard port, gap in world axes, distance and what is left of it beyond the law. */
typedef struct Instant {
    Quaternion frame;
    Vector3 gap;
    real distance, deflection, deflection_rate, commanded, commanded_rate;
} Instant;

static inline Instant point_motion_instant(const PointMotion *motion, const real *u, real clock) {
    Instant now;
    now.frame = frame_on_port(u, motion->axis_frame);
    now.gap = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    Vector3 apart = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7));
    apart = vector_subtract(apart, vector_cross(vector_of(u + 10), now.gap));
    now.distance = quaternion_rotate_back(now.frame, now.gap).x;
    now.commanded = motion->base.p[P_OFFSET] + motion_value(&motion->law, clock);
    now.commanded_rate = 0.0;
    if (!commanded(u, U_HOLD)) now.commanded_rate = motion_rate(&motion->law, clock);
    now.deflection = now.distance - now.commanded;
    now.deflection_rate = quaternion_rotate_back(now.frame, apart).x - now.commanded_rate;
    return now;
}

/* Force of an instant on the outboard port. */
static inline real motion_force(const PointMotion *motion, real deflection, real rate) {
    return -motion->base.p[P_STIFFNESS] * deflection - motion->base.p[P_DAMPING] * rate;
}

/* Mean wrenches on both ports, and their slopes. */
static inline void store_load(const Passage *passage, const MeanLoad *load, real *x_next) {
    const Vector3 zero = {0.0, 0.0, 0.0};
    store_mean_pair(passage, (Vector3){load->force, 0.0, 0.0}, zero, x_next + X_WRENCH);
    store_slope_pair(passage, (Vector3){load->slope, 0.0, 0.0}, zero, x_next + X_WRENCH, x_next + X_SLOPES);
}

/* One step: the mean force of the deflections at both ends, and the work of the motion. */
int NAME(point_motion_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const PointMotion *drive = self;
    const Connection *base = &drive->base;
    (void)why;
    const int impulse = commanded(u, U_IMPULSE), paired = base->paired && !impulse;
    const double clock = commanded(u, U_HOLD) ? x[X_CLOCK] : x[X_CLOCK] + h;
    const double *q = x + X_FRAME, *gap = x + X_GAP;
    Instant now = point_motion_instant(drive, u, clock);
    const double before = base->p[P_OFFSET] + value_of(motion_value(&drive->law, x[X_CLOCK]));
    Passage passage = {{q[0], q[1], q[2], q[3]}, now.frame, {gap[0], gap[1], gap[2]}, now.gap};
    real start = quaternion_rotate_back(passage.frame0, passage.gap0).x - before;
    StepMotion motion = step_motion(x + X_MEMORY, start, now.deflection, h);
    /* inertial terms tame held forces, which an end-point force is not */
    if (base->endpoint) motion.mean_rate = motion.end_rate = value_of(motion.end - motion.start) / h;
    double driven = 0.0;
    for (int i = 0; i < MID_STEP_SIZE; i++) x_next[X_LOAD + i] = 0.0;
    MeanLoad load;
    if (paired) {
        Vector3 velocity, spin;
        relative_moments(&passage, u + INPUTS, &velocity, &spin);
        driven = motion_rate_moment(&drive->law, x[X_CLOCK], clock);
        motion.moment = velocity.x - driven;
        load = workless_spring(base->p[P_STIFFNESS], base->p[P_DAMPING], &motion);
        store_path(&motion, x_next + X_MEMORY);
        store_mid_step_after(x + X_LOAD, load.force, h, x_next + X_LOAD);
    } else {
        load = bushing_load(base->p[P_STIFFNESS], base->p[P_DAMPING], &motion);
        store_memory(&motion, now.deflection_rate, x_next + X_MEMORY);
        if (impulse) store_rate(now.deflection_rate, x_next + X_MEMORY);
    }
    quaternion_store(now.frame, x_next + X_FRAME);
    vector_store(now.gap, x_next + X_GAP);
    store_load(&passage, &load, x_next);
    x_next[X_CLOCK] = clock;
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_WORK] = x[X_WORK] + load.force * (now.commanded - before) + load.slope * driven;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    return 1;
}

/* Wrenches on both ports, time to the next break, slopes of mean wrenches. */
void NAME(point_motion_outputs)(void *self, const real *x, const real *u, real *y) {
    const PointMotion *motion = self;
    if (!gives_means(&motion->base, x, y)) {
        const Vector3 zero = {0.0, 0.0, 0.0};
        Instant now = point_motion_instant(motion, u, x[X_CLOCK]);
        Vector3 force = {motion_force(motion, now.deflection, now.deflection_rate), 0.0, 0.0};
        store_pair(quaternion_rotate(now.frame, force), zero, now.gap, y);
    }
    y[Y_TIME_TO_BREAK] = motion_time_to_break(&motion->law, x[X_CLOCK]);
}

/* Rate of the clock, heat of the end-point force and power of the motion. */
int NAME(point_motion_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const PointMotion *motion = self;
    (void)raw, (void)why;
    Instant now = point_motion_instant(motion, u, x[X_CLOCK]);
    rates[0] = commanded(u, U_HOLD) ? 0.0 : 1.0;
    rates[1] = motion->base.p[P_DAMPING] * now.deflection_rate * now.deflection_rate;
    rates[2] = motion_force(motion, now.deflection, now.deflection_rate) * now.commanded_rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(point_motion)

static void *point_motion_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    PointMotion *motion = create_connection(data, sizes, memory, sizeof *motion, states, why);
    return motion && read_axis_frame(data, motion->axis_frame, why) &&
                   read_motion_law(data, memory, "law", &motion->law, why)
               ? motion
               : NULL;
}

static int point_motion_prepare(void *self, const double *p, Reason *why) {
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the places of the inputs. */
static int point_motion_initial(void *self, const double *u, double *x, Reason *why) {
    (void)why;
    Instant now = point_motion_instant(self, u, 0.0);
    memset(x, 0, STATES * sizeof *x);
    quaternion_store(now.frame, x + X_FRAME);
    vector_store(now.gap, x + X_GAP);
    store_rate(now.deflection_rate, x + X_MEMORY);
    return 1;
}

/* At the communication point; the force from what the last steps' loads were. */
static void point_motion_observe(void *self, const double *x, const double *u, double *z) {
    const PointMotion *motion = self;
    const Connection *base = &motion->base;
    Instant now = point_motion_instant(motion, u, x[X_CLOCK]);
    double rate = x[X_MEMORY + (base->paired ? END_RATE : MEAN_RATE)];
    if (base->endpoint) rate = now.deflection_rate;
    const double force = motion_force(motion, now.deflection, rate);
    z[Z_DISTANCE] = now.distance;
    z[Z_COMMANDED_DISTANCE] = now.commanded;
    z[Z_COMMANDED_RATE] = now.commanded_rate;
    z[Z_COMMANDED_ACCELERATION] = commanded(u, U_HOLD) ? 0.0 : motion_acceleration(&motion->law, x[X_CLOCK]);
    z[Z_MOTION_FORCE] = base->paired ? load_now(x + X_LOAD, force, x[X_MEMORY + ROUGHNESS]) : force;
    z[Z_SUPPLIED_ENERGY] = x[X_WORK];
    z[Z_POTENTIAL_ENERGY] = 0.5 * base->p[P_STIFFNESS] * now.deflection * now.deflection;
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

static double point_motion_break(void *self, const double *x, const double *u) {
    const PointMotion *motion = self;
    return motion_break(&motion->law, x[X_CLOCK], commanded(u, U_HOLD));
}

const Kernel point_motion_kernel = {
    CONNECTION_FUNCTIONS(point_motion, point_motion),
    .time_to_break = point_motion_break,
};

#endif
