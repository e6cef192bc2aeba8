/* Rail: a trolley guided in a plane at its orientation, with Coulomb friction against its sliding: the twin of
   components/rail.py.

   Stiff coordinates: normal displacement, twist about the normal, swing y, z. */

#include "bushing.h"
#include "laws.h"
#include "relative.h"

enum { STIFF_COUNT = 4, CONTINUOUS = 2, OBSERVATIONS = 7 };

/* State: place and orientation at the start, offset and turn from there, remembered mean and end rates of the stiff
   coordinates, mean sliding speeds of two steps, heat of friction and of damping, wrench, what inertial terms took
   away. */
enum {
    START = 0,
    OFFSET = 7,
    TWIST = 10,
    MEAN_RATES = 13,
    END_RATES = 17,
    SLIDE = 21,
    HEAT = 25,
    WRENCH = 27,
    NUMERICAL = 33,
    STATES = 34
};

enum {
    NORMAL_STIFFNESS,
    NORMAL_DAMPING,
    ROTATIONAL_STIFFNESS,
    ROTATIONAL_DAMPING,
    FRICTION_FORCE,
    STICTION_VELOCITY,
    END_WEIGHT,
    PARAMETERS
};

typedef struct Rail {
    double axis_frame[4];
    int endpoint;
    size_t impulse, places[PARAMETERS];
    double stiffness[STIFF_COUNT], damping[STIFF_COUNT];
    double friction_force, stiction_velocity, end_weight;
} Rail;

/* Pose against the start in axes with x along the normal, stiff coordinates and their rates, sliding velocity. */
typedef struct Trolley {
    Pose pose;
    real stiff[STIFF_COUNT], rates[STIFF_COUNT];
    Transverse velocity;
} Trolley;

/* The instant of the inputs; the twist is the one nearest the reference. */
static inline Trolley trolley_of(const Rail *rail, const real *start, const real *u, real reference) {
    real motions[2 * MOTION_SIZE];
    for (int i = 0; i < MOTION_SIZE; i++) {
        motions[i] = 0.0;
        if (i < OFFSET) motions[i] = start[i];
        motions[MOTION_SIZE + i] = u[i];
    }
    /* the turn at the start is a constant of the run */
    double w = value_of(start[3]), x = -value_of(start[4]), y = -value_of(start[5]), z = -value_of(start[6]);
    const double *a = rail->axis_frame;
    double axes[4] = {
        w * a[0] - x * a[1] - y * a[2] - z * a[3],
        w * a[1] + x * a[0] + y * a[3] - z * a[2],
        w * a[2] - x * a[3] + y * a[0] + z * a[1],
        w * a[3] + x * a[2] - y * a[1] + z * a[0],
    };
    Pose pose = relative_pose(motions, axes);
    Rates rates = relative_rates(motions, &pose);
    return (Trolley){
        pose,
        {pose.offset.x, nearest_turn(pose.twist, reference), pose.swing.y, pose.swing.z},
        {rates.offset.x, rates.twist, rates.swing.y, rates.swing.z},
        {rates.offset.y, rates.offset.z},
    };
}

static inline real speed_of(Transverse velocity) {
    return root_of_squares(velocity.y * velocity.y + velocity.z * velocity.z);
}

/* Friction force at a sliding speed. */
static inline real sliding_friction(const Rail *rail, real speed) {
    return rail->friction_force * stiction_factors(real_abs(speed), rail->stiction_velocity, 1.0).constant;
}

/* Friction force over the sliding speed, finite at rest. */
static inline real sliding_resistance(const Rail *rail, real speed) {
    if (value_of(speed) == 0.0) return 1.5 * rail->friction_force / rail->stiction_velocity;
    return sliding_friction(rail, speed) / speed;
}

static inline void trolley_store(const Trolley *trolley, real *x) {
    vector_store(trolley->pose.offset, x + OFFSET);
    for (int i = 1; i < STIFF_COUNT; i++) x[TWIST + i - 1] = trolley->stiff[i];
}

/* Rates to go on from: those of this instant. */
static inline void store_instant_rates(const Trolley *now, real *x) {
    for (int i = 0; i < STIFF_COUNT; i++) x[MEAN_RATES + i] = x[END_RATES + i] = now->rates[i];
    store_mid_step_start(speed_of(now->velocity), x + SLIDE);
}

