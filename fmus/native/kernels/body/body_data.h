/* Making a body from data that are not trusted: part of body.c. */

#ifndef FANFOLD_BODY_DATA_H
#define FANFOLD_BODY_DATA_H

#include "body_interface.h"

#define MOST_MODES 1024
#define MOST_PORTS 1024

/* The array of that name with `count` finite numbers. */
static const double *finite_array(const Data *data, const char *name, size_t count, Reason *why) {
    const double *values = data_array(data, name, count, why);
    for (size_t i = 0; values && i < count; i++)
        if (!isfinite(values[i])) {
            refuse(why, "the body's data have a value of %s that is not finite", name);
            return NULL;
        }
    return values;
}

/* Copies `count` finite numbers. */
static int copy_array(const Data *data, const char *name, size_t count, double *place, Reason *why) {
    const double *values = finite_array(data, name, count, why);
    if (!values) return 0;
    memcpy(place, values, count * sizeof(double));
    return 1;
}

/* Number of forms by which bending stretches, from the size of their array. */
static int read_forms(Body *body, const Data *data, Reason *why) {
    size_t numbers = 0, square = body->second_order * body->second_order;
    if (!data_any(data, "tension_forms", &numbers, why)) return 0;
    if (numbers && (square == 0 || numbers % square != 0 || numbers / square > square))
        return refuse(why, "the body's data have %lu numbers of tension_forms; it takes %lu a form, for at most as many forms",
                      (unsigned long)numbers, (unsigned long)square);
    body->forms = numbers ? numbers / square : 0;
    return 1;
}

/* Numbers of ports and of modes, from the sizes of two arrays. */
static int read_sizes(Body *body, const Data *data, const Sizes *sizes, Reason *why) {
    size_t arms = 0, modes = 0;
    if (!data_any(data, "arms", &arms, why) || !data_any(data, "frequency", &modes, why)) return 0;
    if (arms % 3 != 0 || arms / 3 > MOST_PORTS)
        return refuse(why, "the body's data have %lu numbers for arms; it takes 3 a port, for at most %d ports",
                      (unsigned long)arms, MOST_PORTS);
    if (modes > MOST_MODES)
        return refuse(why, "the body's data have %lu modes; there can be at most %d", (unsigned long)modes,
                      MOST_MODES);
    const double *is_base = finite_array(data, "is_base", 1, why);
    if (!is_base) return 0;
    body->is_base = is_base[0] != 0.0;
    if (body->is_base && modes) return refuse(why, "is_base is for rigid bodies; this one has %lu modes", (unsigned long)modes);
    const double *second_order = finite_array(data, "second_order_modes", 1, why);
    if (!second_order) return 0;
    if (!(second_order[0] >= 0.0 && second_order[0] <= (double)modes))
        return refuse(why, "the body's data have %g modes of second order; it has %lu modes", second_order[0],
                      (unsigned long)modes);
    body->second_order = (size_t)second_order[0];
    if (!read_forms(body, data, why)) return 0;
    body->ports = arms / 3;
    body->modes = modes;
    body->padded_modes = padded(modes);
    body->coordinates = padded(arms);
    const size_t wrenches = WRENCH_SIZE * body->ports;
    const Sizes own = {PARAMETERS + modes, 2 * wrenches + body->is_base, MOTION_SIZE * body->ports + wrenches,
                       OBSERVATIONS + modes + (body->is_base ? interface_told(body) : 0)};
    if (!check_sizes(KIND, sizes, &own, why)) return 0;
    return 1;
}

/* For numbers of a size. */
static int remembered_allocate(const Body *body, Remembered *remembered, size_t size, Memory *memory) {
    const size_t mode = (body->padded_modes + 1) * size, port = (2 * body->coordinates + 1) * size;
    remembered->eta = allocate(memory, mode);
    remembered->quadratic = allocate(memory, 6 * mode);
    remembered->b = allocate(memory, 3 * mode);
    remembered->inertia = allocate(memory, 6 * size);
    remembered->deflection = allocate(memory, port);
    remembered->pairs = allocate(memory, (body->second_order + 1) * port);
    return remembered->eta && remembered->quadratic && remembered->b && remembered->inertia &&
           remembered->deflection && remembered->pairs;
}

static int departure_allocate(const Body *body, Departure *departure, Memory *memory) {
    const size_t mode = (body->padded_modes + 1) * sizeof(double);
    departure->momenta = allocate(memory, mode);
    departure->rates = allocate(memory, mode);
    departure->b = allocate(memory, 3 * mode);
    return departure->momenta && departure->rates && departure->b;
}

