/* How a body's inertia varies with its deformation: the twin of components/body_parts/inertia_coupling.py.

       J(eta) = I7 - (I8_j + I8_j^T) eta_j - I9_jk eta_j eta_k        B(eta) = I5_j eta_j

   Symmetric matrices are held as (xx, yy, zz, xy, xz, yz). I9 is symmetric in its modes, I5 antisymmetric. */

#ifndef FANFOLD_INERTIA_H
#define FANFOLD_INERTIA_H

#include <stddef.h>

#include "frames.h"
#include "real.h"
#include "triangles.h"

/* Scalar product in independent partial sums, which a compiler may keep in one register. */
static inline real dot_product(const real *a, const real *b, size_t count) {
    real sum[FANFOLD_LANES] = {0.0, 0.0, 0.0, 0.0};
    for (size_t j = 0; j < count; j += FANFOLD_LANES)
        for (size_t lane = 0; lane < FANFOLD_LANES; lane++) sum[lane] += a[j + lane] * b[j + lane];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* What a coupling level keeps of the invariants; `modes` is the padded number. */
typedef struct {
    int varies, full;
    size_t modes;
    double inertia[6], inverse[9];
    double *slope;        /* 6 rows of modes */
    Triangles quadratic;  /* 6 */
    Triangles gyroscopic; /* 3 */
} InertiaCoupling;

/* Working memory of a coupling: `quadratic` 6 modes, `b` and `b_rate` 3 modes each. */
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

/* J - B B^T at eta, from the products `scratch` holds at the full level, at a level that varies. */
FANFOLD_VECTORISED static void inertia_at(const InertiaCoupling *coupling, const real *eta,
                                          const CouplingScratch *scratch, real inertia[6]) {
    static const unsigned char first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    size_t modes = coupling->modes;
    for (size_t p = 0; p < 6; p++) {
        const double *slope = coupling->slope + p * modes;
        real sum[FANFOLD_LANES] = {0.0, 0.0, 0.0, 0.0};
        for (size_t j = 0; j < modes; j += FANFOLD_LANES)
            for (size_t lane = 0; lane < FANFOLD_LANES; lane++) sum[lane] += slope[j + lane] * eta[j + lane];
        inertia[p] = coupling->inertia[p] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }
    if (!coupling->full) return;
    for (size_t p = 0; p < 6; p++) {
        inertia[p] -= dot_product(scratch->quadratic + p * modes, eta, modes);
        inertia[p] -= dot_product(scratch->b + first[p] * modes, scratch->b + second[p] * modes, modes);
    }
}

/* What the rate of J - B B^T makes of an angular velocity, at these modal rates and where `scratch` was evaluated,
   with B's rate, at a level that varies. */
FANFOLD_VECTORISED static Vector3 growth_of_momentum(const InertiaCoupling *coupling, const real *rate, Vector3 omega,
                                                     const CouplingScratch *scratch) {
    static const unsigned char first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    size_t n = coupling->modes;
    real growth[6];
    for (size_t p = 0; p < 6; p++) {
        const double *slope = coupling->slope + p * n;
        const real *quadratic = scratch->quadratic + p * n;
        const real *b = scratch->b + first[p] * n, *other_b = scratch->b + second[p] * n;
        const real *b_rate = scratch->b_rate + first[p] * n, *other_rate = scratch->b_rate + second[p] * n;
        real sum[FANFOLD_LANES] = {0.0, 0.0, 0.0, 0.0};
        for (size_t j = 0; j < n; j += FANFOLD_LANES)
            for (size_t lane = 0; lane < FANFOLD_LANES; lane++) {
                size_t i = j + lane;
                sum[lane] += slope[i] * rate[i];
                if (coupling->full) sum[lane] += 2.0 * quadratic[i] * rate[i] + b[i] * other_rate[i] + other_b[i] * b_rate[i];
            }
        growth[p] = -((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }
    return (Vector3){
        growth[0] * omega.x + growth[3] * omega.y + growth[4] * omega.z,
        growth[3] * omega.x + growth[1] * omega.y + growth[5] * omega.z,
        growth[4] * omega.x + growth[5] * omega.y + growth[2] * omega.z,
    };
}

/* Forces on the modes that are quadratic in the velocities, and drag = omega^T B, at a level that varies. */
FANFOLD_VECTORISED static void coupling_forces(const InertiaCoupling *coupling, Vector3 omega,
                                               const CouplingScratch *scratch, real *restrict force,
                                               real *restrict drag) {
    size_t n = coupling->modes;
    const double *restrict slope = coupling->slope;
    real xx = omega.x * omega.x, yy = omega.y * omega.y, zz = omega.z * omega.z;
    real xy = 2.0 * omega.x * omega.y, xz = 2.0 * omega.x * omega.z, yz = 2.0 * omega.y * omega.z;
    for (size_t j = 0; j < n; j++) {
        force[j] = -0.5 * (xx * slope[j] + yy * slope[n + j] + zz * slope[2 * n + j] + xy * slope[3 * n + j] +
                           xz * slope[4 * n + j] + yz * slope[5 * n + j]);
        drag[j] = 0.0;
    }
    if (!coupling->full) return;
    const real *restrict q = scratch->quadratic, *restrict b = scratch->b, *restrict rate = scratch->b_rate;
    for (size_t j = 0; j < n; j++) {
        force[j] -= xx * q[j] + yy * q[n + j] + zz * q[2 * n + j] + xy * q[3 * n + j] + xz * q[4 * n + j] +
                    yz * q[5 * n + j];
        force[j] -= omega.x * rate[j] + omega.y * rate[n + j] + omega.z * rate[2 * n + j];
        drag[j] = omega.x * b[j] + omega.y * b[n + j] + omega.z * b[2 * n + j];
    }
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
