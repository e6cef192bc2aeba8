/* See differences.h. */

#include "differences.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluate.h"
#include "input_slopes.h"
#include "layout.h"

/* What iterations of steps leave, over what they iterate. */
#define ITERATED 1e-12

/* What is differentiated, and where from; `by_step`: over the step made last, from the state before it. */
typedef struct {
    Instance *instance;
    const uint32_t *knowns;
    size_t known_count;
    const double *seed;
    double *base; /* present values of the knowns */
    int by_step, parameters, states, rates;
} Query;

/* Distances from the present knowns and the weights of what is there, over one distance. */
enum { POINTS = 3, STENCILS = 3 };
typedef struct {
    double at[POINTS], weight[POINTS];
} Stencil;

static const Stencil STENCIL[STENCILS] = {{{1.0, -1.0, 0.0}, {0.5, -0.5, 0.0}},
                                          {{1.0, 2.0, 0.0}, {2.0, -0.5, -1.5}},
                                          {{-1.0, -2.0, 0.0}, {-2.0, 0.5, 1.5}}};

int is_exact(const ExactRanges *exact, uint32_t unknown) {
    return (unknown >= exact->first[0] && unknown < exact->end[0]) ||
           (unknown >= exact->first[1] && unknown < exact->end[1]);
}

static double *place_of(Instance *instance, uint32_t known) {
    if (known < instance->ends[3])
        return instance->values + known;
    return instance->x + instance->continuous.places[known - instance->ends[3]];
}

/* What follows from the knowns is to be computed anew. */
static void forget(const Query *query) {
    Instance *instance = query->instance;
    instance->outputs_known = instance->observations_known = instance->continuous.known = instance->inputs_finite = 0;
    if (query->parameters)
        instance->prepared = 0;
    if (instance->mode < MODE_STEP)
        instance->has_state = 0;
}

static void shift(const Query *query, double distance) {
    for (size_t i = 0; i < query->known_count; i++)
        *place_of(query->instance, query->knowns[i]) =
            distance == 0.0 ? query->base[i] : query->base[i] + distance * query->seed[i];
    forget(query);
}

/* The step made last, with the present knowns; where it chooses sizes, those chosen last when not `again`. */
static int step_again(const Query *query, int again, double *stepped, Reason *why) {
    Instance *instance = query->instance;
    const Kernel *kernel = instance->kernel;
    const double h = instance->step_size, *u = input_slopes_over_step(instance, h);
    if (kernel->step_alike)
        return kernel->step_alike(instance->self, instance->before, u, h, again, query->parameters, stepped, why);
    return kernel->step(instance->self, instance->before, u, h, stepped, why);
}

/* Outputs, observations, states and rates of the present knowns, into the values. */
static int evaluate(const Query *query, Reason *why) {
    Instance *instance = query->instance;
    double *values = instance->values, *inputs = values + instance->ends[0];
    double *stepped = instance->apart + 2 * instance->ends[4];
    if (!evaluate_ready(instance, why))
        return 0;
    if (query->by_step && !step_again(query, 1, stepped, why))
        return 0;
    const double *x = query->by_step ? stepped : evaluate_state(instance);
    instance->kernel->outputs(instance->self, x, inputs, values + instance->ends[1]);
    instance->kernel->observe(instance->self, x, inputs, values + instance->ends[2]);
    return !query->rates || evaluate_continuous(instance, why);
}

static int read_knowns(Query *query, Reason *why) {
    Instance *instance = query->instance;
    const size_t *ends = instance->ends;
    if (query->known_count > ends[4])
        return refuse(why, "a known is listed twice");
    const int may_differ = instance->mode == MODE_INITIALIZATION || (instance->stepped && instance->kernel->step_alike);
    for (size_t i = 0; i < query->known_count; i++) {
        const uint32_t known = query->knowns[i];
        const int is_state = known >= ends[3] && known - ends[3] < instance->continuous.count;
        const int is_parameter = known < ends[0] && may_differ &&
                                 (instance->mode == MODE_INITIALIZATION || instance->tunable[known]);
        if (!is_parameter && !is_state && !(known >= ends[0] && known < ends[1])) {
            char name[200] = "the rate of a continuous state";
            if (known < ends[3]) layout_scalar_name(instance, known, name, sizeof name);
            return refuse(why, "derivatives exist with respect to inputs and continuous states, and to parameters during "
                               "initialization or, of steps made of steps inside, to tunable ones, not to %s", name);
        }
        if (is_state && instance->mode == MODE_INITIALIZATION)
            return refuse(why, "continuous states follow from the inputs during initialization");
        query->parameters |= is_parameter;
        query->states |= is_state;
        query->base[i] = *place_of(instance, known);
    }
    return 1;
}

