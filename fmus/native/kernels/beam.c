/* Beams for large deformation: the equations of components/beam.py, where the theory is told. The step is of plain
   numbers alone; its derivatives follow from the linear equations at its end. */

#include "beam_model.h"

void NAME(beam_outputs)(void *self, const real *x, const real *u, real *y);

/* Pose and velocity of every port, world axes. */
void NAME(beam_outputs)(void *self, const real *x, const real *u, real *y) {
    const Beam *beam = self;
    (void)u;
    for (size_t k = 0; k < beam->ports; k++, y += MOTION_SIZE) {
        const size_t node = beam->port_nodes[k];
        const double *own = beam->port_turns + 4 * k;
        const Quaternion q = quaternion_of(x + place_of_orientation(beam) + 4 * node);
        const Quaternion port = {own[0], own[1], own[2], own[3]};
        real r[9];
        rotation_matrix(q, r);
        Vector3 arm = matrix_times(r, constant_vector(beam->port_arms + 3 * k));
        Vector3 rate = matrix_times(r, vector_of(x + place_of_rate(beam) + 3 * node));
        Vector3 velocity = vector_of(x + place_of_velocity(beam) + 3 * node);
        vector_store(vector_add(vector_of(x + place_of_position(beam) + 3 * node), arm), y);
        quaternion_store(quaternion_multiply(q, port), y + 3);
        vector_store(vector_add(velocity, vector_cross(rate, arm)), y + 7);
        vector_store(rate, y + 10);
    }
}

#ifndef FANFOLD_COMPLEX

#include "beam_step.h"
#include "beam_data.h"

void beam_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static int prepare(void *self, const double *p, Reason *why) {
    Beam *beam = self;
    const double *q = p + P_INITIAL_ORIENTATION;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(fabs(length - 1.0) <= 1e-6))
        return refuse(why, "initial_orientation has length %g; a quaternion must have length 1", length);
    memcpy(beam->start_position, p + P_INITIAL_POSITION, sizeof beam->start_position);
    memcpy(beam->start_orientation, q, sizeof beam->start_orientation);
    memcpy(beam->start_velocity, p + P_INITIAL_VELOCITY, sizeof beam->start_velocity);
    memcpy(beam->start_angular_velocity, p + P_INITIAL_ANGULAR_VELOCITY, sizeof beam->start_angular_velocity);
    memcpy(beam->gravity, p + P_GRAVITY, sizeof beam->gravity);
    beam->damping = p[P_STIFFNESS_DAMPING];
    memcpy(beam->start_displacements, p + P_INITIAL_DISPLACEMENT, 3 * beam->nodes * sizeof(double));
    memcpy(beam->start_rotations, p + P_INITIAL_DISPLACEMENT + 3 * beam->nodes, 3 * beam->nodes * sizeof(double));
    beam->start_of_factors.known = beam->end_of_step.known = 0;
    return 1;
}

