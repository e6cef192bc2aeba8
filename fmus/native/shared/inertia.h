/* How a body's inertia varies with its deformation: the twin of components/body_parts/inertia_coupling.py.

       J(eta) = I7 - (I8_j + I8_j^T) eta_j - I9_jk eta_j eta_k        B(eta) = I5_j eta_j

   Symmetric matrices are held as (xx, yy, zz, xy, xz, yz). I9 is symmetric in its modes, I5 antisymmetric. */

#ifndef FANFOLD_INERTIA_H
#define FANFOLD_INERTIA_H

#include <stddef.h>

#include "frames.h"
#include "real.h"
#include "triangles.h"

/* What a coupling level keeps of the invariants; `modes` is the padded number. */
typedef struct {
    int varies, full;
    size_t modes;
    double inertia[6], inverse[9];
    double *slope;        /* 6 rows of modes */
    Triangles quadratic;  /* 6 */
    Triangles gyroscopic; /* 3 */
} InertiaCoupling;

/* Working memory of a coupling at some modal coordinates: `quadratic` 6 modes, `b` and `b_rate` 3 modes each. */
typedef struct {
    real *quadratic, *b, *b_rate;
    double *split;
} CouplingScratch;

/* The six products of I9 with eta, and B. */
static inline void quadratic_at(const InertiaCoupling *coupling, const real *eta, const CouplingScratch *scratch) {
    triangles_combined(&coupling->quadratic, eta, scratch->quadratic, scratch->split);
}

static inline void gyroscopic_of(const InertiaCoupling *coupling, const real *eta, real *b,
                                 const CouplingScratch *scratch) {
    triangles_combined(&coupling->gyroscopic, eta, b, scratch->split);
}

#ifdef FANFOLD_COMPLEX

/* Two numbers at once; products of two slopes vanish beside their values, whatever their sign. */
FANFOLD_VECTORISED static real dot_product(const real *a, const real *b, size_t count) {
    Lanes sum = {0.0}, x, y;
    for (size_t j = 0; j < count; j += 2) {
        memcpy(&x, a + j, sizeof x);
        memcpy(&y, b + j, sizeof y);
        sum += LANES_PICKED(x, x, 0, 0, 2, 2) * y + LANES_PICKED(x, x, 1, 1, 3, 3) * LANES_PICKED(y, y, 1, 0, 3, 2);
    }
    return complex_of(sum[0] + sum[2], sum[1] + sum[3]);
}

static inline real projected(const double *a, const real *b, size_t count) {
    real sum[2] = {0.0, 0.0};
    for (size_t j = 0; j < count; j += 2) {
        sum[0] += a[j] * b[j];
        sum[1] += a[j + 1] * b[j + 1];
    }
    return sum[0] + sum[1];
}

/* B times a vector over the modes. */
static inline Vector3 gyroscopic_times(const real *b, const real *weight, size_t n) {
    return (Vector3){dot_product(b, weight, n), dot_product(b + n, weight, n), dot_product(b + 2 * n, weight, n)};
}

/* J - B B^T at eta, from the products `scratch` holds at the full level, at a level that varies. */
static inline void inertia_at(const InertiaCoupling *coupling, const real *eta, const CouplingScratch *scratch,
                              real inertia[6]) {
    static const unsigned char first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    size_t n = coupling->modes;
    for (size_t p = 0; p < 6; p++) {
        const double *slope = coupling->slope + p * n;
        inertia[p] = coupling->inertia[p];
        inertia[p] -= projected(slope, eta, n);
        if (!coupling->full) continue;
        inertia[p] -= dot_product(scratch->quadratic + p * n, eta, n);
        inertia[p] -= dot_product(scratch->b + first[p] * n, scratch->b + second[p] * n, n);
    }
}

#else

/* sum += product of e and of the lanes that `row` has here, which goes on to the next row of n numbers. */
#define ROW_ADDED(sum, e, row, n)             \
    do {                                      \
        Lanes own_;                           \
        memcpy(&own_, row, sizeof own_);      \
        sum += e * own_;                      \
        row += n;                             \
    } while (0)

FANFOLD_VECTORISED static Vector3 gyroscopic_times(const real *b, const real *weight, size_t n) {
    Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, none = {0.0}, x;
    for (size_t j = 0; j < n; j += FANFOLD_LANES) {
        const double *row = b + j;
        memcpy(&x, weight + j, sizeof x);
        ROW_ADDED(s0, x, row, n);
        ROW_ADDED(s1, x, row, n);
        ROW_ADDED(s2, x, row, n);
    }
    double total[FANFOLD_LANES];
    LANES_SUM(x, s0, s1, s2, none);
    memcpy(total, &x, sizeof x);
    return (Vector3){total[0], total[1], total[2]};
}

