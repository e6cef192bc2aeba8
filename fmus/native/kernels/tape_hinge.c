/* Tape-spring hinge: stiff while it is straight, and soft once it has folded: the twin of components/tape_hinge.py. */

#include "tape_hinge_layout.h"
#include "axial.h"

/* Laws, energy offsets: folded to negative angles, straight, folded to positive angles; `fold` is -1, 0, 1. */
typedef struct TapeHinge {
    Axial axial;
    Law laws[3];
    double snaps[2], backs[2], offsets[3];
} TapeHinge;

/* Of a step: mean torque of the laws and its tangent, state of the fold at the end, heat of snaps. */
typedef struct Course {
    real elastic, tangent, heat;
    int fold;
} Course;

static inline real tape_energy(const TapeHinge *tape, int fold, real angle) {
    return law_potential(tape->laws + fold + 1, angle) + tape->offsets[fold + 1];
}

/* Angle up to which a law acts on the way up or down; infinite where it goes on. */
static inline double tape_limit(const TapeHinge *tape, int fold, double way) {
    if (fold == 0) return tape->snaps[way > 0.0];
    if (fold * way < 0.0) return tape->backs[fold > 0];
    return way > 0.0 ? INFINITY : -INFINITY;
}

static inline int tape_next(int fold, double way) {
    if (fold) return 0;
    return way > 0.0 ? 1 : -1;
}

/* Along the angles of a step, law by law. */
static inline Course tape_course(const TapeHinge *tape, int fold, double start, real end) {
    const double way = value_of(end) - start;
    double at = start, work = 0.0, heat = 0.0;
    int snapped = 0;
    for (; snapped < MOST_SNAPS; snapped++) {
        const double limit = tape_limit(tape, fold, way);
        if ((value_of(end) - limit) * way <= 0.0 || isinf(limit)) break;
        const double stop = (limit - at) * way > 0.0 ? limit : at;
        const int next = tape_next(fold, way);
        work += value_of(law_mean_force(tape->laws + fold + 1, at, stop)) * (stop - at);
        heat += value_of(tape_energy(tape, fold, stop) - tape_energy(tape, next, stop));
        fold = next;
        at = stop;
    }
    const Law *law = tape->laws + fold + 1;
    real last = law_mean_force(law, at, end);
    if (!snapped) return (Course){last, law_tangent(law, start, end), 0.0, fold};
    return (Course){(work + last * (end - at)) / (end - start), 0.0, heat, fold};
}

static inline int fold_of(const double *x) { return (int)x[X_FOLD]; }

/* One step: the discrete gradient of the energy along the laws; a snap turns the rest to heat. */
int NAME(tape_hinge_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const TapeHinge *tape = self;
    (void)why;
    const double damping = tape->axial.base.p[P_DAMPING];
    const int impulse = commanded(u, U_IMPULSE), paired = tape->axial.base.paired && !impulse;
    Turn turn = turn_of(&tape->axial, u, x[X_ANGLE], 0.0);
    Arc arc = arc_to(&turn, x, u, paired);
    StepMotion motion = step_motion(x + X_MEMORY, x[X_ANGLE], turn.angle, h);
    motion.moment = arc.moment;
    Course course = tape_course(tape, fold_of(x), x[X_ANGLE], turn.angle);
    real viscous = -damping * arc.change / h;
    MeanLoad load = {course.elastic + viscous, -viscous * arc.change, 0.0, 0.0};
    if (paired) load = workless_load(course.elastic, course.tangent, damping, &motion, motion.roughness);
    store_turn(&turn, x_next);
    store_load(&arc, &load, paired, x_next);
    if (impulse) {
        store_rate(turn.rate, x_next + X_MEMORY);
        store_mid_step_start(turn.rate, x_next + X_SLIDE);
    } else if (paired) {
        store_path(&motion, x_next + X_MEMORY);
        store_mid_step_start(x_next[X_MEMORY + END_RATE], x_next + X_SLIDE);
    } else {
        store_memory(&motion, turn.rate, x_next + X_MEMORY);
        store_mid_step_after(x + X_SLIDE, arc.change / h, h, x_next + X_SLIDE);
    }
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_FOLD] = course.fold;
    x_next[X_SNAP_HEAT] = x[X_SNAP_HEAT] + course.heat;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    return 1;
}

/* Of the law that acts, and the damper. */
static inline real tape_torque(const TapeHinge *tape, int fold, real angle, real rate) {
    return law_value(tape->laws + fold + 1, angle) - tape->axial.base.p[P_DAMPING] * rate;
}

