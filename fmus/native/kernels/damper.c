/* Eddy-current damper between two ports, about their common axis: the twin of components/damper.py. */

#include "relative.h"

/* State: unwrapped angle, frame, gap, heat, wrenches of both ports, mean rates of two steps, swing. */
enum { ANGLE = 0, FRAME = 1, GAP = 5, HEAT = 8, WRENCH = 9, SLIDE = 21, SWING = 25, STATES = 27 };

typedef struct Damper {
    double axis_frame[4];
    int endpoint;
    size_t coefficient_place, peak_rate_place, impulse;
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

/* One step: the torque of the mean rate, and the heat it makes. */
int NAME(damper_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Damper *damper = self;
    (void)why;
    Pose pose = relative_pose(u, damper->axis_frame);
    real angle = nearest_turn(pose.twist, x[ANGLE]);
    real change = angle - x[ANGLE];
    real torque = damper_torque(damper, change / h);
    Transverse swing = {0.5 * (x[SWING] + pose.swing.y), 0.5 * (x[SWING + 1] + pose.swing.z)};
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, swing);
    Quaternion frame = {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]};
    Vector3 gap = {x[GAP], x[GAP + 1], x[GAP + 2]};
    damper_store_pose(&pose, angle, x_next);
    x_next[HEAT] = x[HEAT] - torque * change;
    store_pair((Vector3){0.0, 0.0, 0.0}, mean_direction(frame, pose.frame, conjugate), vector_mean(gap, pose.gap),
               x_next + WRENCH);
    if (value_of(u[damper->impulse]) < 0.5)
        store_rate_after(x + SLIDE, change / h, h, x_next + SLIDE);
    else
        store_starting_rate(relative_rates(u, &pose).twist, x_next + SLIDE);
    return 1;
}

/* Wrenches on both ports. */
void NAME(damper_outputs)(void *self, const real *x, const real *u, real *y) {
    const Damper *damper = self;
    if (!damper->endpoint) {
        for (int i = 0; i < 2 * WRENCH_SIZE; i++) y[i] = x[WRENCH + i];
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
    int usable = check_sizes("damper", sizes, 2 * MOTION_SIZE + 1, 2 * WRENCH_SIZE, 3, why) &&
                 read_axis_frame(data, damper->axis_frame, why) &&
                 read_choice(data, "endpoint", 1, &damper->endpoint, why) &&
                 find_place(data, "parameter", (VariableName){"damping_coefficient", 1}, sizes->parameters,
                            &damper->coefficient_place, why) &&
                 find_place(data, "parameter", (VariableName){"peak_rate", 1}, sizes->parameters,
                            &damper->peak_rate_place, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &damper->impulse, why);
    return usable ? damper : NULL;
}

static int damper_prepare(void *self, const double *p, Reason *why) {
    Damper *damper = self;
    (void)why;
    damper->coefficient = p[damper->coefficient_place];
    damper->peak_rate = p[damper->peak_rate_place];
    return 1;
}

/* At the pose of the inputs. */
static int damper_initial(void *self, const double *u, double *x, Reason *why) {
    const Damper *damper = self;
    (void)why;
    Pose pose = relative_pose(u, damper->axis_frame);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    damper_store_pose(&pose, pose.twist, x);
    store_starting_rate(relative_rates(u, &pose).twist, x + SLIDE);
    return 1;
}

/* Rate and torque at the communication point, energy dissipated. */
static void damper_observe(void *self, const double *x, const double *u, double *z) {
    const Damper *damper = self;
    Pose pose = relative_pose(u, damper->axis_frame);
    double rate = relative_rates(u, &pose).twist;
    z[0] = rate;
    z[1] = damper_torque(damper, damper->endpoint ? rate : rate_now(x + SLIDE));
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
