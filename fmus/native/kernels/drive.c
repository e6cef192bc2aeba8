/* Drive about an axis: a commanded angle that follows a motion profile, behind the compliance of a gearbox: the
   twin of components/drive.py. */

#include "relative.h"
#include "workless.h"

/* State: unwrapped angle, frame, swing, remembered rates of the deflection, clock, heat, work of the motor, mean
   rates of two steps, wrenches of both ports, what the scheme took away, roughness, slopes of the wrenches. */
enum {
    ANGLE = 0,
    FRAME = 1,
    SWING = 5,
    MEMORY = 7,
    CLOCK = 9,
    HEAT = 10,
    WORK = 11,
    SLIDE = 12,
    WRENCH = 16,
    NUMERICAL = 28,
    ROUGHNESS = 29,
    SLOPES = 30,
    LOAD = 42, /* of order 4, over the last steps */
    STATES = 46
};

enum {
    STIFFNESS,
    DAMPING,
    ALIGNED_ANGLE,
    START_ANGLE,
    END_ANGLE,
    START_TIME,
    DURATION,
    END_WEIGHT,
    ORDER,
    PARAMETERS
};

enum { CONTINUOUS = 3, OBSERVATIONS = 9, PAIR_SIZE = 2 * WRENCH_SIZE };

typedef struct Drive {
    double axis_frame[4];
    int quintic, endpoint;
    int paired; /* torques are of order 4; those of static solutions are not */
    size_t impulse, hold, moments, places[PARAMETERS];
    double stiffness, damping, aligned_angle, start_angle, change, start_time, duration, end_weight;
} Drive;

/* The instant of some inputs: what is commanded, and what the gearbox takes up. */
typedef struct Instant {
    Pose pose;
    real angle, rate, commanded, commanded_rate, deflection, deflection_rate;
} Instant;

/* Share of the duration that has passed. */
static inline real passed_share(const Drive *drive, real time) {
    real share = (time - drive->start_time) / drive->duration;
    if (value_of(share) <= 0.0) return 0.0;
    if (value_of(share) >= 1.0) return 1.0;
    return share;
}

static inline real profile_angle(const Drive *drive, real time) {
    real s = passed_share(drive, time);
    real rise = drive->quintic ? s * s * s * (10.0 + s * (6.0 * s - 15.0)) : s * s * (3.0 - 2.0 * s);
    return drive->start_angle + drive->change * rise;
}

static inline real profile_rate(const Drive *drive, real time) {
    real s = passed_share(drive, time);
    real rest = s * (1.0 - s);
    return drive->change / drive->duration * (drive->quintic ? 30.0 * rest * rest : 6.0 * rest);
}

/* First moment of the rate between two times, by Gauss' rule: exact but where the motion begins or ends. */
static inline double profile_moment(const Drive *drive, double start, double end) {
    const double gauss = sqrt(0.6), middle = 0.5 * (start + end), half = 0.5 * (end - start);
    real change = profile_rate(drive, middle + gauss * half) - profile_rate(drive, middle - gauss * half);
    return 5.0 / 9.0 * gauss * half * value_of(change);
}

static inline int is_held(const Drive *drive, const real *u) { return value_of(u[drive->hold]) > 0.5; }

/* The angle is the one nearest the reference. */
static inline Instant drive_instant(const Drive *drive, const real *u, real clock, real reference) {
    Instant now;
    now.pose = relative_pose(u, drive->axis_frame);
    now.angle = nearest_turn(drive->aligned_angle + now.pose.twist, reference);
    now.rate = relative_rates(u, &now.pose).twist;
    now.commanded = profile_angle(drive, clock);
    now.commanded_rate = 0.0;
    if (!is_held(drive, u)) now.commanded_rate = profile_rate(drive, clock);
    now.deflection = now.angle - now.commanded;
    now.deflection_rate = now.rate - now.commanded_rate;
    return now;
}

/* Torque of an instant. */
static inline real drive_torque(const Drive *drive, real deflection, real rate) {
    return -drive->stiffness * deflection - drive->damping * rate;
}

static inline void drive_store_pose(const Instant *now, real *x) {
    x[ANGLE] = now->angle;
    quaternion_store(now->pose.frame, x + FRAME);
    x[SWING] = now->pose.swing.y;
    x[SWING + 1] = now->pose.swing.z;
}

static inline void drive_store_torque(Vector3 torque, real *wrench) {
    Vector3 zero = {0.0, 0.0, 0.0};
    store_pair(zero, torque, zero, wrench);
}

