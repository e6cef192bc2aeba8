/* Hold-down point: a preloaded joint of two ports in three directions, until it is released: the twin of
   components/hold_down.py. */

#include "hold_down_layout.h"
#include "connection.h"
#include "workless.h"

enum { AXES = 3 };

typedef struct HoldDown {
    Connection base;
    double direction[AXES], free[AXES];
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
        energy += 0.5 * hold_down->base.p[P_TRANSLATIONAL_STIFFNESS + i] * stretch * stretch;
    }
    return energy;
}

/* Force of an instant on the outboard port, inboard axes. */
static inline Vector3 force_of(const HoldDown *hold_down, const real *displacement, const real *rate) {
    real force[AXES];
    for (int i = 0; i < AXES; i++)
        force[i] = -hold_down->base.p[P_TRANSLATIONAL_STIFFNESS + i] * (displacement[i] - hold_down->free[i]) - hold_down->base.p[P_TRANSLATIONAL_DAMPING + i] * rate[i];
    return vector_of(force);
}

/* Where the memory of a displacement, and the last means of the load along it, begin in the state. */
static inline int memory_place(int axis) { return X_MEMORIES + MEMORY_SIZE * axis; }
static inline int load_place(int axis) { return X_LOADS + MID_STEP_SIZE * axis; }

/* Whether the release time is reached. */
static inline int is_due(const HoldDown *hold_down, double clock) {
    return 0.0 < hold_down->base.p[P_RELEASE_TIME] && hold_down->base.p[P_RELEASE_TIME] <= clock + REACHED;
}

static inline void store_rates(const real *rate, real *x) {
    for (int i = 0; i < AXES; i++) store_rate(rate[i], x + memory_place(i));
}

/* Load along an axis over a held step; keeps what is remembered. */
static inline MeanLoad held_load(const HoldDown *hold_down, StepMotion motion, int i, int paired, real rate,
                                 real *x_next) {
    const double *p = hold_down->base.p;
    double stiffness = p[P_TRANSLATIONAL_STIFFNESS + i], damping = p[P_TRANSLATIONAL_DAMPING + i];
    StepMotion moved = shifted_motion(motion, hold_down->free[i]);
    if (paired) {
        store_path(&motion, x_next + memory_place(i));
        return workless_spring(stiffness, damping, &moved);
    }
    store_memory(&motion, rate, x_next + memory_place(i));
    return bushing_load(stiffness, damping, &moved);
}

/* Wrenches over a held step, with what is remembered; adds to the losses. */
static inline void hold_step(const HoldDown *hold_down, const double *x, const real *u, const real *before,
                             const Instant *now, double h, real *x_next) {
    const int impulse = commanded(u, U_IMPULSE), paired = hold_down->base.paired && !impulse;
    const double *q = x + X_FRAME, *gap = x + X_GAP;
    Passage passage = {{q[0], q[1], q[2], q[3]}, now->frame, {gap[0], gap[1], gap[2]}, now->gap};
    Vector3 zero = {0.0, 0.0, 0.0}, velocity = zero, spin;
    if (paired) relative_moments(&passage, u + INPUTS, &velocity, &spin);
    const real moments[AXES] = {velocity.x, velocity.y, velocity.z};
    real force[AXES], slope[AXES];
    for (int i = 0; i < AXES; i++) {
        StepMotion motion = step_motion(x + memory_place(i), before[i], now->displacement[i], h);
        if (hold_down->base.endpoint) leave_inertia_out(&motion);
        motion.moment = moments[i];
        MeanLoad load = held_load(hold_down, motion, i, paired, now->rate[i], x_next);
        force[i] = load.force;
        slope[i] = load.slope;
        if (paired) store_mid_step_after(x + load_place(i), load.force, h, x_next + load_place(i));
        x_next[X_HEAT] += load.heat;
        x_next[X_NUMERICAL] += load.numerical;
    }
    store_mean_pair(&passage, vector_of(force), zero, x_next + X_WRENCH);
    if (paired) store_slope_pair(&passage, vector_of(slope), zero, x_next + X_WRENCH, x_next + X_SLOPES);
    if (impulse) store_rates(now->rate, x_next);
}

