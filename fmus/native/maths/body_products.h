/* Products of a body's port shapes with vectors over its modes or its ports, and what vectors are made of. */

#ifndef FANFOLD_BODY_PRODUCTS_H
#define FANFOLD_BODY_PRODUCTS_H

#include <stddef.h>
#include <string.h>

#include "real.h"

/* Vectors over modes or ports have a multiple of this length, their surplus elements 0. */
#define FANFOLD_LANES 4

/* Loops that pay it are compiled for processors with fused multiply-add as well; glibc chooses at load time. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#define FANFOLD_VECTORISED __attribute__((target_clones("fma", "default")))
#else
#define FANFOLD_VECTORISED
#endif

static inline size_t padded(size_t count) { return (count + FANFOLD_LANES - 1) / FANFOLD_LANES * FANFOLD_LANES; }

/* GCC and Clang: so many doubles, computed with at once. Compilers do not vectorise the sums by themselves. */
typedef double Lanes __attribute__((vector_size(FANFOLD_LANES * sizeof(double))));

#ifdef __clang__
#define LANES_PICKED(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
typedef long long LaneNumbers __attribute__((vector_size(FANFOLD_LANES * sizeof(long long))));
#define LANES_PICKED(a, b, i, j, k, l) __builtin_shuffle(a, b, (LaneNumbers){i, j, k, l})
#endif

/* sum = the sums over the lanes of s0, s1, s2, s3, made at once; these are used up. */
#define LANES_SUM(sum, s0, s1, s2, s3)                                                  \
    do {                                                                                \
        s0 = LANES_PICKED(s0, s1, 0, 4, 2, 6) + LANES_PICKED(s0, s1, 1, 5, 3, 7);       \
        s2 = LANES_PICKED(s2, s3, 0, 4, 2, 6) + LANES_PICKED(s2, s3, 1, 5, 3, 7);       \
        sum = LANES_PICKED(s0, s2, 0, 1, 4, 5) + LANES_PICKED(s0, s2, 2, 3, 6, 7);      \
    } while (0)

/* out[k] = scalar product of row k with `weight`, and with another set of weights that shares the rows; `count` rows of
   `length` numbers, a multiple of FANFOLD_LANES. */
FANFOLD_VECTORISED static void rows_projected_twice_double(const double *restrict rows, size_t count, size_t length,
                                                           const double *restrict weight,
                                                           const double *restrict other, double *restrict out,
                                                           double *restrict other_out) {
    Lanes r0, r1, r2, r3, w, v;
    size_t k = 0;
    for (; k + FANFOLD_LANES <= count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, s3 = {0.0}, t0 = {0.0}, t1 = {0.0}, t2 = {0.0}, t3 = {0.0};
        for (size_t i = 0; i < length; i += FANFOLD_LANES, row += FANFOLD_LANES) {
            memcpy(&w, weight + i, sizeof w);
            memcpy(&v, other + i, sizeof v);
            memcpy(&r0, row, sizeof r0);
            memcpy(&r1, row + length, sizeof r1);
            memcpy(&r2, row + 2 * length, sizeof r2);
            memcpy(&r3, row + 3 * length, sizeof r3);
            s0 += r0 * w;
            s1 += r1 * w;
            s2 += r2 * w;
            s3 += r3 * w;
            t0 += r0 * v;
            t1 += r1 * v;
            t2 += r2 * v;
            t3 += r3 * v;
        }
        LANES_SUM(w, s0, s1, s2, s3);
        LANES_SUM(v, t0, t1, t2, t3);
        memcpy(out + k, &w, sizeof w);
        memcpy(other_out + k, &v, sizeof v);
    }
    for (; k < count; k++) {
        Lanes s = {0.0}, t = {0.0};
        for (size_t i = 0; i < length; i += FANFOLD_LANES) {
            memcpy(&r0, rows + k * length + i, sizeof r0);
            memcpy(&w, weight + i, sizeof w);
            memcpy(&v, other + i, sizeof v);
            s += r0 * w;
            t += r0 * v;
        }
        out[k] = (s[0] + s[1]) + (s[2] + s[3]);
        other_out[k] = (t[0] + t[1]) + (t[2] + t[3]);
    }
}

#ifdef FANFOLD_COMPLEX

/* out = sum of weight[k] times row k, for two sets of weights that share the rows. */
FANFOLD_VECTORISED static void rows_combined_twice_double(const double *restrict rows, size_t count,
                                                          size_t length, const double *restrict weight,
                                                          const double *restrict other, double *restrict out,
                                                          double *restrict other_out) {
    size_t k = 0;
    for (size_t i = 0; i < length; i++) out[i] = other_out[i] = 0.0;
    for (; k + FANFOLD_LANES <= count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        double v0 = other[k], v1 = other[k + 1], v2 = other[k + 2], v3 = other[k + 3];
        for (size_t i = 0; i < length; i++) {
            double r0 = row[i], r1 = row[length + i], r2 = row[2 * length + i], r3 = row[3 * length + i];
            out[i] += w0 * r0 + w1 * r1 + w2 * r2 + w3 * r3;
            other_out[i] += v0 * r0 + v1 * r1 + v2 * r2 + v3 * r3;
        }
    }
    for (; k < count; k++)
        for (size_t i = 0; i < length; i++) {
            out[i] += weight[k] * rows[k * length + i];
            other_out[i] += other[k] * rows[k * length + i];
        }
}

