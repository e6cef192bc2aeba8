/* Exact propagation of independent damped oscillators under a held force: the twin of
   components/numerics/oscillators.py. Each mode obeys eta'' + 2 zeta w eta' + w^2 eta = Q, Q constant over the step.

   Plain doubles: step size and damping carry no derivative, so both number types share the propagators. */

#ifndef FANFOLD_OSCILLATORS_H
#define FANFOLD_OSCILLATORS_H

#include <math.h>
#include <stddef.h>

#include "kernel.h"

/* Step sizes remembered, because a run reuses few. */
#define FANFOLD_STEP_SIZES 32

/* Transition over one step size, one number a mode:
       eta1 = a11 eta0 + a12 v0 + b1 Q,   v1 = a21 eta0 + a22 v0 + a12 Q,
       dissipated = w11 z^2 + w12 z v0 + w22 v0^2 with z = eta0 - compliance Q. */
typedef struct {
    double h;
    double *a11, *a12, *a21, *a22, *b1, *w11, *w12, *w22;
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

/* Memory for `modes` oscillators; all are undamped of frequency 1 until they are given values. */
static int oscillators_allocate(Oscillators *all, size_t modes, Memory *memory) {
    const size_t arrays = 3 + 8 * FANFOLD_STEP_SIZES;
    double *next = allocate(memory, arrays * modes * sizeof(double));
    if (!next) return 0;
    all->modes = modes;
    all->frequency = next;
    all->damping_ratio = next + modes;
    all->compliance = next + 2 * modes;
    next += 3 * modes;
    for (size_t i = 0; i < FANFOLD_STEP_SIZES; i++, next += 8 * modes)
        all->propagators[i] = (Propagator){0.0,
                                           next,
                                           next + modes,
                                           next + 2 * modes,
                                           next + 3 * modes,
                                           next + 4 * modes,
                                           next + 5 * modes,
                                           next + 6 * modes,
                                           next + 7 * modes};
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
