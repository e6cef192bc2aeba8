/* Closed-cable-loop synchroniser: two preloaded strands between two pulleys: the twin of components/ccl.py. */

#include "ccl_layout.h"
#include "connection.h"
#include "strand.h"

typedef struct Loop {
    Connection base;
    double axis_frame[4];
    int guided;
    Law strand;
} Loop;

/* Angles of both pulleys against the strands (unwrapped), the centre line in world axes, and what each angle
   works on: guided, a direction whose torque does the work of that angle; free, the angle's gradient with
   respect to the centre line. */
typedef struct Geometry {
    real angle_1, angle_2;
    Vector3 works_1, works_2, span;
} Geometry;

/* A number for each strand. */
typedef struct Strands {
    real a, b;
} Strands;

/* Direction (a + b) / (1 + a.b) of a frame's x axis a and an axis b, along which a torque works on their twist. */
static inline Vector3 shared_direction(Quaternion frame, Vector3 axis) {
    Vector3 own = quaternion_rotate(frame, (Vector3){1.0, 0.0, 0.0});
    return vector_scaled(1.0 / (1.0 + vector_dot(own, axis)), vector_add(own, axis));
}

/* Angle of the centre line about a frame's x axis, and its gradient with respect to the centre line. */
static inline real angle_of_span(Vector3 span, Quaternion frame, Vector3 *gradient) {
    Vector3 seen = quaternion_rotate_back(frame, span);
    real square = seen.y * seen.y + seen.z * seen.z;
    *gradient = quaternion_rotate(frame, (Vector3){0.0, -seen.z / square, seen.y / square});
    return real_atan2(seen.z, seen.y);
}

/* Geometry of one instant; angles are those nearest the reference. */
static inline Geometry loop_geometry(const Loop *loop, const real *u, real reference_1, real reference_2) {
    Geometry g;
    Quaternion frame_1 = frame_on_port(u, loop->axis_frame);
    Quaternion frame_2 = frame_on_port(u + MOTION_SIZE, loop->axis_frame);
    g.span = vector_subtract(vector_of(u + MOTION_SIZE), vector_of(u));
    if (loop->guided) {
        Quaternion link = frame_on_port(u + 2 * MOTION_SIZE, loop->axis_frame);
        Vector3 axis = quaternion_rotate(link, (Vector3){1.0, 0.0, 0.0});
        g.angle_1 = twist_about_x(quaternion_multiply(quaternion_conjugate(frame_1), link));
        g.angle_2 = twist_about_x(quaternion_multiply(quaternion_conjugate(frame_2), link));
        g.works_1 = shared_direction(frame_1, axis);
        g.works_2 = shared_direction(frame_2, axis);
    } else {
        g.angle_1 = angle_of_span(g.span, frame_1, &g.works_1);
        g.angle_2 = angle_of_span(g.span, frame_2, &g.works_2);
    }
    g.angle_1 = nearest_turn(g.angle_1, reference_1);
    g.angle_2 = nearest_turn(g.angle_2, reference_2);
    return g;
}

/* Strand length between the pulleys, the wrap that changes with the distance included. */
static inline real strand_length(const Loop *loop, real distance) {
    if (loop->guided) return distance;
    double difference = loop->base.p[P_RADIUS_1] - loop->base.p[P_RADIUS_2];
    return real_sqrt(distance * distance - difference * difference) + difference * real_asin(difference / distance);
}

/* Elongations from the start: length change of the loop plus and minus r1 d1 - r2 d2. */
static inline Strands elongations(const Loop *loop, const Geometry *g, const real *x) {
    const real start_1 = x[X_PRELOAD_ANGLES], start_2 = x[X_PRELOAD_ANGLES + 1], start_length = x[X_PRELOAD_LENGTH];
    real turn = loop->base.p[P_RADIUS_1] * (g->angle_1 - start_1) - loop->base.p[P_RADIUS_2] * (g->angle_2 - start_2);
    real stretch = strand_length(loop, vector_norm(g->span)) - start_length;
    return (Strands){stretch + turn, stretch - turn};
}