FANFOLD_VECTORISED static void inertia_at(const InertiaCoupling *coupling, const real *eta,
                                          const CouplingScratch *scratch, real inertia[6]) {
    size_t n = coupling->modes;
    const double *b = scratch->b;
    Lanes s0 = {0.0}, s1 = {0.0}, s2 = {0.0}, s3 = {0.0}, s4 = {0.0}, s5 = {0.0}, none = {0.0}, rest = {0.0}, x, y, z;
    for (int part = 0; part <= coupling->full; part++)
        for (size_t j = 0; j < n; j += FANFOLD_LANES) {
            const double *row = (part ? scratch->quadratic : coupling->slope) + j;
            memcpy(&x, eta + j, sizeof x);
            ROW_ADDED(s0, x, row, n);
            ROW_ADDED(s1, x, row, n);
            ROW_ADDED(s2, x, row, n);
            ROW_ADDED(s3, x, row, n);
            ROW_ADDED(s4, x, row, n);
            ROW_ADDED(s5, x, row, n);
        }
    for (size_t j = 0; coupling->full && j < n; j += FANFOLD_LANES) {
        memcpy(&x, b + j, sizeof x);
        memcpy(&y, b + n + j, sizeof y);
        memcpy(&z, b + 2 * n + j, sizeof z);
        s0 += x * x;
        s1 += y * y;
        s2 += z * z;
        s3 += x * y;
        s4 += x * z;
        s5 += y * z;
    }
    double total[2 * FANFOLD_LANES];
    LANES_SUM(x, s0, s1, s2, s3);
    LANES_SUM(y, s4, s5, none, rest);
    memcpy(total, &x, sizeof x);
    memcpy(total + FANFOLD_LANES, &y, sizeof y);
    for (size_t p = 0; p < 6; p++) inertia[p] = coupling->inertia[p] - total[p];
}

#endif

/* Products at the mean modal coordinates, from those at both ends. */
FANFOLD_VECTORISED static void coupling_mean(size_t n, const double *restrict quadratic_start,
                                             const double *restrict b_start, const CouplingScratch *end,
                                             const CouplingScratch *mid) {
    const real *restrict quadratic_end = end->quadratic, *restrict b_end = end->b;
    real *restrict quadratic = mid->quadratic, *restrict b = mid->b;
    for (size_t i = 0; i < 6 * n; i++) quadratic[i] = 0.5 * (quadratic_start[i] + quadratic_end[i]);
    for (size_t i = 0; i < 3 * n; i++) b[i] = 0.5 * (b_start[i] + b_end[i]);
}

/* Forces on the modes over a step that are quadratic in the velocities, and drag = mean^T B, at a level that varies.
   mid: products at the mean modal coordinates, B of the mean rates among them; start, end: angular velocities, of which
   `mean` is the mean; bend: what this is above the mean over the step. */
FANFOLD_VECTORISED static void coupling_forces(const InertiaCoupling *coupling, Vector3 start, Vector3 end,
                                               Vector3 bend, const CouplingScratch *mid, real *restrict force,
                                               real *restrict drag) {
    size_t n = coupling->modes;
    const double *restrict slope = coupling->slope;
    Vector3 mean = vector_mean(start, end), omega = vector_subtract(mean, bend);
    real xx = start.x * end.x - 2.0 * bend.x * mean.x, yy = start.y * end.y - 2.0 * bend.y * mean.y;
    real zz = start.z * end.z - 2.0 * bend.z * mean.z;
    real xy = start.x * end.y + start.y * end.x - 2.0 * (bend.x * mean.y + bend.y * mean.x);
    real xz = start.x * end.z + start.z * end.x - 2.0 * (bend.x * mean.z + bend.z * mean.x);
    real yz = start.y * end.z + start.z * end.y - 2.0 * (bend.y * mean.z + bend.z * mean.y);
    for (size_t j = 0; j < n; j++) {
        force[j] = -0.5 * (xx * slope[j] + yy * slope[n + j] + zz * slope[2 * n + j] + xy * slope[3 * n + j] +
                           xz * slope[4 * n + j] + yz * slope[5 * n + j]);
        drag[j] = 0.0;
    }
    if (!coupling->full) return;
    const real *restrict q = mid->quadratic, *restrict b = mid->b, *restrict rate = mid->b_rate;
    for (size_t j = 0; j < n; j++) {
        force[j] -= xx * q[j] + yy * q[n + j] + zz * q[2 * n + j] + xy * q[3 * n + j] + xz * q[4 * n + j] +
                    yz * q[5 * n + j];
        force[j] -= omega.x * rate[j] + omega.y * rate[n + j] + omega.z * rate[2 * n + j];
        drag[j] = mean.x * b[j] + mean.y * b[n + j] + mean.z * b[2 * n + j];
    }
}

/* A symmetric 3x3 matrix given by its six entries, times a vector. */
static inline Vector3 symmetric_times(const real a[6], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[3] * v.y + a[4] * v.z,
        a[3] * v.x + a[1] * v.y + a[5] * v.z,
        a[4] * v.x + a[5] * v.y + a[2] * v.z,
    };
}

/* Solves a symmetric 3x3 system given by its six entries, by cofactors. */
static inline Vector3 solve_symmetric(const real entries[6], Vector3 right) {
    real xx = entries[0], yy = entries[1], zz = entries[2], xy = entries[3], xz = entries[4], yz = entries[5];
    real c00 = yy * zz - yz * yz, c01 = xz * yz - xy * zz, c02 = xy * yz - xz * yy;
    real scale = 1.0 / (xx * c00 + xy * c01 + xz * c02);
    real c11 = xx * zz - xz * xz, c12 = xy * xz - xx * yz, c22 = xx * yy - xy * xy;
    return (Vector3){
        scale * (c00 * right.x + c01 * right.y + c02 * right.z),
        scale * (c01 * right.x + c11 * right.y + c12 * right.z),
        scale * (c02 * right.x + c12 * right.y + c22 * right.z),
    };
}

#endif
