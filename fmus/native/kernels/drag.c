/* Aerodynamic drag of a flat rectangular plate by strips, on one port: the twin of components/drag.py. */

#include "relative.h"

/* State: position, orientation, heat, wrench, and the means of two steps of the rates along the normal and about y. */
enum { POSITION = 0, ORIENTATION = 3, HEAT = 7, WRENCH = 8, NORMAL_SLIDE = 14, TURN_SLIDE = 18, STATES = 22 };

enum { START, END, WIDTH, AIR_DENSITY, DRAG_COEFFICIENT, PARAMETERS };

typedef struct Drag {
    int endpoint;
    size_t impulse, places[PARAMETERS];
    double start, end, pressure; /* force per length of the plate and square of the velocity */
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
    const double length = drag->end - drag->start;
    real mean, moment;
    mean_squares(rates.velocity - drag->start * rates.turn, rates.velocity - drag->end * rates.turn, &mean, &moment);
    return (PlateLoads){
        -drag->pressure * length * mean,
        drag->pressure * length * (drag->start * mean + length * moment),
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

/* The y component of the vector of the shortest rotation between two orientations, in the axes of either. */
static inline real turned_about_y(Quaternion before, Quaternion after) {
    Quaternion q = quaternion_multiply(quaternion_conjugate(before), after);
    if (value_of(q.w) < 0.0) q = (Quaternion){-q.w, -q.x, -q.y, -q.z};
    real half = root_of_squares(q.x * q.x + q.y * q.y + q.z * q.z);
    /* the factor's slope is of the order of half and vanishes with it */
    real factor = 2.0;
    if (!(value_of(half) < 1e-8)) factor = 2.0 * real_atan2(half, q.w) / half;
    return factor * q.y;
}

/* One step: the wrench of the mean velocities in the orientation halfway, and the heat it makes. */
int NAME(drag_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Drag *drag = self;
    (void)why;
    Quaternion before = {x[ORIENTATION], x[ORIENTATION + 1], x[ORIENTATION + 2], x[ORIENTATION + 3]};
    Quaternion after = quaternion_of(u + 3), middle = halfway(before, after);
    Vector3 moved = vector_subtract(vector_of(u), (Vector3){x[POSITION], x[POSITION + 1], x[POSITION + 2]});
    PlateRates rates = {vector_dot(plate_normal(middle), moved) / h, turned_about_y(before, after) / h};
    PlateLoads loads = plate_loads(drag, rates);
    for (int i = 0; i < 7; i++) x_next[i] = u[i];
    x_next[HEAT] = x[HEAT] - (loads.force * rates.velocity + loads.torque * rates.turn) * h;
    store_wrench(middle, loads, x_next + WRENCH);
    if (value_of(u[drag->impulse]) < 0.5) {
        store_mid_step_after(x + NORMAL_SLIDE, rates.velocity, h, x_next + NORMAL_SLIDE);
        store_mid_step_after(x + TURN_SLIDE, rates.turn, h, x_next + TURN_SLIDE);
    } else {
        PlateRates end = plate_rates(u);
        store_mid_step_start(end.velocity, x_next + NORMAL_SLIDE);
        store_mid_step_start(end.turn, x_next + TURN_SLIDE);
    }
    return 1;
}

/* Wrench on the port. */
void NAME(drag_outputs)(void *self, const real *x, const real *u, real *y) {
    const Drag *drag = self;
    if (drag->endpoint)
        store_wrench(quaternion_of(u + 3), plate_loads(drag, plate_rates(u)), y);
    else
        for (int i = 0; i < WRENCH_SIZE; i++) y[i] = x[WRENCH + i];
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

int drag_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                       double complex *rates, Reason *why);
int drag_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why);
void drag_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [START] = {"start", 1},
    [END] = {"end", 1},
    [WIDTH] = {"width", 1},
    [AIR_DENSITY] = {"air_density", 1},
    [DRAG_COEFFICIENT] = {"drag_coefficient", 1},
};

static void *drag_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Drag *drag = allocate(memory, sizeof *drag);
    if (!drag) {
        refuse(why, "there is no memory for a drag plate");
        return NULL;
    }
    *states = STATES;
    int usable = check_sizes("drag plate", sizes, MOTION_SIZE + 1, WRENCH_SIZE, 4, why) &&
                 read_choice(data, "endpoint", 1, &drag->endpoint, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, drag->places, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &drag->impulse, why);
    return usable ? drag : NULL;
}

static int drag_prepare(void *self, const double *p, Reason *why) {
    Drag *drag = self;
    const size_t *place = drag->places;
    drag->start = p[place[START]];
    drag->end = p[place[END]];
    drag->pressure = 0.5 * p[place[AIR_DENSITY]] * p[place[DRAG_COEFFICIENT]] * p[place[WIDTH]];
    if (drag->end <= drag->start)
        return refuse(why, "the plate ends at %g m; it must end beyond its start at %g m", drag->end, drag->start);
    return 1;
}

/* At the pose of the inputs. */
static int drag_initial(void *self, const double *u, double *x, Reason *why) {
    (void)self, (void)why;
    for (int i = 0; i < STATES; i++) x[i] = i < 7 ? u[i] : 0.0;
    PlateRates now = plate_rates(u);
    store_mid_step_start(now.velocity, x + NORMAL_SLIDE);
    store_mid_step_start(now.turn, x + TURN_SLIDE);
    return 1;
}

/* Force, torque and velocity at the communication point, energy dissipated. */
static void drag_observe(void *self, const double *x, const double *u, double *z) {
    const Drag *drag = self;
    PlateRates now = {mid_step_now(x + NORMAL_SLIDE), mid_step_now(x + TURN_SLIDE)};
    if (drag->endpoint) now = plate_rates(u);
    PlateLoads loads = plate_loads(drag, now);
    z[0] = loads.force;
    z[1] = loads.torque;
    z[2] = now.velocity - 0.5 * (drag->start + drag->end) * now.turn;
    z[3] = x[HEAT];
}

static size_t drag_continuous(const void *self, size_t *places) {
    (void)self;
    if (places) places[0] = HEAT;
    return 1;
}

const Kernel drag_kernel = {
    "drag",       drag_create,       drag_prepare,         drag_initial, drag_step_real, drag_outputs_real,
    drag_observe, drag_step_complex, drag_outputs_complex, NULL,         NULL,
    .continuous = drag_continuous,
    .rates = drag_rates_real,
    .rates_complex = drag_rates_complex,
};

#endif
