/* Mass properties of what a base carries: see appendage.h. */

#include "appendage.h"

#include <string.h>

#include "frames.h"

/* Quaternions between rows of results are interpolated. */
static Quaternion turn_at(const double *recorded) { return quaternion_normalized(quaternion_of(recorded)); }

/* The parallel axis theorem, for a mass with its centre at r (3,) and its axes turned by `turn`. */
static void add_mass(const double *value, Vector3 r, Quaternion turn, double found[APPENDAGE]) {
    static const size_t first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    const double mass = value[0], *inertia = value + 4, reach[3] = {r.x, r.y, r.z};
    double axes[9];
    rotation_matrix(turn, axes);
    found[0] += mass;
    for (size_t i = 0; i < 3; i++) found[1 + i] += mass * reach[i];
    for (size_t k = 0; k < 6; k++) {
        const double *a = axes + 3 * first[k], *b = axes + 3 * second[k];
        double sum = mass * ((k < 3) * vector_dot(r, r) - reach[first[k]] * reach[second[k]]);
        for (size_t i = 0; i < 9; i++) sum += a[i / 3] * inertia[i] * b[i % 3];
        found[4 + k] += sum;
    }
}

void appendage_observe(const Appendage *a, const double *recorded, double found[APPENDAGE]) {
    const Vector3 origin = vector_of(recorded + a->frame[0]);
    const Quaternion frame = turn_at(recorded + a->frame[1]);
    memset(found, 0, APPENDAGE * sizeof *found);
    for (size_t i = 0; i < a->masses; i++) {
        const size_t *place = a->place + MASS_PLACES * i;
        const double *value = a->value + MASS_VALUES * i;
        const Quaternion turn = turn_at(recorded + place[2]);
        const Vector3 middle = vector_mean(vector_of(recorded + place[0]), vector_of(recorded + place[1]));
        const Vector3 center = vector_add(middle, quaternion_rotate(turn, vector_of(value + 1)));
        add_mass(value, quaternion_rotate_back(frame, vector_subtract(center, origin)),
                 quaternion_multiply(quaternion_conjugate(frame), turn), found);
    }
    for (size_t i = 1; i < 4 && found[0] > 0.0; i++) found[i] /= found[0];
}
