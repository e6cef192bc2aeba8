/* Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch: the twin of
   components/hinge.py.

   Six coordinates: offset x, y, z, hinge angle, swing y, z, all in hinge axes. */

#include "bushing.h"
#include "laws.h"
#include "relative.h"

enum { COORDINATE_COUNT = 6, HINGE_ANGLE = 3 };

/* State: where each part begins. SLIDE are the mean hinge rates and the sizes of the last two steps. */
enum {
    FRAME = 0,
    GAP = 4,
    COORDINATES = 7,
    RATES = 13,
    MEAN_RATES = 19,
    END_RATES = 25,
    WRENCH = 31,
    POWER = 43,
    SLIDE = 46,
    HEAT = 50, /* of friction, latch, damping */
    LATCHED = 53,
    LATCHED_ANGLE = 54,
    HOLDING = 55,
    HOLD_ANGLE = 56,
    STATES = 57
};

enum { HEAT_CAUSES = 3, PAIR_SIZE = 2 * WRENCH_SIZE, OUTPUTS = PAIR_SIZE + 2, OBSERVATIONS = 15 };

enum { NO_LATCH, SPRING_LATCH, TABLE_LATCH, KINEMATIC_LATCH };

enum {
    TRANSLATIONAL_STIFFNESS,
    TRANSLATIONAL_DAMPING,
    ROTATIONAL_STIFFNESS,
    ROTATIONAL_DAMPING,
    ALIGNED_ANGLE,
    STOWED_ANGLE,
    MOTOR_STIFFNESS,
    MOTOR_WIND_UP,
    FRICTION_COEFFICIENT,
    STATIC_FRICTION_RATIO,
    PIN_RADIUS,
    FRICTION_BENDING_ARM,
    FRICTION_PRELOAD,
    STICTION_VELOCITY,
    LATCH_ANGLE,
    LATCH_STIFFNESS,
    LATCH_DAMPING,
    LATCH_AUTOMATIC,
    LOCK_MASS,
    LOCK_INERTIA,
    LOCK_STIFFNESS,
    HOLD_STIFFNESS,
    END_WEIGHT,
    PARAMETERS
};

typedef struct Hinge {
    double axis_frame[4];
    int latch_kind, endpoint, locks;
    size_t latch_command, impulse, hold, places[PARAMETERS];
    double stiffness[COORDINATE_COUNT], damping[COORDINATE_COUNT];
    double aligned_angle, stowed_angle;
    double friction, static_ratio, pin_radius, bending_arm, friction_preload, stiction_velocity;
    double latch_angle, latch_stiffness, latch_damping, lock_mass, lock_inertia, hold_stiffness, end_weight;
    int latch_automatic;
    Law motor, harness, latch;
} Hinge;

/* Pose of one instant, its six coordinates (the hinge angle unwrapped) and their rates. */
typedef struct Motion {
    Quaternion frame;
    Vector3 gap;
    real coordinates[COORDINATE_COUNT], rates[COORDINATE_COUNT];
} Motion;

/* What holds the hinge, and the angles where it took hold. */
typedef struct Grip {
    double latched, holding;
    real latched_angle, hold_angle;
} Grip;

/* Force and torque on B in hinge axes, torque of latch and of friction, heat of friction, latch and damping. */
typedef struct Loads {
    Vector3 force, torque;
    real latch_torque, friction_torque, heat[HEAT_CAUSES];
} Loads;

/* Motion of the inputs; the angle is the one nearest the reference. */
static inline Motion hinge_motion(const Hinge *hinge, const real *u, real reference) {
    Pose pose = relative_pose(u, hinge->axis_frame);
    Rates rates = relative_rates(u, &pose);
    real angle = nearest_turn(hinge->aligned_angle + pose.twist, reference);
    return (Motion){
        pose.frame,
        pose.gap,
        {pose.offset.x, pose.offset.y, pose.offset.z, angle, pose.swing.y, pose.swing.z},
        {rates.offset.x, rates.offset.y, rates.offset.z, rates.twist, rates.swing.y, rates.swing.z},
    };
}

