/* Displacements of the ports to second order in the modes: the twin of components/body_parts/ports.py, where the theory
   is told. Part of body.c, of either number type. */

#ifndef FANFOLD_BODY_SECOND_ORDER_H
#define FANFOLD_BODY_SECOND_ORDER_H

#include "body_tension.h"
#include "dense.h"

/* What modal coordinates add to the shapes of the modes of second order: rows of 2 coordinates, at the end of a step and at
   its mean. `some` and `slope` hold a number a mode of second order, `last` the modal coordinates of the last
   iterate. Of Newton's correction: conjugate wrenches and their slopes, by what coordinates change the forces of both,
   a matrix and its pivots. */
typedef struct {
    real *end, *mid, *some, *slope, *last;
    double *wrenches, *slopes, *tension, *slope_tension, *matrix, *split;
    unsigned short *pivots;
    size_t count, length; /* modes of second order; 2 coordinates */
} Pairs;

static inline Pairs pairs_of(const Body *body, const Work *work) {
    const size_t count = body->second_order, length = 2 * body->coordinates;
    Pairs pairs = {.count = count, .length = length};
    real *next = work->pairs;
    pairs.end = taken(&next, count * length);
    pairs.mid = taken(&next, count * length);
    pairs.last = taken(&next, body->padded_modes);
    pairs.wrenches = (double *)taken(&next, length);
    pairs.slopes = (double *)taken(&next, length);
    pairs.some = taken(&next, count);
    pairs.slope = taken(&next, count);
    pairs.tension = (double *)taken(&next, count * count);
    pairs.slope_tension = (double *)taken(&next, count * count);
    pairs.matrix = (double *)taken(&next, count * count);
    pairs.pivots = (unsigned short *)taken(&next, count);
    pairs.split = (double *)next;
    return pairs;
}

/* Of a vector over all modes, those of second order. */
static inline const real *picked(const Body *body, const Pairs *pairs, const real *modes) {
    for (size_t s = 0; s < pairs->count; s++) pairs->some[s] = modes[body->second_place[s]];
    return pairs->some;
}

/* out += factor times the rows' sum with these weights, one a mode. */
static inline void pairs_combined(const Body *body, const Pairs *pairs, const real *rows, const real *modes,
                                  double factor, real *out) {
#ifdef FANFOLD_COMPLEX
    for (size_t s = 0; s < pairs->count; s++) {
        const real weight = factor * modes[body->second_place[s]], *row = rows + s * pairs->length;
        for (size_t i = 0; i < pairs->length; i++) out[i] += weight * row[i];
    }
#else
    rows_combined(rows, pairs->count, pairs->length, picked(body, pairs, modes), pairs->split, NULL);
    for (size_t i = 0; i < pairs->length; i++) out[i] += factor * pairs->split[i];
#endif
}

/* force += scalar products of the rows with wrenches; other_force += those with the others, unless NULL. */
static inline void pairs_projected(const Body *body, const Pairs *pairs, const real *rows, const real *wrenches,
                                   const real *others, real *force, real *other_force) {
#ifdef FANFOLD_COMPLEX
    for (size_t s = 0; s < pairs->count; s++) {
        const real *row = rows + s * pairs->length;
        real sum = 0.0, other = 0.0;
        for (size_t i = 0; i < pairs->length; i++) sum += row[i] * wrenches[i];
        force[body->second_place[s]] += sum;
        if (!others) continue;
        for (size_t i = 0; i < pairs->length; i++) other += row[i] * others[i];
        other_force[body->second_place[s]] += other;
    }
#else
    if (others)
        rows_projected_twice(rows, pairs->count, pairs->length, wrenches, others, pairs->some, pairs->slope, NULL);
    else
        rows_projected(rows, pairs->count, pairs->length, wrenches, pairs->some, NULL);
    for (size_t s = 0; s < pairs->count; s++) {
        force[body->second_place[s]] += pairs->some[s];
        if (others) other_force[body->second_place[s]] += pairs->slope[s];
    }
#endif
}

