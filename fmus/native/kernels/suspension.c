/* Suspension: a spring that only pulls, along the line between two points: the twin of components/suspension.py. */

#include "suspension_layout.h"
#include "span.h"

static inline real span_tension(const Span *self, real elongation, real rate) {
    return tension_at(&self->law, self->base.p[P_DAMPING], elongation, rate);
}

static inline MeanLoad span_load(const Span *self, const StepMotion *motion, int paired) {
    const double damping = self->base.p[P_DAMPING];
    if (paired) return strand_load(&self->law, damping, motion);
    MeanLoad load = {0.0, 0.0, 0.0, 0.0};
    load.force = -mean_tension(&self->law, damping, motion->start, motion->end, motion->h, &load.heat);
    return load;
}

SPAN_FUNCTIONS(suspension)

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(suspension)

static void *suspension_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    return create_connection(data, sizes, memory, sizeof(Span), states, why);
}

static int suspension_prepare(void *self, const double *p, Reason *why) {
    Span *suspension = self;
    suspension->law = strand_law(p[P_STIFFNESS], p[P_PRELOAD]);
    return prepare_connection(self, p, p[P_ORDER], why);
}

#define suspension_initial span_initial
#define suspension_observe span_observe
const Kernel suspension_kernel = {CONNECTION_FUNCTIONS(suspension, suspension)};

#endif