void NAME(tape_hinge_outputs)(void *self, const real *x, const real *u, real *y) {
    const TapeHinge *tape = self;
    if (gives_means(self, x, y)) return;
    Turn turn = turn_of(&tape->axial, u, value_of(x[X_ANGLE]), 0.0);
    store_torque(&turn, tape_torque(tape, (int)value_of(x[X_FOLD]), turn.angle, turn.rate), y);
}

/* Heat of the damper. */
int NAME(tape_hinge_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const TapeHinge *tape = self;
    (void)raw, (void)why;
    Turn turn = turn_of(&tape->axial, u, value_of(x[X_ANGLE]), 0.0);
    rates[0] = tape->axial.base.p[P_DAMPING] * turn.rate * turn.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(tape_hinge)

/* A copy of finite numbers. */
static int read_angles(const Data *data, const char *name, size_t count, double *copy, Reason *why) {
    const double *values = data_array(data, name, count, why);
    if (!values) return 0;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(copy[i] = values[i])) return refuse(why, "%s contains %g; it must be finite", name, values[i]);
    return 1;
}

static void *tape_hinge_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    static const char *const names[] = {"negative", "straight", "positive"};
    TapeHinge *tape = create_connection(data, sizes, memory, sizeof *tape, states, why);
    if (!tape || !read_axis_frame(data, tape->axial.axis_frame, why)) return NULL;
    for (int i = 0; i < 3; i++)
        if (!read_table(data, memory, names[i], tape->laws + i, why)) return NULL;
    const int sound = read_angles(data, "snaps", 2, tape->snaps, why) && read_angles(data, "backs", 2, tape->backs, why) &&
                      read_angles(data, "offsets", 3, tape->offsets, why);
    return sound ? tape : NULL;
}

static int tape_hinge_prepare(void *self, const double *p, Reason *why) {
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the pose of the inputs, folded where it is beyond a snap. */
static int tape_hinge_initial(void *self, const double *u, double *x, Reason *why) {
    const TapeHinge *tape = self;
    (void)why;
    Turn turn = turn_of(&tape->axial, u, tape->axial.base.p[P_STOWED_ANGLE], 0.0);
    memset(x, 0, STATES * sizeof *x);
    store_turn(&turn, x);
    store_rate(turn.rate, x + X_MEMORY);
    store_mid_step_start(turn.rate, x + X_SLIDE);
    x[X_FOLD] = (turn.angle > tape->snaps[1]) - (turn.angle < tape->snaps[0]);
    return 1;
}

static void tape_hinge_observe(void *self, const double *x, const double *u, double *z) {
    const TapeHinge *tape = self;
    const Connection *base = &tape->axial.base;
    const int fold = fold_of(x);
    Turn turn = turn_of(&tape->axial, u, x[X_ANGLE], 0.0);
    z[Z_ANGLE] = turn.angle;
    z[Z_ANGULAR_RATE] = turn.rate;
    z[Z_TAPE_TORQUE] = tape_torque(tape, fold, turn.angle, base->endpoint ? turn.rate : mid_step_now(x + X_SLIDE));
    z[Z_STRAIGHT] = fold == 0;
    z[Z_POTENTIAL_ENERGY] = tape_energy(tape, fold, turn.angle);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT] + x[X_SNAP_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

/* Angle left up to the next snap. */
static double angle_left(const TapeHinge *tape, int fold, double angle) {
    if (fold) return fold * (angle - tape->backs[fold > 0]);
    return fmin(tape->snaps[1] - angle, angle - tape->snaps[0]);
}

static size_t tape_hinge_indicators(void *self, const double *x, const double *u, double *indicators) {
    const TapeHinge *tape = self;
    if (indicators) indicators[0] = angle_left(tape, fold_of(x), turn_of(&tape->axial, u, x[X_ANGLE], 0.0).angle);
    return 1;
}

/* Follows the angle; at an event it snaps where the angle is reached. */
static void tape_hinge_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const TapeHinge *tape = self;
    const int fold = fold_of(x);
    const double angle = turn_of(&tape->axial, u, x[X_ANGLE], 0.0).angle;
    memcpy(x_next, x, STATES * sizeof *x);
    x_next[X_ANGLE] = angle;
    if (!at_event || angle_left(tape, fold, angle) > REACHED) return;
    const int next = tape_next(fold, angle - 0.5 * (tape->snaps[0] + tape->snaps[1]));
    x_next[X_FOLD] = next;
    x_next[X_SNAP_HEAT] = x[X_SNAP_HEAT] + tape_energy(tape, fold, angle) - tape_energy(tape, next, angle);
}

const Kernel tape_hinge_kernel = {
    CONNECTION_FUNCTIONS(tape_hinge, tape_hinge),
    .indicators = tape_hinge_indicators,
    .update = tape_hinge_update,
};

#endif