/* Latch or hold at the angle where the command arrives. */
static inline Grip commanded_grip(const Hinge *hinge, const double *x, const real *u) {
    Grip grip = {x[LATCHED], 0.0, x[LATCHED_ANGLE], x[HOLD_ANGLE]};
    if (value_of(u[hinge->latch_command]) > 0.5 && x[LATCHED] == 0.0) {
        grip.latched = 1.0;
        grip.latched_angle = x[COORDINATES + HINGE_ANGLE];
    }
    if (value_of(u[hinge->hold]) > 0.5) {
        grip.holding = 1.0;
        if (x[HOLDING] == 0.0) grip.hold_angle = x[COORDINATES + HINGE_ANGLE];
    }
    return grip;
}

/* Whether there is a latch and it is engaged. */
static inline int latch_acts(const Hinge *hinge, const Grip *grip) {
    return grip->latched != 0.0 && hinge->latch_kind != NO_LATCH;
}

/* Coulomb torque mu r_p F_r + T_pre against the sliding rate (Bagnoli 2007, eq 2.2). */
static inline real friction_torque(const Hinge *hinge, const Grip *grip, const real *load, real rate) {
    double preload = grip->latched > 0.5 ? 0.0 : hinge->friction_preload;
    if (hinge->friction == 0.0 && preload == 0.0) return 0.0;
    real square = load[1] * load[1] + load[2] * load[2];
    /* smoothed over one newton */
    real normal = square / real_sqrt(square + 1.0);
    if (hinge->bending_arm > 0.0)
        normal += root_of_squares(load[4] * load[4] + load[5] * load[5]) / hinge->bending_arm;
    StictionFactors sliding = stiction_factors(rate, hinge->stiction_velocity, hinge->static_ratio);
    return -(hinge->friction * hinge->pin_radius * normal * sliding.dynamic + preload * sliding.constant);
}

/* Motion of a coordinate over the step. */
static inline StepMotion step_motion(const double *x, const Motion *new, int i, double h) {
    return (StepMotion){x[COORDINATES + i], new->coordinates[i], h, x[MEAN_RATES + i], x[END_RATES + i]};
}

/* Swing in the middle of a step. */
static inline Transverse mean_swing(const double *x, const Motion *new) {
    return (Transverse){
        0.5 * (x[COORDINATES + 4] + new->coordinates[4]),
        0.5 * (x[COORDINATES + 5] + new->coordinates[5]),
    };
}

/* Mean latch torque, and the energy it turned to heat. */
static inline MeanLoad mean_latch_load(const Hinge *hinge, const Grip *grip, StepMotion motion) {
    StepMotion deflection = shifted_motion(motion, grip->latched_angle);
    real change = deflection.end - deflection.start;
    real extra = -hinge->latch_damping * change / motion.h;
    if (hinge->end_weight == 0.5) extra += inertial_force(hinge->latch_stiffness, &deflection);
    return (MeanLoad){law_mean_force(&hinge->latch, deflection.start, deflection.end) + extra, -extra * change};
}

/* Mean force of a law with its end weight. */
static inline real weighted_mean_force(const Law *law, real start, real end, double end_weight) {
    return law_mean_force(law, start, end) + law_end_force(law, start, end, end_weight);
}