/* Working memory that is too large for the stack; 0 without memory. */
static int allocate_work(Body *body, Memory *memory) {
    size_t numbers = WORK_SIZE(body->padded_modes, body->coordinates) +
                     PAIRS_SIZE(body->second_order, body->padded_modes, body->coordinates) +
                     TENSIONS_SIZE(body->forms, padded(body->second_order));
    if (numbers <= LOCAL_WORK_SIZE) return 1;
    body->work = allocate(memory, numbers * sizeof(double));
    body->work_complex = allocate(memory, numbers * sizeof(double complex));
    return body->work && body->work_complex;
}

static int allocate_all(Body *body, Memory *memory, Reason *why) {
    size_t n = body->padded_modes, l = body->coordinates, mode = (n + 1) * sizeof(double);
    body->damping_ratio = allocate(memory, mode);
    body->start_modal = allocate(memory, mode);
    body->order = allocate(memory, (n + 1) * sizeof *body->order);
    body->arms = allocate(memory, (l + 1) * sizeof(double));
    body->origin_arms = allocate(memory, (l + 1) * sizeof(double));
    body->outside = allocate(memory, (body->ports + 1) * sizeof(double));
    body->port_orientation = allocate(memory, (4 * body->ports + 1) * sizeof(double));
    body->shapes = allocate(memory, 2 * l * mode);
    body->second_place = allocate(memory, (n + 1) * sizeof *body->second_place);
    body->pairs = allocate(memory, (2 * l * body->second_order * body->second_order + 1) * sizeof(double));
    body->tension_forms = allocate(memory, (body->forms * padded(body->second_order) * padded(body->second_order) + 1) * sizeof(double));
    body->coupling.slope = allocate(memory, 6 * mode);
    if (!body->damping_ratio || !body->start_modal || !body->order || !body->arms || !body->origin_arms || !body->outside ||
        !body->port_orientation || !body->shapes || !body->second_place || !body->pairs ||
        !body->tension_forms || !body->coupling.slope || !allocate_work(body, memory) ||
        !oscillators_allocate(&body->oscillators, n, memory) ||
        !departure_allocate(body, &body->departure, memory) ||
        !remembered_allocate(body, &body->at_start, sizeof(double), memory) ||
        !remembered_allocate(body, &body->at_end, sizeof(double), memory) ||
        !remembered_allocate(body, &body->at_end_complex, sizeof(double complex), memory))
        return refuse(why, "no memory for a body of %lu modes", (unsigned long)body->modes);
    return 1;
}

static int read_mass(Body *body, const Data *data, Reason *why) {
    if (!copy_array(data, "mass", 1, &body->mass, why)) return 0;
    if (!(body->mass > 0.0)) return refuse(why, "mass is %g kg; it must be positive", body->mass);
    const double *inertia = body->coupling.inertia;
    if (!copy_array(data, "center_of_mass", 3, body->center_of_mass, why) ||
        !copy_array(data, "inertia", 6, body->coupling.inertia, why) ||
        !copy_array(data, "inverse_inertia", 9, body->coupling.inverse, why))
        return 0;
    body->turning = sqrt(0.5 * (inertia[0] + inertia[1] + inertia[2]));
    return 1;
}

static int read_carried(Body *body, const Data *data, Reason *why) {
    const size_t expected = WRENCH_SIZE * CARRIED_COLUMNS;
    size_t numbers = 0;
    if (!data_any(data, "carried", &numbers, why)) return 0;
    if (numbers && numbers != expected)
        return refuse(why, "the body's data have %lu numbers of carried; it takes %lu", (unsigned long)numbers,
                      (unsigned long)expected);
    body->has_carried = numbers != 0;
    if (!copy_array(data, "base_outside", body->ports, body->outside, why)) return 0;
    return !numbers || copy_array(data, "carried", expected, body->carried, why);
}

static int read_oscillators(Body *body, const Data *data, Reason *why) {
    Oscillators *oscillators = &body->oscillators;
    const double *frequency = finite_array(data, "frequency", body->modes, why);
    const double *ratio = frequency ? finite_array(data, "damping_ratio", body->modes, why) : NULL;
    if (!ratio) return 0;
    for (size_t j = 0; j < body->modes; j++) {
        double own = oscillators->frequency[j] = frequency[body->order[j]];
        body->damping_ratio[j] = ratio[body->order[j]];
        if (!(own > 0.0))
            return refuse(why, "every mode must have a positive frequency; remove the rigid modes first");
        if (!(body->damping_ratio[j] >= 0.0)) return refuse(why, "modal damping ratios must not be negative");
        oscillators->compliance[j] = 1.0 / (own * own);
    }
    return 1;
}

