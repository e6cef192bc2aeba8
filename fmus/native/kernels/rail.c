/* Rail: a trolley guided in a plane at its orientation, with Coulomb friction against its sliding: the twin of
   components/rail.py.

   Stiff coordinates: normal displacement, twist about the normal, swing y, z. */

#include "rail_layout.h"
#include "connection.h"
#include "laws.h"
#include "presliding.h"
#include "workless.h"

/* Of the largest deflection: motion over a step that has no direction, and from where on a deflection is it. */
#define STILL 1e-11
#define AT_LIMIT (1.0 - 1e-9)

enum { STIFF_COUNT = 4, PLACE_SIZE = 7 };

/* Stiffness and damping of friction that sticks are zero where nothing does. */
typedef struct Rail {
    Connection base;
    int sticks;
    double axis_frame[4], stiffness[STIFF_COUNT], damping[STIFF_COUNT], contact_stiffness, contact_damping;
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
        if (i < PLACE_SIZE) motions[i] = start[i];
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

/* Smooth friction at a sliding speed. */
static inline real sliding_friction(const Rail *rail, real speed) {
    return rail->base.p[P_FRICTION_FORCE] * stiction_factors(real_abs(speed), rail->base.p[P_STICTION_VELOCITY], 1.0).constant;
}

/* The same over the sliding speed, finite at rest. */
static inline real sliding_resistance(const Rail *rail, real speed) {
    if (value_of(speed) == 0.0) return 1.5 * rail->base.p[P_FRICTION_FORCE] / rail->base.p[P_STICTION_VELOCITY];
    return sliding_friction(rail, speed) / speed;
}

static inline void trolley_store(const Trolley *trolley, real *x) {
    vector_store(trolley->pose.offset, x + X_OFFSET);
    for (int i = 1; i < STIFF_COUNT; i++) x[X_TURN + i - 1] = trolley->stiff[i];
}

/* Rates to go on from: those of this instant. */
static inline void store_instant_rates(const Trolley *now, real *x) {
    for (int i = 0; i < STIFF_COUNT; i++) store_rate(now->rates[i], x + X_MEMORIES + MEMORY_SIZE * i);
    store_mid_step_start(speed_of(now->velocity), x + X_SLIDE);
}

/* Wrench on the trolley from the loads of the stiff coordinates and from friction in the plane's axes. */
static inline void rail_store_wrench(const Trolley *now, const real *load, Transverse friction, Transverse swing,
                                     real *wrench) {
    Vector3 force = {load[0], friction.y, friction.z};
    Vector3 torque = conjugate_torque(load[1], (Transverse){load[2], load[3]}, swing);
    vector_store(quaternion_rotate(now->pose.frame, force), wrench);
    vector_store(quaternion_rotate(now->pose.frame, torque), wrench + 3);
}

/* First moments of the sliding velocity, and of the rates of the stiff coordinates. */
static inline Transverse trolley_moments(const Trolley *now, const real *trolley, Transverse swing,
                                         real moments[STIFF_COUNT]) {
    const Pose *pose = &now->pose;
    const Passage still = {pose->frame, pose->frame, pose->gap, pose->gap};
    real both[2 * MOMENTS] = {0.0};
    for (int i = 0; i < MOMENTS; i++) both[MOMENTS + i] = trolley[i];
    Rates found = rate_moments(&still, both, swing);
    moments[0] = found.offset.x;
    moments[1] = found.twist;
    moments[2] = found.swing.y;
    moments[3] = found.swing.z;
    return (Transverse){found.offset.y, found.offset.z};
}

/* Load of a stiff coordinate over a step; keeps what is remembered. */
static inline MeanLoad guiding_load(const Rail *rail, const StepMotion *motion, int i, int paired, real rate,
                                    real *memory) {
    if (paired) {
        store_path(motion, memory);
        return workless_spring(rail->stiffness[i], rail->damping[i], motion);
    }
    store_memory(motion, rate, memory);
    return bushing_load(rail->stiffness[i], rail->damping[i], motion);
}

/* Friction over a step: mean and slope in the plane's axes, heat, deflection at the end. */
typedef struct Sliding {
    Transverse force, slope;
    real heat;
    Transverse deflection;
} Sliding;

/* Smooth friction, at both points of Gauss' rule. */
static inline Sliding smooth_sliding(const Rail *rail, Transverse slid, Transverse bent, double h) {
    real rates_y[2], rates_z[2], forces_y[2], forces_z[2];
    gauss_rates(slid.y, bent.y, h, rates_y);
    gauss_rates(slid.z, bent.z, h, rates_z);
    for (int i = 0; i < 2; i++) {
        real resistance = sliding_resistance(rail, speed_of((Transverse){rates_y[i], rates_z[i]}));
        forces_y[i] = -resistance * rates_y[i];
        forces_z[i] = -resistance * rates_z[i];
    }
    MeanLoad y = viscous_load(rates_y, forces_y, h), z = viscous_load(rates_z, forces_z, h);
    return (Sliding){{y.force, z.force}, {y.slope, z.slope}, y.heat + z.heat, {0.0, 0.0}};
}

/* A vector, at most the limit in length. */
static inline Transverse within_circle(Transverse vector, double limit) {
    const real length = speed_of(vector);
    if (!(value_of(length) > limit)) return vector;
    return (Transverse){vector.y * (limit / length), vector.z * (limit / length)};
}

/* Components along an axis of the plane and across it. */
static inline Transverse turned(Transverse vector, Transverse axis) {
    return (Transverse){axis.y * vector.y + axis.z * vector.z, axis.y * vector.z - axis.z * vector.y};
}

/* Direction of most motion: between it and the one across, the mean of v v^T over a step has no part. */
static inline Transverse main_axis(Transverse slid, Transverse bent) {
    const real difference = slid.y * slid.y - slid.z * slid.z + 3.0 * (bent.y * bent.y - bent.z * bent.z);
    const real angle = 0.5 * real_atan2(2.0 * (slid.y * slid.z + 3.0 * bent.y * bent.z), difference);
    return (Transverse){real_cos(angle), real_sin(angle)};
}

/* Integrals over x from 0 to 1 of e^-ax times (1 - x)^n / n!, n from 0 to 3, after e^-a. */
static inline void exponentials(real a, real integrals[5]) {
    static const double terms[4] = {1.0, 1.0, 0.5, 1.0 / 6.0};
    if (value_of(a) < 1.0) {
        real last = 1.0;
        for (int j = 20; j > 4; j--) last = 1.0 - a * last / j;
        integrals[4] = last / 24.0;
        for (int n = 3; n >= 0; n--) integrals[n] = terms[n] - a * integrals[n + 1];
        return;
    }
    integrals[0] = real_exp(-a);
    for (int n = 0; n < 4; n++) integrals[n + 1] = (terms[n] - integrals[n]) / a;
}

/* Load of a spring whose deflection relaxes, z' = v - way z per step. */
static inline Presliding relaxing_load(double stiffness, real way, real start, real change, real moment) {
    real r[5];
    exponentials(way, r);
    const real begin = change - 3.0 * moment, bend = 6.0 * moment;
    const real end = start * r[0] + begin * r[1] + bend * r[2];
    const real mean = start * r[1] + begin * r[2] + bend * r[3];
    const real first = 3.0 * mean - 6.0 * (start * r[2] + begin * r[3] + bend * r[4]);
    const real lost = mean * change + first * moment - 0.5 * (end - start) * (end + start);
    return (Presliding){-stiffness * mean, stiffness * lost, end, -stiffness * first};
}

/* The load with a damper; damping over the step size. */
static inline Presliding with_damper(real damping, Presliding load, real change, real moment) {
    load.force -= damping * change;
    load.heat += damping * (change * change + 3.0 * moment * moment);
    load.slope -= 3.0 * damping * moment;
    return load;
}

/* Whether spring and damper stay within a friction of mean and slope; damping over the step size. */
static inline int contact_holds(double stiffness, double damping, double mean, double slope, double start,
                                double change, double moment) {
    const double begin = change - 3.0 * moment;
    const double z[3] = {start, start + 0.5 * begin, start + change}, v[3] = {begin, change, change + 3.0 * moment};
    for (int i = 0; i < 3; i++) {
        const double most = mean + (i - 1) * slope;
        if (!(fabs(stiffness * z[i]) <= most && fabs(stiffness * z[i] + damping * v[i]) <= most)) return 0;
    }
    return 1;
}

/* Friction along the directions of most and of least motion; 0 where the trolley sticks, as it does in any two. */
static inline int slips(const Rail *rail, Transverse start, Transverse slid, Transverse bent, double h,
                        Sliding *friction) {
    const double k = rail->contact_stiffness, d = rail->contact_damping, most = rail->base.p[P_FRICTION_FORCE];
    const double limit = rail->base.p[P_BREAKAWAY_DEFLECTION];
    const double motion =
        fabs(value_of(slid.y)) + fabs(value_of(slid.z)) + fabs(value_of(bent.y)) + fabs(value_of(bent.z));
    if (motion < STILL * limit) return 0;
    const Transverse axis = main_axis(slid, bent), back = {axis.y, -axis.z};
    start = turned(start, axis);
    slid = turned(slid, axis);
    bent = turned(bent, axis);
    real way = speed_of((Transverse){start.y + slid.y, start.z + slid.z}) / limit - 1.0;
    if (!(value_of(way) > 0.0)) way = 0.0;
    Presliding across = relaxing_load(k, way, start.z, slid.z, bent.z);
    real left[2];
    for (int i = 0; i < 2; i++) {
        const real load = across.force + (i ? sqrt(1.0 / 3.0) : -sqrt(1.0 / 3.0)) * across.slope;
        left[i] = real_sqrt(above(most * most - load * load, 0.0));
    }
    const real mean = 0.5 * (left[0] + left[1]), slope = 0.5 * sqrt(3.0) * (left[1] - left[0]);
    if (value_of(way) == 0.0 && contact_holds(k, d / h, value_of(mean), value_of(slope), value_of(start.y),
                                              value_of(slid.y), value_of(bent.y)))
        return 0;
    const real fastest = root_of_squares(slid.y * slid.y + slid.z * slid.z + 9.0 * (bent.y * bent.y + bent.z * bent.z));
    real felt = 2.0 * most / fastest;
    if (!(value_of(felt) < d / h)) felt = d / h;
    across = with_damper(felt * real_exp(-way), across, slid.z, bent.z);
    const Presliding along = step_force(k, d, mean, slope, start.y, slid.y, bent.y, h);
    *friction = (Sliding){
        turned((Transverse){along.force, across.force}, back),
        turned((Transverse){along.slope, across.slope}, back),
        along.heat + across.heat,
        turned((Transverse){along.deflection, across.deflection}, back),
    };
    return 1;
}

/* Friction that sticks, from a deflection on. */
static inline Sliding sticking_sliding(const Rail *rail, Transverse start, Transverse slid, Transverse bent, double h) {
    const double k = rail->contact_stiffness, damping = rail->contact_damping / h;
    Sliding friction;
    if (!slips(rail, start, slid, bent, h, &friction)) {
        Presliding y = with_damper(damping, relaxing_load(k, 0.0, start.y, slid.y, bent.y), slid.y, bent.y);
        Presliding z = with_damper(damping, relaxing_load(k, 0.0, start.z, slid.z, bent.z), slid.z, bent.z);
        friction = (Sliding){{y.force, z.force}, {y.slope, z.slope}, y.heat + z.heat, {y.deflection, z.deflection}};
    }
    const Transverse free = friction.deflection, held = within_circle(free, rail->base.p[P_BREAKAWAY_DEFLECTION]);
    friction.heat += 0.5 * k * (free.y * free.y + free.z * free.z - held.y * held.y - held.z * held.z);
    friction.deflection = held;
    return friction;
}

/* Deflection that a motion moves, no further than where friction breaks away. */
static inline Transverse deflected(const Rail *rail, Transverse deflection, Transverse slid) {
    if (!rail->sticks) return (Transverse){0.0, 0.0};
    return within_circle((Transverse){deflection.y + slid.y, deflection.z + slid.z},
                         rail->base.p[P_BREAKAWAY_DEFLECTION]);
}

/* Over a step; in an impulse friction that sticks does nothing, of an end point it follows the trolley. */
static inline Sliding sliding_over(const Rail *rail, Transverse start, Transverse slid, Transverse bent, double h,
                                   int impulse) {
    if (!rail->sticks) return smooth_sliding(rail, slid, bent, h);
    if (impulse) return (Sliding){{0.0, 0.0}, {0.0, 0.0}, 0.0, start};
    Sliding friction = sticking_sliding(rail, start, slid, bent, h);
    if (rail->base.endpoint) friction.deflection = deflected(rail, start, slid);
    return friction;
}

/* Deflection at an instant. */
static inline Transverse deflection_now(const Rail *rail, const real *x, const Trolley *now) {
    const Transverse slid = {now->pose.offset.y - x[X_OFFSET + 1], now->pose.offset.z - x[X_OFFSET + 2]};
    return deflected(rail, (Transverse){x[X_DEFLECTION], x[X_DEFLECTION + 1]}, slid);
}

/* Friction of one instant in the plane's axes, and its heat as power. */
static inline Transverse instant_sliding(const Rail *rail, Transverse z, Transverse v, real *heat) {
    if (!rail->sticks) {
        const real speed = speed_of(v), resistance = sliding_resistance(rail, speed);
        *heat = resistance * speed * speed;
        return (Transverse){-resistance * v.y, -resistance * v.z};
    }
    const double k = rail->contact_stiffness, d = rail->contact_damping, limit = rail->base.p[P_BREAKAWAY_DEFLECTION];
    const Transverse against =
        within_circle((Transverse){k * z.y + d * v.y, k * z.z + d * v.z}, rail->base.p[P_FRICTION_FORCE]);
    const real stored = k * (z.y * v.y + z.z * v.z);
    *heat = against.y * v.y + against.z * v.z;
    if (!(value_of(stored) > 0.0 && value_of(speed_of(z)) >= AT_LIMIT * limit)) *heat -= stored;
    return (Transverse){-against.y, -against.z};
}

/* Loads of the stiff coordinates over a step and their slopes, with what is remembered; adds to the losses. */
static inline void guide_step(const Rail *rail, const double *x, const Trolley *now, const real moments[STIFF_COUNT],
                              int paired, double h, real *load, real *slope, real *x_next) {
    x_next[X_DAMPING_HEAT] = x[X_DAMPING_HEAT];
    x_next[X_NUMERICAL] = x[X_NUMERICAL];
    for (int i = 0; i < STIFF_COUNT; i++) {
        const int memory = X_MEMORIES + MEMORY_SIZE * i;
        StepMotion motion = step_motion(x + memory, i == 0 ? x[X_OFFSET] : x[X_TURN + i - 1], now->stiff[i], h);
        if (rail->base.endpoint) leave_inertia_out(&motion);
        motion.moment = moments[i];
        MeanLoad mean = guiding_load(rail, &motion, i, paired, now->rates[i], x_next + memory);
        load[i] = mean.force;
        slope[i] = mean.slope;
        x_next[X_DAMPING_HEAT] += mean.heat;
        x_next[X_NUMERICAL] += mean.numerical;
    }
}

/* One step: mean loads of the stiff coordinates, and friction against the sliding velocity within the step. */
int NAME(rail_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Rail *rail = self;
    (void)why;
    const int impulse = commanded(u, U_IMPULSE), paired = rail->base.paired && !impulse;
    real start[PLACE_SIZE], load[STIFF_COUNT], slope[STIFF_COUNT], moments[STIFF_COUNT] = {0.0};
    for (int i = 0; i < PLACE_SIZE; i++) start[i] = x_next[X_POSITION + i] = x[X_POSITION + i];
    for (int i = 0; i < MOMENTS; i++) x_next[X_SLOPES + i] = 0.0;
    Trolley now = trolley_of(rail, start, u, x[X_TURN]);
    const Transverse swing = {0.5 * (x[X_TURN + 1] + now.stiff[2]), 0.5 * (x[X_TURN + 2] + now.stiff[3])};
    const Transverse slid = {now.pose.offset.y - x[X_OFFSET + 1], now.pose.offset.z - x[X_OFFSET + 2]};
    Transverse bent = {0.0, 0.0};
    if (paired) bent = trolley_moments(&now, u + INPUTS, swing, moments);
    guide_step(rail, x, &now, moments, paired, h, load, slope, x_next);
    const Transverse deflection = {x[X_DEFLECTION], x[X_DEFLECTION + 1]};
    Sliding friction = sliding_over(rail, deflection, slid, bent, h, impulse);
    x_next[X_DEFLECTION] = friction.deflection.y;
    x_next[X_DEFLECTION + 1] = friction.deflection.z;
    x_next[X_FRICTION_HEAT] = x[X_FRICTION_HEAT] + friction.heat;
    trolley_store(&now, x_next);
    rail_store_wrench(&now, load, friction.force, swing, x_next + X_WRENCH);
    store_mid_step_start(0.0, x_next + X_PRESSED);
    if (paired) {
        rail_store_wrench(&now, slope, friction.slope, swing, x_next + X_SLOPES);
        const Transverse ending = {(slid.y + 3.0 * bent.y) / h, (slid.z + 3.0 * bent.z) / h};
        store_mid_step_start(speed_of(ending), x_next + X_SLIDE);
        store_mid_step_after(x + X_PRESSED, load[0], h, x_next + X_PRESSED);
    } else {
        store_mid_step_after(x + X_SLIDE, speed_of(slid) / h, h, x_next + X_SLIDE);
    }
    if (impulse) store_instant_rates(&now, x_next);
    return 1;
}

/* Wrench on the trolley, of order 4 with its slopes. */
void NAME(rail_outputs)(void *self, const real *x, const real *u, real *y) {
    const Rail *rail = self;
    if (gives_means(&rail->base, x, y)) return;
    Trolley now = trolley_of(rail, x + X_POSITION, u, x[X_TURN]);
    real load[STIFF_COUNT];
    for (int i = 0; i < STIFF_COUNT; i++)
        load[i] = -rail->stiffness[i] * now.stiff[i] - rail->damping[i] * now.rates[i];
    real heat;
    const Transverse friction = instant_sliding(rail, deflection_now(rail, x, &now), now.velocity, &heat);
    rail_store_wrench(&now, load, friction, now.pose.swing, y);
}

/* Heat of friction and of damping. */
int NAME(rail_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Rail *rail = self;
    (void)raw, (void)why;
    Trolley now = trolley_of(rail, x + X_POSITION, u, x[X_TURN]);
    instant_sliding(rail, deflection_now(rail, x, &now), now.velocity, &rates[0]);
    rates[1] = 0.0;
    for (int i = 0; i < STIFF_COUNT; i++) rates[1] += rail->damping[i] * now.rates[i] * now.rates[i];
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(rail)

static void *rail_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Rail *rail = create_connection(data, sizes, memory, sizeof *rail, states, why);
    return rail && read_axis_frame(data, rail->axis_frame, why) ? rail : NULL;
}

static int rail_prepare(void *self, const double *p, Reason *why) {
    Rail *rail = self;
    for (int i = 0; i < STIFF_COUNT; i++) {
        rail->stiffness[i] = p[i == 0 ? P_NORMAL_STIFFNESS : P_ROTATIONAL_STIFFNESS];
        rail->damping[i] = p[i == 0 ? P_NORMAL_DAMPING : P_ROTATIONAL_DAMPING];
    }
    rail->sticks = p[P_FRICTION_FORCE] > 0.0 && p[P_BREAKAWAY_DEFLECTION] > 0.0;
    rail->contact_stiffness = rail->sticks ? p[P_FRICTION_FORCE] / p[P_BREAKAWAY_DEFLECTION] : 0.0;
    rail->contact_damping = rail->sticks ? p[P_FRICTION_FORCE] / p[P_STICTION_VELOCITY] : 0.0;
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* The plane goes through the place of the inputs, less the initial offset and turn. */
static int rail_initial(void *self, const double *u, double *x, Reason *why) {
    const Rail *rail = self;
    (void)why;
    const double *p = rail->base.p;
    memset(x, 0, STATES * sizeof *x);
    for (int i = 0; i < 3; i++) x[X_POSITION + i] = u[i] - p[P_INITIAL_OFFSET + i];
    Quaternion turn = quaternion_exponential(vector_of(p + P_INITIAL_TURN));
    quaternion_store(quaternion_multiply(quaternion_conjugate(turn), quaternion_of(u + 3)), x + X_ORIENTATION);
    Trolley now = trolley_of(rail, x + X_POSITION, u, 0.0);
    trolley_store(&now, x);
    store_instant_rates(&now, x);
    return 1;
}

/* Forces at the communication point, and energies; at order 4 from what the last steps' loads were. */
static void rail_observe(void *self, const double *x, const double *u, double *z) {
    const Rail *rail = self;
    Trolley now = trolley_of(rail, x + X_POSITION, u, x[X_TURN]);
    double speed = speed_of(now.velocity), energy = 0.0;
    for (int i = 0; i < STIFF_COUNT; i++) energy += 0.5 * rail->stiffness[i] * now.stiff[i] * now.stiff[i];
    const Transverse deflection = deflection_now(rail, x, &now);
    energy += 0.5 * rail->contact_stiffness * (deflection.y * deflection.y + deflection.z * deflection.z);
    double rate = now.rates[0], felt = speed, heat;
    if (!rail->base.endpoint) {
        rate = x[X_MEMORIES + (rail->base.paired ? END_RATE : MEAN_RATE)];
        felt = mid_step_now(x + X_SLIDE);
    }
    const double normal = -rail->stiffness[0] * now.stiff[0] - rail->damping[0] * rate;
    z[Z_NORMAL_FORCE] = normal;
    if (rail->base.paired) z[Z_NORMAL_FORCE] = load_now(x + X_PRESSED, normal, x[X_MEMORIES + ROUGHNESS]);
    Transverse velocity = {0.0, 0.0};
    if (speed > 0.0) velocity = (Transverse){now.velocity.y / speed * felt, now.velocity.z / speed * felt};
    const double friction = speed_of(instant_sliding(rail, deflection, velocity, &heat));
    z[Z_FRICTION_FORCE_MAGNITUDE] = rail->sticks ? friction : sliding_friction(rail, felt);
    z[Z_SLIDING_SPEED] = speed;
    z[Z_FRICTION_ENERGY] = x[X_FRICTION_HEAT];
    z[Z_POTENTIAL_ENERGY] = energy;
    z[Z_DISSIPATED_ENERGY] = x[X_FRICTION_HEAT] + x[X_DAMPING_HEAT];
    z[Z_NUMERICAL_DISSIPATION] = x[X_NUMERICAL];
}

/* Follows the trolley, with its turn and the deflection of friction. */
static void rail_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    (void)at_event;
    Trolley now = trolley_of(self, x + X_POSITION, u, x[X_TURN]);
    const Transverse deflection = deflection_now(self, x, &now);
    memcpy(x_next, x, STATES * sizeof *x);
    vector_store(now.pose.offset, x_next + X_OFFSET);
    x_next[X_TURN] = now.stiff[1];
    x_next[X_DEFLECTION] = deflection.y;
    x_next[X_DEFLECTION + 1] = deflection.z;
}

const Kernel rail_kernel = {CONNECTION_FUNCTIONS(rail, rail), .update = rail_update};

#endif
