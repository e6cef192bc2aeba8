/* Hold-down point: a preloaded joint of two ports in three directions, until it is released: the twin of
   components/hold_down.py. */

#include "relative.h"
#include "workless.h"

enum { AXES = 3, CONTINUOUS = 2, OBSERVATIONS = 7, PAIR_SIZE = 2 * WRENCH_SIZE };

/* State: orientation of the inboard port, gap, offset at the start, remembered mean and end rates, clock, released or
   not, heat of damping and of the release, wrenches of both ports, what the scheme took away, roughness, slopes. */
enum {
    FRAME = 0,
    GAP = 4,
    START = 7,
    MEAN_RATES = 10,
    END_RATES = 13,
    CLOCK = 16,
    RELEASED = 17,
    HEAT = 18,
    RELEASE_HEAT = 19,
    WRENCH = 20,
    NUMERICAL = 32,
    ROUGHNESS = 33,
    SLOPES = 36,
    LOADS = 48, /* of order 4, over the last steps along each axis */
    STATES = 60
};

enum { STIFFNESS, DAMPING, PRELOAD, RELEASE_TIME, END_WEIGHT, ORDER, PARAMETERS };

/* Distance (s) from the release time that sums of step sizes, or a solver's search, may leave. */
#define REACHED 1e-9

typedef struct HoldDown {
    double direction[AXES];
    int endpoint, paired; /* paired: forces are of order 4; those of static solutions are not */
    size_t release_command, impulse, hold, moments, places[PARAMETERS];
    double stiffness[AXES], damping[AXES], free[AXES], release_time, end_weight;
} HoldDown;

/* Orientation of the inboard port, gap in world axes, displacement and its rate in inboard axes. */
typedef struct Instant {
    Quaternion frame;
    Vector3 gap;
    real displacement[AXES], rate[AXES];
} Instant;

static inline void displacement_of(Quaternion frame, Vector3 gap, const real *start, real *displacement) {
    vector_store(quaternion_rotate_back(frame, gap), displacement);
    for (int i = 0; i < AXES; i++) displacement[i] -= start[i];
}

/* The instant of the inputs; displacements count from the offset at the start. */
static inline Instant hold_down_instant(const real *u, const real *start) {
    Instant now;
    now.frame = quaternion_of(u + 3);
    now.gap = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    displacement_of(now.frame, now.gap, start, now.displacement);
    Vector3 apart = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7));
    apart = vector_subtract(apart, vector_cross(vector_of(u + 10), now.gap));
    vector_store(quaternion_rotate_back(now.frame, apart), now.rate);
    return now;
}

/* Elastic energy. */
static inline real elastic_energy(const HoldDown *hold_down, const real *displacement) {
    real energy = 0.0;
    for (int i = 0; i < AXES; i++) {
        real stretch = displacement[i] - hold_down->free[i];
        energy += 0.5 * hold_down->stiffness[i] * stretch * stretch;
    }
    return energy;
}

/* Force of an instant on the outboard port, inboard axes. */
static inline Vector3 force_of(const HoldDown *hold_down, const real *displacement, const real *rate) {
    real force[AXES];
    for (int i = 0; i < AXES; i++)
        force[i] = -hold_down->stiffness[i] * (displacement[i] - hold_down->free[i]) - hold_down->damping[i] * rate[i];
    return vector_of(force);
}

/* Where the last means of the load along an axis begin in the state. */
static inline int load_place(int axis) { return LOADS + MID_STEP_SIZE * axis; }

/* Whether the release time is reached. */
static inline int is_due(const HoldDown *hold_down, double clock) {
    return 0.0 < hold_down->release_time && hold_down->release_time <= clock + REACHED;
}

static inline int is_held_clock(const HoldDown *hold_down, const real *u) { return value_of(u[hold_down->hold]) > 0.5; }

static inline void store_rates(const real *rate, real *x) {
    for (int i = 0; i < AXES; i++) {
        x[MEAN_RATES + i] = x[END_RATES + i] = rate[i];
        x[ROUGHNESS + i] = 0.0;
    }
}

