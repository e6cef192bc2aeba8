/* One step of a beam, by the rule of the Python component, and its derivatives along inputs: part of beam.c. */

#ifndef FANFOLD_BEAM_STEP_H
#define FANFOLD_BEAM_STEP_H

#include "beam_chain.h"
#include "beam_elements.h"

#define MOST_ITERATIONS 25
#define TOLERANCE 1e-14
#define ROUNDING 1e-8
#define FAR 1e-2
#define CHEAPER 14
#define STANDSTILL 0.5
#define LARGEST_TURN 2.0

/* A step of size h. damping: of the stiffness, over h. */
typedef struct {
    const double *x, *u;
    double h, damping;
} Step;

/* out = r v, and its transpose. */
static inline void turned3(const double r[9], const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
}

static inline void turned_back3(const double r[9], const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = r[i] * v[0] + r[3 + i] * v[1] + r[6 + i] * v[2];
}

/* Rotation vector of Cayley by a rotation vector of the end, world axes: both small changes. */
static inline void cayley_change(const double turn[3], const double change[3], double out[3]) {
    double cross[3];
    cross3(turn, change, cross);
    const double along = 0.25 * dot3(turn, change);
    for (int i = 0; i < 3; i++) out[i] = change[i] - 0.5 * cross[i] + along * turn[i];
}

/* The quaternion turned by a rotation vector of Cayley, world axes. */
static inline void cayley_turned(const double *q, const double turn[3], double *out) {
    const Quaternion half = {1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2]};
    quaternion_store(quaternion_normalized(quaternion_multiply(half, quaternion_of(q))), out);
}

/* Directors, spans and strains where a step starts; 0 where an element is beyond its range. */
static int start_step(Beam *beam, const Step *step, Reason *why) {
    const double *position = step->x + place_of_position(beam), *q = step->x + place_of_orientation(beam);
    const double *rate = step->x + place_of_rate(beam);
    for (size_t n = 0; n < beam->nodes; n++) {
        double spin[3];
        rotation_matrix(quaternion_of(q + 4 * n), beam->start.directors + 9 * n);
        for (int i = 0; i < 3; i++) spin[i] = beam->inertia[3 * n + i] * rate[3 * n + i];
        turned3(beam->start.directors + 9 * n, spin, beam->spins + 3 * n);
    }
    for (size_t i = 0; i < 3 * (beam->nodes - 1); i++) beam->start.spans[i] = position[i + 3] - position[i];
    for (size_t m = 0; m + 1 < beam->nodes; m++)
        if (!strain(beam, &beam->start, m))
            return refuse(why, "element %lu of %lu turns by more than 60 deg between its ends; take more elements,"
                          " smaller steps or smaller loads", (unsigned long)m + 1, (unsigned long)beam->nodes - 1);
    return 1;
}

/* Uniform motion on from the start. */
static void predict(Beam *beam, const Step *step) {
    const double *velocity = step->x + place_of_velocity(beam), *rate = step->x + place_of_rate(beam);
    const double h = step->h;
    for (size_t n = 0; n < beam->nodes; n++) {
        turned3(beam->start.directors + 9 * n, rate + 3 * n, beam->turn + 3 * n);
        for (size_t i = 3 * n; i < 3 * n + 3; i++) {
            beam->travel[i] = h * velocity[i];
            beam->turn[i] *= h;
        }
    }
}

/* Poses and strains after the present travel and turn; 0 where they are beyond what a step may do. */
FANFOLD_VECTORISED static int place(Beam *beam, const Step *step, Reason *why) {
    const double *q = step->x + place_of_orientation(beam);
    for (size_t n = 0; n < beam->nodes; n++) {
        const double *turn = beam->turn + 3 * n;
        if (!(dot3(turn, turn) <= LARGEST_TURN * LARGEST_TURN))
            return refuse(why, "a section turns by more than 90 deg in one step; take smaller steps");
        cayley_turned(q + 4 * n, turn, beam->quaternions + 4 * n);
        rotation_matrix(quaternion_of(beam->quaternions + 4 * n), beam->end.directors + 9 * n);
    }
    for (size_t i = 0; i < 3 * (beam->nodes - 1); i++)
        beam->end.spans[i] = beam->start.spans[i] + beam->travel[i + 3] - beam->travel[i];
    for (size_t m = 0; m + 1 < beam->nodes; m++)
        if (!strain(beam, &beam->end, m))
            return refuse(why, "element %lu of %lu turns by more than 60 deg between its ends; take more elements,"
                          " smaller steps or smaller loads", (unsigned long)m + 1, (unsigned long)beam->nodes - 1);
    return 1;
}