/* Wrenches of all ports; they sum to zero about any point. */
static inline void store_wrenches(const Loop *loop, const Geometry *g, Strands tension, real *wrench) {
    real distance = vector_norm(g->span);
    Vector3 direction = vector_scaled(1.0 / distance, g->span);
    real difference = tension.a - tension.b;
    Vector3 works_1 = vector_scaled(loop->base.p[P_RADIUS_1] * difference, g->works_1);
    Vector3 works_2 = vector_scaled(-loop->base.p[P_RADIUS_2] * difference, g->works_2);
    Vector3 force_2, torque_1, torque_2;
    if (loop->guided) {
        force_2 = vector_scaled(-(tension.a + tension.b), direction);
        torque_1 = works_1;
        torque_2 = works_2;
        Vector3 moments = vector_add(vector_add(torque_1, torque_2), vector_cross(g->span, force_2));
        vector_store((Vector3){0.0, 0.0, 0.0}, wrench + 12);
        vector_store(vector_scaled(-1.0, moments), wrench + 15);
    } else {
        double step = loop->base.p[P_RADIUS_1] - loop->base.p[P_RADIUS_2];
        real axial = (tension.a + tension.b) * real_sqrt(distance * distance - step * step) / distance;
        force_2 = vector_subtract(vector_scaled(-axial, direction), vector_add(works_1, works_2));
        torque_1 = vector_cross(g->span, works_1);
        torque_2 = vector_cross(g->span, works_2);
    }
    vector_store(vector_scaled(-1.0, force_2), wrench);
    vector_store(torque_1, wrench + 3);
    vector_store(force_2, wrench + 6);
    vector_store(torque_2, wrench + 9);
}

static inline int is_held(const Loop *loop, const real *u) { return commanded(own_inputs(&loop->base, u), U_HOLD); }

static inline void store_geometry(const Geometry *g, real *x) {
    x[X_ANGLES] = g->angle_1;
    x[X_ANGLES + 1] = g->angle_2;
    vector_store(g->works_1, x + X_WORKS_1);
    vector_store(g->works_2, x + X_WORKS_2);
    vector_store(g->span, x + X_SPAN);
}

/* Takes a geometry as the one where both strands are at their preload. */
static inline void store_start(const Loop *loop, const Geometry *g, real *x) {
    x[X_PRELOAD_ANGLES] = g->angle_1;
    x[X_PRELOAD_ANGLES + 1] = g->angle_2;
    x[X_PRELOAD_LENGTH] = strand_length(loop, vector_norm(g->span));
}

static inline void store_frames(const real *u, real *x) {
    quaternion_store(quaternion_of(u + 3), x + X_FRAMES);
    quaternion_store(quaternion_of(u + MOTION_SIZE + 3), x + X_FRAMES + 4);
}

/* Force along the centre line for a tension of one: free strands cross it. */
static inline real axial_share(const Loop *loop, real distance) {
    double step = loop->guided ? 0.0 : loop->base.p[P_RADIUS_1] - loop->base.p[P_RADIUS_2];
    return real_sqrt(distance * distance - step * step) / distance;
}

/* Elongation rates from that of the centre line, and from what moves against each pulley. */
static inline Strands rates_of_strands(const Loop *loop, const Geometry *g, Vector3 relative_1, Vector3 relative_2,
                                       real along) {
    real rate_1 = vector_dot(relative_1, g->works_1), rate_2 = vector_dot(relative_2, g->works_2);
    real stretch = along;
    if (!loop->guided) stretch = along * axial_share(loop, vector_norm(g->span));
    real turn = loop->base.p[P_RADIUS_1] * rate_1 - loop->base.p[P_RADIUS_2] * rate_2;
    return (Strands){stretch + turn, stretch - turn};
}

