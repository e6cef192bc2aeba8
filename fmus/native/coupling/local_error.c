/* Local error of a coupled step. */

#include "local_error.h"

#include <math.h>
#include <string.h>

/* Of the load of a step: what was less than this in the step before was none. */
#define NO_LOAD 1e-6

/* Whether a row of the unknown is a slope: half the change of a wrench over a step. */
static INLINE int is_slope(const Network *n, size_t row) { return row % n->width.wrench >= WRENCH; }

/* Translation (m) or rotation (rad) of a body's port along row `row` of its wrenches, for wrenches of 1 on all. */
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

/* Error of a wrench that a solution may leave: the last correction, or what moves the port by its rounding. */
static double noise_of(const Network *n, size_t i, double mobility) {
    const double pose = ROUND_OFF * (i / 3 % 2 ? 1.0 : n->reach);
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
    if (fabs(before) <= NO_LOAD * fabs(now)) load = fmax(fabs(load), fabs(now));
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

/* Note how far the present wrenches bend, and return how much independent errors of the wrenches grow in it.

   It is the mean of now and a step before, in which what changes sign with every step cancels: the ringing of stiff joints
   that a change of step stirs. At order 2 it is h^2 u''. At order 4 it is what rates r, that slopes give, do not tell of it,
   h^2 (u'' - r'), by a formula that vanishes for cubic wrenches: -h^4 u''''/12 where slopes are right. Slopes of joints that a
   step does not resolve are not, and do nothing: a component with a slope bends no more than h^3 u'''/12, which is more than
   that of a resolved vibration. Rows of slopes are zero. */
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