/* Wrench on the trolley from the loads of the stiff coordinates, friction over speed, and the sliding velocity. */
static inline void rail_store_wrench(const Trolley *now, const real *load, real resistance, Transverse velocity,
                                     Transverse swing, real *wrench) {
    Vector3 force = {load[0], -resistance * velocity.y, -resistance * velocity.z};
    Vector3 torque = conjugate_torque(load[1], (Transverse){load[2], load[3]}, swing);
    vector_store(quaternion_rotate(now->pose.frame, force), wrench);
    vector_store(quaternion_rotate(now->pose.frame, torque), wrench + 3);
}

/* One step: mean loads of the stiff coordinates, and friction against the mean sliding velocity. */
int NAME(rail_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Rail *rail = self;
    (void)why;
    real start[OFFSET], load[STIFF_COUNT], heat = 0.0, numerical = 0.0;
    for (int i = 0; i < OFFSET; i++) start[i] = x_next[START + i] = x[START + i];
    Trolley now = trolley_of(rail, start, u, x[TWIST]);
    int impulse = value_of(u[rail->impulse]) > 0.5;
    Transverse slip = {(now.pose.offset.y - x[OFFSET + 1]) / h, (now.pose.offset.z - x[OFFSET + 2]) / h};
    real speed = speed_of(slip);
    for (int i = 0; i < STIFF_COUNT; i++) {
        double before = i == 0 ? x[OFFSET] : x[TWIST + i - 1];
        real mean_rate = (now.stiff[i] - before) / h;
        StepMotion motion = {before, now.stiff[i], h, x[MEAN_RATES + i], x[END_RATES + i], 0.0, 0.0};
        /* inertial terms tame held wrenches, which an end-point wrench is not */
        if (rail->endpoint) motion.mean_rate = motion.end_rate = value_of(mean_rate);
        MeanLoad mean = bushing_load(rail->stiffness[i], rail->damping[i], &motion, rail->end_weight);
        load[i] = mean.force;
        heat += mean.heat;
        numerical += mean.numerical;
        remember_rates(&motion, now.rates[i], x_next + MEAN_RATES + i, x_next + END_RATES + i);
    }
    store_mid_step_after(x + SLIDE, speed, h, x_next + SLIDE);
    if (impulse) store_instant_rates(&now, x_next);
    trolley_store(&now, x_next);
    real resistance = sliding_resistance(rail, speed);
    x_next[HEAT] = x[HEAT] + resistance * speed * speed * h;
    x_next[HEAT + 1] = x[HEAT + 1] + heat;
    x_next[NUMERICAL] = x[NUMERICAL] + numerical;
    Transverse swing = {0.5 * (x[TWIST + 1] + now.stiff[2]), 0.5 * (x[TWIST + 2] + now.stiff[3])};
    rail_store_wrench(&now, load, resistance, slip, swing, x_next + WRENCH);
    return 1;
}

/* Wrench on the trolley. */
void NAME(rail_outputs)(void *self, const real *x, const real *u, real *y) {
    const Rail *rail = self;
    if (!rail->endpoint) {
        for (int i = 0; i < WRENCH_SIZE; i++) y[i] = x[WRENCH + i];
        return;
    }
    Trolley now = trolley_of(rail, x + START, u, x[TWIST]);
    real load[STIFF_COUNT];
    for (int i = 0; i < STIFF_COUNT; i++)
        load[i] = -rail->stiffness[i] * now.stiff[i] - rail->damping[i] * now.rates[i];
    rail_store_wrench(&now, load, sliding_resistance(rail, speed_of(now.velocity)), now.velocity, now.pose.swing, y);
}

/* Heat of friction and of damping. */
int NAME(rail_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Rail *rail = self;
    (void)raw, (void)why;
    Trolley now = trolley_of(rail, x + START, u, x[TWIST]);
    real speed = speed_of(now.velocity);
    rates[0] = sliding_resistance(rail, speed) * speed * speed;
    rates[1] = 0.0;
    for (int i = 0; i < STIFF_COUNT; i++) rates[1] += rail->damping[i] * now.rates[i] * now.rates[i];
    return 1;
}

