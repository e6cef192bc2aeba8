/* Drive about an axis: a commanded angle, by a motion profile or from outside, behind the compliance of a gearbox: the
   twin of components/drive.py. */

#include "drive_layout.h"
#include "axial.h"
#include "motion_law.h"

typedef struct Drive {
    Axial axial;
    int profile;
    double change; /* of the commanded angle */
} Drive;

/* What is commanded from a state on: of a profile, or from where a command from outside has led to. */
typedef struct Command {
    const Drive *drive;
    real followed, since;
} Command;

/* The instant of some inputs: what is commanded, and what the gearbox takes up. */
typedef struct Instant {
    Turn turn;
    real commanded, commanded_rate, deflection, deflection_rate;
} Instant;

/* Share of the duration that has passed. */
static inline real passed_share(const Drive *drive, real time) {
    const double *p = drive->axial.base.p;
    real share = (time - p[P_START_TIME]) / p[P_DURATION];
    if (value_of(share) <= 0.0) return 0.0;
    if (value_of(share) >= 1.0) return 1.0;
    return share;
}

static inline real profile_angle(const Drive *drive, real time) {
    real s = passed_share(drive, time);
    const int quintic = drive->profile == STEP5_PROFILE;
    real rise = quintic ? s * s * s * (10.0 + s * (6.0 * s - 15.0)) : cubic_step(s);
    return drive->axial.base.p[P_START_ANGLE] + drive->change * rise;
}

static inline real profile_rate(const Drive *drive, real time) {
    real s = passed_share(drive, time);
    real rest = s * (1.0 - s);
    const double scale = drive->change / drive->axial.base.p[P_DURATION];
    return scale * (drive->profile == STEP5_PROFILE ? 30.0 * rest * rest : 6.0 * rest);
}

/* What is left of the way to a command from outside. */
static inline real way_left(const Command *law, real time) {
    const double *p = law->drive->axial.base.p;
    return (law->followed - p[P_END_ANGLE]) * exp((law->since - time) / p[P_DURATION]);
}

static inline real law_angle(const Command *law, real time) {
    if (law->drive->profile != COMMANDED_PROFILE) return profile_angle(law->drive, time);
    return law->drive->axial.base.p[P_END_ANGLE] + way_left(law, time);
}

static inline real law_rate(const Command *law, real time) {
    if (law->drive->profile != COMMANDED_PROFILE) return profile_rate(law->drive, time);
    return -way_left(law, time) / law->drive->axial.base.p[P_DURATION];
}

/* Integral of (2 s - 1) exp(-x s) over s from 0 to 1; a series where the rest would be round-off. */
static inline double decay_moment(double x) {
    if (x < SHORT) return -x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * (1.0 / 40.0 - x / 180.0)));
    double left = exp(-x);
    return 2.0 * (1.0 - left * (1.0 + x)) / (x * x) - (1.0 - left) / x;
}

/* First moment of the rate between two times, by Gauss' rule: exact but where the motion begins or ends. */
static inline double profile_moment(const Drive *drive, double start, double end) {
    const double gauss = sqrt(0.6), middle = 0.5 * (start + end), half = 0.5 * (end - start);
    real change = profile_rate(drive, middle + gauss * half) - profile_rate(drive, middle - gauss * half);
    return 5.0 / 9.0 * gauss * half * value_of(change);
}

static inline double law_moment(const Command *law, double start, double end) {
    if (law->drive->profile != COMMANDED_PROFILE) return profile_moment(law->drive, start, end);
    double x = (end - start) / law->drive->axial.base.p[P_DURATION];
    return -value_of(way_left(law, start)) * x * decay_moment(x);
}

/* The angle is the one nearest the reference. */
static inline Instant drive_instant(const Command *law, const real *u, real clock, real reference) {
    const Drive *drive = law->drive;
    Instant now;
    now.turn = turn_of(&drive->axial, u, reference, drive->axial.base.p[P_ALIGNED_ANGLE]);
    now.commanded = law_angle(law, clock);
    now.commanded_rate = 0.0;
    if (!commanded(u, U_HOLD)) now.commanded_rate = law_rate(law, clock);
    now.deflection = now.turn.angle - now.commanded;
    now.deflection_rate = now.turn.rate - now.commanded_rate;
    return now;
}

