/* The inner loop of a coupled step over FMI 2.0 functions; see orchestrator/coupling.py for the method and
   orchestrator/engine.py for who fills these structures. Nothing here allocates or is global. */

#define _POSIX_C_SOURCE 199309L

#include "blocks.h"
#include "participant.h"

#ifdef _WIN32
#include <windows.h>
#define EXPORT __declspec(dllexport)
#else
#include <time.h>
#define EXPORT __attribute__((visibility("default")))
#endif

/* What a participant can fail in, in the order of FAILURES in orchestrator/fmu.py. */
enum { RESTORE, SET, STEP, GET, FINITE, SAVE, OBSERVE };
/* How an iteration ends, in the order of Status in orchestrator/engine.py. */
enum { CONVERGED, NOT_CONVERGED, REFUSED, NOT_FINITE, WANTS_MATRICES, WANTS_PROBES, GOES_ON };

/* A port of a body and the port of a connection that it meets; place: its rows in the order of elimination. */
typedef struct {
    size_t body, body_port, connection, connection_port, place;
} Link;

/* A matrix like Participant.turned, and the axes (3, 3) of the participant's first port when it was made. */
typedef struct {
    const double *matrix, *axes;
} Probe;

/* Numbers of the iteration, see orchestrator/coupling.py; refreshed: iterations that may refresh matrices. */
typedef struct {
    double slow, diverged, steepest, round_off, near, credible;
    size_t most, refreshed[3];
} Limits;

typedef struct {
    double relative, force, torque;
} Tolerance;

/* Bodies come before connections. Arrays have `size` rows but: steps (most, size), squares (most,), product
   with room for a connection's rows over a body's columns. */
typedef struct {
    size_t participants, bodies, links, size;
    Participant *participant;
    const Link *link;
    const Probe *probe;
    const Part *parts; /* by connection, its ports, its ports again, the ports of the first port's body */
    double *wrenches, *law, *residual, *scale, *round_off, *steps, *squares, *product;
    Limits limits;
    Tolerance tolerance;
    Matrix matrix;
    double time, h, last, correction, seconds;
    size_t iteration, kept, sweeps, worst_row, singular, failed, failed_call;
    int failed_status;
} Network;

static double seconds_now(void) {
#ifdef _WIN32
    LARGE_INTEGER count, frequency;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&frequency);
    return (double)count.QuadPart / (double)frequency.QuadPart;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

/* Take note of who failed in what; 0. */
static int fail(Network *n, size_t participant, size_t call, int status) {
    n->failed = participant;
    n->failed_call = call;
    n->failed_status = status;
    return 0;
}

/* One participant from its saved state through the step. */
static int step_one(Network *n, size_t i) {
    const Participant *p = n->participant + i;
    int status = p->set_state(p->component, *p->saved);
    if (status > FMI_WARNING) return fail(n, i, RESTORE, status);
    status = p->set_real(p->component, p->input_references, p->inputs, p->input);
    if (status > FMI_WARNING) return fail(n, i, SET, status);
    status = p->do_step(p->component, n->time, n->h, 0);
    if (status > FMI_WARNING) return fail(n, i, STEP, status);
    status = p->get_real(p->component, p->output_references, p->outputs, p->output);
    if (status > FMI_WARNING) return fail(n, i, GET, status);
    double sum = 0.0;
    for (size_t k = 0; k < p->outputs; k++) sum += p->output[k];
    return isfinite(sum) ? 1 : fail(n, i, FINITE, 0);
}

static int step_all(Network *n, size_t first, size_t last) {
    const double begin = seconds_now();
    int fine = 1;
    for (size_t i = first; i < last && fine; i++) fine = step_one(n, i);
    n->seconds += seconds_now() - begin;
    return fine;
}

