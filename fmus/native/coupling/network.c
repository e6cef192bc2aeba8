/* One sweep over all participants, and what they exchange in it. */

#define _POSIX_C_SOURCE 200112L

#include "network.h"

#include <math.h>
#include <string.h>

#ifdef _WIN32
/* windows.h defines names that are used here */
__declspec(dllimport) int __stdcall QueryPerformanceCounter(long long *count);
__declspec(dllimport) int __stdcall QueryPerformanceFrequency(long long *frequency);
#else
#include <time.h>
#endif

double seconds_now(void) {
#ifdef _WIN32
    long long count, frequency;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&frequency);
    return (double)count / (double)frequency;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

static double sum_of(const double *values, size_t size) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        s0 += values[i];
        s1 += values[i + 1];
        s2 += values[i + 2];
        s3 += values[i + 3];
    }
    for (; i < size; i++) s0 += values[i];
    return (s0 + s1) + (s2 + s3);
}

/* Finite values may have a sum that overflows; then each is checked. */
int all_finite(const double *values, size_t size) {
    if (isfinite(sum_of(values, size))) return 1;
    for (size_t i = 0; i < size; i++)
        if (!isfinite(values[i])) return 0;
    return 1;
}

int network_fail(Network *n, size_t participant, size_t call, int status) {
    n->failed = participant;
    n->failed_call = call;
    n->failed_status = status;
    return 0;
}

int network_step_one(Network *n, size_t i) {
    const Participant *p = n->participant + i;
    int status = p->set_state(p->component, *p->saved);
    if (status > FMI_WARNING) return network_fail(n, i, RESTORE, status);
    status = p->set_real(p->component, p->input_references, p->inputs, p->input);
    if (status > FMI_WARNING) return network_fail(n, i, SET, status);
    status = p->do_step(p->component, n->time, n->h, 0);
    if (status > FMI_WARNING) return network_fail(n, i, STEP, status);
    status = p->get_real(p->component, p->output_references, p->outputs, p->output);
    if (status > FMI_WARNING) return network_fail(n, i, GET, status);
    return all_finite(p->output, p->outputs) ? 1 : network_fail(n, i, FINITE, 0);
}

static int step_all(Network *n, size_t first, size_t last) {
    for (size_t i = first; i < last; i++)
        if (!network_step_one(n, i)) return 0;
    return 1;
}

/* Copy slopes or moments of a port (`count` numbers), where both sides have them. */
static void carry(double *to, size_t to_first, size_t to_port, const double *from, size_t from_first, size_t from_port,
                  size_t count) {
    if (to_first && from_first)
        memcpy(to + to_first + count * to_port, from + from_first + count * from_port, count * sizeof(double));
}

static void give_wrenches(Network *n) {
    const double *wrench = n->wrenches;
    for (const Link *l = n->link; l < n->link + n->links; l++, wrench += n->width.wrench) {
        const Participant *body = n->participant + l->body;
        memcpy(body->input + WRENCH * l->body_port, wrench, WRENCH * sizeof(double));
        carry(body->input, body->slopes, l->body_port, wrench, WRENCH, 0, WRENCH);
    }
}

void network_give_motions(Network *n) {
    for (const Link *l = n->link; l < n->link + n->links; l++) {
        const Participant *body = n->participant + l->body, *connection = n->participant + l->connection;
        memcpy(connection->input + MOTION * l->connection_port, body->output + MOTION * l->body_port,
               MOTION * sizeof(double));
        carry(connection->input, connection->moments, l->connection_port, body->output, body->moments, l->body_port,
              MOMENTS);
    }
}

static void take_wrenches(Network *n) {
    double *law = n->law;
    for (const Link *l = n->link; l < n->link + n->links; l++, law += n->width.wrench) {
        const Participant *connection = n->participant + l->connection;
        memcpy(law, connection->output + WRENCH * l->connection_port, WRENCH * sizeof(double));
        carry(law, WRENCH, 0, connection->output, connection->slopes, l->connection_port, WRENCH);
    }
}

static int exchange(Network *n) {
    give_wrenches(n);
    if (!step_all(n, 0, n->bodies)) return 0;
    network_give_motions(n);
    if (!step_all(n, n->bodies, n->participants)) return 0;
    take_wrenches(n);
    return 1;
}

int network_sweep(Network *n, double time, double h) {
    const double begin = seconds_now();
    n->time = time;
    n->h = h;
    n->sweeps++;
    const int fine = exchange(n);
    n->seconds += seconds_now() - begin;
    return fine;
}

int network_restore(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        int status = p->set_state(p->component, *p->saved);
        if (status > FMI_WARNING) return network_fail(n, i, RESTORE, status);
        status = p->get_real(p->component, p->output_references, p->outputs, p->output);
        if (status > FMI_WARNING) return network_fail(n, i, GET, status);
    }
    network_give_motions(n);
    return 1;
}

int network_save(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        if (*p->saved && !p->overwrites_state) {
            p->free_state(p->component, p->saved);
            *p->saved = NULL;
        }
        const int status = p->get_state(p->component, p->saved);
        if (status > FMI_WARNING) return network_fail(n, i, SAVE, status);
    }
    return 1;
}

int network_observe(Network *n) {
    for (size_t i = 0; i < n->participants; i++) {
        const Participant *p = n->participant + i;
        int status = p->set_real(p->component, p->input_references, p->inputs, p->input);
        if (status > FMI_WARNING) return network_fail(n, i, SET, status);
        if (p->observations == 0) continue;
        status = p->get_real(p->component, p->observation_references, p->observations, p->observation);
        if (status > FMI_WARNING) return network_fail(n, i, OBSERVE, status);
        if (!all_finite(p->observation, p->observations)) return network_fail(n, i, OBSERVED, 0);
    }
    const size_t *row = n->energy_rows;
    for (size_t kind = 0; kind < ENERGIES; kind++) {
        n->energies[kind] = 0.0;
        for (size_t i = 0; i < n->participants; i++) n->energies[kind] += n->observations[*row++];
    }
    return 1;
}

double balance_of(const double *e) {
    return e[KINETIC] + e[POTENTIAL] + e[DISSIPATED] + e[NUMERICAL] - e[SUPPLIED];
}