/* mid = (start + end) / 2. */
FANFOLD_VECTORISED static void averaged(const double *restrict start, const real *restrict end, size_t count,
                                        real *restrict mid) {
    for (size_t i = 0; i < count; i++) mid[i] = 0.5 * (start[i] + end[i]);
}

/* out -= factor (end - start). */
FANFOLD_VECTORISED static void less_growth_of(const double *restrict start, const real *restrict end, size_t count,
                                              real factor, real *restrict out) {
    for (size_t i = 0; i < count; i++) out[i] -= factor * (end[i] - start[i]);
}

/* What eta adds to the shapes, in `end`, and to the deflection. */
static inline void deflect_to_second_order(const Body *body, const real *eta, const Work *work, real *deflection) {
    const Pairs pairs = pairs_of(body, work);
    rows_combined(body->pairs, pairs.count, pairs.count * pairs.length, picked(body, &pairs, eta), pairs.end, pairs.split);
    pairs_combined(body, &pairs, pairs.end, eta, 0.5, deflection);
}

/* Has what `end` holds stand for the whole step. */
static inline void hold_pairs(const Body *body, const Work *work) {
    const Pairs pairs = pairs_of(body, work);
    memcpy(pairs.mid, pairs.end, pairs.count * pairs.length * sizeof(real));
}

/* Sets `mid` to the mean of the start of a step and its end, and takes the turns (coordinates) of the ports from the mean
   of both ends to those at the mean modal coordinates. */
static inline void average_pairs(const Body *body, const Work *work, real *turns) {
    const Pairs pairs = pairs_of(body, work);
    const double *start = body->at_start.pairs;
    averaged(start, pairs.end, pairs.count * pairs.length, pairs.mid);
    for (size_t s = 0; s < pairs.count; s++) {
        const size_t place = body->second_place[s], row = s * pairs.length + body->coordinates;
        const real grown = 0.125 * (work->eta[place] - work->eta_start[place]);
        less_growth_of(start + row, pairs.end + row, body->coordinates, grown, turns);
    }
}

/* By what modal coordinates change the forces of the conjugate wrenches and of their slopes. */
static inline void tensions(const Body *body, int sloped, const Work *work, const Pairs *pairs) {
    for (size_t i = 0; i < pairs->length; i++) {
        pairs->wrenches[i] = value_of(work->wrenches[i]);
        pairs->slopes[i] = sloped ? value_of(work->slope_wrenches[i]) : 0.0;
    }
    rows_projected_twice_double(body->pairs, pairs->count * pairs->count, pairs->length, pairs->wrenches, pairs->slopes,
                                pairs->tension, pairs->slope_tension);
}

/* Newton's matrix, factorised: of what a correction of the coordinates makes of itself. */
static inline void factorise_response(const Body *body, const double *gain, const double *slope_gain, double share,
                                      const Work *work, const Pairs *pairs) {
    const size_t count = pairs->count;
    tensions(body, slope_gain != NULL, work, pairs);
    if (body->forms) {
        const Tensions own = tensions_of(body, work);
        curvature_at_end(body, &own, pairs->matrix);
        for (size_t i = 0; i < count * count; i++) pairs->tension[i] -= pairs->matrix[i];
    }
    for (size_t s = 0; s < count; s++) {
        const size_t place = body->second_place[s];
        const double own = share * gain[place], sloped = slope_gain ? share * slope_gain[place] : 0.0;
        const double *tension = pairs->tension + s * count, *changing = pairs->slope_tension + s * count;
        for (size_t t = 0; t < count; t++)
            pairs->matrix[s * count + t] = (s == t) - own * tension[t] - sloped * changing[t];
    }
    factorise_dense(pairs->matrix, count, pairs->pivots);
}

/* Newton's correction: takes forces and slopes on to those at the coordinates that they make. So far they make `eta`, where
   they were computed at `last`; gains: what a unit of either moves a mode; share: of the change of the coordinates that
   forces see. Without slopes slope_gain is NULL. anew: or by the matrix of the iterate before, which changes little. */