/* Torque of an instant. */
static inline real drive_torque(const Drive *drive, real deflection, real rate) {
    return -drive->axial.base.p[P_STIFFNESS] * deflection - drive->axial.base.p[P_DAMPING] * rate;
}

/* One step: the mean torque of the deflections at both ends, and the motor's work. */
int NAME(drive_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Drive *drive = self;
    const Connection *base = &drive->axial.base;
    (void)why;
    const int impulse = commanded(u, U_IMPULSE), paired = base->paired && !impulse;
    const double clock = commanded(u, U_HOLD) ? x[X_CLOCK] : x[X_CLOCK] + h;
    const Command law = {drive, x[X_FOLLOWED], x[X_CLOCK]};
    Instant now = drive_instant(&law, u, clock, x[X_ANGLE]);
    real before = law_angle(&law, x[X_CLOCK]);
    Arc arc = arc_to(&now.turn, x, u, paired);
    StepMotion motion = step_motion(x + X_MEMORY, x[X_ANGLE] - before, now.deflection, h);
    real mean_rate = (motion.end - motion.start) / h;
    if (base->endpoint) leave_inertia_out(&motion);
    double driven = paired ? law_moment(&law, x[X_CLOCK], clock) : 0.0;
    motion.moment = arc.moment - driven;
    for (int i = 0; i < MID_STEP_SIZE; i++) x_next[X_LOAD + i] = 0.0;
    store_mid_step_start(now.deflection_rate, x_next + X_SLIDE);
    MeanLoad load;
    if (paired) {
        load = workless_spring(base->p[P_STIFFNESS], base->p[P_DAMPING], &motion);
        store_path(&motion, x_next + X_MEMORY);
        store_mid_step_start(x_next[X_MEMORY + END_RATE], x_next + X_SLIDE);
        store_mid_step_after(x + X_LOAD, load.force, h, x_next + X_LOAD);
    } else {
        load = bushing_load(base->p[P_STIFFNESS], base->p[P_DAMPING], &motion);
        store_memory(&motion, now.deflection_rate, x_next + X_MEMORY);
        if (!impulse) store_mid_step_after(x + X_SLIDE, mean_rate, h, x_next + X_SLIDE);
        if (impulse) store_rate(now.deflection_rate, x_next + X_MEMORY);
    }
    store_turn(&now.turn, x_next);
    store_load(&arc, &load, paired, x_next);
    x_next[X_CLOCK] = clock;
    x_next[X_FOLLOWED] = drive->profile == COMMANDED_PROFILE ? now.commanded : x[X_FOLLOWED];
    x_next[X_HEAT] = x[X_HEAT] + load.heat;
    x_next[X_NUMERICAL] = x[X_NUMERICAL] + load.numerical;
    x_next[X_WORK] = x[X_WORK] + load.force * (now.commanded - before) + load.slope * driven;
    return 1;
}

void NAME(drive_outputs)(void *self, const real *x, const real *u, real *y) {
    const Drive *drive = self;
    if (gives_means(self, x, y)) return;
    const Command law = {drive, x[X_FOLLOWED], x[X_CLOCK]};
    Instant now = drive_instant(&law, u, x[X_CLOCK], x[X_ANGLE]);
    store_torque(&now.turn, drive_torque(drive, now.deflection, now.deflection_rate), y);
}

