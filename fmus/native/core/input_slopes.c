/* Inputs that are linear in time over a step: see input_slopes.h. */

#include "input_slopes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "evaluate.h"
#include "layout.h"

/* Declared input `name_slope` of an input; 0 where there is none of its size. */
static int slope_of(const Data *data, const Variable *input, Variable *slope) {
    char name[200];
    snprintf(name, sizeof name, "%s_slope", input->name);
    for (size_t i = 0; i < data->count; i++)
        if (data_variable(data, i, "input", slope) && strcmp(slope->name, name) == 0)
            return slope->size == input->size;
    return 0;
}

int input_slopes_create(Instance *instance, Reason *why) {
    InputSlopes *slopes = &instance->slopes;
    const size_t inputs = instance->sizes.inputs;
    Variable input, slope;
    slopes->places = allocate(&instance->memory, (inputs + 1) * sizeof *slopes->places);
    slopes->rates = allocate(&instance->memory, (inputs + 1) * sizeof *slopes->rates);
    slopes->inputs = allocate(&instance->memory, (inputs + 1) * sizeof *slopes->inputs);
    if (!slopes->places || !slopes->rates || !slopes->inputs)
        return refuse(why, "no memory for the derivatives of %lu inputs", (unsigned long)inputs);
    for (size_t i = 0; i < instance->data.count; i++)
        if (data_variable(&instance->data, i, "input", &input) && slope_of(&instance->data, &input, &slope))
            for (size_t k = 0; k < input.size; k++) {
                slopes->places[input.offset + k] = slope.offset + k;
                slopes->count = inputs;
            }
    return 1;
}

void input_slopes_reset(Instance *instance) {
    memset(instance->slopes.rates, 0, instance->slopes.count * sizeof(double));
    instance->slopes.used = 0;
}

/* Whether an input takes a derivative of this order and value. */
static Status takes(Instance *instance, uint32_t reference, int order, double value) {
    char name[200];
    if (reference >= instance->ends[3])
        return instance_fail(instance, STATUS_ERROR, "value reference %lu is not that of an input", (unsigned long)reference);
    layout_scalar_name(instance, reference, name, sizeof name);
    if (reference < instance->ends[0] || reference >= instance->ends[1] ||
        !instance->slopes.places[reference - instance->ends[0]])
        return instance_fail(instance, STATUS_ERROR, "%s takes no derivative; forces and torques of ports do", name);
    if (order != 1)
        return instance_fail(instance, STATUS_ERROR, "%s takes a derivative of order 1, not of order %d", name, order);
    if (!isfinite(value))
        return instance_fail(instance, STATUS_ERROR, "the derivative of %s cannot be set to %g; it must be a finite number",
                             name, value);
    return STATUS_OK;
}

Status input_slopes_set(Instance *instance, const uint32_t *references, size_t count, const int *orders,
                        const double *values) {
    InputSlopes *slopes = &instance->slopes;
    if (count && instance->continuous.used)
        return instance_fail(instance, STATUS_ERROR, "in model exchange inputs have no derivatives");
    for (size_t i = 0; i < count; i++)
        if (takes(instance, references[i], orders[i], values[i]) != STATUS_OK)
            return STATUS_ERROR;
    for (size_t i = 0; i < count; i++) slopes->rates[references[i] - instance->ends[0]] = values[i];
    if (count) slopes->used = 1;
    return STATUS_OK;
}

const double *input_slopes_over_step(Instance *instance, double h) {
    InputSlopes *slopes = &instance->slopes;
    const double *u = evaluate_inputs(instance);
    if (!slopes->used)
        return u;
    memcpy(slopes->inputs, u, slopes->count * sizeof(double));
    for (size_t i = 0; i < slopes->count; i++)
        if (slopes->places[i]) {
            slopes->inputs[i] += 0.5 * h * slopes->rates[i];
            slopes->inputs[slopes->places[i]] += 0.5 * h * slopes->rates[i];
        }
    return slopes->inputs;
}
