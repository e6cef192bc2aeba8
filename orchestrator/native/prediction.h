/* Wrenches extrapolated over the last accepted steps, and the work of what bends them; see
   orchestrator/history.py, which does the same in Python. */

#ifndef FANFOLD_PREDICTION_H
#define FANFOLD_PREDICTION_H

#include "network.h"

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

/* Remember the mean wrenches of a step; the oldest go. */
static void remember(Network *n, double middle) {
    History *past = &n->history;
    memmove(past->times, past->times + 1, (POINTS - 1) * sizeof(double));
    memmove(past->values, past->values + n->size, (POINTS - 1) * n->size * sizeof(double));
    past->times[POINTS - 1] = middle;
    memcpy(past->values + (POINTS - 1) * n->size, n->wrenches, n->size * sizeof(double));
    if (past->count < POINTS) past->count++;
}

/* Polynomial through the last points at a time, by Lagrange's weights. */
static void extrapolate(const Network *n, double time, size_t points, double *result) {
    const History *past = &n->history;
    const double *times = past->times + POINTS - points, *values = past->values + (POINTS - points) * n->size;
    memset(result, 0, n->size * sizeof(double));
    for (size_t k = 0; k < points; k++, values += n->size) {
        double weight = 1.0;
        for (size_t j = 0; j < points; j++)
            if (j != k) weight *= (time - times[j]) / (times[k] - times[j]);
        for (size_t i = 0; i < n->size; i++) result[i] += weight * values[i];
    }
}

/* Work (J) that a change of wrenches does on the motion it causes. */
static double work_of(const Network *n, const double *change) {
    double total = 0.0;
    for (size_t b = 0; b < n->bodies; b++) {
        const size_t columns = WRENCH * n->participant[b].ports;
        const double *matrix = n->mobility[b].matrix;
        for (size_t row = 0; row < columns; row++)
            total += change[row] * dot(matrix + (row / WRENCH * COORDINATES + row % WRENCH) * columns, change, columns);
        change += columns;
    }
    return total;
}

/* Work (J) of the wrenches h^2 u'' from the last two points and the present one; not a number with fewer. */
static double error_work(Network *n, double middle, double h) {
    const double *times = n->history.times;
    if (n->history.count < 2) return NAN;
    const double factor = 2.0 * h * h / ((middle - times[POINTS - 1]) * (middle - times[POINTS - 2]));
    extrapolate(n, middle, 2, n->bend);
    for (size_t i = 0; i < n->size; i++) n->bend[i] = factor * (n->wrenches[i] - n->bend[i]);
    return work_of(n, n->bend);
}

#endif