static int sweep(Network *n) {
    n->sweeps++;
    for (size_t i = 0; i < n->links; i++) {
        const Link *l = n->link + i;
        memcpy(n->participant[l->body].input + WRENCH * l->body_port, n->wrenches + WRENCH * i,
               WRENCH * sizeof(double));
    }
    if (!step_all(n, 0, n->bodies)) return 0;
    for (size_t i = 0; i < n->links; i++) {
        const Link *l = n->link + i;
        memcpy(n->participant[l->connection].input + MOTION * l->connection_port,
               n->participant[l->body].output + MOTION * l->body_port, MOTION * sizeof(double));
    }
    if (!step_all(n, n->bodies, n->participants)) return 0;
    for (size_t i = 0; i < n->links; i++) {
        const Link *l = n->link + i;
        memcpy(n->law + WRENCH * i, n->participant[l->connection].output + WRENCH * l->connection_port,
               WRENCH * sizeof(double));
    }
    return 1;
}

/* Wrenches that the rounding of a connection's poses and rates makes: ports cannot agree better than that. */
static void note_round_off(Network *n, const Participant *p, double rate) {
    for (size_t row = 0; row < WRENCH * p->ports; row++) {
        const double *stiffness = p->turned + row * COORDINATES * p->ports;
        double sum = 0.0;
        for (size_t port = 0; port < p->ports; port++, stiffness += COORDINATES) {
            const double *place = p->input + MOTION * port;
            const double reach = fmax(fabs(place[0]), fmax(fabs(place[1]), fabs(place[2])));
            for (size_t k = 0; k < COORDINATES; k++)
                sum += fabs(stiffness[k]) * (k < 3 ? reach : k < 6 ? 1.0 : rate);
        }
        n->round_off[WRENCH * p->links[row / WRENCH] + row % WRENCH] = n->limits.round_off * sum;
    }
}

/* Subtract stiffness x mobility of one connection; returns the parts of the matrix not used yet. */
static const Part *subtract_connection(Network *n, const Participant *p, const Part *part) {
    const size_t rows = WRENCH * p->ports;
    for (size_t port = 0; port < p->ports; port++) {
        const Link *l = n->link + p->links[port];
        const Participant *body = n->participant + l->body;
        const size_t columns = WRENCH * body->ports;
        memset(n->product, 0, rows * columns * sizeof(double));
        subtract_product(n->product, columns, p->turned + COORDINATES * port, COORDINATES * p->ports,
                         body->turned + COORDINATES * l->body_port * columns, columns, rows, COORDINATES, columns);
        for (size_t row = 0; row < rows; row += WRENCH)
            for (size_t column = 0; column < columns; column += WRENCH, part++)
                for (size_t i = 0; i < WRENCH; i++)
                    for (size_t j = 0; j < WRENCH; j++)
                        n->matrix.values[part->offset + i * part->stride + j] +=
                            n->product[(row + i) * columns + column + j];
    }
    return part;
}

/* LU factors of I - stiffness x mobility, from the probes turned to the present orientations. */
static void assemble(Network *n) {
    Matrix *m = &n->matrix;
    double rate = 0.0;
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        const size_t rows = (i < n->bodies ? COORDINATES : WRENCH) * p->ports;
        const size_t columns = (i < n->bodies ? WRENCH : COORDINATES) * p->ports;
        turn(n->probe[i].matrix, n->probe[i].axes, i < n->bodies ? p->output : p->input, rows, columns, p->turned);
        for (size_t k = 0; i >= n->bodies && k < MOTION * p->ports; k++)
            if (k % MOTION > 6) rate = fmax(rate, fabs(p->input[k]));
    }
    memset(m->values, 0, m->length * sizeof(double));
    for (size_t g = 0; g < m->groups; g++) {
        const size_t rows = m->begin[g + 1] - m->begin[g];
        for (size_t i = 0; i < rows; i++) m->values[m->blocks[g].offset + i * (rows + 1)] = 1.0;
    }
    const Part *part = n->parts;
    for (size_t i = n->bodies; i < n->participants; i++) {
        note_round_off(n, n->participant + i, rate);
        part = subtract_connection(n, n->participant + i, part);
    }
    n->singular = !factorize_blocks(m);
}

