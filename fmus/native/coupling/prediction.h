/* Wrenches extrapolated over the last accepted steps, and the work of what bends them; see
   orchestrator/cosim/implicit/history.py, which does the same in Python. */

#ifndef FANFOLD_PREDICTION_H
#define FANFOLD_PREDICTION_H

#include "system.h"

static double dot(const double *a, const double *b, size_t size) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0; /* four sums at a time, which the processor overlaps */
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        s0 += a[i] * b[i];
        s1 += a[i + 1] * b[i + 1];
        s2 += a[i + 2] * b[i + 2];
        s3 += a[i + 3] * b[i + 3];
    }
    for (; i < size; i++) s0 += a[i] * b[i];
    return (s0 + s1) + (s2 + s3);
}

/* Whether a row of the unknown is a slope: half the change of a wrench over a step. */
static INLINE int is_slope(const Network *n, size_t row) { return row % n->width.wrench >= WRENCH; }

/* Multiply all slopes among `values` (size,). */
static void scale_slopes(const Network *n, double factor, double *values) {
    for (size_t first = WRENCH; first < n->size; first += n->width.wrench)
        for (size_t k = first; k < first + n->width.wrench - WRENCH; k++) values[k] *= factor;
}

/* Remember the mean wrenches of a step h, and slopes as rates; the oldest go. */
static void remember(Network *n, double middle, double h) {
    History *past = &n->history;
    memmove(past->times, past->times + 1, (POINTS - 1) * sizeof(double));
    memmove(past->values, past->values + n->size, (POINTS - 1) * n->size * sizeof(double));
    past->times[POINTS - 1] = middle;
    memcpy(past->values + (POINTS - 1) * n->size, n->wrenches, n->size * sizeof(double));
    scale_slopes(n, 2.0 / h, past->values + (POINTS - 1) * n->size);
    if (past->count < POINTS) past->count++;
}

/* Polynomial through the last points at the middle of a step h, by Lagrange's weights. */
static void extrapolate(const Network *n, double time, double h, size_t points, double *result) {
    const History *past = &n->history;
    const double *times = past->times + POINTS - points, *values = past->values + (POINTS - points) * n->size;
    memset(result, 0, n->size * sizeof(double));
    for (size_t k = 0; k < points; k++, values += n->size) {
        double weight = 1.0;
        for (size_t j = 0; j < points; j++)
            if (j != k) weight *= (time - times[j]) / (times[k] - times[j]);
        for (size_t i = 0; i < n->size; i++) result[i] += weight * values[i];
    }
    scale_slopes(n, 0.5 * h, result);
}

/* Translation (m) or rotation (rad) of a body's port along row `row` of its wrenches, for wrenches of 1 on all. */
static const double *mobility_row(const Participant *body, Width width, size_t row) {
    return body->turned + (row / width.wrench * width.coordinates + row % width.wrench) * width.wrench * body->ports;
}

/* Work (J) that a change of mean wrenches does on the motion it causes. */
static double work_of(const Network *n, const double *change) {
    double total = 0.0;
    for (const Participant *body = n->participant; body < n->participant + n->bodies; body++) {
        const size_t rows = n->width.wrench * body->ports;
        for (size_t row = 0; row < rows && body->turned; row++)
            if (!is_slope(n, row)) total += change[row] * dot(mobility_row(body, n->width, row), change, rows);
        change += rows;
    }
    return total;
}

/* Error of a wrench that a solution may leave: the last correction, or what moves the port by its rounding. */
static double noise_of(const Network *n, size_t i, double mobility) {
    const double pose = n->limits.round_off * (i / 3 % 2 ? 1.0 : n->reach);
    const double rounded = pose < n->round_off[i] * mobility ? pose / mobility : n->round_off[i];
    return fmax(n->scale[i] * fmin(n->correction, 1.0), rounded);
}

/* Note such errors of all mean wrenches; the work (J) that they do, each on its own, on the motion that they cause. */
static double noise_work(Network *n) {
    double total = 0.0;
    size_t i = 0;
    for (const Participant *body = n->participant; body < n->participant + n->bodies; body++)
        for (size_t row = 0; row < n->width.wrench * body->ports; row++, i++) {
            if (is_slope(n, row)) continue;
            const double mobility = body->turned ? mobility_row(body, n->width, row)[row] : 0.0;
            n->noise[i] = noise_of(n, i, mobility);
            total += mobility * n->noise[i] * n->noise[i];
        }
    return total;
}

/* Square of the part of a watched load that bends over a step, over what its energy makes of it; gain: how much errors
   that solutions leave grow in it. All of it bends in a step that strikes: steps before tell nothing of it, and by
   chance a bend that is no more than a part of a jump. */
static double watched_square(const Network *n, const Watched *w, double h, double gain) {
    double axes[9], load = 0.0, before = 0.0, now = 0.0, noise = 0.0;
    axes_of(n->participant[w->connection].input + MOTION * w->port, axes);
    for (size_t i = 0; i < 3; i++) {
        const double along = axes[3 * i] * w->axis[0] + axes[3 * i + 1] * w->axis[1] + axes[3 * i + 2] * w->axis[2];
        load += along * n->bend[w->row + i];
        before += along * n->accepted[w->row + i];
        now += along * n->wrenches[w->row + i];
        noise = fmax(noise, n->noise[w->row + i]);
    }
    if (fabs(before) <= n->limits.no_load * fabs(now)) load = fmax(fabs(load), fabs(now));
    return w->weight * h * h * fmax(0.0, load * load - gain * gain * noise * noise);
}

