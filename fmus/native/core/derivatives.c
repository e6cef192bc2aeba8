/* Directional derivatives over a step, or at a communication point: see instance.h. */

#include <math.h>

#include "continuous.h"
#include "differences.h"
#include "evaluate.h"
#include "input_slopes.h"
#include "real.h"

/* Inputs of the step just made, or of the present instant. */
static const double *inputs_in_force(Instance *instance) {
    return instance->stepped ? input_slopes_over_step(instance, instance->step_size) : evaluate_inputs(instance);
}

/* Inputs with the seed as their imaginary part. */
static void seeded(Instance *instance, const uint32_t *knowns, size_t count, const double *seed) {
    const double *u = inputs_in_force(instance);
    for (size_t i = 0; i < instance->sizes.inputs; i++)
        instance->complex_inputs[i] = u[i];
    for (size_t i = 0; i < count; i++) {
        size_t place = knowns[i] - instance->ends[0];
        instance->complex_inputs[place] = complex_of(u[place], FANFOLD_INFINITESIMAL * seed[i]);
    }
}

static int differentiate(Instance *instance, Reason *why) {
    const Kernel *kernel = instance->kernel;
    if (!evaluate_ready(instance, why))
        return 0;
    if (!instance->stepped)
        for (size_t i = 0; i < instance->states; i++)
            instance->complex_state[i] = instance->x[i];
    else if (!kernel->step_complex(instance->self, instance->before, instance->complex_inputs,
                                   instance->step_size, instance->complex_state, why))
        return 0;
    kernel->outputs_complex(instance->self, instance->complex_state, instance->complex_inputs,
                            instance->complex_outputs);
    return 1;
}

/* Complex equations give the derivatives of ports' outputs by inputs, after initialization. */
static ExactRanges exact_ranges(const Instance *instance, const uint32_t *knowns, size_t known_count) {
    const ExactRanges none = {{0, 0}, {0, 0}}, outputs = {{instance->ends[1], 0}, {instance->ends[2], 0}};
    if (!instance->kernel->outputs_complex)
        return none;
    for (size_t i = 0; i < known_count; i++)
        if (knowns[i] < instance->ends[0] || knowns[i] >= instance->ends[1])
            return none;
    return instance->mode >= MODE_STEP ? outputs : none;
}

static Status derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count, const uint32_t *knowns,
                         size_t known_count, const double *seed, double *result) {
    Reason why = {""};
    const ExactRanges exact = exact_ranges(instance, knowns, known_count);
    Status status = differences_fill(instance, &exact, unknowns, unknown_count, knowns, known_count, seed, result);
    if (status != STATUS_OK || exact.end[0] == 0)
        return status;
    seeded(instance, knowns, known_count, seed);
    if (!differentiate(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    for (size_t i = 0; i < unknown_count; i++)
        if (is_exact(&exact, unknowns[i]))
            result[i] = cimag(instance->complex_outputs[unknowns[i] - instance->ends[1]]) / FANFOLD_INFINITESIMAL;
    return STATUS_OK;
}

Status instance_derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count,
                           const uint32_t *knowns, size_t known_count, const double *seed, double *result) {
    Reason why = {""};
    for (size_t i = 0; i < known_count; i++)
        if (!isfinite(seed[i]))
            return instance_fail(instance, STATUS_ERROR, "the seed of value reference %lu is %g; it must be finite",
                                 (unsigned long)knowns[i], seed[i]);
    const Status status = (instance->continuous.used ? continuous_derivative : derivative)(
        instance, unknowns, unknown_count, knowns, known_count, seed, result);
    if (status == STATUS_OK && !evaluate_derivatives_finite(instance, unknowns, result, unknown_count, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    return status;
}

Status instance_port_stiffness(Instance *instance, size_t ports, double *matrix) {
    const Kernel *kernel = instance->kernel;
    Reason why = {""};
    if (!kernel->stiffness || !instance->stepped || instance->mode != MODE_STEP)
        return STATUS_DISCARD;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    return kernel->stiffness(instance->self, instance->before, inputs_in_force(instance), instance->step_size, ports,
                             matrix)
               ? STATUS_OK
               : STATUS_DISCARD;
}