/* One step: held or free throughout. */
int NAME(hold_down_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const HoldDown *hold_down = self;
    (void)why;
    real start[AXES], before[AXES];
    for (int i = 0; i < STATES; i++) x_next[i] = x[i];
    for (int i = 0; i < AXES; i++) start[i] = x[X_START + i];
    const double *q = x + X_FRAME, *gap = x + X_GAP;
    displacement_of((Quaternion){q[0], q[1], q[2], q[3]}, (Vector3){gap[0], gap[1], gap[2]}, start, before);
    Instant now = hold_down_instant(u, start);
    quaternion_store(now.frame, x_next + X_FRAME);
    vector_store(now.gap, x_next + X_GAP);
    if (!commanded(u, U_HOLD)) x_next[X_CLOCK] += h;
    for (int i = 0; i < MOMENTS; i++) x_next[X_WRENCH + i] = x_next[X_SLOPES + i] = 0.0;
    for (int i = 0; i < AXES * MID_STEP_SIZE; i++) x_next[X_LOADS + i] = 0.0;
    if (x[X_RELEASED] == 0.0 && commanded(u, U_RELEASE_COMMAND)) {
        x_next[X_RELEASED] = 1.0;
        x_next[X_RELEASE_HEAT] = elastic_energy(hold_down, before);
    }
    if (value_of(x_next[X_RELEASED]) != 0.0) {
        store_rates(now.rate, x_next);
        return 1;
    }
    hold_step(hold_down, x, u, before, &now, h, x_next);
    if (is_due(hold_down, value_of(x_next[X_CLOCK]))) {
        x_next[X_RELEASED] = 1.0;
        x_next[X_RELEASE_HEAT] = elastic_energy(hold_down, now.displacement);
    }
    return 1;
}

/* Whether a release by time is to come. */
static inline int awaits_release(const HoldDown *hold_down, const real *x) {
    return value_of(x[X_RELEASED]) == 0.0 && hold_down->base.p[P_RELEASE_TIME] > 0.0;
}

/* Wrenches on both ports, time to the release, slopes of mean wrenches; an instant where a time set in mid-run is over. */
void NAME(hold_down_outputs)(void *self, const real *x, const real *u, real *y) {
    const HoldDown *hold_down = self;
    y[Y_TIME_TO_BREAK] = NEVER;
    if (awaits_release(hold_down, x)) {
        const real left = hold_down->base.p[P_RELEASE_TIME] - x[X_CLOCK];
        y[Y_TIME_TO_BREAK] = value_of(left) < INSTANT ? INSTANT : left;
    }
    if (gives_means(&hold_down->base, x, y)) return;
    for (int i = 0; i < WRENCHES; i++) y[i] = 0.0;
    if (value_of(x[X_RELEASED]) != 0.0) return;
    Instant now = hold_down_instant(u, x + X_START);
    Vector3 zero = {0.0, 0.0, 0.0}, force = force_of(hold_down, now.displacement, now.rate);
    store_pair(quaternion_rotate(now.frame, force), zero, now.gap, y);
}

/* Rate of the clock, and heat of damping. */
int NAME(hold_down_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const HoldDown *hold_down = self;
    (void)raw, (void)why;
    rates[0] = commanded(u, U_HOLD) ? 0.0 : 1.0;
    rates[1] = 0.0;
    if (value_of(x[X_RELEASED]) != 0.0) return 1;
    Instant now = hold_down_instant(u, x + X_START);
    for (int i = 0; i < AXES; i++) rates[1] += hold_down->base.p[P_TRANSLATIONAL_DAMPING + i] * now.rate[i] * now.rate[i];
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(hold_down)

static void *hold_down_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    HoldDown *hold_down = create_connection(data, sizes, memory, sizeof *hold_down, states, why);
    return hold_down && read_direction(data, "direction", hold_down->direction, why) ? hold_down : NULL;
}