/* Weights of the remembered points and the present one: of mean wrenches, of slopes as rates, and of means in what they
   bend at most. */
typedef struct {
    double mean[POINTS + 1], rate[POINTS + 1], most[POINTS + 1];
} Weights;

/* Add half of h^2 u'' by three of the points at `times`. */
static void add_curvature(const double *times, size_t first, double h, Weights *w) {
    for (size_t i = first; i < first + 3; i++) {
        double weight = h * h;
        for (size_t j = first; j < first + 3; j++)
            if (j != i) weight /= times[i] - times[j];
        w->mean[i] += weight;
    }
}

/* Add half of what three of the points tell of h^2 u'' that slopes do not know of: the fourth divided difference over
   the outer points, doubled, and the one between. In equal steps the second difference of u less that of its rates. */
static void add_unknown_curvature(const double *times, size_t first, double h, Weights *w) {
    const double a = times[first], b = times[first + 1], c = times[first + 2], scale = -h * h * h * h;
    const double of_a = scale / ((a - b) * (a - c) * (a - c)), of_c = scale / ((c - b) * (c - a) * (c - a));
    w->rate[first] += of_a;
    w->rate[first + 2] += of_c;
    w->mean[first] -= of_a * (1.0 / (a - b) + 2.0 / (a - c));
    w->mean[first + 1] += scale / ((b - a) * (b - a) * (b - c) * (b - c));
    w->mean[first + 2] -= of_c * (1.0 / (c - b) + 2.0 / (c - a));
}

/* Of all points in a twelfth of h^3 times the third derivative, by the third divided difference. */
static void add_third_difference(const double *times, double h, Weights *w) {
    for (size_t i = 0; i <= POINTS; i++) {
        w->most[i] = 0.5 * h * h * h;
        for (size_t j = 0; j <= POINTS; j++)
            if (j != i) w->most[i] /= times[i] - times[j];
    }
}

/* Let no component with a slope bend more than the rows of slopes say, which are cleared. */
static void limit_bend(Network *n) {
    for (size_t port = 0; port < n->size; port += n->width.wrench)
        for (size_t i = port; i < port + WRENCH; i++) {
            if (n->wrenches[i + WRENCH] != 0.0 && fabs(n->bend[i + WRENCH]) < fabs(n->bend[i]))
                n->bend[i] = n->bend[i + WRENCH];
            n->bend[i + WRENCH] = 0.0;
        }
}

/* Note how far the present wrenches bend, see implicit/history.py: the mean of it now and a step before, in which
   what changes sign with every step cancels. How much independent errors of the wrenches grow in it. */
static double bend(Network *n, double middle, double h) {
    const History *past = &n->history;
    double times[POINTS + 1], gain = 0.0, most = 0.0;
    Weights weights = {{0.0}, {0.0}, {0.0}};
    const int slopes = n->width.wrench > WRENCH, limited = slopes && past->count == POINTS;
    memcpy(times, past->times, POINTS * sizeof(double));
    times[POINTS] = middle;
    for (size_t i = 0; i < 2; i++) {
        const size_t first = past->count < POINTS ? POINTS - 2 : POINTS - 2 - i;
        slopes ? add_unknown_curvature(times, first, h, &weights) : add_curvature(times, first, h, &weights);
    }
    if (limited) add_third_difference(times, h, &weights);
    memset(n->bend, 0, n->size * sizeof(double));
    for (size_t k = POINTS - past->count; k <= POINTS; k++) {
        const double *values = k < POINTS ? past->values + k * n->size : n->wrenches;
        const double rate = k < POINTS ? weights.rate[k] : weights.rate[k] * 2.0 / h;
        for (size_t port = 0; port < n->size; port += n->width.wrench)
            for (size_t i = port; i < port + WRENCH; i++) {
                n->bend[i] += weights.mean[k] * values[i] + (slopes ? rate * values[i + WRENCH] : 0.0);
                if (limited) n->bend[i + WRENCH] += weights.most[k] * values[i];
            }
        gain += weights.mean[k] * weights.mean[k] + weights.rate[k] * weights.rate[k] * 4.0 / (h * h);
        most += weights.most[k] * weights.most[k];
    }
    if (!limited) return sqrt(gain);
    limit_bend(n);
    return sqrt(fmin(gain, most));
}

/* Square of the relative error that what bends wrenches makes of velocities: its work over an energy, or what it is
   at a watched load. What errors left by the solutions have in it does not count; not a number with fewer points. */
static double error_square(Network *n, double middle, double h, double energy) {
    if (n->history.count < 2) return NAN;
    const double gain = bend(n, middle, h);
    double largest = fmax(0.0, work_of(n, n->bend) - gain * gain * noise_work(n)) / energy;
    for (const Watched *w = n->watched; w < n->watched + n->watched_count; w++)
        largest = fmax(largest, watched_square(n, w, h, gain));
    return largest;
}

#endif