/* Mean loads over a step from both its ends (discrete gradients and mean rates). */
static inline Loads mean_loads(const Hinge *hinge, const double *x, const Grip *grip, const Motion *new, double h) {
    real elastic[COORDINATE_COUNT], heat = 0.0;
    StepMotion turn = step_motion(x, new, HINGE_ANGLE, h);
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        StepMotion motion = step_motion(x, new, i, h);
        if (i == HINGE_ANGLE) motion = shifted_motion(motion, hinge->aligned_angle);
        MeanLoad load = bushing_load(hinge->stiffness[i], hinge->damping[i], &motion, hinge->end_weight);
        elastic[i] = load.force;
        heat += load.heat;
    }
    real change = turn.end - turn.start;
    real friction = friction_torque(hinge, grip, elastic, change / h);
    MeanLoad latch = {0.0, 0.0};
    if (latch_acts(hinge, grip)) latch = mean_latch_load(hinge, grip, turn);
    real twist = elastic[HINGE_ANGLE] + weighted_mean_force(&hinge->motor, turn.start, turn.end, hinge->end_weight) +
                 weighted_mean_force(&hinge->harness, turn.start, turn.end, hinge->end_weight) + friction + latch.force;
    if (grip->holding != 0.0) twist -= hinge->hold_stiffness * (turn.end - grip->hold_angle);
    return (Loads){
        {elastic[0], elastic[1], elastic[2]},
        conjugate_torque(twist, (Transverse){elastic[4], elastic[5]}, mean_swing(x, new)),
        latch.force,
        friction,
        {-friction * change, latch.heat, heat},
    };
}

/* Loads that remove the relative rate in every stiff direction at the end of a vanishing step: an ideal joint
   transmits a latch impulse through its constrained directions in no time. */
static inline Loads impulse_loads(const Hinge *hinge, const double *x, const Grip *grip, const Motion *new, double h) {
    int locked = grip->latched > 0.5 && hinge->locks;
    real load[COORDINATE_COUNT], latch = 0.0, sum = 0.0;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        int stiff = hinge->stiffness[i] > 0.0 || (i == HINGE_ANGLE && locked);
        double inertia = i < HINGE_ANGLE ? hinge->lock_mass : hinge->lock_inertia;
        load[i] = stiff ? -inertia / h * new->rates[i] : 0.0;
        real work = -load[i] * (new->coordinates[i] - x[COORDINATES + i]);
        sum += work;
        if (i == HINGE_ANGLE && locked) latch = work;
    }
    return (Loads){
        {load[0], load[1], load[2]},
        conjugate_torque(load[HINGE_ANGLE], (Transverse){load[4], load[5]}, mean_swing(x, new)),
        0.0,
        0.0,
        {0.0, latch, sum - latch},
    };
}

/* Loads of one instant from coordinates and rates; heat as power (W). */
static inline Loads endpoint_loads(const Hinge *hinge, const Grip *grip, const real *coordinates, const real *rates) {
    real load[COORDINATE_COUNT], damping = 0.0;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        real deflection = i == HINGE_ANGLE ? coordinates[i] - hinge->aligned_angle : coordinates[i];
        load[i] = -hinge->stiffness[i] * deflection - hinge->damping[i] * rates[i];
        damping += hinge->damping[i] * rates[i] * rates[i];
    }
    real angle = coordinates[HINGE_ANGLE], rate = rates[HINGE_ANGLE];
    real friction = friction_torque(hinge, grip, load, rate);
    real latch = 0.0, viscous = 0.0;
    if (latch_acts(hinge, grip)) {
        viscous = -hinge->latch_damping * rate;
        latch = law_value(&hinge->latch, angle - grip->latched_angle) + viscous;
    }
    real twist = load[HINGE_ANGLE] + law_value(&hinge->motor, angle) + law_value(&hinge->harness, angle) + friction +
                 latch;
    if (grip->holding != 0.0) twist -= hinge->hold_stiffness * (angle - grip->hold_angle);
    return (Loads){
        {load[0], load[1], load[2]},
        conjugate_torque(twist, (Transverse){load[4], load[5]}, (Transverse){coordinates[4], coordinates[5]}),
        latch,
        friction,
        {-friction * rate, -viscous * rate, damping},
    };
}

static inline void store_motion(const Motion *motion, real *x) {
    quaternion_store(motion->frame, x + FRAME);
    vector_store(motion->gap, x + GAP);
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        x[COORDINATES + i] = motion->coordinates[i];
        x[RATES + i] = motion->rates[i];
    }
}

