/* Forces on the modes of a body whose bending stretches it: the twin of components/body_parts/tension.py, where the theory
   is told. Part of body.c, of either number type. */

#ifndef FANFOLD_BODY_TENSION_H
#define FANFOLD_BODY_TENSION_H

#include "body_model.h"

/* Tensions of the forms, and of each the derivatives by the modes of second order, at the start and at the end of a step.
   `moment`: first moments of the rates of these modes; `turned`: forms times them. Of Newton's correction: values of mean
   tensions and of those at the end, of both derivatives, by what moments change forces, a matrix and its pivots. */
typedef struct {
    real *start, *end, *slope_start, *slope_end, *turned, *low, *moment, *residual;
    double *mean, *last, *mean_slope, *last_slope, *by_moment, *matrix, *split;
    unsigned short *pivots;
    size_t forms, count, rows, length; /* modes of second order, and padded; rows times forms */
} Tensions;

static inline Tensions tensions_of(const Body *body, const Work *work) {
    const size_t rows = padded(body->second_order), forms = padded(body->forms);
    Tensions own = {.forms = body->forms, .count = body->second_order, .rows = rows, .length = body->forms * rows};
    real *next = work->tensions;
    own.start = taken(&next, forms);
    own.end = taken(&next, forms);
    own.slope_start = taken(&next, own.length);
    own.slope_end = taken(&next, own.length);
    own.turned = taken(&next, own.length);
    own.low = taken(&next, rows);
    own.moment = taken(&next, rows);
    own.residual = taken(&next, 2 * rows);
    own.mean = (double *)taken(&next, forms);
    own.last = (double *)taken(&next, forms);
    own.mean_slope = (double *)taken(&next, own.length);
    own.last_slope = (double *)taken(&next, own.length);
    own.by_moment = (double *)taken(&next, rows * rows);
    own.matrix = (double *)taken(&next, 4 * rows * rows);
    own.pivots = (unsigned short *)taken(&next, 2 * rows);
    own.split = (double *)next;
    return own;
}

static inline void tensions_at(const Body *body, const Tensions *own, const real *eta, real *tension, real *slope) {
    for (size_t s = 0; s < own->rows; s++) own->low[s] = s < own->count ? eta[body->second_place[s]] : 0.0;
    rows_combined(body->tension_forms, own->rows, own->length, own->low, slope, own->split);
    for (size_t p = 0; p < own->forms; p++) {
        real sum = 0.0;
        for (size_t s = 0; s < own->count; s++) sum += slope[p * own->rows + s] * own->low[s];
        tension[p] = 0.5 * sum;
    }
}

/* Sets those of the end of a step, and first moments of the rates of all modes. */
static inline void end_tensions(const Body *body, const real *eta, const real *moment, const Work *work) {
    const Tensions own = tensions_of(body, work);
    tensions_at(body, &own, eta, own.end, own.slope_end);
    for (size_t s = 0; s < own.count; s++) own.moment[s] = moment[body->second_place[s]];
}

/* Has those at eta stand for the whole step, without moments. */
static inline void hold_tensions(const Body *body, const real *eta, const Work *work) {
    const Tensions own = tensions_of(body, work);
    tensions_at(body, &own, eta, own.end, own.slope_end);
    memcpy(own.start, own.end, own.forms * sizeof(real));
    memcpy(own.slope_start, own.slope_end, own.length * sizeof(real));
    for (size_t s = 0; s < own.rows; s++) own.moment[s] = 0.0;
}

/* Takes the gradient of the energy that is held from forces. */
static inline void subtract_held_gradient(const Body *body, const Work *work, real *force) {
    const Tensions own = tensions_of(body, work);
    for (size_t p = 0; p < own.forms; p++)
        for (size_t s = 0; s < own.count; s++)
            force[body->second_place[s]] -= own.end[p] * own.slope_end[p * own.rows + s];
}

/* low += factor times the sum of rows with these weights. */
static inline void weighted_rows(const Tensions *own, const real *weight, const real *rows, double factor) {
    for (size_t p = 0; p < own->forms; p++) {
        const real share = factor * weight[p], *row = rows + p * own->rows;
        for (size_t s = 0; s < own->count; s++) own->low[s] += share * row[s];
    }
}

