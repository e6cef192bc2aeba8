/* Gear between two bodies on one carrier or on two: the twin of components/gear.py. */

#include "gear_layout.h"
#include "connection.h"
#include "clearance.h"

enum { BODIES = 2, SEAT_GAP = 4, SEAT_SWING = 7, SEAT_COORDINATE = 9, SEAT_SIZE = 10 };

typedef struct Gear {
    Connection base;
    int slides[BODIES], carriers[BODIES]; /* whether a body slides, and the port that carries it */
    double axis_frames[BODIES][4];
    Clearance play;
} Gear;

/* A body on its carrier: frame of its axis, gap from the carrier, tilt, angle or distance and its rate. */
typedef struct Seat {
    Quaternion frame;
    Vector3 gap;
    Transverse swing;
    real coordinate, rate;
} Seat;

/* Motions or moments of a body and of its carrier. */
static inline void pick_pair(const Gear *gear, const real *ports, int size, int body, real *both) {
    memcpy(both, ports + gear->carriers[body] * size, (size_t)size * sizeof *both);
    memcpy(both + size, ports + (body + 1) * size, (size_t)size * sizeof *both);
}

static inline Seat seat_of(const Gear *gear, int body, const real *u, real reference) {
    real both[2 * MOTION_SIZE];
    pick_pair(gear, u, MOTION_SIZE, body, both);
    Pose pose = relative_pose(both, gear->axis_frames[body]);
    Rates rates = relative_rates(both, &pose);
    if (gear->slides[body]) return (Seat){pose.frame, pose.gap, pose.swing, pose.offset.x, rates.offset.x};
    return (Seat){pose.frame, pose.gap, pose.swing, nearest_turn(pose.twist, reference), rates.twist};
}

static inline void store_seat(const Seat *seat, real *x) {
    quaternion_store(seat->frame, x);
    vector_store(seat->gap, x + SEAT_GAP);
    x[SEAT_SWING] = seat->swing.y;
    x[SEAT_SWING + 1] = seat->swing.z;
    x[SEAT_COORDINATE] = seat->coordinate;
}

/* Force and torque on a body, in the axes of its frame. */
static inline void seat_loads(const Gear *gear, int body, real load, Transverse swing, Vector3 *force, Vector3 *torque) {
    *force = *torque = (Vector3){0.0, 0.0, 0.0};
    if (gear->slides[body])
        force->x = load;
    else
        *torque = conjugate_torque(load, (Transverse){0.0, 0.0}, swing);
}

/* Adds wrenches on a body and on its carrier to those on all. */
static inline void add_pair(const Gear *gear, const real *both, int body, real *wrench) {
    for (int i = 0; i < WRENCH_SIZE; i++) {
        wrench[gear->carriers[body] * WRENCH_SIZE + i] += both[i];
        wrench[(body + 1) * WRENCH_SIZE + i] = both[WRENCH_SIZE + i];
    }
}

static inline void clear_wrench(const Gear *gear, real *wrench) {
    for (size_t i = 0; i < wrenches_size(&gear->base); i++) wrench[i] = 0.0;
}

/* Share of the torque on the first body that acts on a body. */
static inline double share_of(const Gear *gear, int body) { return body ? -gear->base.p[P_RATIO] : 1.0; }

static inline Passage passage_to(const double *x, const Seat *now) {
    return (Passage){{x[0], x[1], x[2], x[3]}, now->frame, {x[SEAT_GAP], x[SEAT_GAP + 1], x[SEAT_GAP + 2]}, now->gap};
}

static inline Transverse middle_swing(const double *x, const Seat *now) {
    return (Transverse){0.5 * (x[SEAT_SWING] + now->swing.y), 0.5 * (x[SEAT_SWING + 1] + now->swing.z)};
}

/* Stores the wrenches of the mean torque on the first body over a step, and their slopes. */
static inline void store_gear_load(const Gear *gear, const double *x, const Seat *now, const MeanLoad *load, int paired,
                                   real *x_next) {
    real *wrench = x_next + X_WRENCH, *slope = wrench + wrenches_size(&gear->base);
    clear_wrench(gear, wrench);
    clear_wrench(gear, slope);
    for (int i = 0; i < BODIES; i++) {
        const double *seat = x + X_SEATS + i * SEAT_SIZE, share = share_of(gear, i);
        Passage passage = passage_to(seat, now + i);
        Transverse swing = middle_swing(seat, now + i);
        Vector3 force, torque;
        real means[2 * WRENCH_SIZE], slopes[2 * WRENCH_SIZE];
        seat_loads(gear, i, share * load->force, swing, &force, &torque);
        store_mean_pair(&passage, force, torque, means);
        if (paired) {
            seat_loads(gear, i, share * load->slope, swing, &force, &torque);
            store_slope_pair(&passage, force, torque, means, slopes);
            add_pair(gear, slopes, i, slope);
        }
        add_pair(gear, means, i, wrench);
    }
}