static inline void store_grip(const Grip *grip, real *x) {
    x[LATCHED] = grip->latched;
    x[LATCHED_ANGLE] = grip->latched_angle;
    x[HOLDING] = grip->holding;
    x[HOLD_ANGLE] = grip->hold_angle;
}

/* What the coordinates remember of the step. */
static inline void store_memories(const double *x, const Motion *new, double h, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        real mean_rate = (new->coordinates[i] - x[COORDINATES + i]) / h;
        x_next[MEAN_RATES + i] = mean_rate;
        x_next[END_RATES + i] = remembered_end_rate(mean_rate, x[END_RATES + i], new->rates[i]);
    }
    store_rate_after(x + SLIDE, x_next[MEAN_RATES + HINGE_ANGLE], h, x_next + SLIDE);
}

/* After an impulse only the rates of its end are known. */
static inline void store_rates_after_impulse(const Motion *new, real *x_next) {
    for (int i = 0; i < COORDINATE_COUNT; i++) x_next[MEAN_RATES + i] = x_next[END_RATES + i] = new->rates[i];
    store_starting_rate(new->rates[HINGE_ANGLE], x_next + SLIDE);
}

/* Whether the latch engages by itself and has not yet. */
static inline int awaits_latch(const Hinge *hinge, const Grip *grip) {
    return hinge->latch_automatic && grip->latched == 0.0 && hinge->latch_kind != NO_LATCH;
}

static inline void latch_if_reached(const Hinge *hinge, Grip *grip, int reached) {
    if (!reached || !awaits_latch(hinge, grip)) return;
    grip->latched = 1.0;
    grip->latched_angle = hinge->latch_angle;
}

/* Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule. */
static inline void endpoint_step(const Hinge *hinge, const double *x, Grip *grip, const Motion *new, double h,
                                 real *x_next) {
    latch_if_reached(hinge, grip, value_of(new->coordinates[HINGE_ANGLE]) >= hinge->latch_angle);
    Loads loads = endpoint_loads(hinge, grip, new->coordinates, new->rates);
    for (int i = MEAN_RATES; i < HEAT; i++) x_next[i] = x[i];
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[HEAT + i] = x[HEAT + i] + 0.5 * h * (x[POWER + i] + loads.heat[i]);
        x_next[POWER + i] = loads.heat[i];
    }
}

/* Wrench and heat of mean loads. */
static inline void mean_step(const Hinge *hinge, const double *x, Grip *grip, const Motion *new, int impulse, double h,
                             real *x_next) {
    Quaternion frame = {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]};
    Vector3 gap = {x[GAP], x[GAP + 1], x[GAP + 2]};
    Loads loads;
    if (impulse) {
        loads = impulse_loads(hinge, x, grip, new, h);
        if (hinge->locks) grip->latched_angle = new->coordinates[HINGE_ANGLE];
        store_rates_after_impulse(new, x_next);
    } else {
        loads = mean_loads(hinge, x, grip, new, h);
        store_memories(x, new, h, x_next);
    }
    store_pair(mean_direction(frame, new->frame, loads.force), mean_direction(frame, new->frame, loads.torque),
               vector_mean(gap, new->gap), x_next + WRENCH);
    for (int i = 0; i < HEAT_CAUSES; i++) {
        x_next[HEAT + i] = x[HEAT + i] + loads.heat[i];
        x_next[POWER + i] = x[POWER + i];
    }
}

/* One step; the inputs are those of its end. Commands act from its start. */
int NAME(hinge_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Hinge *hinge = self;
    (void)why;
    Grip grip = commanded_grip(hinge, x, u);
    Motion new = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    store_motion(&new, x_next);
    if (hinge->endpoint)
        endpoint_step(hinge, x, &grip, &new, h, x_next);
    else
        mean_step(hinge, x, &grip, &new, value_of(u[hinge->impulse]) > 0.5, h, x_next);
    store_grip(&grip, x_next);
    return 1;
}