/* Correction of the wrenches by the chord Newton method; the residual itself where the matrix is singular. */
static void direction(const Network *n, const double *residual, double *result) {
    if (n->singular) {
        memcpy(result, residual, n->size * sizeof(double));
        return;
    }
    const Matrix *m = &n->matrix;
    for (size_t i = 0; i < n->links; i++)
        memcpy(m->ordered + n->link[i].place, residual + WRENCH * i, WRENCH * sizeof(double));
    solve_blocks(m, m->ordered);
    for (size_t i = 0; i < n->links; i++)
        memcpy(result + WRENCH * i, m->ordered + n->link[i].place, WRENCH * sizeof(double));
}

static double dot(const double *a, const double *b, size_t size) {
    double sum = 0.0;
    for (size_t i = 0; i < size; i++) sum += a[i] * b[i];
    return sum;
}

/* What a correction of 1 means for every row, for wrenches of the size of `wrenches + change`. */
static void set_scale(Network *n, const double *change) {
    double largest[2] = {0.0, 0.0};
    for (size_t i = 0; i < n->size; i++)
        largest[i / 3 % 2] = fmax(largest[i / 3 % 2], fabs(n->wrenches[i] + change[i]));
    const Tolerance *t = &n->tolerance;
    for (size_t i = 0; i < n->size; i++)
        n->scale[i] = t->relative * (i / 3 % 2 ? t->torque + largest[1] : t->force + largest[0]);
}

/* The chord Newton correction in the units of `scale`. */
static void scaled_direction(Network *n, double *result) {
    direction(n, n->residual, result);
    if (n->iteration == 1) set_scale(n, result);
    for (size_t i = 0; i < n->size; i++) result[i] /= n->scale[i];
}

/* Broyden's update of a correction from the steps taken so far, without a matrix. */
static void update(const Network *n, double *result) {
    if (n->kept == 0) return;
    const double *step = n->steps;
    for (size_t k = 0; k + 1 < n->kept; k++, step += n->size) {
        const double share = dot(step, result, n->size) / n->squares[k];
        for (size_t i = 0; i < n->size; i++) result[i] += share * step[n->size + i];
    }
    const double slope = dot(step, result, n->size) / n->squares[n->kept - 1];
    if (slope < n->limits.steepest)
        for (size_t i = 0; i < n->size; i++) result[i] /= 1.0 - slope;
}

/* Largest component and its row; infinite where one is not finite. */
static double largest_of(const double *values, size_t size, size_t *row) {
    double largest = -1.0;
    for (size_t i = 0; i < size; i++) {
        if (!isfinite(values[i])) {
            *row = i;
            return INFINITY;
        }
        if (fabs(values[i]) > largest) {
            largest = fabs(values[i]);
            *row = i;
        }
    }
    return fmax(largest, 0.0);
}

static int within_round_off(const Network *n) {
    for (size_t i = 0; i < n->size; i++)
        if (!(fabs(n->residual[i]) <= n->round_off[i])) return 0;
    return 1;
}

/* Whether wrenches like these can leave this residual; matrices of a motion gone astray correct nothing. */
static int is_credible(const Network *n) {
    size_t row;
    const double wrench = 1.0 + largest_of(n->wrenches, n->size, &row);
    return largest_of(n->residual, n->size, &row) <= n->limits.credible * wrench;
}

/* Keep the step and take it. */
static int apply(Network *n, const double *step) {
    n->last = n->correction;
    n->squares[n->kept] = dot(step, step, n->size);
    n->kept++;
    for (size_t i = 0; i < n->size; i++) n->wrenches[i] += step[i] * n->scale[i];
    return GOES_ON;
}

/* Forget the steps taken with the matrices before, and take one with the present ones. */
static int restart(Network *n) {
    n->kept = 0;
    scaled_direction(n, n->steps);
    return apply(n, n->steps);
}

/* From residual and factors to the next wrenches. */
static int correct(Network *n) {
    double *step = n->steps + n->kept * n->size;
    scaled_direction(n, step);
    update(n, step);
    n->correction = largest_of(step, n->size, &n->worst_row);
    if (n->correction <= 1.0) return is_credible(n) ? CONVERGED : NOT_CONVERGED;
    const int near = n->correction * n->tolerance.relative <= n->limits.near;
    if (near && within_round_off(n)) return CONVERGED;
    if (!isfinite(n->correction) || n->correction > n->limits.diverged * n->last) return NOT_CONVERGED;
    for (size_t k = 0; k < 3; k++)
        if (n->iteration == n->limits.refreshed[k] && n->correction > n->limits.slow * n->last) {
            if (k > 0) return WANTS_PROBES;
            assemble(n);
            return restart(n);
        }
    return apply(n, step);
}