/* Load along an axis over a held step; stores what is remembered. */
static inline MeanLoad held_load(const HoldDown *hold_down, StepMotion motion, int i, int fourth, real rate,
                                 real *x_next) {
    double stiffness = hold_down->stiffness[i], damping = hold_down->damping[i];
    real *mean_rate = x_next + MEAN_RATES + i, *end_rate = x_next + END_RATES + i;
    StepMotion moved = shifted_motion(motion, hold_down->free[i]);
    if (fourth) {
        remember_path(&motion, mean_rate, end_rate, x_next + ROUGHNESS + i);
        return workless_spring(stiffness, damping, &moved);
    }
    remember_rates(&motion, rate, mean_rate, end_rate);
    x_next[ROUGHNESS + i] = 0.0;
    return bushing_load(stiffness, damping, &moved, hold_down->end_weight);
}

/* Wrenches over a held step, with what is remembered; adds to the losses. */
static inline void hold_step(const HoldDown *hold_down, const double *x, const real *u, const real *before,
                             const Instant *now, double h, real *x_next) {
    int impulse = value_of(u[hold_down->impulse]) > 0.5, fourth = hold_down->paired && !impulse;
    Passage passage = {
        {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]}, now->frame, {x[GAP], x[GAP + 1], x[GAP + 2]}, now->gap,
    };
    Vector3 zero = {0.0, 0.0, 0.0}, velocity = zero, spin;
    if (fourth) relative_moments(&passage, u + hold_down->moments, &velocity, &spin);
    const real moments[AXES] = {velocity.x, velocity.y, velocity.z};
    real force[AXES], slope[AXES];
    for (int i = 0; i < AXES; i++) {
        double mean_rate = value_of(now->displacement[i] - before[i]) / h;
        StepMotion motion = {
            before[i], now->displacement[i], h, x[MEAN_RATES + i], x[END_RATES + i], x[ROUGHNESS + i], moments[i],
        };
        /* inertial terms tame held forces, which an end-point force is not */
        if (hold_down->endpoint) motion.mean_rate = motion.end_rate = mean_rate;
        MeanLoad load = held_load(hold_down, motion, i, fourth, now->rate[i], x_next);
        force[i] = load.force;
        slope[i] = load.slope;
        if (fourth) store_mid_step_after(x + load_place(i), load.force, h, x_next + load_place(i));
        x_next[HEAT] += load.heat;
        x_next[NUMERICAL] += load.numerical;
    }
    store_mean_pair(&passage, vector_of(force), zero, x_next + WRENCH);
    if (fourth) store_slope_pair(&passage, vector_of(slope), zero, x_next + WRENCH, x_next + SLOPES);
    if (impulse) store_rates(now->rate, x_next);
}

/* One step: held or free throughout. */
int NAME(hold_down_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const HoldDown *hold_down = self;
    (void)why;
    real start[AXES], before[AXES];
    for (int i = 0; i < AXES; i++) x_next[START + i] = start[i] = x[START + i];
    Quaternion frame = {x[FRAME], x[FRAME + 1], x[FRAME + 2], x[FRAME + 3]};
    Vector3 gap = {x[GAP], x[GAP + 1], x[GAP + 2]};
    displacement_of(frame, gap, start, before);
    Instant now = hold_down_instant(u, start);
    double clock = is_held_clock(hold_down, u) ? x[CLOCK] : x[CLOCK] + h;
    quaternion_store(now.frame, x_next + FRAME);
    vector_store(now.gap, x_next + GAP);
    x_next[CLOCK] = clock;
    for (int i = RELEASED; i <= RELEASE_HEAT; i++) x_next[i] = x[i];
    x_next[NUMERICAL] = x[NUMERICAL];
    for (int i = 0; i < PAIR_SIZE; i++) x_next[WRENCH + i] = x_next[SLOPES + i] = 0.0;
    for (int i = LOADS; i < STATES; i++) x_next[i] = 0.0;
    if (x[RELEASED] == 0.0 && value_of(u[hold_down->release_command]) > 0.5) {
        x_next[RELEASED] = 1.0;
        x_next[RELEASE_HEAT] = elastic_energy(hold_down, before);
    }
    if (value_of(x_next[RELEASED]) != 0.0) {
        store_rates(now.rate, x_next);
        return 1;
    }
    hold_step(hold_down, x, u, before, &now, h, x_next);
    if (is_due(hold_down, clock)) {
        x_next[RELEASED] = 1.0;
        x_next[RELEASE_HEAT] = elastic_energy(hold_down, now.displacement);
    }
    return 1;
}