/* The grip of a state under the present hold command. */
static inline Grip present_grip(const Hinge *hinge, const real *x, const real *u) {
    double holding = value_of(u[hinge->hold]) > 0.5 ? 1.0 : 0.0;
    return (Grip){value_of(x[LATCHED]), holding, x[LATCHED_ANGLE], x[HOLD_ANGLE]};
}

/* Wrenches on both ports, distance to the latch angle, latched or not. */
void NAME(hinge_outputs)(void *self, const real *x, const real *u, real *y) {
    const Hinge *hinge = self;
    real angle = x[COORDINATES + HINGE_ANGLE];
    if (hinge->endpoint) {
        Motion now = hinge_motion(hinge, u, angle);
        Grip grip = present_grip(hinge, x, u);
        Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
        store_pair(quaternion_rotate(now.frame, loads.force), quaternion_rotate(now.frame, loads.torque), now.gap, y);
        angle = now.coordinates[HINGE_ANGLE];
    } else {
        for (int i = 0; i < PAIR_SIZE; i++) y[i] = x[WRENCH + i];
    }
    y[PAIR_SIZE] = hinge->latch_angle - angle;
    y[PAIR_SIZE + 1] = x[LATCHED];
}

#include "hinge_exchange.h"

#ifndef FANFOLD_COMPLEX

int hinge_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                       Reason *why);
void hinge_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [TRANSLATIONAL_STIFFNESS] = {"translational_stiffness", 3},
    [TRANSLATIONAL_DAMPING] = {"translational_damping", 3},
    [ROTATIONAL_STIFFNESS] = {"rotational_stiffness", 3},
    [ROTATIONAL_DAMPING] = {"rotational_damping", 3},
    [ALIGNED_ANGLE] = {"aligned_angle", 1},
    [STOWED_ANGLE] = {"stowed_angle", 1},
    [MOTOR_STIFFNESS] = {"motor_stiffness", 1},
    [MOTOR_WIND_UP] = {"motor_wind_up", 1},
    [FRICTION_COEFFICIENT] = {"friction_coefficient", 1},
    [STATIC_FRICTION_RATIO] = {"static_friction_ratio", 1},
    [PIN_RADIUS] = {"pin_radius", 1},
    [FRICTION_BENDING_ARM] = {"friction_bending_arm", 1},
    [FRICTION_PRELOAD] = {"friction_preload", 1},
    [STICTION_VELOCITY] = {"stiction_velocity", 1},
    [LATCH_ANGLE] = {"latch_angle", 1},
    [LATCH_STIFFNESS] = {"latch_stiffness", 1},
    [LATCH_DAMPING] = {"latch_damping", 1},
    [LATCH_AUTOMATIC] = {"latch_automatic", 1},
    [LOCK_MASS] = {"lock_mass", 1},
    [LOCK_INERTIA] = {"lock_inertia", 1},
    [LOCK_STIFFNESS] = {"lock_stiffness", 1},
    [HOLD_STIFFNESS] = {"hold_stiffness", 1},
    [END_WEIGHT] = {"end_weight", 1},
};

/* The laws that come from the structure. */
static int read_laws(Hinge *hinge, const Data *data, Memory *memory, Reason *why) {
    int has_harness = 0;
    if (!read_choice(data, "has_harness", 1, &has_harness, why)) return 0;
    hinge->harness = spring_law(0.0, 0.0);
    if (has_harness && !read_table(data, memory, "harness", &hinge->harness, why)) return 0;
    if (hinge->latch_kind != TABLE_LATCH) return 1;
    return read_table(data, memory, "latch", &hinge->latch, why);
}