/* Stores the wrenches of a torque about the axis, the mean over a step. */
static inline void store_mean_torque(const Passage *passage, real torque, Transverse swing, real *wrench) {
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, swing);
    drive_store_torque(mean_direction(passage->frame0, passage->frame1, conjugate), wrench);
}

/* One step: the mean torque of the deflections at both ends, and the motor's work. */
int NAME(drive_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Drive *drive = self;
    (void)why;
    double clock = is_held(drive, u) ? x[CLOCK] : x[CLOCK] + h;
    Instant now = drive_instant(drive, u, clock, x[ANGLE]);
    real commanded = profile_angle(drive, x[CLOCK]);
    real start = x[ANGLE] - commanded;
    real mean_rate = (now.deflection - start) / h;
    StepMotion motion = {start, now.deflection, h, x[MEMORY], x[MEMORY + 1], x[ROUGHNESS], 0.0};
    /* inertial terms tame held torques, which an end-point torque is not */
    if (drive->endpoint) motion.mean_rate = motion.end_rate = value_of(mean_rate);
    int impulse = value_of(u[drive->impulse]) > 0.5, fourth = drive->paired && !impulse;
    Transverse swing = {0.5 * (x[SWING] + now.pose.swing.y), 0.5 * (x[SWING + 1] + now.pose.swing.z)};
    Passage passage = {
        {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]}, now.pose.frame, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0},
    };
    double driven = 0.0;
    MeanLoad load;
    if (fourth) {
        driven = profile_moment(drive, x[CLOCK], clock);
        motion.moment = rate_moments(&passage, u + drive->moments, swing).twist - driven;
        load = workless_spring(drive->stiffness, drive->damping, &motion);
    } else {
        load = bushing_load(drive->stiffness, drive->damping, &motion, drive->end_weight);
    }
    drive_store_pose(&now, x_next);
    x_next[CLOCK] = clock;
    x_next[HEAT] = x[HEAT] + load.heat;
    x_next[NUMERICAL] = x[NUMERICAL] + load.numerical;
    x_next[WORK] = x[WORK] + load.force * (now.commanded - commanded) + load.slope * driven;
    store_mean_torque(&passage, load.force, swing, x_next + WRENCH);
    for (int i = ROUGHNESS; i < STATES; i++) x_next[i] = 0.0;
    if (fourth) {
        store_mean_torque(&passage, load.slope, swing, x_next + SLOPES);
        store_mid_step_after(x + LOAD, load.force, h, x_next + LOAD);
        remember_path(&motion, x_next + MEMORY, x_next + MEMORY + 1, x_next + ROUGHNESS);
        store_mid_step_start(x_next[MEMORY + 1], x_next + SLIDE);
    } else if (impulse) {
        x_next[MEMORY] = x_next[MEMORY + 1] = now.deflection_rate;
        store_mid_step_start(now.deflection_rate, x_next + SLIDE);
    } else {
        remember_rates(&motion, now.deflection_rate, x_next + MEMORY, x_next + MEMORY + 1);
        store_mid_step_after(x + SLIDE, mean_rate, h, x_next + SLIDE);
    }
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
void NAME(drive_outputs)(void *self, const real *x, const real *u, real *y) {
    const Drive *drive = self;
    if (!drive->endpoint) {
        for (int i = 0; i < PAIR_SIZE; i++) {
            y[i] = x[WRENCH + i];
            y[PAIR_SIZE + i] = x[SLOPES + i];
        }
        return;
    }
    Instant now = drive_instant(drive, u, x[CLOCK], x[ANGLE]);
    real torque = drive_torque(drive, now.deflection, now.deflection_rate);
    Vector3 conjugate = conjugate_torque(torque, (Transverse){0.0, 0.0}, now.pose.swing);
    drive_store_torque(quaternion_rotate(now.pose.frame, conjugate), y);
}

/* Rate of the clock, heat of the end-point torque and power of the motor. */
int NAME(drive_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Drive *drive = self;
    (void)raw, (void)why;
    Instant now = drive_instant(drive, u, x[CLOCK], x[ANGLE]);
    rates[0] = is_held(drive, u) ? 0.0 : 1.0;
    rates[1] = drive->damping * now.deflection_rate * now.deflection_rate;
    rates[2] = drive_torque(drive, now.deflection, now.deflection_rate) * now.commanded_rate;
    return 1;
}

#ifndef FANFOLD_COMPLEX

