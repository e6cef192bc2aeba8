/* Means over a step belong to its middle; this brings them to the communication point at its end: the twin of
   components/numerics/interval_mean.py, which says why. */

#ifndef FANFOLD_MID_STEP_H
#define FANFOLD_MID_STEP_H

#include "real.h"
#include "scheme.h"

/* Mean over a step, its slope, half the change over the step as far as it is known, and the size of the step. */
typedef struct StepMean {
    double mean, slope, h;
} StepMean;

/* Value at the end of the last of two steps; the mean with its slope where there is but one, or it is an instant. What
   slopes tell goes on as a parabola, and what they do not know of the change of means along a line; after a longer step,
   no more than the gap between the lines of both. */
static inline double extrapolated(StepMean last, StepMean previous) {
    if (last.h <= INSTANT || previous.h <= 0.0) return last.mean + last.slope;
    const double between = 0.5 * (last.h + previous.h);
    const double rate = last.slope * (2.0 / last.h), rate_before = previous.slope * (2.0 / previous.h);
    const double bend = (rate - rate_before) / between;
    const double known =
        0.5 * between * (rate + rate_before) + bend * (last.h * last.h - previous.h * previous.h) / 24.0;
    const double gap = fabs((last.mean - last.slope) - (previous.mean + previous.slope));
    double unknown = last.mean - previous.mean - known;
    if (last.h < previous.h) unknown = fmin(fmax(unknown, -gap), gap);
    return last.mean + last.slope + bend * (last.h * last.h / 12.0) + unknown * (0.5 * last.h / between);
}

/* Value at the communication point between two steps whose sizes are above 0, exact for a cubic. */
static inline double between(StepMean before, StepMean after) {
    const double a = before.h, b = after.h, whole = a + b;
    const double means = b * b * (b + 3.0 * a) * before.mean + a * a * (a + 3.0 * b) * after.mean;
    const double slopes = b * b * (5.0 * a + 3.0 * b) * before.slope - a * a * (3.0 * a + 5.0 * b) * after.slope;
    return (means + slopes * (1.0 / 3.0)) * (1.0 / (whole * whole * whole));
}

/* Means over the last two steps, then the sizes of both, 0 where there is none. */
enum { MID_STEP_SIZE = 4 };

/* Value at the communication point, on the line through both means; the last mean where a step is missing or an
   instant. */
static inline double mid_step_now(const double means[MID_STEP_SIZE]) {
    if (means[2] <= INSTANT || means[3] == 0.0) return means[0];
    return means[0] + (means[0] - means[1]) * (means[2] / (means[2] + means[3]));
}

/* Before the first step, or after an impulse: only an instant's value is known. */
static inline void store_mid_step_start(real value, real *means) {
    means[0] = means[1] = value;
    means[2] = means[3] = 0.0;
}

/* With one step more. */
static inline void store_mid_step_after(const double *old, real mean, double h, real *means) {
    means[0] = mean;
    means[1] = old[0];
    means[2] = h;
    means[3] = old[2];
}

/* Load of a stiff coordinate at the communication point, from that of its law at the end of the last step. */
static inline double load_now(const double means[MID_STEP_SIZE], double at_end, double roughness) {
    if (means[2] <= 0.0) return at_end;
    const double square = roughness * roughness;
    return at_end + square / (square + ROUGH * ROUGH) * (mid_step_now(means) - at_end);
}

/* Mean, slope and size of the last step, then of the one before; sizes 0 where there is none. */
enum { MID_STEP_SLOPE_SIZE = 6 };

/* Value at the communication point. */
static inline double mid_step_slope_now(const double *x) {
    return extrapolated((StepMean){x[0], x[1], x[2]}, (StepMean){x[3], x[4], x[5]});
}

/* Value at the communication point before the last step; zero without two steps. */
static inline double mid_step_slope_before(const double *x) {
    if (x[2] <= 0.0 || x[5] <= 0.0) return 0.0;
    return between((StepMean){x[3], x[4], x[5]}, (StepMean){x[0], x[1], x[2]});
}

/* Load of a stiff coordinate at the communication point, as `load_now`. */
static inline double load_with_slopes_now(const double *x, double at_end, double roughness) {
    return load_now((const double[MID_STEP_SIZE]){x[0], x[3], x[2], x[5]}, at_end, roughness);
}

/* Before the first step, or after an impulse: only an instant's value is known. */
static inline void store_mid_step_slope_start(real value, real *x) {
    x[0] = x[3] = value;
    x[1] = x[2] = x[4] = x[5] = 0.0;
}

/* With one step more. */
static inline void store_mid_step_slope_after(const double *old, real mean, real slope, double h, real *x) {
    x[0] = mean;
    x[1] = slope;
    x[2] = h;
    for (int i = 0; i < 3; i++) x[3 + i] = old[i];
}

#endif
