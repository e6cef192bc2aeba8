/* Interface Jacobians by step size: from directional derivatives, or by differences where a participant has none. */

#include "interface_jacobians.h"

#include <math.h>
#include <string.h>

#define POSE_CHANGE 1e-7
#define RATE_CHANGE 1e-6
#define DISPLACEMENT 1e-5 /* largest motion (m, rad) by a changed wrench */
#define VELOCITY 1e-3
#define ALIKE 1e-2 /* largest relative difference of sizes that share mobilities: an iteration leaves 2 % of an error */

void jacobians_outdate(Jacobians *j) {
    for (size_t i = 0; i < j->kept; i++) j->sizes[i].has_stiffnesses = 0;
}

void jacobians_forget(Jacobians *j) {
    jacobians_outdate(j);
    for (size_t i = 0; i < j->kept; i++) {
        SizedJacobian *one = j->sizes + i;
        one->h = 0.0;
        one->last_use = 0;
        one->has_mobilities = one->bodies_outdated = 0;
    }
    j->uses = 0;
    j->once_h = 0.0;
}

size_t block_size(const Network *n, size_t participant) {
    const size_t ports = n->participant[participant].ports;
    return n->width.wrench * n->width.coordinates * ports * ports;
}

/* Scale a constant mobility that was evaluated once to another step size: poses and moments are proportional to the
   square of the size, rates to the size. */
static void take_constant(const Network *n, const Jacobians *j, size_t i, double ratio, double *numbers) {
    const size_t columns = n->width.wrench * n->participant[i].ports, coordinates = n->width.coordinates;
    const double *once = j->once + j->first[i];
    for (size_t k = 0; k < block_size(n, i); k++)
        numbers[k] = once[k] * (k / columns % coordinates < coordinates - RATES ? ratio * ratio : ratio);
    memcpy(numbers + block_size(n, i), once + block_size(n, i), 9 * sizeof(double));
}

/* Copy the mobilities of a step of nearly this size: events are located by steps that differ little. */
static void take_alike(const Network *n, Jacobians *j, SizedJacobian *to) {
    for (size_t i = 0; i < j->kept; i++) {
        const SizedJacobian *from = j->sizes + i;
        if (from == to || !from->has_mobilities || !(fabs(from->h - to->h) < ALIKE * to->h)) continue;
        memcpy(to->numbers, from->numbers, j->first[n->bodies] * sizeof(double));
        for (size_t b = 0; b < n->bodies; b++)
            if (j->constant[b] && j->once_h != 0.0) take_constant(n, j, b, to->h / j->once_h, to->numbers + j->first[b]);
        to->has_mobilities = 1;
        return;
    }
}

SizedJacobian *jacobian_of(const Network *n, Jacobians *j, double h) {
    SizedJacobian *found = j->sizes;
    for (SizedJacobian *one = j->sizes; one < j->sizes + j->kept && found->h != h; one++)
        if (one->h == h || one->last_use < found->last_use) found = one;
    if (found->h != h) {
        found->h = h;
        found->has_mobilities = found->has_stiffnesses = found->bodies_outdated = 0;
        take_alike(n, j, found);
    }
    found->last_use = ++j->uses;
    return found;
}

const SizedJacobian *nearest_mobilities(const Jacobians *j, double h) {
    const SizedJacobian *best = NULL;
    for (const SizedJacobian *one = j->sizes; one < j->sizes + j->kept; one++)
        if (one->has_mobilities && (!best || fabs(log(one->h / h)) < fabs(log(best->h / h)))) best = one;
    return best;
}

/* Write the difference of a body's outputs from `kept`, over an amount, as a column of its mobility. */
static void note_difference(const Participant *p, Width width, const double *kept, double amount, double *column) {
    const size_t columns = width.wrench * p->ports;
    for (size_t port = 0; port < p->ports; port++) {
        const double *a = p->output + MOTION * port, *b = kept + MOTION * port, *qa = a + 3, *qb = b + 3;
        double *out = column + width.coordinates * port * columns;
        double *rates = out + (width.coordinates - RATES) * columns;
        const double same = qa[0] * qb[0] + qa[1] * qb[1] + qa[2] * qb[2] + qa[3] * qb[3];
        for (size_t k = 0; k < 3; k++) {
            const size_t i = 1 + (k + 1) % 3, l = 1 + (k + 2) % 3;
            /* rotation vector: twice the vector part of qa times the conjugate of qb */
            const double turned = qb[0] * qa[k + 1] - qa[0] * qb[k + 1] - qa[i] * qb[l] + qa[l] * qb[i];
            out[k * columns] = (a[k] - b[k]) / amount;
            out[(3 + k) * columns] = copysign(2.0, same) * turned / amount;
        }
        for (size_t k = 0; k < RATES; k++) rates[k * columns] = (a[7 + k] - b[7 + k]) / amount;
        for (size_t k = POSE; k + RATES < width.coordinates; k++) {
            const size_t moment = p->moments + MOMENTS * port + k - POSE;
            out[k * columns] = p->moments ? (p->output[moment] - kept[moment]) / amount : 0.0;
        }
    }
}