static inline void correct_forces(const Body *body, const double *gain, const double *slope_gain, double share, int anew,
                                  const Work *work, real *force, real *slope) {
    const Pairs pairs = pairs_of(body, work);
    const size_t count = pairs.count;
    if (anew) factorise_response(body, gain, slope_gain, share, work, &pairs);
    for (size_t s = 0; s < count; s++) {
        const size_t place = body->second_place[s];
        pairs.some[s] = work->eta[place] - pairs.last[place];
    }
    solve_dense(pairs.matrix, count, pairs.pivots, (double *)pairs.some, sizeof(real) / sizeof(double));
    for (size_t s = 0; s < count; s++) {
        const double *tension = pairs.tension + s * count, *changing = pairs.slope_tension + s * count;
        real gained = 0.0, grown = 0.0;
        for (size_t t = 0; t < count; t++) gained += tension[t] * pairs.some[t];
        force[body->second_place[s]] += share * gained;
        if (!slope_gain) continue;
        for (size_t t = 0; t < count; t++) grown += changing[t] * pairs.some[t];
        slope[body->second_place[s]] += share * grown;
    }
}

/* The same over a step of a body whose bending stretches it, whose forces depend on first moments of the rates as well. */
static inline void correct_stretching_forces(const Body *body, const Propagator *prop, int sloped, const Work *work,
                                             real *force, real *slope) {
    const Pairs pairs = pairs_of(body, work);
    const Tensions own = tensions_of(body, work);
    const size_t n = own.count, size = 2 * n;
    double *by_end = pairs.tension, *slope_by_end = pairs.slope_tension;
    tensions(body, sloped, work, &pairs);
    curvature_at_end(body, &own, pairs.matrix);
    divided_curvature(body, &own);
    for (size_t i = 0; i < n * n; i++) {
        by_end[i] = 0.5 * by_end[i] - (1.0 / 3.0) * own.by_moment[i] - (1.0 / 6.0) * pairs.matrix[i];
        slope_by_end[i] = 0.5 * (slope_by_end[i] - pairs.matrix[i]);
        own.by_moment[i] *= 0.5;
    }
    for (size_t s = 0; s < n; s++) {
        const size_t place = body->second_place[s];
        const double b = prop->b1[place], c = prop->c1[place], d = prop->d[place];
        double *upper = own.matrix + s * size, *lower = own.matrix + (n + s) * size;
        for (size_t t = 0; t < n; t++) {
            const size_t i = s * n + t;
            upper[t] = (s == t) - b * by_end[i] - c * slope_by_end[i];
            upper[n + t] = -b * own.by_moment[i];
            lower[t] = c * by_end[i] - d * slope_by_end[i];
            lower[n + t] = (s == t) + c * own.by_moment[i];
        }
        own.residual[s] = work->eta[place] - pairs.last[place];
        own.residual[n + s] = work->moment[place] - own.moment[s];
    }
    factorise_dense(own.matrix, size, own.pivots);
    solve_dense(own.matrix, size, own.pivots, (double *)own.residual, sizeof(real) / sizeof(double));
    for (size_t s = 0; s < n; s++)
        for (size_t t = 0; t < n; t++) {
            const size_t i = s * n + t, place = body->second_place[s];
            force[place] += by_end[i] * own.residual[t] + own.by_moment[i] * own.residual[n + t];
            slope[place] += slope_by_end[i] * own.residual[t];
        }
}

/* Sum of the squares of what an iteration changed values by. */
FANFOLD_VECTORISED static double squared_change(const real *last, const real *next, size_t count) {
    double sums[FANFOLD_LANES] = {0.0};
    for (size_t j = 0; j < count; j += FANFOLD_LANES)
        for (size_t k = 0; k < FANFOLD_LANES; k++) {
            const double moved = value_of(next[j + k]) - value_of(last[j + k]);
            sums[k] += moved * moved;
        }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* By how much an iteration deflected the body, as the angle (rad) whose turn moves its mass as far. */
static inline double modal_change(const Body *body, const Work *work) {
    return sqrt(squared_change(pairs_of(body, work).last, work->eta, body->padded_modes)) / body->turning;
}

/* Whether the next iteration would change them by less: by as much less than this one as this did than the one before. */
static inline int settled(double change, double before, double tolerance) {
    return change <= tolerance || change * change <= tolerance * before;
}

#endif
