/* Wrenches extrapolated over the last accepted steps. */

#include "prediction.h"

#include <string.h>

/* Multiply all slopes among `values` (size,). */
static void scale_slopes(const Network *n, double factor, double *values) {
    for (size_t first = WRENCH; first < n->size; first += n->width.wrench)
        for (size_t k = first; k < first + n->width.wrench - WRENCH; k++) values[k] *= factor;
}

void history_add(Network *n, double middle, double h) {
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

void history_clear(Network *n) { n->history.count = 0; }

void predict(const Network *n, double middle, double h, double *result) {
    if (n->history.count)
        extrapolate(n, middle, h, n->history.count, result);
    else
        memcpy(result, n->accepted, n->size * sizeof(double));
}
