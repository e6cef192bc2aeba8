/* Rigid and modal bodies: the equations of components/body.py, where the theory is told. */

#include "body_step.h"
#include "body_ports.h"
#include "body_exchange.h"

#ifndef FANFOLD_COMPLEX

#include "body_data.h"

int body_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                      Reason *why);
void body_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

static int prepare(void *self, const double *p, Reason *why) {
    Body *body = self;
    const double *q = p + P_INITIAL_ORIENTATION;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), scale = p[P_DAMPING_SCALE];
    if (!(fabs(length - 1.0) <= 1e-6))
        return refuse(why, "initial_orientation has length %g; a quaternion must have length 1", length);
    memcpy(body->start_position, p + P_INITIAL_POSITION, sizeof body->start_position);
    memcpy(body->start_orientation, q, sizeof body->start_orientation);
    memcpy(body->start_velocity, p + P_INITIAL_VELOCITY, sizeof body->start_velocity);
    memcpy(body->start_angular_velocity, p + P_INITIAL_ANGULAR_VELOCITY, sizeof body->start_angular_velocity);
    memcpy(body->start_modal, p + P_INITIAL_MODAL_COORDINATE, body->modes * sizeof(double));
    memcpy(body->gravity, p + P_GRAVITY, sizeof body->gravity);
    if (scale == body->damping_scale) return 1;
    body->damping_scale = scale;
    for (size_t j = 0; j < body->modes; j++) body->oscillators.damping_ratio[j] = body->damping_ratio[j] * scale;
    oscillators_forget(&body->oscillators);
    return 1;
}

/* Placed, bent and moving as the initial parameters say, with no momentum of the modes. */
static int initial(void *self, const double *u, double *x, Reason *why) {
    Body *body = self;
    LocalWork stack;
    Work work = work_of(body, &stack);
    double a[9], j[6];
    (void)u, (void)why;
    Quaternion q = quaternion_normalized(quaternion_of(body->start_orientation));
    rotation_matrix(q, a);
    Vector3 omega = transposed_times(a, vector_of(body->start_angular_velocity));
    memset(x, 0, (interface_begin(body) + (body->is_base ? interface_states(body) : 0)) * sizeof(double));
    vector_store(vector_add(vector_of(body->start_position), matrix_times(a, vector_of(body->center_of_mass))),
                 x + X_POSITION);
    quaternion_store(q, x + X_ORIENTATION);
    vector_store(vector_scaled(body->mass, vector_of(body->start_velocity)), x + X_MOMENTUM);
    vector_store(omega, x + X_ANGULAR_VELOCITY);
    memcpy(x + X_MODAL_AMPLITUDE, body->start_modal, body->modes * sizeof(double));
    load_modes(body, x, work.eta, work.pi);
    memcpy(j, body->coupling.inertia, sizeof j);
    evaluate_coupling(body, work.eta, &work.coupling, j);
    const double inertia[9] = {j[0], j[3], j[4], j[3], j[1], j[5], j[4], j[5], j[2]};
    vector_store(matrix_times(a, matrix_times(inertia, omega)), x + X_SPIN);
    return 1;
}

/* Energies of the modes: half of rate times momentum, and of strain. */
static void modal_energies(Body *body, const double *x, double *kinetic, double *strain) {
    LocalWork stack;
    Work work = work_of(body, &stack);
    const double *rate = work.pi, *frequency = body->oscillators.frequency;
    load_modes(body, x, work.eta, work.pi);
    if (body->coupling.full) {
        const double *b = gyroscopic_at(body, known_at(body, work.eta), work.eta, &work);
        modal_rate(body->padded_modes, vector_of(x + X_ANGULAR_VELOCITY), b, work.pi, work.rate_mean);
        rate = work.rate_mean;
    }
    *kinetic = *strain = 0.0;
    for (size_t j = 0; j < body->modes; j++) {
        *kinetic += 0.5 * rate[j] * work.pi[j];
        *strain += 0.5 * (frequency[j] * work.eta[j]) * (frequency[j] * work.eta[j]);
    }
    if (body->forms) *strain += tension_energy(body, work.eta, &work);
}

/* Pose of the construction frame, momenta, energies and modal coordinates. */
static void observe(void *self, const double *x, const double *u, double *z) {
    Body *body = self;
    double a[9], kinetic, strain;
    rotation_matrix(quaternion_of(x + X_ORIENTATION), a);
    Vector3 position = vector_of(x + X_POSITION), momentum = vector_of(x + X_MOMENTUM), spin = vector_of(x + X_SPIN);
    modal_energies(body, x, &kinetic, &strain);
    kinetic += 0.5 * (vector_dot(momentum, momentum) / body->mass +
                      vector_dot(vector_of(x + X_ANGULAR_VELOCITY), transposed_times(a, spin)));
    vector_store(vector_subtract(position, matrix_times(a, vector_of(body->center_of_mass))),
                 z + Z_FRAME_POSITION);
    memcpy(z + Z_FRAME_ORIENTATION, x + X_ORIENTATION, 4 * sizeof(double));
    memcpy(z + Z_LINEAR_MOMENTUM, x + X_MOMENTUM, 3 * sizeof(double));
    vector_store(vector_add(spin, vector_cross(position, momentum)), z + Z_ANGULAR_MOMENTUM);
    z[Z_KINETIC_ENERGY] = kinetic;
    z[Z_POTENTIAL_ENERGY] = strain - body->mass * vector_dot(vector_of(body->gravity), position);
    z[Z_DISSIPATED_ENERGY] = x[X_HEAT];
    memcpy(z + Z_MODAL_COORDINATE, x + X_MODAL_AMPLITUDE, body->modes * sizeof(double));
    if (body->is_base) observe_interface(body, x, u, z + OBSERVATIONS);
}

const Kernel body_kernel = {
    KIND,    create,            prepare,              initial, body_step_real, body_outputs_real,
    observe, body_step_complex, body_outputs_complex, NULL,    NULL,
    .continuous = body_continuous,
    .complete = body_complete_real,
    .complete_complex = body_complete_complex,
    .rates = body_rates_real,
    .rates_complex = body_rates_complex,
    .layout = LAYOUT_DIGEST,
};

#endif