static int find_commands(Hinge *hinge, const Data *data, const Sizes *sizes, Reason *why) {
    return find_place(data, "input", (VariableName){"latch_command", 1}, sizes->inputs, &hinge->latch_command, why) &&
           find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &hinge->impulse, why) &&
           find_place(data, "input", (VariableName){"hold", 1}, sizes->inputs, &hinge->hold, why);
}

static void *hinge_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Hinge *hinge = allocate(memory, sizeof *hinge);
    if (!hinge) {
        refuse(why, "there is no memory for a hinge");
        return NULL;
    }
    *states = STATES;
    int usable = check_sizes("hinge", sizes, 2 * MOTION_SIZE + 3, OUTPUTS, OBSERVATIONS, why) &&
                 read_axis_frame(data, hinge->axis_frame, why) &&
                 read_choice(data, "latch_kind", KINEMATIC_LATCH, &hinge->latch_kind, why) &&
                 read_choice(data, "endpoint", 1, &hinge->endpoint, why) && read_laws(hinge, data, memory, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, hinge->places, why) &&
                 find_commands(hinge, data, sizes, why);
    hinge->locks = hinge->latch_kind == KINEMATIC_LATCH && !hinge->endpoint;
    return usable ? hinge : NULL;
}

/* A kinematic latch is as good as rigid, except where an explicit host cannot solve for a lock. */
static void prepare_latch(Hinge *hinge, const double *p) {
    const size_t *place = hinge->places;
    hinge->latch_angle = p[place[LATCH_ANGLE]];
    hinge->latch_automatic = p[place[LATCH_AUTOMATIC]] > 0.5;
    hinge->latch_stiffness = p[place[hinge->locks ? LOCK_STIFFNESS : LATCH_STIFFNESS]];
    hinge->latch_damping = hinge->locks ? 0.0 : p[place[LATCH_DAMPING]];
    if (hinge->latch_kind != TABLE_LATCH) hinge->latch = spring_law(hinge->latch_stiffness, 0.0);
}

static int hinge_prepare(void *self, const double *p, Reason *why) {
    Hinge *hinge = self;
    const size_t *place = hinge->places;
    (void)why;
    for (size_t i = 0; i < 3; i++) {
        hinge->stiffness[i] = p[place[TRANSLATIONAL_STIFFNESS] + i];
        hinge->damping[i] = p[place[TRANSLATIONAL_DAMPING] + i];
        hinge->stiffness[3 + i] = p[place[ROTATIONAL_STIFFNESS] + i];
        hinge->damping[3 + i] = p[place[ROTATIONAL_DAMPING] + i];
    }
    hinge->aligned_angle = p[place[ALIGNED_ANGLE]];
    hinge->stowed_angle = p[place[STOWED_ANGLE]];
    hinge->motor = spring_law(p[place[MOTOR_STIFFNESS]], p[place[MOTOR_WIND_UP]]);
    hinge->friction = p[place[FRICTION_COEFFICIENT]];
    hinge->static_ratio = p[place[STATIC_FRICTION_RATIO]];
    hinge->pin_radius = p[place[PIN_RADIUS]];
    hinge->bending_arm = p[place[FRICTION_BENDING_ARM]];
    hinge->friction_preload = p[place[FRICTION_PRELOAD]];
    hinge->stiction_velocity = p[place[STICTION_VELOCITY]];
    hinge->lock_mass = p[place[LOCK_MASS]];
    hinge->lock_inertia = p[place[LOCK_INERTIA]];
    hinge->hold_stiffness = p[place[HOLD_STIFFNESS]];
    hinge->end_weight = p[place[END_WEIGHT]];
    prepare_latch(hinge, p);
    return 1;
}

/* Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle. */
static int hinge_initial(void *self, const double *u, double *x, Reason *why) {
    const Hinge *hinge = self;
    (void)why;
    Motion motion = hinge_motion(hinge, u, hinge->stowed_angle);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    store_motion(&motion, x);
    store_rates_after_impulse(&motion, x);
    x[HOLD_ANGLE] = motion.coordinates[HINGE_ANGLE];
    return 1;
}

