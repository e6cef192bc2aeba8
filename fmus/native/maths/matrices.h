/* Products of 3x3 matrices, row by row, with vectors and with each other. */

#ifndef FANFOLD_MATRICES_H
#define FANFOLD_MATRICES_H

#include "frames.h"

static inline Vector3 matrix_times(const real a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[1] * v.y + a[2] * v.z,
        a[3] * v.x + a[4] * v.y + a[5] * v.z,
        a[6] * v.x + a[7] * v.y + a[8] * v.z,
    };
}

static inline Vector3 transposed_times(const real a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[3] * v.y + a[6] * v.z,
        a[1] * v.x + a[4] * v.y + a[7] * v.z,
        a[2] * v.x + a[5] * v.y + a[8] * v.z,
    };
}

static inline Vector3 constant_times(const double a[9], Vector3 v) {
    return (Vector3){
        a[0] * v.x + a[1] * v.y + a[2] * v.z,
        a[3] * v.x + a[4] * v.y + a[5] * v.z,
        a[6] * v.x + a[7] * v.y + a[8] * v.z,
    };
}

static inline void matrix_product(const real a[9], const real b[9], real product[9]) {
    for (size_t i = 0; i < 9; i += 3)
        for (size_t j = 0; j < 3; j++) product[i + j] = a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j];
}

static inline Vector3 constant_vector(const double *v) { return (Vector3){v[0], v[1], v[2]}; }

#endif
