/* End stop of a hinge line: a torque that pushes back from an angle on: the twin of components/end_stop.py. */

#include "end_stop_layout.h"
#include "axial.h"

typedef struct EndStop {
    Axial axial;
    Law spring;
} EndStop;

static inline Turn stop_turn(const EndStop *stop, const real *u, double reference) {
    return turn_of(&stop->axial, u, reference, stop->axial.base.p[P_ALIGNED_ANGLE]);
}

/* Torque of an instant, negative as it closes; it never opens. */
static inline real stop_torque(const EndStop *stop, real penetration, real rate) {
    const double *p = stop->axial.base.p;
    real damping = p[P_DAMPING] * cubic_step(penetration / p[P_FULL_DAMPING_PENETRATION]);
    return -above(damping * rate - law_value(&stop->spring, penetration), 0.0);
}

/* The share of it that only takes energy. */
static inline real stop_braking(const EndStop *stop, real penetration, real rate) {
    return stop_torque(stop, penetration, rate) - law_value(&stop->spring, penetration);
}

/* Load of a step: the spring's has a potential, braking is that at both points of Gauss' rule. */
static inline MeanLoad stop_load(const EndStop *stop, const StepMotion *m, int paired) {
    real change = m->end - m->start, middle = 0.5 * (m->start + m->end - m->moment);
    real off = 0.5 * sqrt(1.0 / 3.0) * change, rates[2];
    gauss_rates(change, m->moment, m->h, rates);
    const real forces[2] = {stop_braking(stop, middle - off, rates[0]), stop_braking(stop, middle + off, rates[1])};
    MeanLoad braking = viscous_load(rates, forces, m->h), elastic = {0.0, 0.0, 0.0, 0.0};
    if (paired) {
        elastic = workless_law(&stop->spring, 0.0, m, m->roughness);
        elastic.slope += braking.slope;
    } else {
        elastic.force = law_mean_force(&stop->spring, m->start, m->end);
    }
    return (MeanLoad){elastic.force + braking.force, braking.heat, elastic.numerical, elastic.slope};
}

/* Lets a stop fail at its angle that is commanded to; what its spring stores there is heat. */
static inline void fail_if_commanded(const EndStop *stop, const real *u, real *x) {
    if (value_of(x[X_FAILED]) != 0.0 || !commanded(u, U_FAILURE_COMMAND)) return;
    x[X_FAILED] = 1.0;
    x[X_FAILURE_HEAT] = law_potential(&stop->spring, x[X_ANGLE] - stop->axial.base.p[P_STOP_ANGLE]);
}

/* One step; a command acts from its start. */
int NAME(end_stop_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const EndStop *stop = self;
    (void)why;
    const int impulse = commanded(u, U_IMPULSE), paired = stop->axial.base.paired && !impulse;
    Turn turn = stop_turn(stop, u, x[X_ANGLE]);
    for (int i = 0; i < STATES; i++) x_next[i] = x[i];
    fail_if_commanded(stop, u, x_next);
    store_turn(&turn, x_next);
    store_rate(turn.rate, x_next + X_MEMORY);
    store_mid_step_start(turn.rate, x_next + X_SLIDE);
    store_mid_step_start(0.0, x_next + X_LOAD);
    for (int i = 0; i < MOMENTS; i++) x_next[X_WRENCH + i] = x_next[X_SLOPES + i] = 0.0;
    if (value_of(x_next[X_FAILED]) != 0.0) return 1;
    Arc arc = arc_to(&turn, x, u, paired);
    const double before = x[X_ANGLE] - stop->axial.base.p[P_STOP_ANGLE];
    StepMotion motion = step_motion(x + X_MEMORY, before, before + arc.change, h);
    motion.moment = arc.moment;
    MeanLoad load = stop_load(stop, &motion, paired);
    store_load(&arc, &load, paired, x_next);
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    if (paired) {
        store_path(&motion, x_next + X_MEMORY);
        store_mid_step_start(x_next[X_MEMORY + END_RATE], x_next + X_SLIDE);
        store_mid_step_after(x + X_LOAD, load.force, h, x_next + X_LOAD);
    } else if (!impulse) {
        store_mid_step_after(x + X_SLIDE, arc.change / h, h, x_next + X_SLIDE);
    }
    return 1;
}

