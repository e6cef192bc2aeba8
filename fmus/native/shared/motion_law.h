/* Motion laws: a number over time in pieces, with the times where one ends and the next begins: the twin of
   components/numerics/motion_law.py. */

#ifndef FANFOLD_MOTION_LAW_H
#define FANFOLD_MOTION_LAW_H

#include <stdio.h>

#include "frames.h"
#include "laws.h"
#include "scheme.h"

enum { LAW_COEFFICIENTS = 6, LAW_SINE = 6 };

#define LAW_REACHED 1e-9 /* distance (s) from a break that sums of step sizes may leave */

/* Breaks; coefficients of the pieces, one more than breaks, by rising power of the time since a piece began, the first
   of which counts from zero; sines: amplitude, angular frequency, reference time, phase, from when, until when. */
typedef struct MotionLaw {
    size_t breaks, sines;
    const double *time, *coefficients, *sine;
} MotionLaw;

/* Number of breaks up to a time. */
static inline size_t law_breaks_before(const MotionLaw *law, double time) {
    size_t low = 0, high = law->breaks;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (law->time[middle] <= time)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The sines at a time, or a derivative of them. */
static inline real law_waves(const MotionLaw *law, real time, int order) {
    real sum = 0.0;
    for (size_t i = 0; i < law->sines; i++) {
        const double *s = law->sine + LAW_SINE * i;
        if (!(s[4] <= value_of(time) && value_of(time) < s[5])) continue;
        real value = s[0] * real_sin(s[1] * (time - s[2]) + s[3] + 0.5 * FANFOLD_PI * order);
        for (int k = 0; k < order; k++) value *= s[1];
        sum += value;
    }
    return sum;
}

/* Time since the piece of a time began, and its coefficients. */
static inline real time_in_piece(const MotionLaw *law, real time, const double **coefficients) {
    const size_t piece = law_breaks_before(law, value_of(time));
    *coefficients = law->coefficients + LAW_COEFFICIENTS * piece;
    return time - (piece ? law->time[piece - 1] : 0.0);
}

static inline real motion_value(const MotionLaw *law, real time) {
    const double *c;
    const real t = time_in_piece(law, time, &c);
    return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5])))) + law_waves(law, time, 0);
}

/* At a break that of what follows. */
static inline real motion_rate(const MotionLaw *law, real time) {
    const double *c;
    const real t = time_in_piece(law, time, &c);
    return c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5]))) + law_waves(law, time, 1);
}

/* The second derivative, at a break that of what follows. */
static inline real motion_acceleration(const MotionLaw *law, real time) {
    const double *c;
    const real t = time_in_piece(law, time, &c);
    return 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5])) + law_waves(law, time, 2);
}

/* Values at the three points of Gauss' rule between two times. */
static inline void motion_samples(const MotionLaw *law, double start, double end, double samples[3]) {
    const double middle = 0.5 * (start + end), arm = 0.5 * sqrt(0.6) * (end - start);
    samples[0] = value_of(motion_value(law, middle - arm));
    samples[1] = value_of(motion_value(law, middle));
    samples[2] = value_of(motion_value(law, middle + arm));
}

/* First moment of the rate. */
static inline double motion_rate_moment(const MotionLaw *law, double start, double end) {
    if (start == end) return 0.0;
    double at[3];
    motion_samples(law, start, end, at);
    const double mean = (5.0 * at[0] + 8.0 * at[1] + 5.0 * at[2]) / 18.0;
    return value_of(motion_value(law, start) + motion_value(law, end)) - 2.0 * mean;
}

/* Time to the next break. */
static inline real motion_time_to_break(const MotionLaw *law, real time) {
    const size_t next = law_breaks_before(law, value_of(time) + LAW_REACHED);
    if (next < law->breaks) return law->time[next] - time;
    return NEVER;
}

#ifndef FANFOLD_COMPLEX

/* The same as kernels tell it; a clock that stands still comes to none. */
static inline double motion_break(const MotionLaw *law, double clock, int stands) {
    const double left = motion_time_to_break(law, clock);
    return stands || left >= NEVER ? INFINITY : left;
}

/* The tables `<name>_breaks`, `<name>_coefficients` and `<name>_sines`. */
static inline int read_motion_law(const Data *data, Memory *memory, const char *name, MotionLaw *law, Reason *why) {
    char key[64];
    snprintf(key, sizeof key, "%s_breaks", name);
    if (!data_any(data, key, &law->breaks, why)) return 0;
    snprintf(key, sizeof key, "%s_sines", name);
    if (!data_any(data, key, &law->sines, why)) return 0;
    if (law->breaks > 1000000 || law->sines > 1000000 || law->sines % LAW_SINE)
        return refuse(why, "%s has %zu breaks and %zu numbers of sines", name, law->breaks, law->sines);
    law->time = read_table_part(data, memory, name, "breaks", law->breaks, why);
    law->sine = law->time ? read_table_part(data, memory, name, "sines", law->sines, why) : NULL;
    law->sines /= LAW_SINE;
    if (!law->sine) return 0;
    for (size_t i = 1; i < law->breaks; i++)
        if (!(law->time[i] > law->time[i - 1])) return refuse(why, "the times of %s_breaks must increase", name);
    law->coefficients = read_table_part(data, memory, name, "coefficients", LAW_COEFFICIENTS * (law->breaks + 1), why);
    return law->coefficients != NULL;
}

#endif
#endif