/* Rate of the clock, heat of the end-point torque, power of the motor, rate of what is followed. */
int NAME(drive_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Drive *drive = self;
    (void)raw, (void)why;
    const Command law = {drive, x[X_FOLLOWED], x[X_CLOCK]};
    Instant now = drive_instant(&law, u, x[X_CLOCK], x[X_ANGLE]);
    rates[0] = commanded(u, U_HOLD) ? 0.0 : 1.0;
    rates[1] = drive->axial.base.p[P_DAMPING] * now.deflection_rate * now.deflection_rate;
    rates[2] = drive_torque(drive, now.deflection, now.deflection_rate) * now.commanded_rate;
    rates[3] = drive->profile == COMMANDED_PROFILE ? now.commanded_rate : 0.0;
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(drive)

static void *drive_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Drive *drive = create_connection(data, sizes, memory, sizeof *drive, states, why);
    return drive && read_axis_frame(data, drive->axial.axis_frame, why) &&
                   read_choice(data, "profile", COMMANDED_PROFILE, &drive->profile, why)
               ? drive
               : NULL;
}

static int drive_prepare(void *self, const double *p, Reason *why) {
    Drive *drive = self;
    if (drive->profile == COMMANDED_PROFILE && p[P_START_TIME] != 0.0)
        return refuse(why, "start_time is %g; a commanded drive follows from the start on", p[P_START_TIME]);
    drive->change = p[P_END_ANGLE] - p[P_START_ANGLE];
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* At the pose of the inputs; the angle is the one nearest the start angle. */
static int drive_initial(void *self, const double *u, double *x, Reason *why) {
    const Drive *drive = self;
    (void)why;
    const Command law = {drive, drive->axial.base.p[P_START_ANGLE], 0.0};
    Instant now = drive_instant(&law, u, 0.0, law.followed);
    memset(x, 0, STATES * sizeof *x);
    store_turn(&now.turn, x);
    x[X_FOLLOWED] = law.followed;
    store_rate(now.deflection_rate, x + X_MEMORY);
    store_mid_step_start(now.deflection_rate, x + X_SLIDE);
    return 1;
}

/* At the communication point; at order 4 the torque comes from what the last steps' loads were. */
static void drive_observe(void *self, const double *x, const double *u, double *z) {
    const Drive *drive = self;
    const Connection *base = &drive->axial.base;
    const Command law = {drive, x[X_FOLLOWED], x[X_CLOCK]};
    Instant now = drive_instant(&law, u, x[X_CLOCK], x[X_ANGLE]);
    double felt = base->endpoint ? now.deflection_rate : mid_step_now(x + X_SLIDE);
    double torque = drive_torque(drive, now.deflection, felt);
    z[Z_ANGLE] = now.turn.angle;
    z[Z_ANGULAR_RATE] = now.turn.rate;
    z[Z_COMMANDED_ANGLE] = now.commanded;
    z[Z_COMMANDED_RATE] = now.commanded_rate;
    z[Z_DRIVE_TORQUE] = base->paired ? load_now(x + X_LOAD, torque, x[X_MEMORY + ROUGHNESS]) : torque;
    z[Z_SUPPLIED_ENERGY] = x[X_WORK];
    z[Z_POTENTIAL_ENERGY] = 0.5 * base->p[P_STIFFNESS] * now.deflection * now.deflection;
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

/* Follows the angle. */
static void drive_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    (void)at_event;
    memcpy(x_next, x, STATES * sizeof *x);
    const Command law = {self, x[X_FOLLOWED], x[X_CLOCK]};
    x_next[X_ANGLE] = drive_instant(&law, u, x[X_CLOCK], x[X_ANGLE]).turn.angle;
}

/* Time until the motion starts or ends. */
static double drive_break(void *self, const double *x, const double *u) {
    const Drive *drive = self;
    const double *p = drive->axial.base.p;
    const double ends[2] = {p[P_START_TIME], p[P_START_TIME] + p[P_DURATION]};
    for (int i = 0; i < 2 && drive->profile != COMMANDED_PROFILE && !commanded(u, U_HOLD); i++)
        if (ends[i] > x[X_CLOCK] + LAW_REACHED) return ends[i] - x[X_CLOCK];
    return INFINITY;
}

const Kernel drive_kernel = {
    CONNECTION_FUNCTIONS(drive, drive),
    .update = drive_update,
    .time_to_break = drive_break,
};

#endif
