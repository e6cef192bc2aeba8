/* What a latch-up changes at a hinge line. */

#include "latch_up.h"

#include <math.h>
#include <string.h>

#include "convergence.h"
#include "system.h"

enum { FREQUENCY_SEARCH = 6 };
#define LONG_STEP 100.0
#define LEAST_STIFFENING 1e-12
#define LONGEST_SWING 0.02 /* s, for the swing of a wing as a whole; over many periods derivatives show no inertia */

double fastest_of(const StiffenedLine *line) { return fmax(line->frequency, line->decay); }

/* Eigenvalues of a symmetric matrix (n, n), which is destroyed, onto its diagonal, and vectors as columns, by Jacobi's
   rotations. */
static void symmetric_eigen(double *a, size_t n, double *vectors) {
    for (size_t i = 0; i < n * n; i++) vectors[i] = i % (n + 1) == 0;
    for (size_t sweep_number = 0; sweep_number < 60; sweep_number++) {
        double off = 0.0, all = 0.0;
        for (size_t i = 0; i < n * n; i++) {
            all += a[i] * a[i];
            if (i % (n + 1)) off += a[i] * a[i];
        }
        if (!(off > 1e-32 * all)) return;
        for (size_t p = 0; p + 1 < n; p++)
            for (size_t q = p + 1; q < n; q++) {
                if (a[p * n + q] == 0.0) continue;
                const double theta = 0.5 * (a[q * n + q] - a[p * n + p]) / a[p * n + q];
                const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
                const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
                for (size_t k = 0; k < n; k++) {
                    const double x = a[k * n + p], y = a[k * n + q];
                    a[k * n + p] = c * x - s * y, a[k * n + q] = s * x + c * y;
                }
                for (size_t k = 0; k < n; k++) {
                    const double x = a[p * n + k], y = a[q * n + k];
                    a[p * n + k] = c * x - s * y, a[q * n + k] = s * x + c * y;
                }
                for (size_t k = 0; k < n; k++) {
                    const double x = vectors[k * n + p], y = vectors[k * n + q];
                    vectors[k * n + p] = c * x - s * y, vectors[k * n + q] = s * x + c * y;
                }
            }
    }
}

/* Derivatives (PORT_ROWS, PORT_ROWS) of a hinge's wrenches by its poses, over a step from its saved state. */
static int pose_stiffness(Solver *s, size_t i, double time, double h, double *result) {
    Network *n = s->network;
    const Width width = n->width;
    const size_t columns = width.coordinates * HINGE_PORTS;
    Participant *p = n->participant + i;
    double *matrix = s->start, *moments = p->input + p->moments, held[MOMENTS * HINGE_PORTS] = {0.0};
    const size_t held_size = p->moments ? sizeof held : 0;
    n->time = time;
    n->h = h;
    memcpy(held, moments, held_size); /* at rest, as moments belong to the last step */
    memset(moments, 0, held_size);
    const int filled = network_step_one(n, i) && fill_block(n, &s->jacobians, i, matrix);
    memcpy(moments, held, held_size);
    if (!filled) return 0;
    for (size_t row = 0; row < PORT_ROWS; row++)
        for (size_t column = 0; column < PORT_ROWS; column++)
            result[row * PORT_ROWS + column] = matrix[(row / WRENCH * width.wrench + row % WRENCH) * columns +
                                                      column / POSE * width.coordinates + column % POSE];
    return 1;
}

int slope_of(Solver *s, size_t connection, double time, double h, Slope *slope) {
    return pose_stiffness(s, connection, time, h, slope->step) &&
           pose_stiffness(s, connection, time, LONG_STEP, slope->lasting);
}

int stiffening_of(const Network *n, size_t hinge, const Slope *old, const Slope *new, double h, Stiffening *found) {
    double change[PORT_ROWS * PORT_ROWS], own[9], vectors[9], axes[9], axis[3], largest = 0.0;
    size_t first = POSE;
    for (size_t i = 0; i < PORT_ROWS * PORT_ROWS; i++) {
        change[i] = old->lasting[i] - new->lasting[i];
        largest = fmax(largest, fabs(new->lasting[i]));
    }
    for (size_t i = 0; i < 9; i++) /* torques where there are any */
        if (change[(POSE + 3 + i / 3) * PORT_ROWS + POSE + 3 + i % 3] != 0.0) first = POSE + 3;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            own[3 * i + j] =
                0.5 * (change[(first + i) * PORT_ROWS + first + j] + change[(first + j) * PORT_ROWS + first + i]);
    symmetric_eigen(own, 3, vectors);
    size_t best = own[4] > own[0] ? 1 : 0;
    if (own[8] > own[4 * best]) best = 2;
    const double value = own[4 * best];
    if (!(value > LEAST_STIFFENING * largest)) return 0;
    double viscous = 0.0;
    for (size_t i = 0; i < 3; i++) axis[i] = vectors[3 * i + best];
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            const size_t at = (first + i) * PORT_ROWS + first + j;
            viscous += axis[i] * (old->step[at] - new->step[at] - change[at]) * axis[j];
        }
    axes_of(n->participant[hinge].input + MOTION * (HINGE_PORTS - 1), axes);
    found->connection = (double)hinge;
    found->first = (double)(first - POSE);
    found->stiffness = 2.0 * value; /* a mean load is half of that at the end */
    found->damping = fmax(0.0, h * viscous);
    for (size_t i = 0; i < 3; i++)
        found->axis[i] = axes[i] * axis[0] + axes[3 + i] * axis[1] + axes[6 + i] * axis[2];
    for (size_t k = 0; k < PORT_ROWS; k++) {
        found->wrench[k] = found->rotation[k] = 0.0;
        for (size_t i = 0; i < 3; i++) {
            found->wrench[k] += change[k * PORT_ROWS + first + i] * axis[i] / value;
            found->rotation[k] += axis[i] * change[(first + i) * PORT_ROWS + k] / value;
        }
    }
    return 1;
}

