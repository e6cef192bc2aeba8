/* Forces on the modes of a body whose bending stretches it: the twin of components/body_parts/tension.py, where the theory
   is told. Part of body.c, of either number type. */

#ifndef FANFOLD_BODY_TENSION_H
#define FANFOLD_BODY_TENSION_H

#include "body_model.h"

/* Tensions of the forms, and of each the derivatives by the modes of second order, at the start and at the end of a step;
   values of these derivatives, their mean over the step and those of its end, for the tangent. */
typedef struct {
    real *start, *end, *slope_start, *slope_end, *low;
    double *mean_value, *end_value, *split;
    size_t forms, count, rows, length; /* modes of second order, and padded; rows times forms */
} Tensions;

static inline Tensions tensions_of(const Body *body, const Work *work) {
    const size_t rows = padded(body->second_order);
    Tensions own = {.forms = body->forms, .count = body->second_order, .rows = rows, .length = body->forms * rows};
    real *next = work->tensions;
    own.start = taken(&next, padded(own.forms));
    own.end = taken(&next, padded(own.forms));
    own.slope_start = taken(&next, own.length);
    own.slope_end = taken(&next, own.length);
    own.low = taken(&next, rows);
    own.mean_value = (double *)taken(&next, own.length);
    own.end_value = (double *)taken(&next, own.length);
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

/* Sets those of the end of a step. */
static inline void tensions_at_end(const Body *body, const real *eta, const Work *work) {
    const Tensions own = tensions_of(body, work);
    tensions_at(body, &own, eta, own.end, own.slope_end);
}

/* Has those at eta stand for the whole step. */
static inline void hold_tensions(const Body *body, const real *eta, const Work *work) {
    const Tensions own = tensions_of(body, work);
    tensions_at(body, &own, eta, own.end, own.slope_end);
    memcpy(own.start, own.end, own.forms * sizeof(real));
    memcpy(own.slope_start, own.slope_end, own.length * sizeof(real));
}

/* Adds the forces of a step between these ends. */
static inline void add_tension_forces(const Body *body, const Work *work, real *force) {
    const Tensions own = tensions_of(body, work);
    for (size_t s = 0; s < own.rows; s++) own.low[s] = 0.0;
    for (size_t p = 0; p < own.forms; p++) {
        const real quarter = 0.25 * (own.start[p] + own.end[p]);
        const real *start = own.slope_start + p * own.rows, *end = own.slope_end + p * own.rows;
        for (size_t s = 0; s < own.count; s++) own.low[s] += quarter * (start[s] + end[s]);
    }
    for (size_t s = 0; s < own.count; s++) force[body->second_place[s]] -= own.low[s];
}

/* tangent (rows, rows) -= products of slopes, and forms times tensions. */
FANFOLD_VECTORISED static void subtract_tensions(const double *restrict forms, const double *restrict tension,
                                                 const double *restrict mean, const double *restrict end, size_t count,
                                                 size_t rows, size_t length, double *restrict tangent) {
    for (size_t s = 0; s < count; s++) {
        const double *own = forms + s * length;
        double *row = tangent + s * rows;
        for (size_t p = 0, first = 0; first < length; p++, first += rows) {
            const double held = tension[p], slope = mean[first + s];
            for (size_t t = 0; t < rows; t++) row[t] -= held * own[first + t] + slope * end[first + t];
        }
    }
}

/* Adds twice the derivative of the forces of a step by the coordinates at its end; at equal ends that of the forces of an
   instant by its coordinates. */
static inline void add_tension_tangent(const Body *body, const Work *work, double *tangent) {
    const Tensions own = tensions_of(body, work);
    double *mean = own.split;
    for (size_t p = 0; p < own.forms; p++) mean[p] = 0.5 * value_of(own.start[p] + own.end[p]);
    for (size_t i = 0; i < own.length; i++) {
        own.end_value[i] = value_of(own.slope_end[i]);
        own.mean_value[i] = 0.5 * (value_of(own.slope_start[i]) + own.end_value[i]);
    }
    subtract_tensions(body->tension_forms, mean, own.mean_value, own.end_value, own.count, own.rows, own.length, tangent);
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
