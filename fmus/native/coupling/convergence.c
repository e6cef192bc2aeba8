/* When the wrenches of a coupled step agree. */

#include "convergence.h"

#include <math.h>

void set_scale(Network *n, const double *change) {
    double largest[2] = {0.0, 0.0};
    for (size_t i = 0; i < n->size; i++)
        largest[i / 3 % 2] = fmax(largest[i / 3 % 2], fabs(n->wrenches[i] + change[i]));
    const Tolerance *t = &n->tolerance;
    for (size_t i = 0; i < n->size; i++)
        n->scale[i] = t->relative * (i / 3 % 2 ? t->torque + largest[1] : t->force + largest[0]);
}

double largest_of(const double *values, size_t size, size_t *row) {
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

int is_near(const Network *n) { return n->correction * n->tolerance.relative <= NEAR; }

int is_within_round_off(const Network *n) {
    const double wrenches = fmax(n->tolerance.residual, ROUND_OFF / n->tolerance.relative);
    for (size_t i = 0; i < n->size; i++)
        if (!(fabs(n->residual[i]) <= n->round_off[i] + wrenches * n->scale[i])) return 0;
    return 1;
}

int is_credible(const Network *n) {
    size_t row;
    const double wrench = 1.0 + largest_of(n->wrenches, n->size, &row);
    return largest_of(n->residual, n->size, &row) <= CREDIBLE * wrench;
}

/* Whether residuals are as small as recorded loads require, or as rounding allows.

   A stiff joint turns a small correction into a large residual. */
static int agrees(const Network *n) {
    for (size_t i = 0; i < n->size; i++)
        if (!(fabs(n->residual[i]) <= fmax(AGREED * n->scale[i], n->round_off[i]))) return 0;
    return 1;
}

/* Whether all corrections to come, if they shrink like the last one, add up to less than 1; slow ones may not. */
static int leaves_little(const Network *n) {
    return n->last == 0.0 || n->correction <= 1.0 - n->correction / n->last;
}

int is_enough(const Network *n) { return leaves_little(n) && (n->last <= 1.0 || agrees(n)); }

int is_too_slow(const Network *n) {
    return n->correction * pow(n->correction / n->last, (double)(MOST_ITERATIONS - n->iteration)) > 1.0;
}

int overshoots(const Network *n, const double *step) {
    if (n->kept == 0 || !(n->correction >= OVERSHOT * n->last)) return 0;
    const double *before = n->steps + (n->kept - 1) * n->size;
    const double back = -dot(before, step, n->size);
    const double length = sqrt(n->squares[n->kept - 1] * dot(step, step, n->size));
    return back > OVERSHOT * length;
}