/* Sweeps and corrections until there is something to tell. */
static int proceed(Network *n, int ready) {
    while (n->iteration < n->limits.most) {
        n->iteration++;
        if (!sweep(n)) return REFUSED;
        for (size_t i = 0; i < n->size; i++) n->residual[i] = n->law[i] - n->wrenches[i];
        if (!isfinite(largest_of(n->residual, n->size, &n->worst_row))) {
            n->correction = INFINITY;
            return NOT_FINITE;
        }
        if (!ready) return WANTS_MATRICES;
        const int status = correct(n);
        if (status != GOES_ON) return status;
    }
    return NOT_CONVERGED;
}

/* Bytes of the structures, by which Python knows that it means the same. */
EXPORT void coupling_sizes(size_t *sizes) {
    sizes[0] = sizeof(Participant);
    sizes[1] = sizeof(Network);
}

/* Bodies under the wrenches, then connections over the motions, all from their saved states; 1 or 0. */
EXPORT int coupling_sweep(Network *n, double time, double h) {
    n->time = time;
    n->h = h;
    return sweep(n);
}

/* Iterate from the present wrenches; ready: matrices for h are assembled. */
EXPORT int coupling_iterate(Network *n, double time, double h, int ready) {
    n->time = time;
    n->h = h;
    n->iteration = n->kept = 0;
    n->last = n->correction = INFINITY;
    return proceed(n, ready);
}

/* Go on with the probes that the iteration wanted; again: it had others before. */
EXPORT int coupling_resume(Network *n, int again) {
    assemble(n);
    const int status = again ? restart(n) : correct(n);
    return status == GOES_ON ? proceed(n, 1) : status;
}

/* Assemble and factorise from the present probes and motions. */
EXPORT void coupling_assemble(Network *n) { assemble(n); }

/* Chord Newton correction for a residual. */
EXPORT void coupling_direction(const Network *n, const double *residual, double *result) {
    direction(n, residual, result);
}

/* Work (J) that a change of wrenches does on the motion it causes. */
EXPORT double coupling_work(const Network *n, const double *change) {
    double total = 0.0;
    for (size_t b = 0; b < n->bodies; b++) {
        const size_t columns = WRENCH * n->participant[b].ports;
        const double *matrix = n->probe[b].matrix;
        for (size_t row = 0; row < columns; row++)
            total += change[row] * dot(matrix + (row / WRENCH * COORDINATES + row % WRENCH) * columns, change, columns);
        change += columns;
    }
    return total;
}

/* Save the states of all; 1 or 0. */
EXPORT int coupling_save(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        if (*p->saved && !p->overwrites_state) {
            p->free_state(p->component, p->saved);
            *p->saved = NULL;
        }
        const int status = p->get_state(p->component, p->saved);
        if (status > FMI_WARNING) return fail(n, i, SAVE, status);
    }
    return 1;
}

/* Read the observations of all, for the present inputs; 1 or 0. */
EXPORT int coupling_observe(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        int status = p->set_real(p->component, p->input_references, p->inputs, p->input);
        if (status > FMI_WARNING) return fail(n, i, SET, status);
        if (p->observations == 0) continue;
        status = p->get_real(p->component, p->observation_references, p->observations, p->observation);
        if (status > FMI_WARNING) return fail(n, i, OBSERVE, status);
    }
    return 1;
}

/* Mobility (12 ports, 6 ports) of the step just made; slope: room for 13 ports. FMI status. */
EXPORT int coupling_mobility(const Participant *p, double *matrix, double *slope) {
    return mobility_of(p, matrix, slope);
}

/* Stiffness (6 ports, 12 ports) of the step just made; slope: room for 13 ports. FMI status. */
EXPORT int coupling_stiffness(const Participant *p, double *matrix, double *slope) {
    return stiffness_of(p, matrix, slope);
}