/* Means of the directors of a node and of its neighbour, and of the span between them. */
typedef struct {
    double a[9], b[9], span[3];
} Middle;

static inline Middle middle_of(const Shape *start, const Shape *end, size_t m) {
    Middle found;
    for (int i = 0; i < 9; i++) {
        found.a[i] = 0.5 * (start->directors[9 * m + i] + end->directors[9 * m + i]);
        found.b[i] = 0.5 * (start->directors[9 * m + 9 + i] + end->directors[9 * m + 9 + i]);
    }
    for (int i = 0; i < 3; i++) found.span[i] = 0.5 * (start->spans[3 * m + i] + end->spans[3 * m + i]);
    return found;
}

/* Mean arm of a port over a step, world axes. */
static inline void mean_arm(const Beam *beam, size_t port, double arm[3]) {
    const size_t node = beam->port_nodes[port];
    double r[9];
    for (int i = 0; i < 9; i++)
        r[i] = 0.5 * (beam->start.directors[9 * node + i] + beam->end.directors[9 * node + i]);
    turned3(r, beam->port_arms + 3 * port, arm);
}

/* Loads on all nodes, six numbers each. */
FANFOLD_VECTORISED static void load_nodes(Beam *beam, const Step *step) {
    const Shape *start = &beam->start;
    for (size_t n = 0; n < beam->nodes; n++)
        for (int i = 0; i < 3; i++) {
            beam->loads[NODE * n + i] = beam->weights[n] * beam->gravity[i];
            beam->loads[NODE * n + 3 + i] = 0.0;
        }
    for (size_t m = 0; m + 1 < beam->nodes; m++) {
        double *stress = beam->stresses + 6 * m, *change = beam->changes + 6 * m;
        const Middle middle = middle_of(start, &beam->end, m);
        const Strains *before_it = start->strains + m, *after = beam->end.strains + m;
        if (step->damping > 0.0) {
            double z[6];
            change_of(middle.a, middle.b, middle.span, beam->travel + 3 * m, beam->turn + 3 * m, beam->lengths[m], z);
            strain_change(beam, m, before_it, after, z, change);
        }
        stress_of(beam, m, before_it, after, step->damping, change, stress);
        add_loads(middle.a, middle.b, middle.span, stress, beam->loads + NODE * m);
    }
    for (size_t k = 0; k < beam->ports; k++) {
        const double *wrench = step->u + WRENCH_SIZE * k;
        double *load = beam->loads + NODE * beam->port_nodes[k], arm[3], moment[3];
        mean_arm(beam, k, arm);
        cross3(arm, wrench, moment);
        for (int i = 0; i < 3; i++) {
            load[i] += wrench[i];
            load[3 + i] += moment[i] + wrench[3 + i];
        }
    }
}

/* Angular momentum of a section at the end of the step, as its turn gives it, world axes. */
static inline void spin_of_turn(const Beam *beam, const Step *step, size_t n, double spin[3]) {
    double turn[3];
    const double *rate = step->x + place_of_rate(beam) + 3 * n;
    turned_back3(beam->start.directors + 9 * n, beam->turn + 3 * n, turn);
    for (int i = 0; i < 3; i++)
        turn[i] = beam->inertia[3 * n + i] * (2.0 * turn[i] / step->h - rate[i]);
    turned3(beam->end.directors + 9 * n, turn, spin);
}

/* What changes of momenta are missing of the loads over the step: minus the residual. */
static void miss_loads(Beam *beam, const Step *step) {
    const double *velocity = step->x + place_of_velocity(beam), h = step->h;
    double last[3] = {0.0, 0.0, 0.0};
    for (size_t n = 0; n < beam->nodes; n++) {
        double spin[3], *missing = beam->residual + NODE * n;
        spin_of_turn(beam, step, n, spin);
        for (int i = 0; i < 3; i++) {
            missing[i] = beam->loads[NODE * n + i];
            missing[3 + i] = beam->loads[NODE * n + 3 + i] - (spin[i] - beam->spins[3 * n + i]) / h;
        }
    }
    for (size_t n = 0; n < beam->nodes; n++) {
        const double own = n + 1 < beam->nodes ? beam->line_mass * beam->lengths[n] / 6.0 : 0.0;
        const double earlier = n > 0 ? beam->line_mass * beam->lengths[n - 1] / 6.0 : 0.0;
        for (int i = 0; i < 3; i++) {
            const size_t at = 3 * n + i;
            const double *next = beam->travel + at + (n + 1 < beam->nodes ? 3 : 0);
            const double *fast = velocity + at + (n + 1 < beam->nodes ? 3 : 0);
            const double here = 2.0 * (beam->travel[at] - h * velocity[at]);
            const double there = 2.0 * (*next - h * *fast);
            const double gain = 2.0 * (own + earlier) * here + own * there + earlier * last[i];
            beam->residual[NODE * n + i] -= gain / (h * h);
            last[i] = here;
        }
    }
}