/* Adds means and slopes of the forces of a step. */
static inline void add_tension_forces(const Body *body, const real *eta, const Work *work, real *force, real *slope) {
    const Tensions own = tensions_of(body, work);
    const size_t n = own.count;
    for (size_t s = 0; s < own.rows; s++) own.low[s] = 0.0;
    weighted_rows(&own, own.start, own.slope_start, -0.5);
    weighted_rows(&own, own.end, own.slope_end, 0.5);
    for (size_t s = 0; s < n; s++) {
        slope[body->second_place[s]] -= own.low[s];
        own.low[s] = 0.0;
    }
    weighted_rows(&own, own.start, own.slope_start, -1.0 / 6.0);
    weighted_rows(&own, own.end, own.slope_end, -1.0 / 6.0);
    rows_combined(body->tension_forms, own.rows, own.length, own.moment, own.turned, own.split);
    for (size_t p = 0; p < own.forms; p++) {
        const real *first = own.slope_start + p * own.rows, *last = own.slope_end + p * own.rows;
        const real *turned = own.turned + p * own.rows, ends = own.start[p] + own.end[p];
        real cross = 0.0, carried = 0.0;
        for (size_t s = 0; s < n; s++) {
            cross += first[s] * eta[body->second_place[s]];
            carried += (first[s] + last[s]) * own.moment[s];
        }
        const real mean = 0.125 * carried - (1.0 / 12.0) * (ends + cross);
        for (size_t s = 0; s < n; s++) own.low[s] += mean * (first[s] + last[s]) + 0.25 * ends * turned[s];
    }
    for (size_t s = 0; s < n; s++) force[body->second_place[s]] += own.low[s];
}

/* Second derivatives (count, count) of the energy by values of tensions and of their derivatives. */
FANFOLD_VECTORISED static void curvature(const double *restrict forms, const double *restrict tension,
                                         const double *restrict slopes, size_t count, size_t rows, size_t length,
                                         double *restrict found) {
    for (size_t s = 0; s < count; s++) {
        const double *own = forms + s * length;
        double *row = found + s * count;
        for (size_t t = 0; t < count; t++) row[t] = 0.0;
        for (size_t p = 0, first = 0; first < length; p++, first += rows) {
            const double held = tension[p], slope = slopes[first + s];
            for (size_t t = 0; t < count; t++) row[t] += held * own[first + t] + slope * slopes[first + t];
        }
    }
}

/* Curvature of the energy at the end of a step. */
static inline void curvature_at_end(const Body *body, const Tensions *own, double *found) {
    for (size_t p = 0; p < own->forms; p++) own->last[p] = value_of(own->end[p]);
    for (size_t i = 0; i < own->length; i++) own->last_slope[i] = value_of(own->slope_end[i]);
    curvature(body->tension_forms, own->last, own->last_slope, own->count, own->rows, own->length, found);
}

/* Divided difference of the energy's gradient over a step, in `by_moment`; behind `curvature_at_end`. */
static inline void divided_curvature(const Body *body, const Tensions *own) {
    for (size_t p = 0; p < own->forms; p++) own->mean[p] = 0.5 * (value_of(own->start[p]) + own->last[p]);
    for (size_t i = 0; i < own->length; i++)
        own->mean_slope[i] = 0.5 * (value_of(own->slope_start[i]) + own->last_slope[i]);
    curvature(body->tension_forms, own->mean, own->mean_slope, own->count, own->rows, own->length, own->by_moment);
}

/* Energy (J) of the tensions at eta. */
static inline real tension_energy(const Body *body, const real *eta, const Work *work) {
    const Tensions own = tensions_of(body, work);
    real energy = 0.0;
    tensions_at(body, &own, eta, own.end, own.slope_end);
    for (size_t p = 0; p < own.forms; p++) energy += 0.5 * own.end[p] * own.end[p];
    return energy;
}

#endif
