/* Scalar force laws that have a potential, and their exact mean over a step: the twin of
   components/numerics/laws.py.

   A law gives the generalised force -V'(s) and the potential V(s) of one coordinate s. */

#ifndef FANFOLD_LAWS_H
#define FANFOLD_LAWS_H

#include <stdio.h>
#include <string.h>

#include "kernel.h"
#include "real.h"
#include "scheme.h"

typedef enum { SPRING_LAW, STRAND_LAW, TABLE_LAW } LawKind;

/* A spring with a constant force beside it, a strand that only pulls (each with its stiffness and the coordinate where
   it is free), or a piecewise cubic table: coefficients per piece, highest power first, 4 of the force and 5 of the potential. */
typedef struct Law {
    LawKind kind;
    double stiffness, free, constant;
    size_t pieces;
    const double *breaks, *force, *potential;
} Law;

static inline Law spring_law(double stiffness, double free) {
    return (Law){SPRING_LAW, stiffness, free, 0.0, 0, NULL, NULL, NULL};
}

static inline Law strand_law(double stiffness, double preload) {
    return (Law){STRAND_LAW, stiffness, -(preload / stiffness), 0.0, 0, NULL, NULL, NULL};
}

/* The piece of a table that holds s; the first and the last reach to infinity, NaN falls into the last. */
static inline size_t table_piece(const Law *law, double s) {
    size_t low = 0, high = law->pieces - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (s < law->breaks[middle + 1])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Force at s. */
static inline real law_value(const Law *law, real s) {
    if (law->kind == TABLE_LAW) {
        size_t piece = table_piece(law, value_of(s));
        const double *c = law->force + 4 * piece;
        real t = s - law->breaks[piece];
        return ((c[0] * t + c[1]) * t + c[2]) * t + c[3];
    }
    real stretch = s - law->free;
    if (law->kind == STRAND_LAW && !(value_of(stretch) > 0.0)) return 0.0;
    return law->constant - law->stiffness * stretch;
}

/* Energy at s; of a table, zero at an arbitrary point. */
static inline real law_potential(const Law *law, real s) {
    if (law->kind == TABLE_LAW) {
        size_t piece = table_piece(law, value_of(s));
        const double *c = law->potential + 5 * piece;
        real t = s - law->breaks[piece];
        return (((c[0] * t + c[1]) * t + c[2]) * t + c[3]) * t + c[4];
    }
    real stretch = s - law->free;
    if (law->kind == STRAND_LAW && !(value_of(stretch) > 0.0)) return 0.0;
    return (0.5 * law->stiffness * stretch - law->constant) * stretch;
}

/* Whether the law is one cubic between two coordinates. */
static inline int law_is_cubic_between(const Law *law, double s0, double s1) {
    if (law->kind == TABLE_LAW) return table_piece(law, s0) == table_piece(law, s1);
    return law->kind == SPRING_LAW || (s0 > law->free) == (s1 > law->free);
}

/* Mean force between the coordinates at both ends of a step: the discrete gradient, and the force at the middle
   where the difference is too small to divide by. */
static inline real law_mean_force(const Law *law, real s0, real s1) {
    real change = s1 - s0;
    if (!(fabs(value_of(change)) > LEAST_CHANGE)) return law_value(law, 0.5 * (s0 + s1));
#ifdef FANFOLD_COMPLEX
    /* the quotient loses digits, and its slope twice as many; Simpson's rule is the same mean of a cubic */
    if (law_is_cubic_between(law, value_of(s0), value_of(s1)))
        return (law_value(law, s0) + 4.0 * law_value(law, 0.5 * (s0 + s1)) + law_value(law, s1)) / 6.0;
#endif
    return (law_potential(law, s0) - law_potential(law, s1)) / change;
}

static inline real above(real a, double limit) {
    if (value_of(a) > limit) return a;
    return limit;
}

static inline real clamped(const double range[2], real s) {
    if (value_of(s) > range[1]) return range[1];
    return above(s, range[0]);
}

/* Share of the way between two coordinates that lies outside of a play; all of it where there is none. */
static inline real share_beyond(const double play[2], real s0, real s1) {
    const real change = s1 - s0, within = clamped(play, s1) - clamped(play, s0);
    if (play[0] == play[1]) return 1.0;
    if (value_of(change) != 0.0 && value_of(within) != value_of(change)) return 1.0 - within / change;
    const double middle = value_of(0.5 * (s0 + s1));
    return play[0] < middle && middle < play[1] ? 0.0 : 1.0;
}

/* Share of the way between two elongations on which a strand is taut. */
static inline real taut_share(const Law *strand, real s0, real s1) {
    double slack = strand->free;
    int taut0 = value_of(s0) > slack, taut1 = value_of(s1) > slack;
    if (taut0 && taut1) return 1.0;
    if (!taut0 && !taut1) return 0.0;
    return (above(s1, slack) - above(s0, slack)) / (s1 - s0);
}

/* Minus the mean slope of a table's force between two coordinates, at one where they are too close to divide by;
   of one piece without a difference of forces. */
static inline real table_tangent(const Law *table, real s0, real s1) {
    size_t piece = table_piece(table, value_of(s0));
    if (piece != table_piece(table, value_of(s1))) {
        if (fabs(value_of(s1 - s0)) > LEAST_CHANGE) return (law_value(table, s0) - law_value(table, s1)) / (s1 - s0);
        s0 = s1 = 0.5 * (s0 + s1);
        piece = table_piece(table, value_of(s0));
    }
    const double *c = table->force + 4 * piece;
    real t0 = s0 - table->breaks[piece], t1 = s1 - table->breaks[piece];
    return -(c[0] * (t0 * t0 + t0 * t1 + t1 * t1) + c[1] * (t0 + t1) + c[2]);
}

/* Divided difference of V' between two coordinates, V'' where they are one. */
static inline real law_tangent(const Law *law, real s0, real s1) {
    if (law->kind == TABLE_LAW) return table_tangent(law, s0, s1);
    if (law->kind == STRAND_LAW) return law->stiffness * taut_share(law, s0, s1);
    return law->stiffness;
}

/* STEP: s^2 (3 - 2 s) from 0 to 1, constant before and after. */
static inline real cubic_step(real s) {
    if (!(value_of(s) > 0.0)) return 0.0;
    return value_of(s) >= 1.0 ? 1.0 : s * s * (3.0 - 2.0 * s);
}

/* Factors on dynamic Coulomb friction and on a constant friction torque. */
typedef struct StictionFactors {
    real dynamic, constant;
} StictionFactors;

/* Factor on dynamic Coulomb friction: static up to a rate, falling smoothly to 1 at 1.5 times that. */
static inline real static_factor(real rate, double transition, double static_ratio) {
    return static_ratio + (1.0 - static_ratio) * cubic_step(2.0 * (real_abs(rate) / transition - 1.0));
}

/* Signed factors at a sliding rate. Rises smoothly to the static value at the stiction transition velocity,
   falls to the dynamic one between 1 and 1.5 times it; the second factor stays at 1 beyond the transition. */
static inline StictionFactors stiction_factors(real rate, double transition, double static_ratio) {
    real ratio = real_abs(rate) / transition, constant = 1.0;
    if (value_of(ratio) < 1.0) constant = ratio * (1.5 - 0.5 * ratio * ratio);
    real dynamic = static_factor(rate, transition, static_ratio) * constant;
    if (value_of(rate) >= 0.0) return (StictionFactors){dynamic, constant};
    return (StictionFactors){-dynamic, -constant};
}

#ifndef FANFOLD_COMPLEX

/* A copy of the finite numbers `<table>_<part>`; NULL and a sentence when they are not `count` finite numbers. */
static inline const double *read_table_part(const Data *data, Memory *memory, const char *table, const char *part,
                                            size_t count, Reason *why) {
    char name[64];
    snprintf(name, sizeof name, "%s_%s", table, part);
    const double *values = data_array(data, name, count, why);
    if (!values) return NULL;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i])) {
            refuse(why, "%s contains %g; it must contain finite numbers", name, values[i]);
            return NULL;
        }
    double *copy = allocate(memory, count * sizeof(double));
    if (!copy) {
        refuse(why, "there is no memory for %s", name);
        return NULL;
    }
    return memcpy(copy, values, count * sizeof(double));
}

/* The table whose arrays are `<table>_breaks`, `<table>_force` and `<table>_potential`. */
static inline int read_table(const Data *data, Memory *memory, const char *table, Law *law, Reason *why) {
    char name[64];
    size_t count;
    snprintf(name, sizeof name, "%s_breaks", table);
    if (!data_any(data, name, &count, why)) return 0;
    if (count < 2 || count > 1000000) return refuse(why, "%s has %zu numbers; it must have 2 to 1000000", name, count);
    law->kind = TABLE_LAW;
    law->pieces = count - 1;
    law->breaks = read_table_part(data, memory, table, "breaks", count, why);
    if (!law->breaks) return 0;
    for (size_t i = 0; i < law->pieces; i++)
        if (!(law->breaks[i + 1] > law->breaks[i])) return refuse(why, "the numbers of %s must increase", name);
    law->force = read_table_part(data, memory, table, "force", 4 * law->pieces, why);
    if (!law->force) return 0;
    law->potential = read_table_part(data, memory, table, "potential", 5 * law->pieces, why);
    return law->potential != NULL;
}

#endif
#endif