/* Half the width of the difference: where rounding, which is more where steps iterate, and the third derivative err about
   equally. */
static double width_of(const Query *query) {
    double size = 0.0, slope = 0.0;
    for (size_t i = 0; i < query->known_count; i++) {
        const double value = fabs(query->base[i]);
        const int is_parameter = query->knowns[i] < query->instance->ends[0];
        size = fmax(size, is_parameter && value > 0.0 ? value : fmax(1.0, value));
        slope = fmax(slope, fabs(query->seed[i]));
    }
    const int iterates = query->by_step && query->instance->kernel->step_alike;
    return slope > 0.0 ? cbrt(iterates ? ITERATED : DBL_EPSILON) * size / slope : 0.0;
}

/* Adds `factor` times the unknowns at a distance from the present knowns; 0 where there is no evaluating there. */
static int add(const Query *query, double distance, double factor, const uint32_t *unknowns, size_t count, double *sum,
               Reason *why) {
    shift(query, distance);
    if (!evaluate(query, why))
        return 0;
    for (size_t i = 0; i < count; i++)
        sum[i] += factor * query->instance->values[unknowns[i]];
    return 1;
}

/* Central, or one-sided at the bound of a range; 0 where neither can be. */
static int difference(const Query *query, const uint32_t *unknowns, size_t count, double *sum, Reason *why) {
    const double width = width_of(query);
    int done = 0;
    memset(sum, 0, count * sizeof(double));
    if (width == 0.0)
        return 1;
    const int chooses = query->by_step && query->instance->kernel->step_alike;
    if (chooses && !step_again(query, 0, query->instance->apart + 2 * query->instance->ends[4], why))
        return 0;
    for (const Stencil *s = STENCIL; s < STENCIL + STENCILS && !done; s++) {
        memset(sum, 0, count * sizeof(double));
        done = 1;
        for (int k = 0; k < POINTS && done; k++)
            done = s->weight[k] == 0.0 || add(query, s->at[k] * width, s->weight[k] / width, unknowns, count, sum, why);
    }
    return done;
}

Status differences_fill(Instance *instance, const ExactRanges *exact, const uint32_t *unknowns, size_t unknown_count,
                        const uint32_t *knowns, size_t known_count, const double *seed, double *result) {
    Reason why = {""};
    Query query = {instance, knowns, known_count, seed, instance->apart, 0, 0, 0, 0};
    size_t others = 0;
    for (size_t i = 0; i < unknown_count; i++) {
        if (is_exact(exact, unknowns[i]))
            continue;
        if (unknowns[i] < instance->ends[1] || unknowns[i] >= instance->ends[4])
            return instance_fail(instance, STATUS_ERROR, "value reference %lu is no unknown that has a derivative",
                                 (unsigned long)unknowns[i]);
        query.rates |= unknowns[i] >= instance->ends[3];
        others++;
    }
    if (!others)
        return STATUS_OK;
    if (instance->mode == MODE_INSTANTIATED)
        return instance_fail(instance, STATUS_ERROR, "derivatives exist from initialization mode on");
    if (unknown_count > instance->ends[4] || !read_knowns(&query, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text[0] ? why.text : "an unknown is listed twice");
    query.by_step = instance->stepped && !query.states;
    double *sum = instance->apart + instance->ends[4];
    const int done = difference(&query, unknowns, unknown_count, sum, &why);
    shift(&query, 0.0);
    if (!done)
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    for (size_t i = 0; i < unknown_count; i++)
        if (!is_exact(exact, unknowns[i]))
            result[i] = sum[i];
    return STATUS_OK;
}
