/* Eddy-current damper between two ports, about their common axis: the twin of components/damper.py. */

#include "relative.h"
#include "workless.h"

/* State: unwrapped angle, frame, gap, heat, wrenches of both ports, mean rates of two steps, swing, slopes. */
enum { ANGLE = 0, FRAME = 1, GAP = 5, HEAT = 8, WRENCH = 9, SLIDE = 21, SWING = 25, SLOPES = 27, STATES = 39 };

enum { OBSERVATIONS = 3, PAIR_SIZE = 2 * WRENCH_SIZE };

typedef struct Damper {
    double axis_frame[4];
    int endpoint, paired; /* paired: torques are of order 4 */
    size_t coefficient_place, peak_rate_place, order_place, impulse, moments;
    double coefficient, peak_rate;
} Damper;

/* Torque against the rate: c w / (1 + (w / w_peak)^2), linear where no peak rate is given. */
static inline real damper_torque(const Damper *damper, real rate) {
    if (damper->peak_rate == 0.0) return -damper->coefficient * rate;
    real ratio = rate / damper->peak_rate;
    return -damper->coefficient * rate / (1.0 + ratio * ratio);
}

static inline void damper_store_pose(const Pose *pose, real angle, real *x) {
    x[ANGLE] = angle;
    quaternion_store(pose->frame, x + FRAME);
    vector_store(pose->gap, x + GAP);
    x[SWING] = pose->swing.y;
    x[SWING + 1] = pose->swing.z;
}

/* Load of the mean rate. */
static inline MeanLoad load_of_mean(const Damper *damper, real change, double h) {
    real torque = damper_torque(damper, change / h);
    return (MeanLoad){torque, -torque * change, 0.0, 0.0};
}

/* Load along a rate that is linear in time. */
static inline MeanLoad load_of_path(const Damper *damper, real change, real moment, double h) {
    real rates[2], torques[2];
    gauss_rates(change, moment, h, rates);
    for (int i = 0; i < 2; i++) torques[i] = damper_torque(damper, rates[i]);
    return viscous_load(rates, torques, h);
}

/* Stores the wrenches of a torque about the axis, the mean over a step. */
static inline void store_mean_torque(const Passage *passage, real torque, Transverse swing, real *wrench) {
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, swing);
    store_mean_pair(passage, (Vector3){0.0, 0.0, 0.0}, conjugate, wrench);
}

/* One step: the torque of the mean rate, at order 4 that along the path, and the heat it makes. */
int NAME(damper_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Damper *damper = self;
    (void)why;
    Pose pose = relative_pose(u, damper->axis_frame);
    real angle = nearest_turn(pose.twist, x[ANGLE]);
    real change = angle - x[ANGLE];
    Transverse swing = {0.5 * (x[SWING] + pose.swing.y), 0.5 * (x[SWING + 1] + pose.swing.z)};
    Passage passage = {
        {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]}, pose.frame, {x[GAP], x[GAP + 1], x[GAP + 2]}, pose.gap,
    };
    int impulse = !(value_of(u[damper->impulse]) < 0.5);
    MeanLoad load;
    if (damper->paired && !impulse) {
        real moment = rate_moments(&passage, u + damper->moments, swing).twist;
        load = load_of_path(damper, change, moment, h);
        store_mid_step_start((change + 3.0 * moment) / h, x_next + SLIDE);
    } else {
        load = load_of_mean(damper, change, h);
        if (impulse)
            store_mid_step_start(relative_rates(u, &pose).twist, x_next + SLIDE);
        else
            store_mid_step_after(x + SLIDE, change / h, h, x_next + SLIDE);
    }
    damper_store_pose(&pose, angle, x_next);
    x_next[HEAT] = x[HEAT] + load.heat;
    store_mean_torque(&passage, load.force, swing, x_next + WRENCH);
    if (damper->paired && !impulse)
        store_mean_torque(&passage, load.slope, swing, x_next + SLOPES);
    else
        for (int i = 0; i < PAIR_SIZE; i++) x_next[SLOPES + i] = 0.0;
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
void NAME(damper_outputs)(void *self, const real *x, const real *u, real *y) {
    const Damper *damper = self;
    if (!damper->endpoint) {
        for (int i = 0; i < PAIR_SIZE; i++) {
            y[i] = x[WRENCH + i];
            y[PAIR_SIZE + i] = x[SLOPES + i];
        }
        return;
    }
    Pose pose = relative_pose(u, damper->axis_frame);
    real torque = damper_torque(damper, relative_rates(u, &pose).twist);
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, pose.swing);
    store_pair((Vector3){0.0, 0.0, 0.0}, quaternion_rotate(pose.frame, conjugate), pose.gap, y);
}