/* Wrenches on both ports, slopes of mean wrenches. */
void NAME(hold_down_outputs)(void *self, const real *x, const real *u, real *y) {
    const HoldDown *hold_down = self;
    for (int i = 0; i < PAIR_SIZE; i++) {
        y[i] = hold_down->endpoint ? 0.0 : x[WRENCH + i];
        if (!hold_down->endpoint) y[PAIR_SIZE + i] = x[SLOPES + i];
    }
    if (!hold_down->endpoint || value_of(x[RELEASED]) != 0.0) return;
    Instant now = hold_down_instant(u, x + START);
    Vector3 zero = {0.0, 0.0, 0.0}, force = force_of(hold_down, now.displacement, now.rate);
    store_pair(quaternion_rotate(now.frame, force), zero, now.gap, y);
}

/* Rate of the clock, and heat of damping. */
int NAME(hold_down_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const HoldDown *hold_down = self;
    (void)raw, (void)why;
    rates[0] = is_held_clock(hold_down, u) ? 0.0 : 1.0;
    rates[1] = 0.0;
    if (value_of(x[RELEASED]) != 0.0) return 1;
    Instant now = hold_down_instant(u, x + START);
    for (int i = 0; i < AXES; i++) rates[1] += hold_down->damping[i] * now.rate[i] * now.rate[i];
    return 1;
}

#ifndef FANFOLD_COMPLEX

int hold_down_rates_complex(void *self, const double complex *raw, const double complex *x, const double complex *u,
                            double complex *rates, Reason *why);
int hold_down_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                           Reason *why);
void hold_down_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [STIFFNESS] = {"translational_stiffness", AXES},
    [DAMPING] = {"translational_damping", AXES},
    [PRELOAD] = {"preload", 1},
    [RELEASE_TIME] = {"release_time", 1},
    [END_WEIGHT] = {"end_weight", 1},
    [ORDER] = {"order", 1},
};

/* Direction of the preload, of unit length. */
static int read_direction(const Data *data, double *direction, Reason *why) {
    const double *value = data_array(data, "direction", AXES, why);
    if (!value) return 0;
    double square = 0.0;
    for (int i = 0; i < AXES; i++) {
        direction[i] = value[i];
        square += value[i] * value[i];
    }
    if (!(fabs(square - 1.0) < 1e-9)) return refuse(why, "direction is not of unit length");
    return 1;
}

static void *hold_down_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    HoldDown *hold_down = allocate(memory, sizeof *hold_down);
    if (!hold_down) {
        refuse(why, "there is no memory for a hold-down point");
        return NULL;
    }
    *states = STATES;
    if (!read_choice(data, "endpoint", 1, &hold_down->endpoint, why)) return NULL;
    size_t pairs = hold_down->endpoint ? 0 : PAIR_SIZE;
    int usable =
        check_sizes("hold-down point", sizes, 2 * MOTION_SIZE + 3 + pairs, PAIR_SIZE + pairs, OBSERVATIONS, why) &&
        read_direction(data, hold_down->direction, why) &&
        find_moments(data, "inboard.velocity_moment", hold_down->endpoint ? 0 : 2, sizes, &hold_down->moments, why) &&
        find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, hold_down->places, why) &&
        find_place(data, "input", (VariableName){"release_command", 1}, sizes->inputs, &hold_down->release_command,
                   why) &&
        find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &hold_down->impulse, why) &&
        find_place(data, "input", (VariableName){"hold", 1}, sizes->inputs, &hold_down->hold, why);
    return usable ? hold_down : NULL;
}

static int hold_down_prepare(void *self, const double *p, Reason *why) {
    HoldDown *hold_down = self;
    const size_t *place = hold_down->places;
    double preload = p[place[PRELOAD]];
    int fourth = 0;
    if (!read_order(p[place[ORDER]], &fourth, why)) return 0;
    for (size_t i = 0; i < AXES; i++) {
        double stiffness = p[place[STIFFNESS] + i], share = hold_down->direction[i];
        if (!(stiffness > 0.0) && preload * share != 0.0)
            return refuse(why,
                          "translational_stiffness[%d] is 0 N/m; a preload of %g N has a share along that axis "
                          "and needs stiffness there",
                          (int)i + 1, preload);
        hold_down->stiffness[i] = stiffness;
        hold_down->damping[i] = p[place[DAMPING] + i];
        hold_down->free[i] = stiffness > 0.0 ? -preload * share / stiffness : 0.0;
    }
    hold_down->release_time = p[place[RELEASE_TIME]];
    hold_down->end_weight = p[place[END_WEIGHT]];
    hold_down->paired = fourth && hold_down->end_weight == 0.5 && !hold_down->endpoint;
    return 1;
}