/* Moment of what moves against a pulley of free strands; `moments` are those of its port. */
static inline Vector3 moment_against(const Geometry *g, const Line *line, Vector3 apart, const real *moments,
                                     const double *before, const real *after) {
    Quaternion start = {before[0], before[1], before[2], before[3]};
    Vector3 turning = vector_cross(turn_between(start, quaternion_of(after)), vector_scaled(1.0 / 6.0, line->change));
    return vector_subtract(vector_subtract(apart, vector_cross(vector_of(moments + 3), g->span)), turning);
}

/* Moments of both elongations' rates; the adjoint of store_pairs. */
static inline Strands strand_moments(const Loop *loop, const double *x, const real *u, const Geometry *g,
                                     const Line *line) {
    const real *first = own_inputs(&loop->base, u) + OWN_INPUTS, *second = first + WRENCH_SIZE;
    Vector3 apart = vector_subtract(vector_of(second), vector_of(first)), relative_1, relative_2;
    if (loop->guided) {
        Vector3 guide = vector_of(second + WRENCH_SIZE + 3);
        relative_1 = vector_subtract(guide, vector_of(first + 3));
        relative_2 = vector_subtract(guide, vector_of(second + 3));
    } else {
        const double *frames = x + X_FRAMES;
        relative_1 = moment_against(g, line, apart, first, frames, u + 3);
        relative_2 = moment_against(g, line, apart, second, frames + 4, u + MOTION_SIZE + 3);
    }
    return rates_of_strands(loop, g, relative_1, relative_2, line_moment(line, apart));
}

static inline void add_to(Vector3 added, real *place) {
    vector_store(vector_add(vector_of(place), added), place);
}

/* Mean wrenches of all ports and their slopes, which give no angular momentum as the centre line moves. */
static inline void store_pairs(const Loop *loop, const Geometry *g, const Line *line, Strands tension, Strands slope,
                               real *wrench, real *slopes) {
    store_wrenches(loop, g, tension, wrench);
    store_wrenches(loop, g, slope, slopes);
    Vector3 force = line_force(line, 0.0, axial_share(loop, vector_norm(g->span)) * (slope.a + slope.b));
    add_to(vector_scaled(-1.0, force), wrench);
    add_to(force, wrench + WRENCH_SIZE);
    if (loop->guided) return;
    Vector3 change = vector_scaled((slope.a - slope.b) / 6.0, line->change);
    add_to(vector_scaled(loop->base.p[P_RADIUS_1], vector_cross(change, g->works_1)), wrench + 3);
    add_to(vector_scaled(-loop->base.p[P_RADIUS_2], vector_cross(change, g->works_2)), wrench + WRENCH_SIZE + 3);
}

/* Load of one strand at order 4. */
static inline MeanLoad load_of_strand(const Loop *loop, real before, real after, real moment, double h) {
    StepMotion motion = {before, after, h, 0.0, 0.0, 0.0, moment};
    return strand_load(&loop->strand, loop->base.p[P_STRAND_DAMPING], &motion);
}

/* Mean tension of one strand over a step; adds to the heat. */
static inline real tension_of_strand(const Loop *loop, real before, real after, double h, real *heat) {
    return mean_tension(&loop->strand, loop->base.p[P_STRAND_DAMPING], before, after, h, heat);
}