/* Heat of the end-point torque. */
int NAME(damper_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Damper *damper = self;
    (void)raw, (void)x, (void)why;
    Pose pose = relative_pose(u, damper->axis_frame);
    real rate = relative_rates(u, &pose).twist;
    rates[0] = -damper_torque(damper, rate) * rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

int damper_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                         double complex *rates, Reason *why);
int damper_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                        Reason *why);
void damper_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static void *damper_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Damper *damper = allocate(memory, sizeof *damper);
    if (!damper) {
        refuse(why, "there is no memory for a damper");
        return NULL;
    }
    *states = STATES;
    if (!read_choice(data, "endpoint", 1, &damper->endpoint, why)) return NULL;
    size_t pairs = damper->endpoint ? 0 : PAIR_SIZE;
    int usable = check_sizes("damper", sizes, 2 * MOTION_SIZE + 1 + pairs, PAIR_SIZE + pairs, OBSERVATIONS, why) &&
                 read_axis_frame(data, damper->axis_frame, why) &&
                 find_place(data, "parameter", (VariableName){"damping_coefficient", 1}, sizes->parameters,
                            &damper->coefficient_place, why) &&
                 find_place(data, "parameter", (VariableName){"peak_rate", 1}, sizes->parameters,
                            &damper->peak_rate_place, why) &&
                 find_place(data, "parameter", (VariableName){"order", 1}, sizes->parameters, &damper->order_place,
                            why) &&
                 find_moments(data, "inboard.velocity_moment", damper->endpoint ? 0 : 2, sizes, &damper->moments,
                              why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &damper->impulse, why);
    return usable ? damper : NULL;
}

static int damper_prepare(void *self, const double *p, Reason *why) {
    Damper *damper = self;
    int fourth = 0;
    if (!read_order(p[damper->order_place], &fourth, why)) return 0;
    damper->coefficient = p[damper->coefficient_place];
    damper->peak_rate = p[damper->peak_rate_place];
    damper->paired = fourth && !damper->endpoint;
    return 1;
}

/* At the pose of the inputs. */
static int damper_initial(void *self, const double *u, double *x, Reason *why) {
    const Damper *damper = self;
    (void)why;
    Pose pose = relative_pose(u, damper->axis_frame);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    damper_store_pose(&pose, pose.twist, x);
    store_mid_step_start(relative_rates(u, &pose).twist, x + SLIDE);
    return 1;
}

/* Rate and torque at the communication point, energy dissipated. */
static void damper_observe(void *self, const double *x, const double *u, double *z) {
    const Damper *damper = self;
    Pose pose = relative_pose(u, damper->axis_frame);
    double rate = relative_rates(u, &pose).twist;
    z[0] = rate;
    z[1] = damper_torque(damper, damper->endpoint ? rate : mid_step_now(x + SLIDE));
    z[2] = x[HEAT];
}

static size_t damper_continuous(const void *self, size_t *places) {
    (void)self;
    if (places) places[0] = HEAT;
    return 1;
}

const Kernel damper_kernel = {
    "eddy_current_damper", damper_create,       damper_prepare, damper_initial,      damper_step_real,
    damper_outputs_real,   damper_observe, damper_step_complex, damper_outputs_complex, NULL, NULL,
    .continuous = damper_continuous,
    .rates = damper_rates_real,
    .rates_complex = damper_rates_complex,
};

#endif
