/* Aerodynamic drag of a flat rectangular plate by strips, on one port: the twin of components/drag.py. */

#include "drag_layout.h"
#include "connection.h"

typedef struct Drag {
    Connection base;
    double pressure; /* force per length of the plate and square of the velocity */
} Drag;

/* Velocity of the port along the plate's normal, and its rate about the plate's y axis. */
typedef struct PlateRates {
    real velocity, turn;
} PlateRates;

/* Force along the normal and torque about the y axis, both at the port. */
typedef struct PlateLoads {
    real force, torque;
} PlateLoads;

/* Means over t from 0 to 1 of v |v| and of t v |v|, with v linear from first to last. */
static inline void mean_squares(real first, real last, real *mean, real *moment) {
    if (value_of(first) * value_of(last) >= 0.0) {
        double sign = value_of(first) + value_of(last) >= 0.0 ? 1.0 : -1.0;
        real cross = first * last;
        *mean = sign * (first * first + cross + last * last) / 3.0;
        *moment = sign * (first * first + 2.0 * cross + 3.0 * last * last) / 12.0;
        return;
    }
    real still = first / (first - last);
    real left = first * real_abs(first) * still, right = last * real_abs(last) * (1.0 - still);
    *mean = (left + right) / 3.0;
    *moment = left * still / 12.0 + right * (still / 3.0 + (1.0 - still) / 4.0);
}

/* The strip at x has the velocity of the port minus x times its turn rate. */
static inline PlateLoads plate_loads(const Drag *drag, PlateRates rates) {
    const double start = drag->base.p[P_START], end = drag->base.p[P_END], length = end - start;
    real mean, moment;
    mean_squares(rates.velocity - start * rates.turn, rates.velocity - end * rates.turn, &mean, &moment);
    return (PlateLoads){
        -drag->pressure * length * mean,
        drag->pressure * length * (start * mean + length * moment),
    };
}

static inline Vector3 plate_normal(Quaternion orientation) {
    return quaternion_rotate(orientation, (Vector3){0.0, 0.0, 1.0});
}

static inline Vector3 turn_axis(Quaternion orientation) {
    return quaternion_rotate(orientation, (Vector3){0.0, 1.0, 0.0});
}

static inline PlateRates plate_rates(const real *u) {
    Quaternion orientation = quaternion_of(u + 3);
    return (PlateRates){
        vector_dot(plate_normal(orientation), vector_of(u + 7)),
        vector_dot(turn_axis(orientation), vector_of(u + 10)),
    };
}

/* Rates to go on from: those of an instant. */
static inline void store_plate_rates(PlateRates rates, real *x) {
    store_mid_step_start(rates.velocity, x + X_NORMAL_RATE);
    store_mid_step_start(rates.turn, x + X_TURN_RATE);
}

/* In world axes. */
static inline void store_wrench(Quaternion orientation, PlateLoads loads, real *wrench) {
    vector_store(vector_scaled(loads.force, plate_normal(orientation)), wrench);
    vector_store(vector_scaled(loads.torque, turn_axis(orientation)), wrench + 3);
}

/* Orientation after half of the shortest rotation between two. */
static inline Quaternion halfway(Quaternion a, Quaternion b) {
    const double sign = value_of(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z) >= 0.0 ? 1.0 : -1.0;
    return quaternion_normalized((Quaternion){a.w + sign * b.w, a.x + sign * b.x, a.y + sign * b.y, a.z + sign * b.z});
}

/* One step: the wrench of the mean velocities in the orientation halfway, and the heat it makes. */
int NAME(drag_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Drag *drag = self;
    (void)why;
    const double *place = x + X_POSITION, *q = x + X_ORIENTATION;
    Quaternion before = {q[0], q[1], q[2], q[3]};
    Quaternion after = quaternion_of(u + 3), middle = halfway(before, after);
    Vector3 moved = vector_subtract(vector_of(u), (Vector3){place[0], place[1], place[2]});
    PlateRates rates = {vector_dot(plate_normal(middle), moved) / h, rotation_vector(quaternion_multiply(quaternion_conjugate(before), after)).y / h};
    PlateLoads loads = plate_loads(drag, rates);
    vector_store(vector_of(u), x_next + X_POSITION);
    quaternion_store(after, x_next + X_ORIENTATION);
    x_next[X_HEAT] = x[X_HEAT] - (loads.force * rates.velocity + loads.torque * rates.turn) * h;
    store_wrench(middle, loads, x_next + X_WRENCH);
    store_mid_step_after(x + X_NORMAL_RATE, rates.velocity, h, x_next + X_NORMAL_RATE);
    store_mid_step_after(x + X_TURN_RATE, rates.turn, h, x_next + X_TURN_RATE);
    if (commanded(u, U_IMPULSE)) store_plate_rates(plate_rates(u), x_next);
    return 1;
}

/* Wrench on the port. */
void NAME(drag_outputs)(void *self, const real *x, const real *u, real *y) {
    const Drag *drag = self;
    if (!gives_means(&drag->base, x, y)) store_wrench(quaternion_of(u + 3), plate_loads(drag, plate_rates(u)), y);
}

/* Heat of the end-point wrench. */
int NAME(drag_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Drag *drag = self;
    (void)raw, (void)x, (void)why;
    PlateRates now = plate_rates(u);
    PlateLoads loads = plate_loads(drag, now);
    rates[0] = -(loads.force * now.velocity + loads.torque * now.turn);
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(drag)

static void *drag_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    return create_connection(data, sizes, memory, sizeof(Drag), states, why);
}

static int drag_prepare(void *self, const double *p, Reason *why) {
    Drag *drag = self;
    drag->pressure = 0.5 * p[P_AIR_DENSITY] * p[P_DRAG_COEFFICIENT] * p[P_WIDTH];
    if (p[P_END] <= p[P_START])
        return refuse(why, "the plate ends at %g m; it must end beyond its start at %g m", p[P_END], p[P_START]);
    return prepare_connection(self, p, 2.0, why);
}

/* At the pose of the inputs. */
static int drag_initial(void *self, const double *u, double *x, Reason *why) {
    (void)self, (void)why;
    memset(x, 0, STATES * sizeof *x);
    vector_store(vector_of(u), x + X_POSITION);
    quaternion_store(quaternion_of(u + 3), x + X_ORIENTATION);
    store_plate_rates(plate_rates(u), x);
    return 1;
}

/* Force, torque and velocity at the communication point, energy dissipated. */
static void drag_observe(void *self, const double *x, const double *u, double *z) {
    const Drag *drag = self;
    PlateRates now = {mid_step_now(x + X_NORMAL_RATE), mid_step_now(x + X_TURN_RATE)};
    if (drag->base.endpoint) now = plate_rates(u);
    PlateLoads loads = plate_loads(drag, now);
    z[Z_DRAG_FORCE] = loads.force;
    z[Z_DRAG_TORQUE] = loads.torque;
    z[Z_NORMAL_VELOCITY] = now.velocity - 0.5 * (drag->base.p[P_START] + drag->base.p[P_END]) * now.turn;
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
}

const Kernel drag_kernel = {CONNECTION_FUNCTIONS(drag, drag)};

#endif