static int hold_down_prepare(void *self, const double *p, Reason *why) {
    HoldDown *hold_down = self;
    const double preload = p[P_PRELOAD];
    for (int i = 0; i < AXES; i++) {
        const double stiffness = p[P_TRANSLATIONAL_STIFFNESS + i], share = hold_down->direction[i];
        if (!(stiffness > 0.0) && preload * share != 0.0)
            return refuse(why,
                          "translational_stiffness[%d] is 0 N/m; a preload of %g N has a share along that axis "
                          "and needs stiffness there",
                          i + 1, preload);
        hold_down->free[i] = stiffness > 0.0 ? -preload * share / stiffness : 0.0;
    }
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* Held, in the pose of the inputs by its initial displacement away from where displacements count. */
static int hold_down_initial(void *self, const double *u, double *x, Reason *why) {
    const HoldDown *hold_down = self;
    (void)why;
    Instant now = hold_down_instant(u, hold_down->base.p + P_INITIAL_DISPLACEMENT);
    memset(x, 0, STATES * sizeof *x);
    quaternion_store(now.frame, x + X_FRAME);
    vector_store(now.gap, x + X_GAP);
    for (int i = 0; i < AXES; i++) x[X_START + i] = now.displacement[i];
    store_rates(now.rate, x);
    return 1;
}

/* Force at the communication point, and energies; at order 4 from what the last steps' loads were. */
static void hold_down_observe(void *self, const double *x, const double *u, double *z) {
    const HoldDown *hold_down = self;
    const int released = x[X_RELEASED] != 0.0;
    Instant now = hold_down_instant(u, x + X_START);
    for (int i = 0; i < AXES && !hold_down->base.endpoint; i++)
        now.rate[i] = x[memory_place(i) + (hold_down->base.paired ? END_RATE : MEAN_RATE)];
    double force[AXES];
    vector_store(force_of(hold_down, now.displacement, now.rate), force);
    for (int i = 0; i < AXES; i++) {
        if (hold_down->base.paired) force[i] = load_now(x + load_place(i), force[i], x[memory_place(i) + ROUGHNESS]);
        z[Z_FORCE + i] = released ? 0.0 : force[i];
    }
    z[Z_RELEASED] = released;
    z[Z_POTENTIAL_ENERGY] = released ? 0.0 : elastic_energy(hold_down, now.displacement);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT] + x[X_RELEASE_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

/* Time left to the release; one where none is coming. */
static size_t hold_down_indicators(void *self, const double *x, const double *u, double *indicators) {
    const HoldDown *hold_down = self;
    (void)u;
    if (indicators) indicators[0] = awaits_release(hold_down, x) ? hold_down->base.p[P_RELEASE_TIME] - x[X_CLOCK] : 1.0;
    return 1;
}

/* The state after the release that is commanded or due. */
static void release_if(const HoldDown *hold_down, const double *x, const double *u, int due, double *x_next) {
    memcpy(x_next, x, STATES * sizeof *x);
    if (x[X_RELEASED] != 0.0 || !(due || commanded(u, U_RELEASE_COMMAND))) return;
    Instant now = hold_down_instant(u, x + X_START);
    x_next[X_RELEASED] = 1.0;
    x_next[X_RELEASE_HEAT] = elastic_energy(hold_down, now.displacement);
}

/* At an event, the release that is commanded or due. */
static void hold_down_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const HoldDown *hold_down = self;
    if (at_event)
        release_if(hold_down, x, u, is_due(hold_down, x[X_CLOCK]), x_next);
    else
        memcpy(x_next, x, STATES * sizeof *x);
}

/* Time until the release; mean wrenches are released between steps by themselves. */
static double hold_down_next_event(void *self, const double *x, const double *u) {
    const HoldDown *hold_down = self;
    if (!hold_down->base.endpoint || !awaits_release(hold_down, x) || commanded(u, U_HOLD)) return INFINITY;
    return fmax(hold_down->base.p[P_RELEASE_TIME] - x[X_CLOCK], 0.0);
}

static void hold_down_event(void *self, const double *x, const double *u, int due, double *x_next) {
    const HoldDown *hold_down = self;
    if (hold_down->base.endpoint)
        release_if(hold_down, x, u, due || is_due(hold_down, x[X_CLOCK]), x_next);
    else
        memcpy(x_next, x, STATES * sizeof *x);
}

const Kernel hold_down_kernel = {
    CONNECTION_FUNCTIONS(hold_down, hold_down),
    .next_event = hold_down_next_event,
    .event = hold_down_event,
    .indicators = hold_down_indicators,
    .update = hold_down_update,
};

#endif