/* One step; mean tensions from the strands' elongations at both ends. */
int NAME(loop_step)(void *self, const double *x, const real *u, double h, real *x_next, Reason *why) {
    const Loop *loop = self;
    (void)why;
    Geometry new = loop_geometry(loop, u, x[X_ANGLES], x[X_ANGLES + 1]);
    const size_t wrenches = wrenches_size(&loop->base);
    real start[X_HEAT], *slopes = x_next + X_WRENCH + wrenches;
    for (int i = 0; i < X_HEAT; i++) start[i] = x_next[i] = x[i];
    for (size_t i = 0; i < wrenches; i++) slopes[i] = 0.0;
    x_next[X_HEAT] = x[X_HEAT];
    store_geometry(&new, x_next);
    store_frames(u, x_next);
    if (is_held(loop, u)) {
        real preload = -law_value(&loop->strand, 0.0);
        store_start(loop, &new, x_next);
        store_wrenches(loop, &new, (Strands){preload, preload}, x_next + X_WRENCH);
        return 1;
    }
    Geometry old = {
        start[X_ANGLES], start[X_ANGLES + 1], vector_of(start + X_WORKS_1), vector_of(start + X_WORKS_2),
        vector_of(start + X_SPAN),
    };
    Strands before = elongations(loop, &old, start), after = elongations(loop, &new, start);
    Geometry middle = {
        new.angle_1,
        new.angle_2,
        vector_mean(old.works_1, new.works_1),
        vector_mean(old.works_2, new.works_2),
        vector_mean(old.span, new.span),
    };
    if (loop->base.paired) {
        Line line = line_between(old.span, new.span, 1.0 / vector_norm(middle.span));
        Strands moment = strand_moments(loop, x, u, &middle, &line);
        MeanLoad a = load_of_strand(loop, before.a, after.a, moment.a, h);
        MeanLoad b = load_of_strand(loop, before.b, after.b, moment.b, h);
        x_next[X_HEAT] = x[X_HEAT] + (a.heat + b.heat);
        store_pairs(loop, &middle, &line, (Strands){-a.force, -b.force}, (Strands){-a.slope, -b.slope},
                    x_next + X_WRENCH, slopes);
        return 1;
    }
    real heat = 0.0;
    Strands tension;
    tension.a = tension_of_strand(loop, before.a, after.a, h, &heat);
    tension.b = tension_of_strand(loop, before.b, after.b, h, &heat);
    x_next[X_HEAT] = x[X_HEAT] + heat;
    store_wrenches(loop, &middle, tension, x_next + X_WRENCH);
    return 1;
}

/* Elongation rates of both strands from the ports' velocities. */
static inline Strands elongation_rates(const Loop *loop, const real *u, const Geometry *g) {
    Vector3 velocity = vector_subtract(vector_of(u + MOTION_SIZE + 7), vector_of(u + 7)), relative_1, relative_2;
    Vector3 spin_1 = vector_of(u + 10), spin_2 = vector_of(u + MOTION_SIZE + 10);
    if (loop->guided) {
        Vector3 spin = vector_of(u + 2 * MOTION_SIZE + 10);
        relative_1 = vector_subtract(spin, spin_1);
        relative_2 = vector_subtract(spin, spin_2);
    } else {
        relative_1 = vector_subtract(velocity, vector_cross(spin_1, g->span));
        relative_2 = vector_subtract(velocity, vector_cross(spin_2, g->span));
    }
    real along = vector_dot(velocity, vector_scaled(1.0 / vector_norm(g->span), g->span));
    return rates_of_strands(loop, g, relative_1, relative_2, along);
}

/* Geometry of an instant, and elongations, their rates and tensions of the strands. */
typedef struct Instant {
    Geometry geometry;
    Strands elongation, rate, tension;
} Instant;

/* Of this instant; strands that are being adjusted are at their preload. */
static inline Instant loop_now(const Loop *loop, const real *x, const real *u) {
    Instant now = {.geometry = loop_geometry(loop, u, x[X_ANGLES], x[X_ANGLES + 1])};
    if (!(loop->base.endpoint && is_held(loop, u))) {
        now.elongation = elongations(loop, &now.geometry, x);
        if (loop->base.p[P_STRAND_DAMPING] > 0.0) now.rate = elongation_rates(loop, u, &now.geometry);
    }
    now.tension.a = tension_at(&loop->strand, loop->base.p[P_STRAND_DAMPING], now.elongation.a, now.rate.a);
    now.tension.b = tension_at(&loop->strand, loop->base.p[P_STRAND_DAMPING], now.elongation.b, now.rate.b);
    return now;
}

/* Wrenches on all ports, slopes of mean wrenches. */
void NAME(loop_outputs)(void *self, const real *x, const real *u, real *y) {
    const Loop *loop = self;
    if (gives_means(&loop->base, x, y)) return;
    Instant now = loop_now(loop, x, u);
    store_wrenches(loop, &now.geometry, now.tension, y);
}