/* Derivative of the change of a section's angular momentum by its rotation vector, over the step's size. */
FANFOLD_INLINED void add_spin(const Beam *beam, const Step *step, size_t n, double *block) {
    const double share = 2.0 / (step->h * step->h);
    double spin[3];
    spin_of_turn(beam, step, n, spin);
    for (int column = 0; column < 3; column++) {
        double unit[3] = {0.0}, change[3], local[3], gain[3], turning[3];
        unit[column] = 1.0;
        cayley_change(beam->turn + 3 * n, unit, change);
        turned_back3(beam->start.directors + 9 * n, change, local);
        for (int i = 0; i < 3; i++) local[i] *= share * beam->inertia[3 * n + i];
        turned3(beam->end.directors + 9 * n, local, gain);
        cross3(unit, spin, turning);
        for (int i = 0; i < 3; i++)
            block[NODE * (3 + i) + 3 + column] += gain[i] + turning[i] / step->h;
    }
}

/* Minus the derivative of the moment that a port's force has on its node by the rotation of that. */
static void add_arm(const Beam *beam, const Step *step, size_t port, double *block) {
    const double *force = step->u + WRENCH_SIZE * port;
    double arm[3];
    turned3(beam->end.directors + 9 * beam->port_nodes[port], beam->port_arms + 3 * port, arm);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            block[NODE * (3 + i) + 3 + j] -= 0.5 * (arm[i] * force[j] - (i == j ? dot3(arm, force) : 0.0));
}

/* Factors of the derivative of the residual by the unknowns where the iteration stands. */
FANFOLD_VECTORISED static void factorise(Beam *beam, const Step *step, Factors *f, int with_ports) {
    const Shape *start = &beam->start, *end = &beam->end;
    const size_t nodes = beam->nodes, elements = nodes - 1;
    memset(f->nodes, 0, BLOCK * nodes * sizeof(double));
    memset(f->next, 0, BLOCK * elements * sizeof(double));
    memset(f->back, 0, BLOCK * elements * sizeof(double));
    for (size_t m = 0; m < elements; m++) {
        const Middle middle = middle_of(start, end, m);
        const double *a = end->directors + 9 * m, length = beam->lengths[m];
        double mean[6 * COORDINATES], last[6 * COORDINATES], g[36], k[COORDINATES * COORDINATES] = {0.0};
        stiffness_of(beam, m, start->strains + m, end->strains + m, step->damping, beam->changes + 6 * m, g);
        motions_of(middle.a, middle.b, middle.span, length, mean);
        motions_of(a, a + 9, end->spans + 3 * m, length, last);
        add_geometric(middle.a, middle.b, middle.span, a, a + 9, beam->stresses + 6 * m, k);
        add_material(mean, g, last, length, k);
        double *aa = f->nodes + BLOCK * m, *ab = f->next + BLOCK * m, *ba = f->back + BLOCK * m, *bb = aa + BLOCK;
        add_to_blocks(k, aa, ab, ba, bb);
        const double mass = 2.0 * beam->line_mass * length / (6.0 * step->h * step->h);
        for (int i = 0; i < 3; i++) {
            aa[(NODE + 1) * i] += 2.0 * mass;
            ab[(NODE + 1) * i] += mass;
            ba[(NODE + 1) * i] += mass;
            bb[(NODE + 1) * i] += 2.0 * mass;
        }
    }
    for (size_t n = 0; n < nodes; n++) add_spin(beam, step, n, f->nodes + BLOCK * n);
    for (size_t k = 0; k < beam->ports && with_ports; k++)
        add_arm(beam, step, k, f->nodes + BLOCK * beam->port_nodes[k]);
    factorise_chain(f, nodes);
}