#ifndef FANFOLD_COMPLEX

int rail_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                       double complex *rates, Reason *why);
int rail_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why);
void rail_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [NORMAL_STIFFNESS] = {"normal_stiffness", 1},
    [NORMAL_DAMPING] = {"normal_damping", 1},
    [ROTATIONAL_STIFFNESS] = {"rotational_stiffness", 1},
    [ROTATIONAL_DAMPING] = {"rotational_damping", 1},
    [FRICTION_FORCE] = {"friction_force", 1},
    [STICTION_VELOCITY] = {"stiction_velocity", 1},
    [END_WEIGHT] = {"end_weight", 1},
};

static void *rail_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Rail *rail = allocate(memory, sizeof *rail);
    if (!rail) {
        refuse(why, "there is no memory for a rail");
        return NULL;
    }
    *states = STATES;
    int usable = check_sizes("rail", sizes, MOTION_SIZE + 1, WRENCH_SIZE, OBSERVATIONS, why) &&
                 read_axis_frame(data, rail->axis_frame, why) &&
                 read_choice(data, "endpoint", 1, &rail->endpoint, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, rail->places, why) &&
                 find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &rail->impulse, why);
    return usable ? rail : NULL;
}

static int rail_prepare(void *self, const double *p, Reason *why) {
    Rail *rail = self;
    const size_t *place = rail->places;
    (void)why;
    for (int i = 0; i < STIFF_COUNT; i++) {
        rail->stiffness[i] = p[place[i == 0 ? NORMAL_STIFFNESS : ROTATIONAL_STIFFNESS]];
        rail->damping[i] = p[place[i == 0 ? NORMAL_DAMPING : ROTATIONAL_DAMPING]];
    }
    rail->friction_force = p[place[FRICTION_FORCE]];
    rail->stiction_velocity = p[place[STICTION_VELOCITY]];
    rail->end_weight = p[place[END_WEIGHT]];
    return 1;
}

/* The plane goes through the place of the inputs. */
static int rail_initial(void *self, const double *u, double *x, Reason *why) {
    const Rail *rail = self;
    (void)why;
    Trolley now = trolley_of(rail, u, u, 0.0);
    for (int i = 0; i < STATES; i++) x[i] = i < OFFSET ? u[i] : 0.0;
    trolley_store(&now, x);
    store_instant_rates(&now, x);
    return 1;
}

/* Forces at the communication point, and energies. */
static void rail_observe(void *self, const double *x, const double *u, double *z) {
    const Rail *rail = self;
    Trolley now = trolley_of(rail, x + START, u, x[TWIST]);
    double speed = speed_of(now.velocity), energy = 0.0;
    for (int i = 0; i < STIFF_COUNT; i++) energy += 0.5 * rail->stiffness[i] * now.stiff[i] * now.stiff[i];
    z[0] = -rail->stiffness[0] * now.stiff[0] - rail->damping[0] * (rail->endpoint ? now.rates[0] : x[MEAN_RATES]);
    z[1] = sliding_friction(rail, rail->endpoint ? speed : mid_step_now(x + SLIDE));
    z[2] = speed;
    z[3] = x[HEAT];
    z[4] = energy;
    z[5] = x[HEAT] + x[HEAT + 1];
    z[6] = x[NUMERICAL];
}

static size_t rail_continuous(const void *self, size_t *places) {
    (void)self;
    for (size_t i = 0; places && i < CONTINUOUS; i++) places[i] = HEAT + i;
    return CONTINUOUS;
}

/* Follows the trolley's turn. */
static void rail_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const Rail *rail = self;
    (void)at_event;
    memcpy(x_next, x, STATES * sizeof(double));
    x_next[TWIST] = trolley_of(rail, x + START, u, x[TWIST]).stiff[1];
}

const Kernel rail_kernel = {
    .kind = "rail",
    .create = rail_create,
    .prepare = rail_prepare,
    .initial = rail_initial,
    .step = rail_step_real,
    .outputs = rail_outputs_real,
    .observe = rail_observe,
    .step_complex = rail_step_complex,
    .outputs_complex = rail_outputs_complex,
    .continuous = rail_continuous,
    .rates = rail_rates_real,
    .rates_complex = rail_rates_complex,
    .update = rail_update,
};

#endif