void NAME(end_stop_outputs)(void *self, const real *x, const real *u, real *y) {
    const EndStop *stop = self;
    if (gives_means(self, x, y)) return;
    Turn turn = stop_turn(stop, u, value_of(x[X_ANGLE]));
    real torque = 0.0;
    if (value_of(x[X_FAILED]) == 0.0)
        torque = stop_torque(stop, turn.angle - stop->axial.base.p[P_STOP_ANGLE], turn.rate);
    store_torque(&turn, torque, y);
}

/* Heat of the braking share. */
int NAME(end_stop_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const EndStop *stop = self;
    (void)raw, (void)why;
    Turn turn = stop_turn(stop, u, value_of(x[X_ANGLE]));
    rates[0] = 0.0;
    if (value_of(x[X_FAILED]) == 0.0)
        rates[0] = -stop_braking(stop, turn.angle - stop->axial.base.p[P_STOP_ANGLE], turn.rate) * turn.rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(end_stop)

static void *end_stop_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    EndStop *stop = create_connection(data, sizes, memory, sizeof *stop, states, why);
    return stop && read_axis_frame(data, stop->axial.axis_frame, why) ? stop : NULL;
}

static int end_stop_prepare(void *self, const double *p, Reason *why) {
    EndStop *stop = self;
    stop->spring = strand_law(p[P_STIFFNESS], 0.0);
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the pose of the inputs; the angle is the one nearest the stowed angle. */
static int end_stop_initial(void *self, const double *u, double *x, Reason *why) {
    const EndStop *stop = self;
    (void)why;
    Turn turn = stop_turn(stop, u, stop->axial.base.p[P_STOWED_ANGLE]);
    memset(x, 0, STATES * sizeof *x);
    store_turn(&turn, x);
    store_rate(turn.rate, x + X_MEMORY);
    store_mid_step_start(turn.rate, x + X_SLIDE);
    return 1;
}

/* At the communication point; at order 4 the torque comes from what the last steps' loads were. */
static void end_stop_observe(void *self, const double *x, const double *u, double *z) {
    const EndStop *stop = self;
    const Connection *base = &stop->axial.base;
    Turn turn = stop_turn(stop, u, x[X_ANGLE]);
    double now[STATES];
    memcpy(now, x, sizeof now);
    /* in a mean wrench a command acts from the next step's start, which is this instant */
    if (!base->endpoint) fail_if_commanded(stop, u, now);
    const int failed = now[X_FAILED] != 0.0;
    const double penetration = turn.angle - base->p[P_STOP_ANGLE];
    const double felt = base->endpoint ? turn.rate : mid_step_now(x + X_SLIDE);
    double torque = failed ? 0.0 : stop_torque(stop, penetration, felt);
    if (base->paired && torque < 0.0) torque = fmin(load_now(x + X_LOAD, torque, x[X_MEMORY + ROUGHNESS]), 0.0);
    z[Z_PENETRATION] = penetration;
    z[Z_ANGULAR_RATE] = turn.rate;
    z[Z_STOP_TORQUE] = 0.0 - torque;
    z[Z_POTENTIAL_ENERGY] = failed ? 0.0 : law_potential(&stop->spring, penetration);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT] + now[X_FAILURE_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
    z[Z_IN_CONTACT] = penetration >= 0.0 && !failed ? 1.0 : 0.0;
}

/* Follows the angle; at an event commands act. */
static void end_stop_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const EndStop *stop = self;
    memcpy(x_next, x, STATES * sizeof *x);
    x_next[X_ANGLE] = stop_turn(stop, u, x[X_ANGLE]).angle;
    if (at_event) fail_if_commanded(stop, u, x_next);
}

const Kernel end_stop_kernel = {
    CONNECTION_FUNCTIONS(end_stop, end_stop),
    .update = end_stop_update,
};

#endif
