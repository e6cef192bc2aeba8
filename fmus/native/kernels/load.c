/* Load from outside on one port: a force and a torque along a direction of the world or of the body, over time: the
   twin of components/load.py. */

#include "load_layout.h"
#include "connection.h"
#include "motion_law.h"

typedef struct Load {
    Connection base;
    double direction[3];
    int turns;
    MotionLaw force, torque;
    double added_force, added_torque;
} Load;

static inline Vector3 load_direction(const Load *load) {
    return (Vector3){load->direction[0], load->direction[1], load->direction[2]};
}

/* The direction at the points of Gauss' rule: of a turning one the parabola through three places. turned: rotation
   vector of the step; bend: first moment of the angular velocity, of which a rate that is linear in time leaves the
   orientation by three quarters behind in the middle. */
static inline void directions_over(const Load *load, Quaternion before, Quaternion after, Vector3 turned, Vector3 bend,
                                   Vector3 directions[3]) {
    const Vector3 own = load_direction(load);
    for (int i = 0; i < 3; i++) directions[i] = own;
    if (!load->turns) return;
    Vector3 lag = vector_subtract(vector_scaled(0.5, turned), vector_scaled(0.75, bend));
    Vector3 start = quaternion_rotate(before, own), end = quaternion_rotate(after, own);
    Vector3 middle = quaternion_rotate(quaternion_multiply(quaternion_exponential(lag), before), own);
    Vector3 slope = vector_scaled(0.5 * sqrt(0.6), vector_subtract(end, start));
    Vector3 curve = vector_scaled(0.6, vector_subtract(vector_mean(start, end), middle));
    directions[0] = vector_add(vector_subtract(middle, slope), curve);
    directions[1] = middle;
    directions[2] = vector_add(vector_add(middle, slope), curve);
}

/* Mean and slope over a step of a law along the directions at the points of Gauss' rule. */
static inline void store_means(const MotionLaw *law, double added, double start, double end,
                               const Vector3 directions[3], real *mean, real *slope) {
    double at[3];
    motion_samples(law, start, end, at);
    for (int i = 0; i < 3; i++) at[i] += added;
    Vector3 before = vector_scaled(at[0], directions[0]), after = vector_scaled(at[2], directions[2]);
    Vector3 sum = vector_scaled(5.0 / 18.0, vector_add(before, after));
    vector_store(vector_add(sum, vector_scaled(8.0 / 18.0 * at[1], directions[1])), mean);
    vector_store(vector_scaled(5.0 / 6.0 * sqrt(0.6), vector_subtract(after, before)), slope);
}

/* One step: mean and slope of the load along the way, and its work. */
int NAME(load_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Load *load = self;
    (void)why;
    const double clock = commanded(u, U_HOLD) ? x[X_CLOCK] : x[X_CLOCK] + h;
    const int paired = load->base.paired && !commanded(u, U_IMPULSE);
    const double *r = x + X_POSITION, *q = x + X_ORIENTATION;
    Quaternion before = {q[0], q[1], q[2], q[3]}, after = quaternion_of(u + 3);
    Vector3 turned = rotation_vector(quaternion_multiply(after, quaternion_conjugate(before)));
    Vector3 moved = vector_subtract(vector_of(u), (Vector3){r[0], r[1], r[2]}), bend = {0.0, 0.0, 0.0}, directions[3];
    if (paired) bend = vector_of(u + INPUTS + 3);
    directions_over(load, before, after, turned, bend, directions);
    real *wrench = x_next + X_WRENCH, *slopes = x_next + X_SLOPES;
    store_means(&load->force, load->added_force, x[X_CLOCK], clock, directions, wrench, slopes);
    store_means(&load->torque, load->added_torque, x[X_CLOCK], clock, directions, wrench + 3, slopes + 3);
    real work = vector_dot(vector_of(wrench), moved) + vector_dot(vector_of(wrench + 3), turned);
    for (int i = 0; i < WRENCH_SIZE && paired; i++) work += slopes[i] * u[INPUTS + i];
    for (int i = 0; i < WRENCH_SIZE && !paired; i++) slopes[i] = 0.0;
    vector_store(vector_of(u), x_next + X_POSITION);
    quaternion_store(after, x_next + X_ORIENTATION);
    x_next[X_CLOCK] = clock;
    x_next[X_WORK] = x[X_WORK] + work;
    return 1;
}

/* The wrench at the present time and orientation. */
static inline void store_present(const Load *load, const real *x, const real *u, real *wrench) {
    Vector3 along = load_direction(load);
    if (load->turns) along = quaternion_rotate(quaternion_of(u + 3), along);
    vector_store(vector_scaled(motion_value(&load->force, x[X_CLOCK]) + load->added_force, along), wrench);
    vector_store(vector_scaled(motion_value(&load->torque, x[X_CLOCK]) + load->added_torque, along), wrench + 3);
}

/* Wrench, time to the next break, slopes of the mean wrench. */
void NAME(load_outputs)(void *self, const real *x, const real *u, real *y) {
    const Load *load = self;
    real force_left = motion_time_to_break(&load->force, x[X_CLOCK]);
    real torque_left = motion_time_to_break(&load->torque, x[X_CLOCK]);
    if (!gives_means(&load->base, x, y)) store_present(load, x, u, y);
    y[Y_TIME_TO_BREAK] = value_of(force_left) <= value_of(torque_left) ? force_left : torque_left;
}

/* Rate of the clock, and power of the load. */
int NAME(load_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    real wrench[WRENCH_SIZE];
    (void)raw, (void)why;
    store_present(self, x, u, wrench);
    rates[0] = commanded(u, U_HOLD) ? 0.0 : 1.0;
    rates[1] = vector_dot(vector_of(wrench), vector_of(u + 7)) + vector_dot(vector_of(wrench + 3), vector_of(u + 10));
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(load)

static void *load_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Load *load = create_connection(data, sizes, memory, sizeof *load, states, why);
    return load && read_direction(data, "direction", load->direction, why) &&
                   read_choice(data, "turns", 1, &load->turns, why) &&
                   read_motion_law(data, memory, "force", &load->force, why) &&
                   read_motion_law(data, memory, "torque", &load->torque, why)
               ? load
               : NULL;
}

static int load_prepare(void *self, const double *p, Reason *why) {
    Load *load = self;
    load->added_force = p[P_ADDED_FORCE], load->added_torque = p[P_ADDED_TORQUE];
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the place of the inputs. */
static int load_initial(void *self, const double *u, double *x, Reason *why) {
    (void)self, (void)why;
    memset(x, 0, STATES * sizeof *x);
    vector_store(vector_of(u), x + X_POSITION);
    quaternion_store(quaternion_of(u + 3), x + X_ORIENTATION);
    return 1;
}

/* The load at the communication point, and its work. */
static void load_observe(void *self, const double *x, const double *u, double *z) {
    const Load *load = self;
    (void)u;
    z[Z_APPLIED_FORCE] = motion_value(&load->force, x[X_CLOCK]) + load->added_force;
    z[Z_APPLIED_TORQUE] = motion_value(&load->torque, x[X_CLOCK]) + load->added_torque;
    z[Z_SUPPLIED_ENERGY] = x[X_WORK];
}

static double load_break(void *self, const double *x, const double *u) {
    const Load *load = self;
    const int stands = commanded(u, U_HOLD);
    return fmin(motion_break(&load->force, x[X_CLOCK], stands), motion_break(&load->torque, x[X_CLOCK], stands));
}

const Kernel load_kernel = {CONNECTION_FUNCTIONS(load, load), .time_to_break = load_break};

#endif