/* Heat of the strands' damping. */
int NAME(loop_rates)(void *self, const real *raw, const real *x, const real *u, real *rates, Reason *why) {
    const Loop *loop = self;
    (void)raw, (void)why;
    Instant now = loop_now(loop, x, u);
    const double damping = loop->base.p[P_STRAND_DAMPING];
    rates[0] = damping_power(&loop->strand, damping, now.elongation.a, now.rate.a) +
               damping_power(&loop->strand, damping, now.elongation.b, now.rate.b);
    return 1;
}

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(loop)

static void *loop_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    int guided;
    if (!read_choice(data, "guided", 1, &guided, why)) return NULL;
    Loop *loop = create_connection(data, sizes, memory, sizeof *loop, guided ? 3 : 2, states, why);
    if (!loop) return NULL;
    loop->guided = guided;
    return read_axis_frame(data, loop->axis_frame, why) ? loop : NULL;
}

static int loop_prepare(void *self, const double *p, Reason *why) {
    Loop *loop = self;
    const double preload = p[P_CUT] < 0.5 ? p[P_PRELOAD] : -FAR_APART * p[P_STRAND_STIFFNESS];
    loop->strand = strand_law(p[P_STRAND_STIFFNESS], preload);
    return prepare_connection(self, p, p[P_ORDER], why);
}

/* Both strands at their preload in the pose of the inputs. */
static int loop_initial(void *self, const double *u, double *x, Reason *why) {
    const Loop *loop = self;
    Geometry g = loop_geometry(loop, u, 0.0, 0.0);
    double distance = vector_norm(g.span);
    if (distance <= fabs(loop->base.p[P_RADIUS_1] - loop->base.p[P_RADIUS_2]))
        return refuse(why, "the pulleys are %g m apart, less than the difference of their radii; check the ports",
                      distance);
    memset(x, 0, states_size(&loop->base) * sizeof *x);
    store_geometry(&g, x);
    store_start(loop, &g, x);
    store_frames(u, x);
    return 1;
}

/* Tensions, forces and torques of this instant, and energies. */
static void loop_observe(void *self, const double *x, const double *u, double *z) {
    const Loop *loop = self;
    const Instant now = loop_now(loop, x, u);
    Strands elongation = now.elongation, tension = now.tension;
    double distance = vector_norm(now.geometry.span);
    double step = loop->guided ? 0.0 : loop->base.p[P_RADIUS_1] - loop->base.p[P_RADIUS_2];
    double difference = tension.a - tension.b;
    z[Z_TENSION_A] = tension.a;
    z[Z_TENSION_B] = tension.b;
    z[Z_TORQUE_1] = loop->base.p[P_RADIUS_1] * difference;
    z[Z_TORQUE_2] = -loop->base.p[P_RADIUS_2] * difference;
    z[Z_AXIAL_FORCE] = (tension.a + tension.b) * sqrt(distance * distance - step * step) / distance;
    z[Z_LATERAL_FORCE] = -difference * step / distance;
    z[Z_SYNCHRONIZATION_ERROR] = 0.5 * (elongation.a - elongation.b);
    z[Z_POTENTIAL_ENERGY] = law_potential(&loop->strand, elongation.a) + law_potential(&loop->strand, elongation.b);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
}

/* Follows the angles; while strands are adjusted, the present geometry is the one of their preload. */
static void loop_update(void *self, const double *x, const double *u, int at_event, double *x_next) {
    const Loop *loop = self;
    (void)at_event;
    Geometry now = loop_geometry(loop, u, x[X_ANGLES], x[X_ANGLES + 1]);
    memcpy(x_next, x, states_size(&loop->base) * sizeof *x);
    x_next[X_ANGLES] = now.angle_1;
    x_next[X_ANGLES + 1] = now.angle_2;
    if (is_held(loop, u)) store_start(loop, &now, x_next);
}

const Kernel ccl_kernel = {CONNECTION_FUNCTIONS(loop, loop), .update = loop_update};

#endif
