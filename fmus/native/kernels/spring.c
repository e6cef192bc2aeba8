/* Spring and damper along the line between two points, which pulls and pushes: the twin of components/spring.py. */

#include "spring_layout.h"
#include "span.h"

static inline real span_tension(const Span *self, real elongation, real rate) {
    return self->base.p[P_DAMPING] * rate - span_value(self, elongation);
}

static inline MeanLoad span_load(const Span *self, const StepMotion *motion, int paired) {
    const double damping = self->base.p[P_DAMPING];
    real start = motion->start, end = motion->end;
    real elastic = law_mean_force(&self->law, start, end), tangent = law_tangent(&self->law, start, end);
    if (self->table.pieces) {
        elastic += law_mean_force(&self->table, start, end);
        tangent += law_tangent(&self->table, start, end);
    }
    if (paired) return workless_load(elastic, tangent, damping, motion, motion->roughness);
    return damped_load(elastic, self->base.p[P_STIFFNESS], damping, motion);
}

SPAN_FUNCTIONS(spring)

#ifndef FANFOLD_COMPLEX

DECLARE_COMPLEX(spring)

static void *spring_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Span *spring = create_connection(data, sizes, memory, sizeof *spring, states, why);
    int has_table;
    if (!spring || !read_choice(data, "has_table", 1, &has_table, why)) return NULL;
    return !has_table || read_table(data, memory, "tension", &spring->table, why) ? spring : NULL;
}

static int spring_prepare(void *self, const double *p, Reason *why) {
    Span *spring = self;
    spring->law = spring_law(p[P_STIFFNESS], 0.0);
    spring->law.constant = -p[P_PRELOAD];
    return prepare_connection(self, p, p[P_ORDER], why);
}

#define spring_initial span_initial
#define spring_observe span_observe
const Kernel spring_kernel = {CONNECTION_FUNCTIONS(spring, spring)};

#endif