static const size_t *links_of(const Network *n, const Stiffening *hinge) {
    return n->participant[(size_t)hinge->connection].links;
}

/* Rotations (rad) of all hinges under a torque of 1 N.m at one, held over the step in use, all joints in place. */
static void turned_by(Solver *s, const StiffenedLine *line, const Stiffening *loaded, double *rotations) {
    const Network *n = s->network;
    const Width width = n->width;
    double *load = s->start, *change = s->step;
    memset(load, 0, n->size * sizeof(double));
    for (size_t k = 0; k < PORT_ROWS; k++)
        load[width.wrench * links_of(n, loaded)[k / WRENCH] + k % WRENCH] += loaded->wrench[k];
    system_direction(n, load, change);
    for (size_t i = 0; i < (size_t)line->hinges; i++) {
        rotations[i] = 0.0;
        for (size_t k = 0; k < PORT_ROWS; k++) {
            const Link *link = n->link + links_of(n, line->hinge + i)[k / WRENCH];
            const Participant *body = n->participant + link->body;
            if (!body->turned) continue;
            const size_t rows = width.wrench * body->ports;
            const double *mobility = body->turned + (width.coordinates * link->body_port + k % POSE) * rows;
            const size_t first = (size_t)(link - n->link) - link->body_port; /* a body's ports follow each other */
            rotations[i] += line->hinge[i].rotation[k] * dot(mobility, change + width.wrench * first, rows);
        }
    }
}

/* Present rate (rad/s) of the rotation. */
static double rate_of(const Network *n, const Stiffening *hinge) {
    const double *input = n->participant[(size_t)hinge->connection].input;
    double rate = 0.0;
    for (size_t k = 0; k < PORT_ROWS; k++) rate += hinge->rotation[k] * input[MOTION * (k / 6) + 7 + k % 6];
    return rate;
}

/* Compute frequency, decay and energy of a line on the time scale of a step h (s), whose matrices are in use. They are
   0 where a hinge would turn against its torque, or so far that the matrices are nearly singular. */
static void note_swing(Solver *s, double h, StiffenedLine *line, double *room) {
    const size_t hinges = (size_t)line->hinges;
    double *compliance = room, *matrix = compliance + hinges * hinges, *vectors = matrix + hinges * hinges;
    double largest = 0.0, least = 1.0, energy = 0.0, damping = 0.0;
    for (size_t j = 0; j < hinges; j++) turned_by(s, line, line->hinge + j, compliance + j * hinges);
    for (size_t i = 0; i < hinges; i++)
        for (size_t j = 0; j < hinges; j++) /* symmetric except for the turning of axes */
            matrix[i * hinges + j] = 0.5 * sqrt(line->hinge[i].stiffness * line->hinge[j].stiffness) *
                                     (compliance[i * hinges + j] + compliance[j * hinges + i]);
    for (size_t i = 0; i < hinges; i++) least = fmin(least, compliance[i * (hinges + 1)]);
    symmetric_eigen(matrix, hinges, vectors);
    for (size_t i = 0; i < hinges; i++) {
        const Stiffening *hinge = line->hinge + i;
        const double rate = rate_of(s->network, hinge);
        largest = fmax(largest, matrix[i * (hinges + 1)]);
        energy += 0.5 * hinge->stiffness * rate * rate;
        damping = fmax(damping, hinge->damping / hinge->stiffness);
    }
    line->frequency = line->decay = line->energy = 0.0;
    if (!(largest > 0.0 && largest < CREDIBLE && least > 0.0)) return;
    const double square = 2.0 * largest / (h * h);
    line->frequency = sqrt(square);
    line->decay = damping * square;
    line->energy = energy / square;
}

double note_whole_swing(Solver *s, double time, double largest, StiffenedLine *line, double *room) {
    double size = fmin(largest, LONGEST_SWING);
    line->frequency = line->decay = line->energy = 0.0;
    for (size_t i = 0; i < FREQUENCY_SEARCH; i++) {
        if (linearize(s, time, size)) note_swing(s, size, line, room);
        if (fastest_of(line) > 0.0) break;
        size *= 0.5;
    }
    return size;
}

double resolving_step(Solver *s, double time, StiffenedLine *line, double size, double h, double phase, double *room) {
    const double frequency = line->frequency, decay = line->decay, energy = line->energy;
    for (size_t i = 0; i < FREQUENCY_SEARCH && fastest_of(line) * size >= 2.0; i++) {
        size = fmax(1.0 / fastest_of(line), 0.1 * size);
        if (!linearize(s, time, size)) break;
        note_swing(s, size, line, room);
    }
    const double fastest = fastest_of(line);
    line->frequency = frequency, line->decay = decay, line->energy = energy;
    return fastest * h > phase ? phase / fastest : h;
}

size_t watch_loads(const Network *n, const StiffenedLine *line, double energy, Watched *watched) {
    for (size_t i = 0; i < (size_t)line->hinges; i++) {
        const Stiffening *hinge = line->hinge + i;
        const size_t last = HINGE_PORTS - 1;
        watched[i].connection = (size_t)hinge->connection;
        watched[i].port = last;
        watched[i].row = n->width.wrench * links_of(n, hinge)[last] + (size_t)hinge->first;
        memcpy(watched[i].axis, hinge->axis, sizeof hinge->axis);
        watched[i].weight = line->hinges * line->frequency * line->frequency / (2.0 * hinge->stiffness * energy);
    }
    return (size_t)line->hinges;
}