/* Compute the mobility of a body by differences of steps from its saved state. */
static int mobility_by_differences(Network *n, size_t i, double *matrix, double *kept) {
    const Participant *p = n->participant + i;
    const size_t columns = n->width.wrench * p->ports;
    const double amount = fmin(DISPLACEMENT / (n->h * n->h), VELOCITY / n->h);
    memcpy(kept, p->output, p->outputs * sizeof(double));
    memset(matrix, 0, block_size(n, i) * sizeof(double));
    for (size_t column = 0; column < columns; column++) {
        const size_t port = column / n->width.wrench, k = column % n->width.wrench;
        double *input = p->input + (k < WRENCH ? WRENCH * port + k : p->slopes + WRENCH * port + k - WRENCH);
        if (k >= WRENCH && !p->slopes) continue;
        const double held = *input;
        *input += amount;
        const int fine = network_step_one(n, i);
        *input = held;
        if (!fine) return 0;
        note_difference(p, n->width, kept, amount, matrix + column);
    }
    return network_step_one(n, i);
}

/* Change a coordinate of the motion at a connection's port; returns by how much, 0 for one that it does not have. */
static double displace(const Participant *p, Width width, size_t port, size_t k) {
    double *motion = p->input + MOTION * port, *q = motion + 3;
    if (k < 3) motion[k] += POSE_CHANGE;
    else if (k < POSE) {
        const double before[4] = {q[0], q[1], q[2], q[3]}, half = 0.5 * POSE_CHANGE, whole = sqrt(1.0 - half * half);
        const size_t i = k - 3, a = (i + 1) % 3, b = (i + 2) % 3;
        q[0] = whole * before[0] - half * before[1 + i];
        q[1 + i] = whole * before[1 + i] + half * before[0];
        q[1 + a] = whole * before[1 + a] - half * before[1 + b];
        q[1 + b] = whole * before[1 + b] + half * before[1 + a];
    } else if (k >= width.coordinates - RATES) {
        motion[7 + k - (width.coordinates - RATES)] += RATE_CHANGE;
        return RATE_CHANGE;
    } else if (p->moments) p->input[p->moments + MOMENTS * port + k - POSE] += POSE_CHANGE;
    else return 0.0;
    return POSE_CHANGE;
}

/* Compute the stiffness of a connection by differences of steps from its saved state. */
static int stiffness_by_differences(Network *n, size_t i, double *matrix, double *kept) {
    const Participant *p = n->participant + i;
    const Width width = n->width;
    const size_t columns = width.coordinates * p->ports;
    double *inputs = kept + p->outputs;
    memcpy(kept, p->output, p->outputs * sizeof(double));
    memcpy(inputs, p->input, p->inputs * sizeof(double));
    memset(matrix, 0, block_size(n, i) * sizeof(double));
    for (size_t column = 0; column < columns; column++) {
        const double amount = displace(p, width, column / width.coordinates, column % width.coordinates);
        const int fine = amount == 0.0 || network_step_one(n, i);
        memcpy(p->input, inputs, p->inputs * sizeof(double));
        if (!fine) return 0;
        for (size_t row = 0; amount != 0.0 && row < width.wrench * p->ports; row++) {
            const size_t port = row / width.wrench, k = row % width.wrench;
            const size_t at = k < WRENCH ? WRENCH * port + k : p->slopes + WRENCH * port + k - WRENCH;
            if (k < WRENCH || p->slopes) matrix[row * columns + column] = (p->output[at] - kept[at]) / amount;
        }
    }
    return network_step_one(n, i);
}

int fill_block(Network *n, const Jacobians *j, size_t i, double *numbers) {
    const Participant *p = n->participant + i;
    const int is_body = i < n->bodies;
    axes_of(is_body ? p->output : p->input, numbers + block_size(n, i));
    if (!p->derivative)
        return is_body ? mobility_by_differences(n, i, numbers, j->slope)
                       : stiffness_by_differences(n, i, numbers, j->slope);
    const int status = is_body ? participant_mobility(p, n->width, numbers, j->slope)
                               : participant_stiffness(p, n->width, numbers, j->slope);
    return status <= FMI_WARNING || network_fail(n, i, STEP, status);
}

static int fill_mobilities(Network *n, Jacobians *j, SizedJacobian *one) {
    for (size_t i = 0; i < n->bodies; i++) {
        double *numbers = one->numbers + j->first[i];
        if (j->constant[i] && j->once_h != 0.0) take_constant(n, j, i, one->h / j->once_h, numbers);
        else if (!fill_block(n, j, i, numbers)) return 0;
    }
    if (j->once_h == 0.0) {
        memcpy(j->once, one->numbers, j->first[n->bodies] * sizeof(double));
        j->once_h = one->h;
    }
    one->has_mobilities = 1;
    one->bodies_outdated = 0;
    return 1;
}

static int fill_stiffnesses(Network *n, Jacobians *j, SizedJacobian *one) {
    for (size_t i = n->bodies; i < n->participants; i++)
        if (!fill_block(n, j, i, one->numbers + j->first[i])) return 0;
    return one->has_stiffnesses = 1;
}

int use_jacobian(Network *n, Jacobians *j, SizedJacobian *one) {
    if ((!one->has_mobilities || one->bodies_outdated) && !fill_mobilities(n, j, one)) return 0;
    if (!one->has_stiffnesses && !fill_stiffnesses(n, j, one)) return 0;
    n->mobility = one->mobility;
    n->stiffness = one->stiffness;
    return 1;
}
