/* Exact propagation of independent damped oscillators under a force linear in time: the twin of
   components/numerics/oscillators.py. Each mode obeys eta'' + 2 zeta w eta' + w^2 eta = Q + S P1, P1 = 2 t / h - 1.

   Plain doubles: step size and damping carry no derivative, so both number types share the propagators. */

#ifndef FANFOLD_OSCILLATORS_H
#define FANFOLD_OSCILLATORS_H

#include <math.h>
#include <stddef.h>

#include "kernel.h"

/* Step sizes remembered, because a run reuses few. */
#define FANFOLD_STEP_SIZES 32
#define FANFOLD_PROPAGATOR 14
#define FANFOLD_SERIES 32

/* Transition over one step size, one number a mode:
       eta1 = a11 eta0 + a12 v0 + b1 Q + c1 S,   v1 = a21 eta0 + a22 v0 + a12 Q + c2 S,
       integral of P1 v dt = -c1 (Q - w^2 eta0) - c2 v0 + d S,
       dissipated = w11 z^2 + w12 z v0 + w22 v0^2 + S (s1 z + s2 v0 + s3 S) with z = eta0 - compliance Q. */
typedef struct {
    double h;
    double *a11, *a12, *a21, *a22, *b1, *w11, *w12, *w22, *c1, *c2, *d, *s1, *s2, *s3;
} Propagator;

typedef struct {
    size_t modes;
    double *frequency;     /* rad/s, positive */
    double *damping_ratio; /* of critical, not negative */
    double *compliance;    /* 1 / frequency^2 */
    size_t known, latest;
    Propagator propagators[FANFOLD_STEP_SIZES];
} Oscillators;

#ifndef FANFOLD_COMPLEX

/* A propagator whose arrays of `modes` numbers lie one after the other. */
static Propagator propagator_at(double *next, size_t modes) {
    Propagator made = {.h = 0.0};
    double **const arrays[FANFOLD_PROPAGATOR] = {
        &made.a11, &made.a12, &made.a21, &made.a22, &made.b1, &made.w11, &made.w12,
        &made.w22, &made.c1,  &made.c2,  &made.d,   &made.s1, &made.s2,  &made.s3,
    };
    for (size_t i = 0; i < FANFOLD_PROPAGATOR; i++) *arrays[i] = next + i * modes;
    return made;
}

/* Memory for `modes` oscillators; all are undamped of frequency 1 until they are given values. */
static int oscillators_allocate(Oscillators *all, size_t modes, Memory *memory) {
    const size_t arrays = 3 + FANFOLD_PROPAGATOR * FANFOLD_STEP_SIZES;
    double *next = allocate(memory, arrays * modes * sizeof(double));
    if (!next) return 0;
    all->modes = modes;
    all->frequency = next;
    all->damping_ratio = next + modes;
    all->compliance = next + 2 * modes;
    next += 3 * modes;
    for (size_t i = 0; i < FANFOLD_STEP_SIZES; i++, next += FANFOLD_PROPAGATOR * modes)
        all->propagators[i] = propagator_at(next, modes);
    for (size_t j = 0; j < modes; j++) all->frequency[j] = all->compliance[j] = 1.0;
    return 1;
}

/* To be called when a damping ratio has changed. */
static void oscillators_forget(Oscillators *all) { all->known = all->latest = 0; }

#endif

/* Quadratic form of the energy 2 zeta w int v^2 dt over a step, of mode j.

   With the scaled state y = (w z, v) and y' = A y the Gramian G = int E^T e e^T E dt, e = (0, 1), solves
   A^T G + G A = E(h)^T e e^T E(h) - e e^T, with (-w s, a22) the second row of E: solved by elimination. */
static inline void propagator_dissipation(Propagator *made, size_t j, double w, double zeta) {
    double first = -w * made->a12[j], second = made->a22[j];
    double r0 = first * first, r1 = first * second;
    double w22 = zeta > 0.0 ? 0.5 * (1.0 - second * second - r0) : 0.0;
    made->w11[j] = w * w * (2.0 * zeta * (r1 - zeta * r0) + w22);
    made->w12[j] = -2.0 * zeta * w * r0;
    made->w22[j] = w22;
}

/* What a slope S adds to the energy dissipated, S (s1 z + s2 v0 + s3 S), of mode j: its work less the energy it brings. */
static inline void propagator_slope_dissipation(Propagator *made, size_t j, double w, double zeta) {
    double c1 = made->c1[j], c2 = made->c2[j], s = made->a12[j], square = w * w;
    made->s1[j] = made->s2[j] = made->s3[j] = 0.0;
    if (!(zeta > 0.0)) return;
    made->s1[j] = square * (square * made->b1[j] * c1 + s * c2);
    made->s2[j] = -(1.0 + made->a22[j]) * c2 - square * s * c1;
    made->s3[j] = made->d[j] - 0.5 * (c2 * c2 + square * c1 * c1);
}

/* c1 / h^2, c2 / h and d / h^2 as series of the derivatives of the response to an impulse:
   y(n+2) = first y(n+1) + second y(n). */