/* Takes the solution of the linear equations over; how large it is, of the beam's length or in rad. */
static double correct(Beam *beam) {
    double largest = 0.0;
    for (size_t n = 0; n < beam->nodes; n++) {
        const double *by = beam->residual + NODE * n;
        double change[3];
        cayley_change(beam->turn + 3 * n, by + 3, change);
        for (int i = 0; i < 3; i++) {
            beam->travel[3 * n + i] += by[i];
            beam->turn[3 * n + i] += change[i];
            largest = fmax(largest, fmax(fabs(by[i]) / beam->length, fabs(by[3 + i])));
        }
    }
    return largest;
}

static int same(Key *key, const double *x, size_t states, const double *u, size_t inputs, double h) {
    return key->known && key->h == h && memcmp(key->x, x, states * sizeof(double)) == 0 &&
           memcmp(key->u, u, inputs * sizeof(double)) == 0;
}

static void remember(Key *key, const double *x, size_t states, const double *u, size_t inputs, double h) {
    key->known = 1;
    key->h = h;
    memcpy(key->x, x, states * sizeof(double));
    memcpy(key->u, u, inputs * sizeof(double));
}

/* The factors at the prediction: they follow from the start and the step's size, not from loads, and serve all steps
   from there. */
static const Factors *predicted_factors(Beam *beam, const Step *step) {
    if (!same(&beam->start_of_factors, step->x, beam->states, step->u, 0, step->h)) {
        factorise(beam, step, &beam->predicted, 0);
        remember(&beam->start_of_factors, step->x, beam->states, step->u, 0, step->h);
    }
    return &beam->predicted;
}

/* Newton's iteration from uniform motion, with factors kept while they serve; leaves poses and loads of the end. */
static int iterate(Beam *beam, const Step *step, Reason *why) {
    const Factors *factors = NULL;
    double last = INFINITY;
    int done = 0;
    if (!start_step(beam, step, why)) return 0;
    predict(beam, step);
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        if (!place(beam, step, why)) return 0;
        load_nodes(beam, step);
        if (done) return 1;
        miss_loads(beam, step);
        if (i == 0)
            factors = predicted_factors(beam, step);
        else if (!factors) {
            factorise(beam, step, &beam->renewed, 1);
            factors = &beam->renewed;
        }
        solve_chain(factors, beam->nodes, beam->residual);
        const double change = correct(beam), shrinks = i > 0 ? change / last : 1.0;
        done = change * fmin(shrinks, 1.0) <= TOLERANCE || (change <= ROUNDING && shrinks > STANDSTILL && i > 0);
        if (change > FAR || (i > 0 && change * pow(shrinks, CHEAPER) > TOLERANCE)) factors = NULL;
        last = change;
    }
    return refuse(why, "a step of %g s finds no end in %d iterations; take smaller steps or loads", step->h,
                  MOST_ITERATIONS);
}

static Step step_of(const Beam *beam, const double *x, const double *u, double h) {
    return (Step){x, u, h, beam->damping / h};
}

/* Writes the velocities that loads lead to, and the heat. */
static void store_motion(Beam *beam, const Step *step, double *x_next) {
    const double *x = step->x, h = step->h;
    double *velocity = x_next + place_of_velocity(beam), *rate = x_next + place_of_rate(beam), heat = 0.0;
    for (size_t n = 0; n < beam->nodes; n++) {
        double spin[3], own[3];
        for (int i = 0; i < 3; i++) {
            velocity[3 * n + i] = h * beam->loads[NODE * n + i];
            spin[i] = beam->spins[3 * n + i] + h * beam->loads[NODE * n + 3 + i];
        }
        turned_back3(beam->end.directors + 9 * n, spin, own);
        for (int i = 0; i < 3; i++) rate[3 * n + i] = own[i] / beam->inertia[3 * n + i];
    }
    divide_by_mass(beam, velocity);
    for (size_t i = 0; i < 3 * beam->nodes; i++) velocity[i] += x[place_of_velocity(beam) + i];
    for (size_t m = 0; m + 1 < beam->nodes && step->damping > 0.0; m++)
        for (int i = 0; i < 6; i++) {
            const double change = beam->changes[6 * m + i];
            heat += beam->lengths[m] * beam->stiffness[i] * change * change;
        }
    x_next[X_HEAT] = x[X_HEAT] + step->damping * heat;
}

