/* Local error of a coupled step. */

#include "local_error.h"

#include <math.h>
#include <string.h>

/* Share of the load of a step: a smaller load in the step before counts as none. */
#define NO_LOAD 1e-6

/* Whether a row of the unknown is a slope: half the change of a wrench over a step. */
static INLINE int is_slope(const Network *n, size_t row) { return row % n->width.wrench >= WRENCH; }

/* Derivatives by all wrenches on a body, of the translation (m) or rotation (rad) along row `row` of its wrenches. */
static const double *mobility_row(const Participant *body, Width width, size_t row) {
    return body->turned + (row / width.wrench * width.coordinates + row % width.wrench) * width.wrench * body->ports;
}

double work_of(const Network *n, const double *change) {
    double total = 0.0;
    for (const Participant *body = n->participant; body < n->participant + n->bodies; body++) {
        const size_t rows = n->width.wrench * body->ports;
        for (size_t row = 0; row < rows && body->turned; row++)
            if (!is_slope(n, row)) total += change[row] * dot(mobility_row(body, n->width, row), change, rows);
        change += rows;
    }
    return total;
}

/* Error that a solution may leave in a wrench: the last correction, or its rounding, at most what moves the port by the
   rounding of its pose. */
static double noise_of(const Network *n, size_t i, double mobility) {
    const double pose = ROUND_OFF * (i / 3 % 2 ? 1.0 : n->reach);
    const double rounded = pose < n->round_off[i] * mobility ? pose / mobility : n->round_off[i];
    return fmax(n->scale[i] * fmin(n->correction, 1.0), rounded);
}

/* Note these errors of all mean wrenches. Returns the work (J) of each on the motion that it causes, added up. */
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

/* Square of the bend of a watched load over a step, times its weight; gain: growth of errors of solutions in the bend.
   In a step that strikes the whole load counts, as steps before do not show it and its bend may by chance be a small
   part of the jump. */
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
    if (fabs(before) <= NO_LOAD * fabs(now)) load = fmax(fabs(load), fabs(now));
    return w->weight * h * h * fmax(0.0, load * load - gain * gain * noise * noise);
}

/* Weights of the remembered points and the present one: of mean wrenches and of slopes as rates in the bend, and of
   mean wrenches in its limit. */
typedef struct {
    double mean[POINTS + 1], rate[POINTS + 1], most[POINTS + 1];
} Weights;

/* Add half of h^2 u'' from three of the points at `times`. */
static void add_curvature(const double *times, size_t first, double h, Weights *w) {
    for (size_t i = first; i < first + 3; i++) {
        double weight = h * h;
        for (size_t j = first; j < first + 3; j++)
            if (j != i) weight /= times[i] - times[j];
        w->mean[i] += weight;
    }
}

/* Add half of the part of h^2 u'' that slopes do not represent, from three of the points: the fourth divided difference
   over the outer points, doubled, and the one between. In equal steps it is the second difference of u less the
   difference of its rates. */
static void add_unknown_curvature(const double *times, size_t first, double h, Weights *w) {
    const double a = times[first], b = times[first + 1], c = times[first + 2], scale = -h * h * h * h;
    const double of_a = scale / ((a - b) * (a - c) * (a - c)), of_c = scale / ((c - b) * (c - a) * (c - a));
    w->rate[first] += of_a;
    w->rate[first + 2] += of_c;
    w->mean[first] -= of_a * (1.0 / (a - b) + 2.0 / (a - c));
    w->mean[first + 1] += scale / ((b - a) * (b - a) * (b - c) * (b - c));
    w->mean[first + 2] -= of_c * (1.0 / (c - b) + 2.0 / (c - a));
}

/* Set the weights of all points in h^3 u'''/12, by the third divided difference. */
static void add_third_difference(const double *times, double h, Weights *w) {
    for (size_t i = 0; i <= POINTS; i++) {
        w->most[i] = 0.5 * h * h * h;
        for (size_t j = 0; j <= POINTS; j++)
            if (j != i) w->most[i] /= times[i] - times[j];
    }
}

/* Limit the bend of each component that has a slope by the row of the slope, which is then cleared. */
static void limit_bend(Network *n) {
    for (size_t port = 0; port < n->size; port += n->width.wrench)
        for (size_t i = port; i < port + WRENCH; i++) {
            if (n->wrenches[i + WRENCH] != 0.0 && fabs(n->bend[i + WRENCH]) < fabs(n->bend[i]))
                n->bend[i] = n->bend[i + WRENCH];
            n->bend[i + WRENCH] = 0.0;
        }
}

/* Compute the bend of the present wrenches; returns the growth of independent errors of wrenches in it.

   The bend is the mean of this step and the step before, in which terms that alternate with every step cancel: the
   ringing of stiff joints after a change of size. At order 2 it is h^2 u''. At order 4 it is what the rates r of slopes
   do not represent, h^2 (u'' - r'), by a formula that vanishes for cubic wrenches: -h^4 u''''/12 where slopes are
   right. Slopes of joints that a step does not resolve are wrong but do no work. So a component with a slope bends by
   at most h^3 u'''/12, which is more than a resolved vibration does. Rows of slopes are zero. */
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

double error_square(Network *n, double middle, double h, double energy) {
    if (n->history.count < 2) return NAN;
    const double gain = bend(n, middle, h);
    double largest = fmax(0.0, work_of(n, n->bend) - gain * gain * noise_work(n)) / energy;
    for (const Watched *w = n->watched; w < n->watched + n->watched_count; w++)
        largest = fmax(largest, watched_square(n, w, h, gain));
    return largest;
}