static inline void slope_series(double first, double second, double found[3]) {
    double before = 0.0, now = 1.0, factorial = 2.0, term = 0.0, last = 1.0; /* (n + 2)! */
    found[0] = found[1] = found[2] = 0.0;
    for (int n = 0; n < FANFOLD_SERIES && (n < 4 || fabs(term) + fabs(last) > 1e-18 * fabs(found[2])); n++) {
        double next = first * now + second * before;
        last = term, term = now / factorial;
        found[0] -= term * (n + 1) / (n + 3);
        found[1] -= term * n;
        found[2] -= term * n / (n + 4);
        before = now, now = next, factorial *= n + 3;
    }
}

/* The same of a response exp(z t / h), z negative. */
static inline void slope_of_exponential(double z, double found[3]) {
    if (z < -1.0) {
        double phi1 = expm1(z) / z, phi2 = (phi1 - 1.0) / z, phi3 = (phi2 - 0.5) / z;
        found[0] = 2.0 * phi2 - phi1;
        found[1] = 2.0 * phi1 - exp(z);
        found[2] = 4.0 * phi2 - 4.0 * phi3 - phi1;
        return;
    }
    double power = 1.0; /* z^n / (n + 1)! */
    found[0] = found[1] = found[2] = 0.0;
    for (int n = 0; n < FANFOLD_SERIES; n++) {
        found[0] -= power * n / (n + 2);
        found[1] += power * (1 - n);
        found[2] -= power * (n * n + n - 2) / ((n + 2) * (n + 3));
        power *= z / (n + 2);
    }
}

/* What a slope does to mode j over a step h. With g(k) the k-fold integral of the response to an impulse, of size
   one, c1 / h^2 = 2 g2 - g1, c2 / h = 2 g1 - g0, d / h^2 = 4 g2 - 4 g3 - g1: series where these differences are small,
   the recurrence of g(k) where it is stable, and a difference of both roots far above critical damping. */
static inline void propagator_slopes(Propagator *made, size_t j, double w, double zeta, double h) {
    double found[3], angle = w * h;
    if (fmax(zeta, 1.0) * angle < 2.0) {
        slope_series(-2.0 * zeta * angle, -angle * angle, found);
    } else if (zeta >= 2.0) {
        double root = sqrt((zeta - 1.0) * (zeta + 1.0)), slow = -angle / (zeta + root), fast = -angle * (zeta + root);
        double other[3];
        slope_of_exponential(slow, found);
        slope_of_exponential(fast, other);
        for (int i = 0; i < 3; i++) found[i] = (found[i] - other[i]) / (slow - fast);
    } else {
        double g0 = made->a12[j] / h, g1 = made->b1[j] / (h * h);
        double g2 = (1.0 - 2.0 * zeta * angle * g1 - g0) / (angle * angle);
        double g3 = (0.5 - 2.0 * zeta * angle * g2 - g1) / (angle * angle);
        found[0] = 2.0 * g2 - g1;
        found[1] = 2.0 * g1 - g0;
        found[2] = 4.0 * g2 - 4.0 * g3 - g1;
    }
    made->c1[j] = found[0] * (h * h);
    made->c2[j] = found[1] * h;
    made->d[j] = found[2] * (h * h);
    propagator_slope_dissipation(made, j, w, zeta);
}

/* Mode j over a step h: the exponential of a 2x2 companion matrix without differences of nearly equal
   numbers, by the slower root, or by the real part of both where they are complex. Modes far above critical
   damping keep the accuracy of the others. */
static inline void propagator_mode(Propagator *made, size_t j, double w, double zeta, double h) {
    int over = zeta >= 1.0;
    double root = sqrt(fabs((zeta - 1.0) * (zeta + 1.0))), gap = 2.0 * w * root;
    double rate = over ? w / (zeta + root) : zeta * w;
    double envelope = exp(-rate * h), swing = over ? 0.0 : envelope * cos(0.5 * gap * h);
    double first = over ? envelope : swing, second = over ? envelope * exp(-gap * h) : swing;
    double loss = over ? -expm1(-rate * h) : 1.0 - swing;
    double s = envelope * (gap > 0.0 ? (over ? -expm1(-gap * h) : 2.0 * sin(0.5 * gap * h)) / gap : h);
    double angle = w * h;
    double series = h * h * (0.5 - zeta * angle / 3.0 + (4.0 * zeta * zeta - 1.0) * angle * angle / 24.0);
    made->a11[j] = first + rate * s;
    made->a12[j] = s;
    made->a21[j] = -w * w * s;
    made->a22[j] = second - rate * s;
    made->b1[j] = fmax(zeta, 1.0) * angle < 1e-3 ? series : (loss - rate * s) / (w * w);
    propagator_dissipation(made, j, w, zeta);
    propagator_slopes(made, j, w, zeta, h);
}

/* The propagator of step size h > 0; makes it when it is not remembered. */
static inline const Propagator *oscillators_propagator(Oscillators *all, double h) {
    if (all->known && all->propagators[all->latest].h == h) return &all->propagators[all->latest];
    for (size_t i = 0; i < all->known; i++)
        if (all->propagators[i].h == h) return &all->propagators[all->latest = i];
    if (all->known == FANFOLD_STEP_SIZES) all->known = 0; /* too many step sizes: start anew */
    all->latest = all->known++;
    Propagator *made = &all->propagators[all->latest];
    made->h = h;
    for (size_t j = 0; j < all->modes; j++)
        propagator_mode(made, j, all->frequency[j], all->damping_ratio[j], h);
    return made;
}

#endif