/* First moment of the deflection's rate. */
static inline real deflection_moment(const Gear *gear, const double *x, const real *u, const Seat *now) {
    real sum = 0.0, both[2 * WRENCH_SIZE];
    for (int i = 0; i < BODIES; i++) {
        const double *seat = x + X_SEATS + i * SEAT_SIZE;
        Passage passage = passage_to(seat, now + i);
        pick_pair(gear, own_inputs(&gear->base, u) + OWN_INPUTS, WRENCH_SIZE, i, both);
        Rates rates = rate_moments(&passage, both, middle_swing(seat, now + i));
        sum += share_of(gear, i) * (gear->slides[i] ? rates.offset.x : rates.twist);
    }
    return sum;
}

static inline void both_seats(const Gear *gear, const double *x, const real *u, Seat *now) {
    for (int i = 0; i < BODIES; i++) now[i] = seat_of(gear, i, u, x ? x[X_SEATS + i * SEAT_SIZE + SEAT_COORDINATE] : 0.0);
}

static inline real deflection_of(const Gear *gear, const Seat *now) {
    return now[0].coordinate - gear->base.p[P_RATIO] * now[1].coordinate;
}

static inline real deflection_rate(const Gear *gear, const Seat *now) {
    return now[0].rate - gear->base.p[P_RATIO] * now[1].rate;
}

/* Torque on the first body. */
static inline real torque_of(const Gear *gear, real deflection, real rate) {
    real torque = 0.0;
    if (gear->play.size > 0.0)
        add_clearance_force(&gear->play, &deflection, &rate, &torque);
    else
        torque = -gear->base.p[P_STIFFNESS] * deflection - gear->base.p[P_DAMPING] * rate;
    return torque;
}

/* One step: the mean torque on both bodies and their carriers. */
int NAME(gear_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Gear *gear = self;
    (void)why;
    const double stiffness = gear->base.p[P_STIFFNESS], damping = gear->base.p[P_DAMPING];
    const int impulse = commanded(own_inputs(&gear->base, u), U_IMPULSE), paired = gear->base.paired && !impulse;
    const double *seats = x + X_SEATS;
    Seat now[BODIES];
    both_seats(gear, x, u, now);
    const double before = seats[SEAT_COORDINATE] - gear->base.p[P_RATIO] * seats[SEAT_SIZE + SEAT_COORDINATE] - x[X_START];
    StepMotion motion = step_motion(x + X_MEMORY, before, deflection_of(gear, now) - x[X_START], h);
    if (paired) motion.moment = deflection_moment(gear, x, u, now);
    if (gear->base.endpoint) leave_inertia_out(&motion);
    MeanLoad load;
    if (gear->play.size > 0.0)
        clearance_loads(&gear->play, &motion, paired, &load);
    else
        load = paired ? workless_spring(stiffness, damping, &motion) : bushing_load(stiffness, damping, &motion);
    store_gear_load(gear, x, now, &load, paired, x_next);
    for (int i = 0; i < BODIES; i++) store_seat(now + i, x_next + X_SEATS + i * SEAT_SIZE);
    if (impulse) {
        store_rate(deflection_rate(gear, now), x_next + X_MEMORY);
        store_mid_step_start(deflection_rate(gear, now), x_next + X_SLIDE);
    } else if (paired) {
        store_path(&motion, x_next + X_MEMORY);
        store_mid_step_start(x_next[X_MEMORY + END_RATE], x_next + X_SLIDE);
    } else {
        store_memory(&motion, deflection_rate(gear, now), x_next + X_MEMORY);
        store_mid_step_after(x + X_SLIDE, (motion.end - motion.start) / h, h, x_next + X_SLIDE);
    }
    x_next[X_START] = x[X_START];
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    return 1;
}