/* Placed, bent and moving like a rigid body as the initial parameters say. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    const Beam *beam = self;
    const Quaternion q = quaternion_normalized(quaternion_of(beam->start_orientation));
    const Vector3 omega = vector_of(beam->start_angular_velocity);
    Vector3 center = {0.0, 0.0, 0.0};
    double a[9], mass = 0.0;
    (void)u, (void)why;
    rotation_matrix(q, a);
    x[X_HEAT] = 0.0;
    for (size_t n = 0; n < beam->nodes; n++) {
        Vector3 position = vector_add(vector_of(beam->positions + 3 * n), vector_of(beam->start_displacements + 3 * n));
        position = matrix_times(a, position);
        position = vector_add(vector_of(beam->start_position), position);
        center = vector_add(center, vector_scaled(beam->weights[n], position));
        mass += beam->weights[n];
        vector_store(position, x + place_of_position(beam) + 3 * n);
    }
    center = vector_scaled(1.0 / mass, center);
    for (size_t n = 0; n < beam->nodes; n++) {
        const Quaternion turn = quaternion_exponential(vector_of(beam->start_rotations + 3 * n));
        const Quaternion bent = quaternion_multiply(turn, quaternion_of(beam->turns + 4 * n));
        const Quaternion own = quaternion_normalized(quaternion_multiply(q, bent));
        Vector3 arm = vector_subtract(vector_of(x + place_of_position(beam) + 3 * n), center);
        double r[9];
        rotation_matrix(own, r);
        quaternion_store(own, x + place_of_orientation(beam) + 4 * n);
        vector_store(vector_add(vector_of(beam->start_velocity), vector_cross(omega, arm)),
                     x + place_of_velocity(beam) + 3 * n);
        vector_store(transposed_times(r, omega), x + place_of_rate(beam) + 3 * n);
    }
    return 1;
}

/* Momenta, linear and about the world's origin, and kinetic energy. */
static void observe_motion(const Beam *beam, const double *x, double *z) {
    const double *position = x + place_of_position(beam), *velocity = x + place_of_velocity(beam);
    const double *rates = x + place_of_rate(beam);
    Vector3 linear = {0.0, 0.0, 0.0}, angular = {0.0, 0.0, 0.0};
    double twice = 0.0;
    for (size_t n = 0; n < beam->nodes; n++) {
        const double after = n + 1 < beam->nodes ? beam->line_mass * beam->lengths[n] / 6.0 : 0.0;
        const double earlier = n > 0 ? beam->line_mass * beam->lengths[n - 1] / 6.0 : 0.0;
        const double *j = beam->inertia + 3 * n;
        const Vector3 rate = vector_of(rates + 3 * n), own = vector_of(velocity + 3 * n);
        const Vector3 spin = {j[0] * rate.x, j[1] * rate.y, j[2] * rate.z};
        Vector3 momentum = vector_scaled(2.0 * (after + earlier), own);
        if (n > 0) momentum = vector_add(momentum, vector_scaled(earlier, vector_of(velocity + 3 * n - 3)));
        if (after > 0.0) momentum = vector_add(momentum, vector_scaled(after, vector_of(velocity + 3 * n + 3)));
        linear = vector_add(linear, momentum);
        angular = vector_add(angular, vector_cross(vector_of(position + 3 * n), momentum));
        angular = vector_add(angular, matrix_times(beam->start.directors + 9 * n, spin));
        twice += vector_dot(momentum, own) + vector_dot(spin, rate);
    }
    vector_store(linear, z + Z_LINEAR_MOMENTUM);
    vector_store(angular, z + Z_ANGULAR_MOMENTUM);
    z[Z_KINETIC_ENERGY] = 0.5 * twice;
}

/* Momenta, energies, positions of the nodes and resultants of the sections. */
static void observe(void *self, const double *x, const double *u, double *z) {
    Beam *beam = self;
    const size_t nodes = beam->nodes, elements = nodes - 1;
    const Step step = step_of(beam, x, u, 1.0);
    double energy = 0.0, *force = z + Z_NODE_POSITION + 3 * nodes, *moment = force + 3 * elements;
    Reason unused;
    (void)start_step(beam, &step, &unused);
    for (size_t m = 0; m < elements; m++) {
        (void)strain(beam, &beam->start, m);
        const double *e = beam->start.strains[m].e;
        for (int i = 0; i < 3; i++) {
            force[3 * m + i] = beam->stiffness[i] * e[i];
            moment[3 * m + i] = beam->stiffness[3 + i] * e[3 + i];
            energy += 0.5 * beam->lengths[m] * (force[3 * m + i] * e[i] + moment[3 * m + i] * e[3 + i]);
        }
    }
    observe_motion(beam, x, z);
    for (size_t n = 0; n < nodes; n++)
        energy -= beam->weights[n] * dot3(beam->gravity, x + place_of_position(beam) + 3 * n);
    z[Z_POTENTIAL_ENERGY] = energy;
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    memcpy(z + Z_NODE_POSITION, x + place_of_position(beam), 3 * nodes * sizeof(double));
    memcpy(moment + 3 * elements, x + place_of_orientation(beam), 4 * nodes * sizeof(double));
    beam->end_of_step.known = 0; /* its start has been written over */
}

const Kernel beam_kernel = {
    KIND, create, prepare, initial, beam_step_real, beam_outputs_real, observe, beam_step_complex, beam_outputs_complex,
    .layout = LAYOUT_DIGEST,
};

#endif
