/* The equations of an instance at its present values: see evaluate.h. */

#include "evaluate.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "layout.h"

static int prepare(Instance *instance, Reason *why) {
    if (!instance->prepared)
        instance->prepared =
            layout_ranges_hold(instance, why) && instance->kernel->prepare(instance->self, instance->values, why);
    return instance->prepared;
}

double *evaluate_inputs(const Instance *instance) { return instance->values + instance->ends[0]; }

/* A number less itself is a zero without a sign, or it is no finite number. */
int evaluate_all_finite(const double *numbers, size_t count, size_t *bad) {
    uint64_t found = 0, bits;
    for (size_t i = 0; i < count; i++) {
        const double nothing = numbers[i] - numbers[i];
        memcpy(&bits, &nothing, sizeof bits);
        found |= bits;
    }
    if (!found)
        return 1;
    for (*bad = 0; *bad < count && isfinite(numbers[*bad]);)
        ++*bad;
    return *bad == count;
}

static int inputs_finite(Instance *instance, Reason *why) {
    size_t bad = 0;
    char name[200];
    if (instance->inputs_finite || evaluate_all_finite(evaluate_inputs(instance), instance->sizes.inputs, &bad))
        return instance->inputs_finite = 1;
    layout_scalar_name(instance, (uint32_t)(instance->ends[0] + bad), name, sizeof name);
    return refuse(why, "input %s is %g; it must be a finite number", name, evaluate_inputs(instance)[bad]);
}

/* Whether no input is a quaternion of zeros, which tools that have nothing to give yet may set. */
static int orientations_given(const Instance *instance, Reason *why) {
    static const char ending[] = ".orientation[1]";
    const double *inputs = evaluate_inputs(instance);
    char name[200];
    for (size_t i = 0; i + 4 <= instance->sizes.inputs; i++) {
        if (inputs[i] != 0.0 || inputs[i + 1] != 0.0 || inputs[i + 2] != 0.0 || inputs[i + 3] != 0.0)
            continue;
        layout_scalar_name(instance, (uint32_t)(instance->ends[0] + i), name, sizeof name);
        size_t length = strlen(name), end = sizeof ending - 1;
        if (length > end && strcmp(name + length - end, ending) == 0)
            return refuse(why, "input %.*s is zero; connect it, or leave it at its start value: a quaternion has length 1",
                          (int)(length - 3), name);
    }
    return 1;
}

/* Whether the values from `first` to before `end`, just computed, are finite: sums of finite inputs overflow. */
static int values_finite(const Instance *instance, size_t first, size_t end, Reason *why) {
    size_t bad = 0;
    char name[200];
    if (evaluate_all_finite(instance->values + first, end - first, &bad))
        return 1;
    if (!orientations_given(instance, why))
        return 0;
    layout_scalar_name(instance, (uint32_t)(first + bad), name, sizeof name);
    return refuse(why, "%s is not finite (%g)", name, instance->values[first + bad]);
}

int evaluate_derivatives_finite(const Instance *instance, const uint32_t *unknowns, const double *result, size_t count,
                                Reason *why) {
    size_t bad = 0;
    char name[200] = "the rate of a continuous state";
    if (evaluate_all_finite(result, count, &bad))
        return 1;
    if (!orientations_given(instance, why))
        return 0;
    if (unknowns[bad] < instance->ends[3])
        layout_scalar_name(instance, unknowns[bad], name, sizeof name);
    return refuse(why, "the derivative of %s is not finite (%g)", name, result[bad]);
}

int evaluate_state_finite(const Instance *instance, const double *x, Reason *why) {
    size_t bad = 0;
    if (instance->kernel->checks_itself || evaluate_all_finite(x, instance->states, &bad))
        return 1;
    if (!orientations_given(instance, why))
        return 0;
    return refuse(why, "the new state is not finite, first x[%lu] = %g of %lu", (unsigned long)bad, x[bad],
                  (unsigned long)instance->states);
}

int evaluate_initial(Instance *instance, Reason *why) {
    if (instance->has_state)
        return 1;
    if (!prepare(instance, why) || !inputs_finite(instance, why) || !orientations_given(instance, why) ||
        !instance->kernel->initial(instance->self, evaluate_inputs(instance), instance->x, why) ||
        !evaluate_state_finite(instance, instance->x, why))
        return 0;
    instance->has_state = 1;
    instance->continuous.known = 0;
    return 1;
}

int evaluate_ready(Instance *instance, Reason *why) {
    return evaluate_initial(instance, why) && prepare(instance, why) && inputs_finite(instance, why);
}

const double *evaluate_state(Instance *instance) {
    Continuous *continuous = &instance->continuous;
    if (!continuous->used || !instance->kernel->complete)
        return instance->x;
    if (!continuous->known) {
        memcpy(continuous->completed, instance->x, instance->states * sizeof(double));
        instance->kernel->complete(instance->self, continuous->completed);
        continuous->known = 1;
    }
    return continuous->completed;
}

int evaluate_rates(Instance *instance, double *rates, Reason *why) {
    return instance->kernel->rates(instance->self, instance->x, evaluate_state(instance),
                                   instance->values + instance->ends[0], rates, why);
}

void evaluate_states(const Instance *instance, double *states) {
    for (size_t i = 0; i < instance->continuous.count; i++)
        states[i] = instance->x[instance->continuous.places[i]];
}

int evaluate_continuous(Instance *instance, Reason *why) {
    double *states = instance->values + instance->ends[3], *rates = states + instance->continuous.count;
    size_t bad = 0;
    if (!evaluate_ready(instance, why) || !evaluate_rates(instance, rates, why))
        return 0;
    evaluate_states(instance, states);
    if (evaluate_all_finite(states, 2 * instance->continuous.count, &bad))
        return 1;
    return refuse(why, "continuous state %lu or its rate is %g", (unsigned long)(bad % instance->continuous.count) + 1,
                  states[bad]);
}

int evaluate_outputs(Instance *instance, Reason *why) {
    if (instance->outputs_known)
        return 1;
    if (!evaluate_ready(instance, why))
        return 0;
    instance->kernel->outputs(instance->self, evaluate_state(instance), evaluate_inputs(instance),
                              instance->values + instance->ends[1]);
    return instance->outputs_known = values_finite(instance, instance->ends[1], instance->ends[2], why);
}

int evaluate_observations(Instance *instance, Reason *why) {
    if (instance->observations_known)
        return 1;
    if (!evaluate_ready(instance, why))
        return 0;
    instance->kernel->observe(instance->self, evaluate_state(instance), evaluate_inputs(instance),
                              instance->values + instance->ends[2]);
    return instance->observations_known = values_finite(instance, instance->ends[2], instance->ends[3], why);
}
