/* What a body is made of, and what its calls work on: part of body.c, of either number type. */

#ifndef FANFOLD_BODY_MODEL_H
#define FANFOLD_BODY_MODEL_H

#include <stdint.h>
#include <string.h>
#include "body_layout.h"
#include "inertia.h"
#include "kernel.h"
#include "matrices.h"
#include "oscillators.h"
#include "port_sizes.h"

/* Loads, and products of two rates. */
enum { CARRIED_COLUMNS = WRENCH_SIZE + 6 };

/* What modal coordinates make of a body, at those it was last evaluated for: B, J - B B^T and what its quadratic part is
   made of, the deflection of the ports and what is added to the shapes. A state is asked for it several times, and all
   steps that are tried from a state start with it. */
typedef struct {
    int known;
    void *eta, *quadratic, *b, *inertia, *deflection, *pairs;
} Remembered;

/* What the start of a step gives to all steps from there besides, for modal momenta and an angular velocity: modal rates,
   and B of these. */
typedef struct {
    int known;
    double *momenta, *rates, *b, omega[3];
} Departure;

typedef struct {
    size_t ports, modes, padded_modes, coordinates; /* coordinates: 3 a port, padded */
    double mass, center_of_mass[3];
    double turning; /* root of the sum of mass times square of its distance from the centre of mass */
    InertiaCoupling coupling;
    Oscillators oscillators;
    double *damping_ratio;    /* before the scale */
    double *arms;             /* 3 a port */
    double *port_orientation; /* 4 a port */
    double *shapes;           /* modes rows of 2 coordinates: translations, then rotations */
    size_t second_order;      /* modes whose pairs displace the ports, 0 without */
    double *pairs;            /* by every two of them, 2 coordinates */
    unsigned short *second_place; /* where they are among the modes here */
    size_t forms;             /* of bending that stretches, 0 without */
    double *tension_forms;    /* by every mode of second order, padded, a row a form of as many */
    unsigned short *order;    /* mode j here is mode order[j] of the state and of the data */
    double start_position[3], start_orientation[4], start_velocity[3], start_angular_velocity[3];
    double *start_modal; /* in the order of the state */
    double gravity[3], damping_scale;
    int is_base;         /* 1: it has the input impulse, and tells of the loads at its ports */
    double *outside;     /* of a base 1 a port at which something from outside acts */
    double *origin_arms; /* 3 a port, from the construction frame's origin */
    int has_carried;     /* 1: `carried` tells loads without what accelerates bodies that a base carries */
    double carried[WRENCH_SIZE * CARRIED_COLUMNS];
    Remembered at_start, at_end, at_end_complex;
    Departure departure;
    void *work, *work_complex; /* of a large body */
} Body;

/* Working memory of one number type. Vectors over modes are padded, with zeros. */
typedef struct {
    real *eta_start, *pi_start, *eta_mean, *rate_mean, *rate_start;
    real *eta, *pi, *force, *port_force, *drag;
    real *slope, *moment;   /* slope of the modal forces; first moment of the modal rates */
    real *wrenches;         /* 2 coordinates: forces and torques conjugate to the modes, body axes */
    real *slope_wrenches;   /* 2 coordinates: their slopes */
    real *deflection;       /* 2 coordinates: of the ports, and their turns */
    real *rates;            /* 2 coordinates: the same for the modal rates */
    real *arms;             /* coordinates */
    real *arms_start;       /* coordinates: at the start of a step, world axes */
    real *arms_end;         /* coordinates: at its end, world axes */
    CouplingScratch coupling; /* at given modal coordinates, in a step at those of its end; without b_rate */
    CouplingScratch mid;      /* at the mean ones of a step */
    real *pairs;              /* what `pairs_of` divides */
    real *tensions;           /* what `tensions_of` divides */
} Work;

/* `split` holds values and slopes, at most 6 modes or 2 coordinates of sums and as many weights */
#define WORK_SPLIT(modes, coordinates) (7 * (modes) + 4 * (coordinates))
/* what `work_of` takes */
#define WORK_SIZE(modes, coordinates) (33 * (modes) + 11 * (coordinates) + WORK_SPLIT(modes, coordinates))
/* what `pairs_of` takes besides, for so many modes of second order */
#define PAIRS_SIZE(rows, modes, coordinates) \
    ((rows) ? 8 * (rows) * (coordinates) + 4 * (coordinates) + 3 * (rows) * (rows) + 6 * (rows) + (modes) : 0)
/* what `tensions_of` takes besides, for so many forms */
#define TENSIONS_SIZE(forms, rows) \
    ((forms) ? 7 * (forms) * (rows) + 4 * padded(forms) + 5 * (rows) * (rows) + 8 * (rows) : 0)

/* Working memory lies on the stack, where all bodies of a process find the same, warm in the cache; only that of
   large bodies, of 50 modes and more, is their own. */
#define LOCAL_WORK_SIZE 2560
typedef struct {
#ifdef __GNUC__
    __attribute__((aligned(64)))
#endif
    real numbers[LOCAL_WORK_SIZE];
} LocalWork;

/* The next so many numbers of a block, which then begins behind them. */
static inline real *taken(real **block, size_t count) {
    real *numbers = *block;
    *block += count;
    return numbers;
}