/* Shapes of one kind (ports, 3, modes), stored from coordinate `first` on. */
static int read_shapes(Body *body, const Data *data, const char *name, size_t first, Reason *why) {
    size_t m = body->modes, length = 2 * body->coordinates;
    const double *shapes = finite_array(data, name, 3 * body->ports * m, why);
    if (!shapes) return 0;
    for (size_t i = 0; i < 3 * body->ports; i++)
        for (size_t j = 0; j < m; j++) body->shapes[j * length + first + i] = shapes[i * m + body->order[j]];
    return 1;
}

/* Displacements and turns of the ports (ports, 6, modes of second order twice), those of a pair together. */
static int read_second_order(Body *body, const Data *data, Reason *why) {
    size_t count = body->second_order, l = body->coordinates;
    const double *values = finite_array(data, "second_order", 6 * body->ports * count * count, why);
    if (!values) return 0;
    for (size_t j = 0; j < body->modes; j++)
        if (body->order[j] < count) body->second_place[body->order[j]] = (unsigned short)j;
    for (size_t i = 0; i < 6 * body->ports * count; i++) {
        size_t port = i / (6 * count), axis = i / count % 6, s = i % count;
        size_t place = (axis < 3 ? 0 : l) + 3 * port + axis % 3;
        for (size_t t = 0; t < count; t++) body->pairs[(t * count + s) * 2 * l + place] = values[i * count + t];
    }
    return 1;
}

/* Of every mode of second order the rows of all forms. */
static int read_tension_forms(Body *body, const Data *data, Reason *why) {
    const size_t count = body->second_order, rows = padded(count), length = body->forms * rows;
    const double *values = finite_array(data, "tension_forms", body->forms * count * count, why);
    if (!values) return 0;
    for (size_t p = 0; p < body->forms; p++)
        for (size_t s = 0; s < count; s++)
            for (size_t t = 0; t < count; t++)
                body->tension_forms[s * length + p * rows + t] = values[(p * count + s) * count + t];
    return 1;
}

static int read_ports(Body *body, const Data *data, Reason *why) {
    return copy_array(data, "arms", 3 * body->ports, body->arms, why) &&
           copy_array(data, "port_orientation", 4 * body->ports, body->port_orientation, why) &&
           read_shapes(body, data, "translation", 0, why) &&
           read_shapes(body, data, "rotation", body->coordinates, why) && read_second_order(body, data, why) &&
           read_tension_forms(body, data, why);
}

static int read_level(Body *body, const Data *data, Reason *why) {
    double varies = 0.0, full = 0.0;
    if (!copy_array(data, "inertia_varies", 1, &varies, why) || !copy_array(data, "full_coupling", 1, &full, why))
        return 0;
    body->coupling.modes = body->padded_modes;
    body->coupling.varies = body->modes && varies != 0.0;
    body->coupling.full = body->coupling.varies && full != 0.0;
    return 1;
}

/* The invariants that the level keeps, and the order of the modes that suits them. */
static int read_coupling(Body *body, const Data *data, Memory *memory, Reason *why) {
    InertiaCoupling *coupling = &body->coupling;
    size_t m = body->modes, n = body->padded_modes;
    for (size_t j = 0; j < m; j++) body->order[j] = (unsigned short)j;
    if (coupling->full) {
        const double *tensors = finite_array(data, "tensors", 9 * m * m, why);
        if (!tensors) return 0;
        const StackedMatrices quadratic = {tensors, 6, m, 1.0, body->order};
        const StackedMatrices gyroscopic = {tensors + 6 * m * m, 3, m, -1.0, body->order};
        order_by_interaction(&gyroscopic, body->order);
        if (!triangles_create(&coupling->quadratic, &quadratic, memory) ||
            !triangles_create(&coupling->gyroscopic, &gyroscopic, memory))
            return refuse(why, "no memory for the inertia of %lu modes", (unsigned long)m);
    }
    if (!coupling->varies) return 1;
    const double *slope = finite_array(data, "slope", 6 * m, why);
    if (!slope) return 0;
    for (size_t p = 0; p < 6; p++)
        for (size_t j = 0; j < m; j++) coupling->slope[p * n + j] = slope[p * m + body->order[j]];
    return 1;
}

static void *create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Body *body = allocate(memory, sizeof *body);
    if (!body) {
        refuse(why, "no memory for a body");
        return NULL;
    }
    body->damping_scale = -1.0; /* none yet */
    if (!read_sizes(body, data, sizes, why) || !read_level(body, data, why) || !allocate_all(body, memory, why) ||
        !read_mass(body, data, why) || !read_carried(body, data, why) || !read_coupling(body, data, memory, why) ||
        !read_oscillators(body, data, why) || !read_ports(body, data, why))
        return NULL;
    for (size_t i = 0; i < 3 * body->ports; i++) body->origin_arms[i] = body->arms[i] + body->center_of_mass[i % 3];
    *states = interface_begin(body) + (body->is_base ? interface_states(body) : 0);
    return body;
}

#endif
