/* Step sizes by errors, and which steps the energy balance allows. */

#include "step_control.h"

#include <math.h>
#include <string.h>

#define RATIO 1.4142135623730951 /* of neighbouring sizes */
#define REJECTED 3.0             /* error over the allowed one from which a step is rejected */
#define REJECTED_STIRRED 10.0    /* the same right after a change of size */
#define FORGET 0.8
#define GROWTH_MARGIN 0.5
#define LEAST_ERROR 1e-9
enum {
    STIRRED_STEPS = 3,
    STEPS_AFTER_GROWTH = STIRRED_STEPS + 1,
    STEPS_AFTER_SHRINKING = 8,
    MOST_LEVELS = 6,
    MOST_GROWTH = 2,
    STEPS_AFTER_DIVISION = 16,
    PARTS = 4,
    MOST_PARTS = 1024
};
/* Share of all energies: rounding of their sums, and what the tolerance of iterations leaves at rest. */
#define ROUNDED 1e-12
#define LEAST_KINETIC 1e-17 /* J in motion, for steps in which hardly anything moves yet and all is rounding */
#define STEADY 2.0
#define ALLOWANCE 2.0

static ptrdiff_t least(ptrdiff_t a, ptrdiff_t b) { return a < b ? a : b; }
static ptrdiff_t most(ptrdiff_t a, ptrdiff_t b) { return a > b ? a : b; }

double size_now(const StepSizes *s) { return s->largest * pow(RATIO, (double)-s->level); }

static void size_changed(StepSizes *s, ptrdiff_t wait) {
    s->wait = wait;
    s->stirred = STIRRED_STEPS;
    s->worst = 0.0;
}

void restart_sizes(StepSizes *s, double size, int stirred) {
    const double levels = -floor(log(size / s->largest) / log(RATIO) + 1e-9);
    s->level = levels > 0.0 ? (ptrdiff_t)levels : 0;
    size_changed(s, STEPS_AFTER_GROWTH);
    if (!stirred) s->stirred = 0;
}

static void go_down(StepSizes *s, ptrdiff_t levels) {
    s->level += levels;
    size_changed(s, STEPS_AFTER_SHRINKING);
}

int shrink_size(StepSizes *s, double share) {
    go_down(s, 2);
    return size_now(s) >= s->smallest * share;
}

/* Logarithm of the growth of a step's error by one level. */
static double per_level(const StepSizes *s) { return (double)(s->order + 1) * log(RATIO); }

/* Go to larger sizes, where the worst error since the last change leaves room. */
static void grow(StepSizes *s) {
    const ptrdiff_t room = (ptrdiff_t)floor(log(GROWTH_MARGIN / fmax(s->worst, LEAST_ERROR)) / per_level(s));
    if (room < 1 || s->level == 0) return;
    s->level = most(0, s->level - least(room, MOST_GROWTH));
    size_changed(s, STEPS_AFTER_GROWTH);
}

int judge_error(StepSizes *s, double error) {
    const int can_shrink = size_now(s) > 2.0 * s->smallest, is_stirred = s->stirred > 0;
    if (error > (is_stirred ? REJECTED_STIRRED : REJECTED) && can_shrink) {
        const double levels = ceil(log(error) / per_level(s));
        go_down(s, levels < (double)MOST_LEVELS ? most(1, (ptrdiff_t)levels) : MOST_LEVELS);
        return 0;
    }
    s->wait--;
    if (is_stirred) {
        s->stirred--;
        return 1;
    }
    s->worst = fmax(error, FORGET * s->worst);
    if (error > 1.0 && can_shrink) go_down(s, 1);
    else if (s->wait <= 0) grow(s);
    return 1;
}

double share_that_fits(const ErrorLimit *limit, double square) {
    return fmin(1.0, GROWTH_MARGIN / fmax(sqrt(square) / limit->allowed, LEAST_ERROR));
}

static double jump_of(const EnergyGuard *g, const double *energies) {
    return fabs(balance_of(energies) - balance_of(g->last));
}

static double in_motion(const EnergyGuard *g, const double *energies) {
    double largest = g->kinetic;
    for (size_t i = 0; i < ENERGIES; i++) largest = fmax(largest, fabs(energies[i] - g->last[i]));
    return largest;
}

void begin_guard(EnergyGuard *g, const double *energies) {
    memset(g, 0, sizeof *g);
    g->kinetic = LEAST_KINETIC;
    guard_accepts(g, energies);
}

int guard_allows(EnergyGuard *g, const double *energies, double h, double share) {
    const double jump = jump_of(g, energies);
    double all = 0.0, high, low;
    if (jump <= share * g->kinetic) return 1;
    for (size_t i = 0; i < ENERGIES; i++) all += fabs(energies[i]);
    const double known = fmax(fmax(g->power * h, g->rounding), ROUNDED * all);
    if (!(jump > fmax(share * in_motion(g, energies), known))) return 1;
    memmove(g->powers, g->powers + 1, (TRIALS - 1) * sizeof(double));
    g->powers[TRIALS - 1] = jump / h;
    if (g->trials < TRIALS) g->trials++;
    high = low = g->powers[TRIALS - 1];
    for (size_t i = 0; i + 1 < TRIALS; i++) high = fmax(high, g->powers[i]), low = fmin(low, g->powers[i]);
    if (g->trials < TRIALS || !(high < STEADY * low)) return 0;
    g->power = ALLOWANCE * high;
    return 1;
}

void guard_gives_in(EnergyGuard *g, const double *energies) { g->rounding = ALLOWANCE * jump_of(g, energies); }

void guard_accepts(EnergyGuard *g, const double *energies) {
    memcpy(g->last, energies, sizeof g->last);
    g->kinetic = fmax(g->kinetic, energies[KINETIC]);
    g->trials = 0;
}

int divide_step(SubdividedStep *d) {
    d->parts *= PARTS;
    d->made = 0;
    return d->parts <= MOST_PARTS;
}

void step_stood(SubdividedStep *d) {
    d->made++;
    if (d->parts > 1 && d->made >= STEPS_AFTER_DIVISION) {
        d->parts /= 2;
        d->made = 0;
    }
}