/* The state at the end of the step. */
static void store_end(Beam *beam, const Step *step, double *x_next) {
    const double *position = step->x + place_of_position(beam);
    for (size_t i = 0; i < 3 * beam->nodes; i++)
        x_next[place_of_position(beam) + i] = position[i] + beam->travel[i];
    memcpy(x_next + place_of_orientation(beam), beam->quaternions, 4 * beam->nodes * sizeof(double));
    x_next[X_HEAT] = step->x[X_HEAT];
    store_motion(beam, step, x_next);
}

int beam_step_real(void *self, const double *x, const double *u, double h, double *x_next, Reason *why);
int beam_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why);

int beam_step_real(void *self, const double *x, const double *u, double h, double *x_next, Reason *why) {
    Beam *beam = self;
    const Step step = step_of(beam, x, u, h);
    beam->end_of_step.known = 0;
    if (!iterate(beam, &step, why)) return 0;
    store_end(beam, &step, x_next);
    return 1;
}

/* Makes sure that poses and exact factors of a step's end are at hand. */
static int at_end_of(Beam *beam, const Step *step, Reason *why) {
    const size_t inputs = WRENCH_SIZE * beam->ports;
    if (same(&beam->end_of_step, step->x, beam->states, step->u, inputs, step->h)) return 1;
    if (!iterate(beam, step, why)) return 0;
    factorise(beam, step, &beam->renewed, 1);
    remember(&beam->end_of_step, step->x, beam->states, step->u, inputs, step->h);
    return 1;
}

/* Slopes of travel and rotations at the end along those of the inputs, into the residual. */
static void differentiate_step(Beam *beam, const Step *step, const double complex *u) {
    memset(beam->residual, 0, NODE * beam->nodes * sizeof(double));
    for (size_t k = 0; k < beam->ports; k++) {
        double slope[WRENCH_SIZE], arm[3], moment[3], *load = beam->residual + NODE * beam->port_nodes[k];
        for (int i = 0; i < WRENCH_SIZE; i++) slope[i] = cimag(u[WRENCH_SIZE * k + i]);
        mean_arm(beam, k, arm);
        cross3(arm, slope, moment);
        for (int i = 0; i < 3; i++) {
            load[i] += slope[i];
            load[3 + i] += moment[i] + slope[3 + i];
        }
    }
    solve_chain(&beam->renewed, beam->nodes, beam->residual);
}

/* Slopes of the state at the end, from those of travel and rotations; heat has none, as no output depends on it. */
static void store_slopes(const Beam *beam, double h, double complex *x_next) {
    const double rate = 2.0 / h;
    for (size_t n = 0; n < beam->nodes; n++) {
        const double *by = beam->residual + NODE * n;
        const Quaternion turning = {0.0, 0.5 * by[3], 0.5 * by[4], 0.5 * by[5]};
        double change[3], local[3], slope[4];
        quaternion_store(quaternion_multiply(turning, quaternion_of(beam->quaternions + 4 * n)), slope);
        cayley_change(beam->turn + 3 * n, by + 3, change);
        turned_back3(beam->start.directors + 9 * n, change, local);
        double complex *position = x_next + place_of_position(beam) + 3 * n, *q = x_next + place_of_orientation(beam) + 4 * n;
        double complex *velocity = x_next + place_of_velocity(beam) + 3 * n, *spin = x_next + place_of_rate(beam) + 3 * n;
        for (int i = 0; i < 3; i++) {
            position[i] = complex_of(creal(position[i]), by[i]);
            velocity[i] = complex_of(creal(velocity[i]), rate * by[i]);
            spin[i] = complex_of(creal(spin[i]), rate * local[i]);
        }
        for (int i = 0; i < 4; i++) q[i] = complex_of(creal(q[i]), slope[i]);
    }
}

/* The plain step, and slopes that follow from the equations at its end. */
int beam_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why) {
    Beam *beam = self;
    for (size_t i = 0; i < WRENCH_SIZE * beam->ports; i++) beam->inputs[i] = creal(u[i]);
    const Step step = step_of(beam, x, beam->inputs, h);
    if (!at_end_of(beam, &step, why)) return 0;
    store_end(beam, &step, beam->next);
    for (size_t i = 0; i < beam->states; i++) x_next[i] = beam->next[i];
    differentiate_step(beam, &step, u);
    store_slopes(beam, h, x_next);
    return 1;
}

#endif
