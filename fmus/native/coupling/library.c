/* Functions that Python calls (orchestrator/cosim/coupling.py), for a coupling that owns its memory. */

#include <stdlib.h>
#include <string.h>

#include "data.h"
#include "memory.h"
#include "prediction.h"
#include "solver.h"
#include "tables.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    Coupling coupling;
    Memory memory;
    Data data;
    double *state;
    size_t size;
} Owned;

/* Sizes (bytes) of the shared records, by which a caller checks its own declarations. */
EXPORT void fanfold_sizes(size_t *sizes) {
    sizes[0] = sizeof(Participant);
    sizes[1] = sizeof(Request);
    sizes[2] = sizeof(Progress);
}

EXPORT void fanfold_free(Owned *o) {
    if (!o) return;
    release(&o->memory);
    free(o);
}

/* A coupling of participants from the bytes of its tables; NULL and a sentence where they are unusable. */
EXPORT Owned *fanfold_create(const Participant *participants, size_t count, const unsigned char *bytes, size_t size,
                             size_t room, Reason *why) {
    Owned *o = calloc(1, sizeof *o);
    if (!o) return NULL;
    Coupling *c = &o->coupling;
    if (data_parse(&o->data, "the tables of the coupling", bytes, size, &o->memory, why) &&
        coupling_create(c, &o->data, participants, count, room, &o->memory, why)) {
        o->size = coupling_arrange(c, NULL);
        o->state = allocate(&o->memory, (o->size + 1) * sizeof(double));
        if (o->state) {
            coupling_arrange(c, o->state);
            return o;
        }
    }
    fanfold_free(o);
    return NULL;
}

EXPORT Request *fanfold_request(Owned *o) { return &o->coupling.request; }
EXPORT Progress *fanfold_progress(Owned *o) { return &o->coupling.progress; }

/* An array by name, and how many numbers it has; NULL for none of that name. */
EXPORT double *fanfold_array(Owned *o, const char *name, size_t *count) {
    Coupling *c = &o->coupling;
    const Network *n = &c->network;
    const Rows *r = &c->rows;
    const size_t width = r->columns + CHANNELS + r->signals;
    const struct {
        const char *name;
        double *array;
        size_t count;
    } arrays[] = {{"state", o->state, o->size},
                  {"wrenches", n->wrenches, n->size},
                  {"accepted", n->accepted, n->size},
                  {"observations", n->observations, r->observations},
                  {"energies", n->energies, ENERGIES},
                  {"pending", c->pending, c->crossings},
                  {"reached", c->reached, c->crossings},
                  {"passed", c->passed, c->crossings},
                  {"steps", c->steps, r->room},
                  {"times", r->times, r->room},
                  {"values", r->values, r->room * width},
                  {"signal", r->signal, r->signals}};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (strcmp(arrays[i].name, name) == 0) {
            *count = arrays[i].count;
            return arrays[i].array;
        }
    return NULL;
}

/* tolerance: of a run; persistent: whether a slow damped iteration is made before a step is given up. */
EXPORT void fanfold_set(Owned *o, double tolerance, int persistent) {
    coupling_take_tolerance(&o->coupling, tolerance);
    o->coupling.solver.persistent = persistent;
}

EXPORT int fanfold_start(Owned *o) { return coupling_start(&o->coupling); }
EXPORT int fanfold_record_start(Owned *o) { return coupling_record_start(&o->coupling); }
EXPORT int fanfold_advance(Owned *o) { return coupling_advance(&o->coupling); }
EXPORT void fanfold_give_in(Owned *o) { coupling_give_in(&o->coupling); }
EXPORT void fanfold_watch(Owned *o) { coupling_watch(&o->coupling); }
EXPORT int fanfold_observe(Owned *o) {
    return network_observe(&o->coupling.network) || coupling_fails(&o->coupling, OF_PARTICIPANT);
}
EXPORT int fanfold_note_roughness(Owned *o, double after) { return coupling_note_roughness(&o->coupling, after); }
EXPORT int fanfold_record_jump(Owned *o, double after, int others) {
    return coupling_record_jump(&o->coupling, after, others);
}
EXPORT int fanfold_is_untold(const Owned *o) { return o->coupling.untold != 0; }
EXPORT int fanfold_impulse(Owned *o, double h) { return coupling_impulse(&o->coupling, h); }
EXPORT void fanfold_record_impulse(Owned *o) { coupling_record_impulse(&o->coupling); }
EXPORT double fanfold_engage(Owned *o, size_t line, int judged) { return coupling_engage(&o->coupling, line, judged); }
EXPORT void fanfold_release(Owned *o, size_t participant) { coupling_release(&o->coupling, participant); }
EXPORT int fanfold_unlatch(Owned *o, size_t line, int open) { return coupling_unlatch(&o->coupling, line, open); }
EXPORT void fanfold_judge_loads(Owned *o) { coupling_judge_loads(&o->coupling); }
EXPORT int fanfold_supply(Owned *o, double before) { return coupling_supply(&o->coupling, before); }
EXPORT void fanfold_renew(Owned *o, double known) { coupling_renew(&o->coupling, known); }
EXPORT void fanfold_restart(Owned *o, double size) { coupling_restart(&o->coupling, size); }
EXPORT void fanfold_begin_segment(Owned *o) { coupling_begin_segment(&o->coupling); }
EXPORT double fanfold_size(const Owned *o) { return size_now(&o->coupling.sizes); }
EXPORT double fanfold_smallest(const Owned *o) { return o->coupling.sizes.smallest; }
EXPORT double fanfold_instant(double size) { return instant_of(size); }
EXPORT double fanfold_distance(const Owned *o, size_t crossing) { return distance_of(o->coupling.crossing + crossing); }
EXPORT size_t fanfold_rows(const Owned *o) { return o->coupling.rows.count; }
EXPORT void fanfold_take_rows(Owned *o) { o->coupling.rows.count = 0; }
EXPORT void fanfold_release_rows(Owned *o) { rows_release(&o->coupling.rows); }
EXPORT size_t fanfold_sweeps(const Owned *o) { return o->coupling.network.sweeps; }
EXPORT double fanfold_seconds(const Owned *o) { return o->coupling.network.seconds; }
EXPORT void fanfold_forget(Owned *o, int bodies) {
    bodies ? forget_all(&o->coupling.solver) : forget_stiffnesses(&o->coupling.solver);
}
EXPORT void fanfold_predict(const Owned *o, double h, double *result) {
    const Coupling *c = &o->coupling;
    predict(&c->network, c->progress.time + 0.5 * h, h, result);
}
EXPORT double fanfold_step_after_jump(Owned *o, double h, const double *change) {
    return coupling_step_after_jump(&o->coupling, h, change);
}

/* Add a row of what was observed last, for a step h (s) after so many iterations. */
EXPORT void fanfold_add_row(Owned *o, double h, double iterations) {
    Coupling *c = &o->coupling;
    guard_accepts(&c->guard, c->network.energies);
    rows_add(&c->rows, &c->network, c->progress.time, h, iterations, c->segment + 0.5);
}

/* Copy numbers of the coupling into "state", or restore the coupling from it. */
EXPORT void fanfold_write_state(Owned *o) { coupling_exchange_scalars(&o->coupling, 1); }
EXPORT int fanfold_stand(Owned *o) { return coupling_stand(&o->coupling); }