/* Held, without displacement in the pose of the inputs. */
static int hold_down_initial(void *self, const double *u, double *x, Reason *why) {
    const double nowhere[AXES] = {0.0, 0.0, 0.0};
    (void)self, (void)why;
    Instant now = hold_down_instant(u, nowhere);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    quaternion_store(now.frame, x + FRAME);
    vector_store(now.gap, x + GAP);
    for (int i = 0; i < AXES; i++) x[START + i] = now.displacement[i];
    store_rates(now.rate, x);
    return 1;
}

/* Force at the communication point, and energies; at order 4 from what the last steps' loads were. */
static void hold_down_observe(void *self, const double *x, const double *u, double *z) {
    const HoldDown *hold_down = self;
    int released = x[RELEASED] != 0.0;
    Instant now = hold_down_instant(u, x + START);
    const double *remembered = x + (hold_down->paired ? END_RATES : MEAN_RATES);
    Vector3 force = force_of(hold_down, now.displacement, hold_down->endpoint ? now.rate : remembered);
    if (released) force = (Vector3){0.0, 0.0, 0.0};
    vector_store(force, z);
    for (int i = 0; hold_down->paired && !released && i < AXES; i++)
        z[i] = load_now(x + load_place(i), z[i], x[ROUGHNESS + i]);
    z[3] = released;
    z[4] = released ? 0.0 : elastic_energy(hold_down, now.displacement);
    z[5] = x[HEAT] + x[RELEASE_HEAT];
    z[6] = x[NUMERICAL];
}

static size_t hold_down_continuous(const void *self, size_t *places) {
    (void)self;
    if (places) {
        places[0] = CLOCK;
        places[1] = HEAT;
    }
    return CONTINUOUS;
}

/* Whether a release by time is to come. */
static int awaits_release(const HoldDown *hold_down, const double *x) {
    return x[RELEASED] == 0.0 && hold_down->release_time > 0.0;
}

/* Time left to the release; one where none is coming. */
static size_t hold_down_indicators(void *self, const double *x, const double *u, double *indicators) {
    const HoldDown *hold_down = self;
    (void)u;
    if (indicators) indicators[0] = awaits_release(hold_down, x) ? hold_down->release_time - x[CLOCK] : 1.0;
    return 1;
}

/* The state after the release that is commanded or due. */
static void release_if(const HoldDown *hold_down, const double *x, const double *u, int due, double *x_next) {
    memcpy(x_next, x, STATES * sizeof(double));
    if (x[RELEASED] != 0.0 || !(due || u[hold_down->release_command] > 0.5)) return;
    Instant now = hold_down_instant(u, x + START);
    x_next[RELEASED] = 1.0;
    x_next[RELEASE_HEAT] = elastic_energy(hold_down, now.displacement);
}

/* At an event, the release that is commanded or due. */
static void hold_down_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const HoldDown *hold_down = self;
    if (at_event)
        release_if(hold_down, x, u, is_due(hold_down, x[CLOCK]), x_next);
    else
        memcpy(x_next, x, STATES * sizeof(double));
}

/* Time until the release; mean wrenches are released between steps by themselves. */
static double hold_down_next_event(void *self, const double *x, const double *u) {
    const HoldDown *hold_down = self;
    if (!hold_down->endpoint || !awaits_release(hold_down, x) || is_held_clock(hold_down, u)) return INFINITY;
    return fmax(hold_down->release_time - x[CLOCK], 0.0);
}

static void hold_down_event(void *self, const double *x, const double *u, int due, double *x_next) {
    const HoldDown *hold_down = self;
    if (hold_down->endpoint)
        release_if(hold_down, x, u, due || is_due(hold_down, x[CLOCK]), x_next);
    else
        memcpy(x_next, x, STATES * sizeof(double));
}

const Kernel hold_down_kernel = {
    .kind = "hold_down",
    .create = hold_down_create,
    .prepare = hold_down_prepare,
    .initial = hold_down_initial,
    .step = hold_down_step_real,
    .outputs = hold_down_outputs_real,
    .observe = hold_down_observe,
    .step_complex = hold_down_step_complex,
    .outputs_complex = hold_down_outputs_complex,
    .next_event = hold_down_next_event,
    .event = hold_down_event,
    .continuous = hold_down_continuous,
    .rates = hold_down_rates_real,
    .rates_complex = hold_down_rates_complex,
    .indicators = hold_down_indicators,
    .update = hold_down_update,
};

#endif
