/* Rotations and spatial vectors: the twin of components/contract/frames.py in either number type.

   Quaternions are scalar first and rotate body into world coordinates. */

#ifndef FANFOLD_FRAMES_H
#define FANFOLD_FRAMES_H

#include "real.h"

#define FANFOLD_PI 3.14159265358979323846

typedef struct Quaternion {
    real w, x, y, z;
} Quaternion;

typedef struct Vector3 {
    real x, y, z;
} Vector3;

/* A rotation split into a twist about x and a swing about an axis normal to it. */
typedef struct SwingTwist {
    real twist, swing_y, swing_z;
} SwingTwist;

static inline Quaternion quaternion_of(const real *q) { return (Quaternion){q[0], q[1], q[2], q[3]}; }

static inline Vector3 vector_of(const real *v) { return (Vector3){v[0], v[1], v[2]}; }

static inline void vector_store(Vector3 v, real *place) {
    place[0] = v.x;
    place[1] = v.y;
    place[2] = v.z;
}

static inline void quaternion_store(Quaternion q, real *place) {
    place[0] = q.w;
    place[1] = q.x;
    place[2] = q.y;
    place[3] = q.z;
}

/* Product a b: first b, then a. */
static inline Quaternion quaternion_multiply(Quaternion a, Quaternion b) {
    return (Quaternion){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

/* Root of a sum of squares. Where all of them vanish, the square of the infinitesimal part would leave a
   negative number under the root. */
static inline real root_of_squares(real sum) {
    if (value_of(sum) <= 0.0) return 0.0;
    return real_sqrt(sum);
}

/* Inverse of a unit quaternion. */
static inline Quaternion quaternion_conjugate(Quaternion q) { return (Quaternion){q.w, -q.x, -q.y, -q.z}; }

static inline Quaternion quaternion_normalized(Quaternion q) {
    real scale = 1.0 / real_sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (Quaternion){q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

/* Quaternion of the rotation vector v (rad). */
static inline Quaternion quaternion_exponential(Vector3 v) {
    real square = v.x * v.x + v.y * v.y + v.z * v.z;
    real angle = root_of_squares(square);
    if (value_of(angle) < 1e-6) {
        real k = 0.5 - square / 48.0;
        return (Quaternion){1.0 - square / 8.0, k * v.x, k * v.y, k * v.z};
    }
    real k = real_sin(0.5 * angle) / angle;
    return (Quaternion){real_cos(0.5 * angle), k * v.x, k * v.y, k * v.z};
}

/* Rotation vector, half a turn at most, of a unit quaternion. */
static inline Vector3 rotation_vector(Quaternion q) {
    if (value_of(q.w) < 0.0) q = (Quaternion){-q.w, -q.x, -q.y, -q.z};
    real half = root_of_squares(q.x * q.x + q.y * q.y + q.z * q.z);
    /* the factor's slope is of the order of half and vanishes with it */
    real factor = 2.0;
    if (!(value_of(half) < 1e-8)) factor = 2.0 * real_atan2(half, q.w) / half;
    return (Vector3){factor * q.x, factor * q.y, factor * q.z};
}

/* The vector v turned by q. */
static inline Vector3 quaternion_rotate(Quaternion q, Vector3 v) {
    real tx = 2.0 * (q.y * v.z - q.z * v.y);
    real ty = 2.0 * (q.z * v.x - q.x * v.z);
    real tz = 2.0 * (q.x * v.y - q.y * v.x);
    return (Vector3){
        v.x + q.w * tx + q.y * tz - q.z * ty,
        v.y + q.w * ty + q.z * tx - q.x * tz,
        v.z + q.w * tz + q.x * ty - q.y * tx,
    };
}

/* The vector v turned by the inverse of q. */
static inline Vector3 quaternion_rotate_back(Quaternion q, Vector3 v) {
    return quaternion_rotate(quaternion_conjugate(q), v);
}

/* Rotation matrix of a unit quaternion, row by row. */
static inline void rotation_matrix(Quaternion q, real matrix[9]) {
    matrix[0] = 1.0 - 2.0 * (q.y * q.y + q.z * q.z);
    matrix[1] = 2.0 * (q.x * q.y - q.w * q.z);
    matrix[2] = 2.0 * (q.x * q.z + q.w * q.y);
    matrix[3] = 2.0 * (q.x * q.y + q.w * q.z);
    matrix[4] = 1.0 - 2.0 * (q.x * q.x + q.z * q.z);
    matrix[5] = 2.0 * (q.y * q.z - q.w * q.x);
    matrix[6] = 2.0 * (q.x * q.z - q.w * q.y);
    matrix[7] = 2.0 * (q.y * q.z + q.w * q.x);
    matrix[8] = 1.0 - 2.0 * (q.x * q.x + q.y * q.y);
}

static inline Vector3 vector_cross(Vector3 a, Vector3 b) {
    return (Vector3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline real vector_dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static inline Vector3 vector_add(Vector3 a, Vector3 b) { return (Vector3){a.x + b.x, a.y + b.y, a.z + b.z}; }

static inline Vector3 vector_subtract(Vector3 a, Vector3 b) { return (Vector3){a.x - b.x, a.y - b.y, a.z - b.z}; }

static inline Vector3 vector_scaled(real k, Vector3 a) { return (Vector3){k * a.x, k * a.y, k * a.z}; }

static inline Vector3 vector_mean(Vector3 a, Vector3 b) {
    return (Vector3){0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)};
}

static inline real vector_norm(Vector3 a) { return root_of_squares(a.x * a.x + a.y * a.y + a.z * a.z); }

/* The angle plus the multiple of a full turn that brings it nearest to the reference (unwrapping). */
static inline real nearest_turn(real angle, real reference) {
    /* a number of turns is a decision: it takes values only; rint is Python's round, halves to even */
    return angle + 2.0 * FANFOLD_PI * rint((value_of(reference) - value_of(angle)) / (2.0 * FANFOLD_PI));
}

/* Angle of the twist about x alone, in (-2 pi, 2 pi). */
static inline real twist_about_x(Quaternion q) { return 2.0 * real_atan2(q.x, q.w); }

/* Split a rotation, q = swing twist: twist about x in (-2 pi, 2 pi), and the swing's rotation vector (y, z). */
static inline SwingTwist swing_twist(Quaternion q) {
    real length = real_sqrt(q.w * q.w + q.x * q.x);
    real tw = q.w / length, tx = q.x / length;
    /* swing = q * conjugate(twist); its x component vanishes */
    real sy = q.y * tw - q.z * tx, sz = q.z * tw + q.y * tx;
    real half = root_of_squares(sy * sy + sz * sz);
    /* the factor's slope is of the order of half and vanishes with it */
    real k = 2.0;
    if (!(value_of(half) < 1e-8)) k = 2.0 * real_atan2(half, length) / half;
    return (SwingTwist){twist_about_x(q), k * sy, k * sz};
}

#endif