/* Energy in bushing, motor, harness, latch and hold. */
static double stored_energy(const Hinge *hinge, const Grip *grip, const double *coordinates) {
    double angle = coordinates[HINGE_ANGLE], energy = 0.0;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        double deflection = i == HINGE_ANGLE ? coordinates[i] - hinge->aligned_angle : coordinates[i];
        energy += 0.5 * hinge->stiffness[i] * deflection * deflection;
    }
    energy += law_potential(&hinge->motor, angle) + law_potential(&hinge->harness, angle);
    if (latch_acts(hinge, grip))
        energy += law_potential(&hinge->latch, angle - grip->latched_angle) - law_potential(&hinge->latch, 0.0);
    if (grip->holding != 0.0) {
        double held = angle - grip->hold_angle;
        energy += 0.5 * hinge->hold_stiffness * held * held;
    }
    return energy;
}

/* Angles, torques and forces at the communication point (end-point law), and energies. */
static void hinge_observe(void *self, const double *x, const double *u, double *z) {
    const Hinge *hinge = self;
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    Grip grip = present_grip(hinge, x, u);
    double angle = now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (!hinge->endpoint) {
        memcpy(now.rates, x + MEAN_RATES, sizeof now.rates);
        now.rates[HINGE_ANGLE] = rate_now(x + SLIDE);
    }
    Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
    z[0] = angle;
    z[1] = rate;
    z[2] = law_value(&hinge->motor, angle);
    z[3] = law_value(&hinge->harness, angle);
    z[4] = loads.friction_torque;
    z[5] = loads.latch_torque;
    z[6] = loads.force.x;
    z[7] = sqrt(loads.force.y * loads.force.y + loads.force.z * loads.force.z);
    z[8] = sqrt(loads.torque.y * loads.torque.y + loads.torque.z * loads.torque.z);
    z[9] = law_potential(&hinge->motor, hinge->stowed_angle) - law_potential(&hinge->motor, angle);
    for (int i = 0; i < HEAT_CAUSES; i++) z[10 + i] = x[HEAT + i];
    z[13] = stored_energy(hinge, &grip, now.coordinates);
    z[14] = x[HEAT] + x[HEAT + 1] + x[HEAT + 2];
}

/* Time until the latch angle is reached at the present rate; in end-point mode only does a latch engage by itself. */
static double hinge_next_event(void *self, const double *x, const double *u) {
    const Hinge *hinge = self;
    Grip grip = commanded_grip(hinge, x, u);
    if (!hinge->endpoint || !awaits_latch(hinge, &grip)) return INFINITY;
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    double ahead = hinge->latch_angle - now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (ahead <= 0.0) return 0.0;
    return rate > 0.0 ? ahead / rate : INFINITY;
}

/* Commands act, and a latch that is due engages at its angle; from here on it gives off its own heat. */
static void hinge_event(void *self, const double *x, const double *u, int due, double *x_next) {
    const Hinge *hinge = self;
    memcpy(x_next, x, STATES * sizeof(double));
    if (!hinge->endpoint) return;
    Grip grip = commanded_grip(hinge, x, u);
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    latch_if_reached(hinge, &grip, due || now.coordinates[HINGE_ANGLE] >= hinge->latch_angle);
    store_grip(&grip, x_next);
    Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
    for (int i = 0; i < HEAT_CAUSES; i++) x_next[POWER + i] = loads.heat[i];
}

const Kernel hinge_kernel = {
    "hinge",       hinge_create,       hinge_prepare,         hinge_initial,    hinge_step_real, hinge_outputs_real,
    hinge_observe, hinge_step_complex, hinge_outputs_complex, hinge_next_event, hinge_event,
    .continuous = hinge_continuous,
    .rates = hinge_rates_real,
    .rates_complex = hinge_rates_complex,
    .indicators = hinge_indicators,
    .update = hinge_update,
};

#endif