int drive_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                        double complex *rates, Reason *why);
int drive_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                       Reason *why);
void drive_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [STIFFNESS] = {"stiffness", 1},     [DAMPING] = {"damping", 1},         [ALIGNED_ANGLE] = {"aligned_angle", 1},
    [START_ANGLE] = {"start_angle", 1}, [END_ANGLE] = {"end_angle", 1},     [START_TIME] = {"start_time", 1},
    [DURATION] = {"duration", 1},       [END_WEIGHT] = {"end_weight", 1},   [ORDER] = {"order", 1},
};

static void *drive_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Drive *drive = allocate(memory, sizeof *drive);
    if (!drive) {
        refuse(why, "there is no memory for a drive");
        return NULL;
    }
    *states = STATES;
    if (!read_choice(data, "endpoint", 1, &drive->endpoint, why)) return NULL;
    size_t pairs = drive->endpoint ? 0 : PAIR_SIZE;
    int usable = check_sizes("drive", sizes, 2 * MOTION_SIZE + 2 + pairs, PAIR_SIZE + pairs, OBSERVATIONS, why) &&
                 find_moments(data, "inboard.velocity_moment", drive->endpoint ? 0 : 2, sizes, &drive->moments, why) &&
                 read_axis_frame(data, drive->axis_frame, why) &&
                 read_choice(data, "quintic", 1, &drive->quintic, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, drive->places, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &drive->impulse, why) &&
                 find_place(data, "input", (VariableName){"hold", 1}, sizes->inputs, &drive->hold, why);
    return usable ? drive : NULL;
}

static int drive_prepare(void *self, const double *p, Reason *why) {
    Drive *drive = self;
    const size_t *place = drive->places;
    int fourth = 0;
    if (!read_order(p[place[ORDER]], &fourth, why)) return 0;
    drive->stiffness = p[place[STIFFNESS]];
    drive->damping = p[place[DAMPING]];
    drive->aligned_angle = p[place[ALIGNED_ANGLE]];
    drive->start_angle = p[place[START_ANGLE]];
    drive->change = p[place[END_ANGLE]] - drive->start_angle;
    drive->start_time = p[place[START_TIME]];
    drive->duration = p[place[DURATION]];
    drive->end_weight = p[place[END_WEIGHT]];
    drive->paired = fourth && drive->end_weight == 0.5 && !drive->endpoint;
    return 1;
}

/* At the pose of the inputs; the angle is the one nearest the start angle. */
static int drive_initial(void *self, const double *u, double *x, Reason *why) {
    const Drive *drive = self;
    (void)why;
    Instant now = drive_instant(drive, u, 0.0, drive->start_angle);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    drive_store_pose(&now, x);
    x[MEMORY] = x[MEMORY + 1] = now.deflection_rate;
    store_mid_step_start(now.deflection_rate, x + SLIDE);
    return 1;
}

/* Angles, rates and torque at the communication point, and energies. At order 4 the torque comes from what the last
   steps' loads were. */
static void drive_observe(void *self, const double *x, const double *u, double *z) {
    const Drive *drive = self;
    Instant now = drive_instant(drive, u, x[CLOCK], x[ANGLE]);
    z[0] = now.angle;
    z[1] = now.rate;
    z[2] = now.commanded;
    z[3] = now.commanded_rate;
    z[4] = drive_torque(drive, now.deflection, drive->endpoint ? now.deflection_rate : mid_step_now(x + SLIDE));
    if (drive->paired) z[4] = load_now(x + LOAD, z[4], x[ROUGHNESS]);
    z[5] = x[WORK];
    z[6] = 0.5 * drive->stiffness * now.deflection * now.deflection;
    z[7] = x[HEAT];
    z[8] = x[NUMERICAL];
}

static size_t drive_continuous(const void *self, size_t *places) {
    (void)self;
    for (size_t i = 0; places && i < CONTINUOUS; i++) places[i] = CLOCK + i;
    return CONTINUOUS;
}

/* Follows the angle. */
static void drive_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const Drive *drive = self;
    (void)at_event;
    memcpy(x_next, x, STATES * sizeof(double));
    x_next[ANGLE] = drive_instant(drive, u, x[CLOCK], x[ANGLE]).angle;
}

const Kernel drive_kernel = {
    .kind = "drive",
    .create = drive_create,
    .prepare = drive_prepare,
    .initial = drive_initial,
    .step = drive_step_real,
    .outputs = drive_outputs_real,
    .observe = drive_observe,
    .step_complex = drive_step_complex,
    .outputs_complex = drive_outputs_complex,
    .continuous = drive_continuous,
    .rates = drive_rates_real,
    .rates_complex = drive_rates_complex,
    .update = drive_update,
};

#endif