/* The working memory, cut out of its block. */
static inline Work work_of(const Body *body, LocalWork *local) {
#ifdef FANFOLD_COMPLEX
    real *next = body->work_complex ? body->work_complex : local->numbers;
#else
    real *next = body->work ? body->work : local->numbers;
#endif
    size_t n = body->padded_modes, l = body->coordinates;
    Work work;
    work.eta_start = taken(&next, n);
    work.pi_start = taken(&next, n);
    work.eta_mean = taken(&next, n);
    work.rate_mean = taken(&next, n);
    work.rate_start = taken(&next, n);
    work.eta = taken(&next, n);
    work.pi = taken(&next, n);
    work.force = taken(&next, n);
    work.port_force = taken(&next, n);
    work.drag = taken(&next, n);
    work.slope = taken(&next, n);
    work.moment = taken(&next, n);
    work.wrenches = taken(&next, 2 * l);
    work.slope_wrenches = taken(&next, 2 * l);
    work.deflection = taken(&next, 2 * l);
    work.rates = taken(&next, 2 * l);
    work.arms = taken(&next, l);
    work.arms_start = taken(&next, l);
    work.arms_end = taken(&next, l);
    work.coupling.quadratic = taken(&next, 6 * n);
    work.coupling.b = taken(&next, 3 * n);
    work.coupling.b_rate = NULL;
    work.mid.quadratic = taken(&next, 6 * n);
    work.mid.b = taken(&next, 3 * n);
    work.mid.b_rate = taken(&next, 3 * n);
    work.coupling.split = work.mid.split = (double *)next;
    work.pairs = next + WORK_SPLIT(n, l);
    work.tensions = work.pairs + PAIRS_SIZE(body->second_order, n, l);
    return work;
}

/* Forces and torques of wrenches, summed up, or their moments. */
typedef struct {
    Vector3 force, torque;
} Sums;

static inline Sums sums_of(const Body *body, const real *wrenches) {
    Sums sums = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t k = 0; k < body->ports; k++) {
        sums.force = vector_add(sums.force, vector_of(wrenches + WRENCH_SIZE * k));
        sums.torque = vector_add(sums.torque, vector_of(wrenches + WRENCH_SIZE * k + 3));
    }
    return sums;
}

/* Wrenches of all ports, world axes, linear in time over a step: means and slopes, and their sums. Without any slope,
   in value and in derivative, `sloped` is 0 and everything they do is left out. */
typedef struct {
    const real *wrenches, *slopes;
    Sums mean, slope;
    int sloped;
} Load;

/* Whether any of these numbers, or its derivative, has a bit that a zero has not. */
static inline int any_set(const real *numbers, size_t count) {
    uint64_t bits = 0, own;
    const unsigned char *bytes = (const unsigned char *)numbers;
    for (size_t i = 0; i < count * sizeof(real); i += sizeof own) {
        memcpy(&own, bytes + i, sizeof own);
        bits |= own;
    }
    return bits != 0;
}

static inline Load load_of(const Body *body, const real *u) {
    const real *slopes = u + WRENCH_SIZE * body->ports + body->is_base;
    Load load = {u, slopes, sums_of(body, u), {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, 0};
    load.sloped = any_set(load.slopes, WRENCH_SIZE * body->ports);
    if (load.sloped) load.slope = sums_of(body, load.slopes);
    return load;
}

/* Sum of the moments of the ports' mean forces on arms in the axes of rotation a. */
static inline Vector3 moment_of(const Body *body, const Load *load, const real *arms, const real a[9]) {
    Vector3 sum = {0.0, 0.0, 0.0};
    for (size_t k = 0; k < body->ports; k++)
        sum = vector_add(sum, vector_cross(matrix_times(a, vector_of(arms + 3 * k)),
                                           vector_of(load->wrenches + WRENCH_SIZE * k)));
    return sum;
}

/* A vector linear in time over a step. */
typedef struct {
    Vector3 mean, slope;
} Course;

/* The same of means and slopes, and the arms in world axes. */
static inline Course moments_at(const Body *body, const Load *load, const real *arms, const real a[9],
                                real *world_arms) {
    Course found = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t k = 0; k < body->ports; k++) {
        Vector3 arm = matrix_times(a, vector_of(arms + 3 * k));
        vector_store(arm, world_arms + 3 * k);
        found.mean = vector_add(found.mean, vector_cross(arm, vector_of(load->wrenches + WRENCH_SIZE * k)));
        if (load->sloped)
            found.slope = vector_add(found.slope, vector_cross(arm, vector_of(load->slopes + WRENCH_SIZE * k)));
    }
    return found;
}

/* Moment over a step, from the moments on the arms of both its ends. A changing force on an arm that moves on has a
   mean moment as well. */
static inline Course moment_over(const Load *load, const Course *start, const Course *end) {
    Course found = {vector_add(vector_mean(start->mean, end->mean), load->mean.torque), {0.0, 0.0, 0.0}};
    if (!load->sloped) return found;
    found.mean = vector_add(found.mean, vector_scaled(1.0 / 6.0, vector_subtract(end->slope, start->slope)));
    found.slope = vector_add(vector_mean(start->slope, end->slope), load->slope.torque);
    return found;
}

#endif