/* Values and slopes of numbers, apart. */
static inline void values_and_slopes(const real *numbers, size_t count, double *value, double *slope) {
    for (size_t k = 0; k < count; k++) {
        value[k] = creal(numbers[k]);
        slope[k] = cimag(numbers[k]);
    }
}

static inline void joined(const double *value, const double *slope, size_t count, real *numbers) {
    for (size_t i = 0; i < count; i++) numbers[i] = complex_of(value[i], slope[i]);
}

/* Values and slopes are two sets of weights; `split` holds 2 (count + length) doubles. */
static inline void rows_combined(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                 double *split) {
    double *value = split, *slope = value + count, *value_out = slope + count, *slope_out = value_out + length;
    values_and_slopes(weight, count, value, slope);
    rows_combined_twice_double(rows, count, length, value, slope, value_out, slope_out);
    joined(value_out, slope_out, length, out);
}

static inline void rows_projected(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                  double *split) {
    double *value = split, *slope = value + length, *value_out = slope + length, *slope_out = value_out + count;
    values_and_slopes(weight, length, value, slope);
    rows_projected_twice_double(rows, count, length, value, slope, value_out, slope_out);
    joined(value_out, slope_out, count, out);
}

static inline void rows_projected_twice(const double *rows, size_t count, size_t length, const real *weight,
                                        const real *other, real *out, real *other_out, double *split) {
    rows_projected(rows, count, length, weight, out, split);
    rows_projected(rows, count, length, other, other_out, split);
}

#else

/* out = sum of weight[k] times row k; `count` rows of `length` numbers, a multiple of FANFOLD_LANES. */
FANFOLD_VECTORISED static void rows_combined_double(const double *restrict rows, size_t count, size_t length,
                                                    const double *restrict weight, double *restrict out) {
    size_t k = count % FANFOLD_LANES;
    for (size_t i = 0; i < length; i++) out[i] = k > 0 ? weight[0] * rows[i] : 0.0;
    for (size_t j = 1; j < k; j++)
        for (size_t i = 0; i < length; i++) out[i] += weight[j] * rows[j * length + i];
    for (; k < count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
        for (size_t i = 0; i < length; i++)
            out[i] += w0 * row[i] + w1 * row[length + i] + w2 * row[2 * length + i] + w3 * row[3 * length + i];
    }
}

/* out[k] = scalar product of row k with `weight`. */
FANFOLD_VECTORISED static void rows_projected_double(const double *restrict rows, size_t count, size_t length,
                                                     const double *restrict weight, double *restrict out) {
    Lanes r0, r1, r2, r3, w;
    size_t k = 0;
    for (; k + FANFOLD_LANES <= count; k += FANFOLD_LANES) {
        const double *row = rows + k * length;
        Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, s3 = {0.0};
        for (size_t i = 0; i < length; i += FANFOLD_LANES, row += FANFOLD_LANES) {
            memcpy(&w, weight + i, sizeof w);
            memcpy(&r0, row, sizeof r0);
            memcpy(&r1, row + length, sizeof r1);
            memcpy(&r2, row + 2 * length, sizeof r2);
            memcpy(&r3, row + 3 * length, sizeof r3);
            s0 += r0 * w;
            s1 += r1 * w;
            s2 += r2 * w;
            s3 += r3 * w;
        }
        LANES_SUM(w, s0, s1, s2, s3);
        memcpy(out + k, &w, sizeof w);
    }
    for (; k < count; k++) {
        Lanes s = {0.0};
        for (size_t i = 0; i < length; i += FANFOLD_LANES) {
            memcpy(&r0, rows + k * length + i, sizeof r0);
            memcpy(&w, weight + i, sizeof w);
            s += r0 * w;
        }
        out[k] = (s[0] + s[1]) + (s[2] + s[3]);
    }
}

static inline void rows_combined(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                 double *split) {
    (void)split;
    rows_combined_double(rows, count, length, weight, out);
}

static inline void rows_projected(const double *rows, size_t count, size_t length, const real *weight, real *out,
                                  double *split) {
    (void)split;
    rows_projected_double(rows, count, length, weight, out);
}

static inline void rows_projected_twice(const double *rows, size_t count, size_t length, const real *weight,
                                        const real *other, real *out, real *other_out, double *split) {
    (void)split;
    rows_projected_twice_double(rows, count, length, weight, other, out, other_out);
}

#endif

#endif