void NAME(gear_outputs)(void *self, const real *x, const real *u, real *y) {
    const Gear *gear = self;
    if (gives_means(&gear->base, x, y)) return;
    Seat now[BODIES];
    for (int i = 0; i < BODIES; i++)
        now[i] = seat_of(gear, i, u, value_of(x[X_SEATS + i * SEAT_SIZE + SEAT_COORDINATE]));
    real torque = torque_of(gear, deflection_of(gear, now) - x[X_START], deflection_rate(gear, now));
    clear_wrench(gear, y);
    for (int i = 0; i < BODIES; i++) {
        Vector3 force, moment;
        real both[2 * WRENCH_SIZE];
        seat_loads(gear, i, share_of(gear, i) * torque, now[i].swing, &force, &moment);
        store_pair(quaternion_rotate(now[i].frame, force), quaternion_rotate(now[i].frame, moment), now[i].gap, both);
        add_pair(gear, both, i, y);
    }
}

/* Heat of the damper. */
int NAME(gear_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Gear *gear = self;
    (void)raw, (void)why;
    Seat now[BODIES];
    for (int i = 0; i < BODIES; i++)
        now[i] = seat_of(gear, i, u, value_of(x[X_SEATS + i * SEAT_SIZE + SEAT_COORDINATE]));
    real rate = deflection_rate(gear, now), deflection = deflection_of(gear, now) - x[X_START], torque = 0.0;
    if (gear->play.size > 0.0)
        rates[0] = add_clearance_force(&gear->play, &deflection, &rate, &torque);
    else
        rates[0] = gear->base.p[P_DAMPING] * rate * rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(gear)

static void *gear_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    int two;
    if (!read_choice(data, "second_carrier", 1, &two, why)) return NULL;
    Gear *gear = create_connection(data, sizes, memory, sizeof *gear, BODIES + 1 + (size_t)two, states, why);
    if (!gear) return NULL;
    gear->carriers[1] = two ? BODIES + 1 : 0;
    const int sound = read_unit(data, "first_frame", 4, gear->axis_frames[0], why) &&
                      read_unit(data, "second_frame", 4, gear->axis_frames[1], why) &&
                      read_choice(data, "second_slides", 1, gear->slides + 1, why);
    return sound ? gear : NULL;
}

static int gear_prepare(void *self, const double *p, Reason *why) {
    if (p[P_RATIO] == 0.0) return refuse(why, "ratio is 0; a gear has another ratio, negative for an external pair");
    ((Gear *)self)->play = (Clearance){.count = 1, .size = p[P_PLAY], .stiffness = p[P_STIFFNESS], .damping = p[P_DAMPING]};
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* In mesh at the pose of the inputs. */
static int gear_initial(void *self, const double *u, double *x, Reason *why) {
    const Gear *gear = self;
    (void)why;
    Seat now[BODIES];
    both_seats(gear, NULL, u, now);
    memset(x, 0, states_size(&gear->base) * sizeof *x);
    for (int i = 0; i < BODIES; i++) store_seat(now + i, x + X_SEATS + i * SEAT_SIZE);
    x[X_START] = deflection_of(gear, now);
    store_rate(deflection_rate(gear, now), x + X_MEMORY);
    store_mid_step_start(deflection_rate(gear, now), x + X_SLIDE);
    return 1;
}

static void gear_observe(void *self, const double *x, const double *u, double *z) {
    const Gear *gear = self;
    Seat now[BODIES];
    both_seats(gear, x, u, now);
    const double deflection = deflection_of(gear, now) - x[X_START];
    const double felt = gear->base.endpoint ? deflection_rate(gear, now) : mid_step_now(x + X_SLIDE);
    z[Z_FIRST_ANGLE] = now[0].coordinate;
    z[Z_SECOND_COORDINATE] = now[1].coordinate;
    z[Z_GEAR_TORQUE] = torque_of(gear, deflection, felt);
    z[Z_POTENTIAL_ENERGY] = clearance_potential(&gear->play, &deflection);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

/* Follows the angles. */
static void gear_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const Gear *gear = self;
    Seat now[BODIES];
    (void)at_event;
    both_seats(gear, x, u, now);
    memcpy(x_next, x, states_size(&gear->base) * sizeof *x);
    for (int i = 0; i < BODIES; i++) x_next[X_SEATS + i * SEAT_SIZE + SEAT_COORDINATE] = now[i].coordinate;
}

const Kernel gear_kernel = {CONNECTION_FUNCTIONS(gear, gear), .update = gear_update};

#endif
