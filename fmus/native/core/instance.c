/* One instance of a component: see instance.h. */

#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "continuous.h"
#include "layout.h"
#include "real.h"

Status instance_fail(Instance *instance, Status status, const char *format, ...) {
    char sentence[768];
    int length = snprintf(sentence, sizeof sentence, "%.100s at t = %.9g s: ", instance->name, instance->time);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence + length, sizeof sentence - (size_t)length, format, arguments);
    va_end(arguments);
    if (instance->logger)
        instance->logger(instance->host, status, sentence);
    return status;
}

Status instance_reset(Instance *instance) {
    memset(instance->values, 0, instance->ends[3] * sizeof(double));
    memcpy(instance->values, instance->start, instance->ends[1] * sizeof(double));
    instance->mode = MODE_INSTANTIATED;
    instance->time = 0.0;
    instance->prepared = instance->has_state = instance->stepped = instance->event_due = 0;
    instance->outputs_known = instance->observations_known = instance->continuous.known = 0;
    return STATUS_OK;
}

Status instance_terminate(Instance *instance) {
    if (instance->mode < MODE_STEP || instance->mode == MODE_TERMINATED)
        return instance_fail(instance, STATUS_ERROR, "terminated before the end of initialization mode");
    instance->mode = MODE_TERMINATED;
    return STATUS_OK;
}

Status instance_enter_initialization(Instance *instance, double start_time) {
    if (instance->mode != MODE_INSTANTIATED)
        return instance_fail(instance, STATUS_ERROR, "initialization mode is entered once, after instantiation");
    instance->time = start_time;
    instance->mode = MODE_INITIALIZATION;
    return STATUS_OK;
}

static int prepare(Instance *instance, Reason *why) {
    if (!instance->prepared)
        instance->prepared =
            layout_ranges_hold(instance, why) && instance->kernel->prepare(instance->self, instance->values, why);
    return instance->prepared;
}

static double *inputs_of(const Instance *instance) { return instance->values + instance->ends[0]; }

/* Whether all numbers are finite: their sum then is, but for absurdly large ones, which are looked at singly. */
static int all_finite(const double *numbers, size_t count, size_t *bad) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += numbers[i] * 0.0;
    if (sum == 0.0)
        return 1;
    for (*bad = 0; *bad < count && isfinite(numbers[*bad]);)
        ++*bad;
    return *bad == count;
}

static int inputs_finite(const Instance *instance, Reason *why) {
    size_t bad = 0;
    char name[200];
    if (all_finite(inputs_of(instance), instance->sizes.inputs, &bad))
        return 1;
    layout_scalar_name(instance, (uint32_t)(instance->ends[0] + bad), name, sizeof name);
    return refuse(why, "input %s is %g; it must be a finite number", name, inputs_of(instance)[bad]);
}

static int state_finite(const Instance *instance, const double *x, Reason *why) {
    size_t bad = 0;
    if (all_finite(x, instance->states, &bad))
        return 1;
    return refuse(why, "the new state is not finite, first x[%lu] = %g of %lu", (unsigned long)bad, x[bad],
                  (unsigned long)instance->states);
}

/* The state at the start, as long as initialization goes on. */
static int initialize(Instance *instance, Reason *why) {
    if (instance->has_state)
        return 1;
    if (!prepare(instance, why) || !inputs_finite(instance, why) ||
        !instance->kernel->initial(instance->self, inputs_of(instance), instance->x, why) ||
        !state_finite(instance, instance->x, why))
        return 0;
    instance->has_state = 1;
    instance->continuous.known = 0;
    return 1;
}

int instance_ready(Instance *instance, Reason *why) {
    return initialize(instance, why) && prepare(instance, why) && inputs_finite(instance, why);
}

Status instance_exit_initialization(Instance *instance) {
    Reason why = {""};
    if (instance->mode != MODE_INITIALIZATION)
        return instance_fail(instance, STATUS_ERROR, "initialization mode ends only where it has begun");
    if (!initialize(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    instance->mode = instance->continuous.used ? MODE_EVENT : MODE_STEP;
    return STATUS_OK;
}

/* Whether the references are one range, as those of a port or of all inputs are. */
static int contiguous(const uint32_t *references, size_t count) {
    for (size_t i = 1; i < count; i++)
        if (references[i] != references[0] + i)
            return 0;
    return count > 0;
}

static Status no_such_reference(Instance *instance, uint32_t reference) {
    return instance_fail(instance, STATUS_ERROR, "there is no value reference %lu; it must be below %lu",
                         (unsigned long)reference, (unsigned long)instance->ends[4]);
}

/* Whether a reference may be set now. */
static Status settable(Instance *instance, uint32_t reference) {
    char name[200];
    if (reference >= instance->ends[4])
        return no_such_reference(instance, reference);
    if (reference >= instance->ends[3])
        return instance_fail(instance, STATUS_ERROR, "value reference %lu is that of a continuous state or its rate; "
                             "it cannot be set", (unsigned long)reference);
    if (reference >= instance->ends[1]) {
        layout_scalar_name(instance, reference, name, sizeof name);
        return instance_fail(instance, STATUS_ERROR, "%s is an output; it cannot be set", name);
    }
    if (instance->mode >= MODE_STEP && reference < instance->ends[0] && !instance->tunable[reference]) {
        layout_scalar_name(instance, reference, name, sizeof name);
        return instance_fail(instance, STATUS_ERROR, "%s is fixed; it cannot be set after initialization", name);
    }
    return STATUS_OK;
}

Status instance_set(Instance *instance, const uint32_t *references, size_t count, const double *values) {
    int parameters = 0, continuous = instance->mode == MODE_CONTINUOUS;
    Status status = STATUS_OK, worst = STATUS_OK;
    if (!continuous && contiguous(references, count) && references[0] >= instance->ends[0] &&
        references[count - 1] < instance->ends[1]) {
        memcpy(instance->values + references[0], values, count * sizeof(double));
    } else {
        for (size_t i = 0; i < count; i++)
            if (settable(instance, references[i]) != STATUS_OK)
                return STATUS_ERROR;
        for (size_t i = 0; i < count; i++) {
            if (!continuous)
                instance->values[references[i]] = values[i];
            else if ((status = continuous_set_value(instance, references[i], values[i])) > worst)
                worst = status;
            parameters |= references[i] < instance->ends[0];
        }
    }
    instance->observations_known = 0;
    if (parameters) {
        instance->prepared = instance->stepped = 0;
        instance->outputs_known = 0;
    } else if (instance->feedthrough) {
        instance->outputs_known = 0;
    }
    if (instance->mode < MODE_STEP)
        instance->has_state = instance->outputs_known = 0;
    return worst;
}

static int know_outputs(Instance *instance, Reason *why) {
    if (instance->outputs_known)
        return 1;
    if (!initialize(instance, why) || !prepare(instance, why))
        return 0;
    instance->kernel->outputs(instance->self, continuous_state(instance), inputs_of(instance),
                              instance->values + instance->ends[1]);
    return instance->outputs_known = 1;
}

static int know_observations(Instance *instance, Reason *why) {
    if (instance->observations_known)
        return 1;
    if (!initialize(instance, why) || !prepare(instance, why))
        return 0;
    instance->kernel->observe(instance->self, continuous_state(instance), inputs_of(instance),
                              instance->values + instance->ends[2]);
    return instance->observations_known = 1;
}

Status instance_get(Instance *instance, const uint32_t *references, size_t count, double *values) {
    Reason why = {""};
    int outputs = 0, observations = 0, continuous = 0;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= instance->ends[4])
            return no_such_reference(instance, references[i]);
        outputs |= references[i] >= instance->ends[1] && references[i] < instance->ends[2];
        observations |= references[i] >= instance->ends[2] && references[i] < instance->ends[3];
        continuous |= references[i] >= instance->ends[3];
    }
    if ((outputs && !know_outputs(instance, &why)) || (observations && !know_observations(instance, &why)) ||
        (continuous && !continuous_show(instance, &why)))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    if (contiguous(references, count))
        memcpy(values, instance->values + references[0], count * sizeof(double));
    else
        for (size_t i = 0; i < count; i++)
            values[i] = instance->values[references[i]];
    return STATUS_OK;
}

Status instance_step(Instance *instance, double time, double h) {
    Reason why = {""};
    double before = instance->time;
    instance->time = time; /* for what is said of a failure */
    if (instance->mode != MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, instance->continuous.used
                                 ? "this instance is for model exchange; a solver outside makes the steps"
                                 : "a step before the end of initialization mode");
    if (!isfinite(time))
        return instance_fail(instance, STATUS_ERROR, "the communication point is %g s; it must be a finite number", time);
    if (!(h > 0.0 && isfinite(h)))
        return instance_fail(instance, STATUS_DISCARD, "the communication step size is %g s; it must be positive", h);
    double *next = instance->before;
    if (!inputs_finite(instance, &why) || !prepare(instance, &why) ||
        !instance->kernel->step(instance->self, instance->x, inputs_of(instance), h, next, &why) ||
        !state_finite(instance, next, &why)) {
        instance->stepped = 0;
        instance_fail(instance, STATUS_DISCARD, "%s", why.text);
        instance->time = before;
        return STATUS_DISCARD;
    }
    instance->before = instance->x;
    instance->x = next;
    instance->time = time + h;
    instance->step_size = h;
    instance->stepped = 1;
    instance->outputs_known = instance->observations_known = 0;
    return STATUS_OK;
}

double instance_next_event(Instance *instance) {
    Reason why = {""};
    const Kernel *kernel = instance->kernel;
    if (!kernel->next_event || !instance->has_state || !inputs_finite(instance, &why) || !prepare(instance, &why))
        return INFINITY;
    return kernel->next_event(instance->self, instance->x, inputs_of(instance));
}

Status instance_enter_event_mode(Instance *instance) {
    if (instance->mode != MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, "event mode is entered from step mode");
    instance->mode = MODE_EVENT;
    return STATUS_OK;
}

Status instance_enter_step_mode(Instance *instance) {
    if (instance->mode != MODE_EVENT)
        return instance_fail(instance, STATUS_ERROR, "step mode is entered from event mode");
    instance->mode = MODE_STEP;
    return STATUS_OK;
}

Status instance_update_discrete_states(Instance *instance) {
    Reason why = {""};
    const Kernel *kernel = instance->kernel;
    if (instance->mode != MODE_EVENT)
        return instance_fail(instance, STATUS_ERROR, "discrete states are updated in event mode");
    if (!kernel->event)
        return STATUS_OK;
    if (!inputs_finite(instance, &why) || !prepare(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    double *next = instance->before;
    kernel->event(instance->self, instance->x, inputs_of(instance), instance->event_due, next);
    instance->before = instance->x;
    instance->x = next;
    instance->event_due = instance->stepped = 0;
    instance->outputs_known = instance->observations_known = 0;
    return STATUS_OK;
}

/* Inputs with the seed as their imaginary part; 0 where a known is none. */
static int seeded(Instance *instance, const uint32_t *knowns, size_t count, const double *seed, Reason *why) {
    const double *u = inputs_of(instance);
    for (size_t i = 0; i < instance->sizes.inputs; i++)
        instance->complex_inputs[i] = u[i];
    for (size_t i = 0; i < count; i++) {
        if (knowns[i] < instance->ends[0] || knowns[i] >= instance->ends[1])
            return refuse(why, "derivatives exist with respect to inputs only, not to value reference %lu",
                          (unsigned long)knowns[i]);
        size_t place = knowns[i] - instance->ends[0];
        instance->complex_inputs[place] = complex_of(u[place], FANFOLD_INFINITESIMAL * seed[i]);
    }
    return 1;
}

static int differentiate(Instance *instance, Reason *why) {
    const Kernel *kernel = instance->kernel;
    if (!prepare(instance, why))
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

Status instance_derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count,
                           const uint32_t *knowns, size_t known_count, const double *seed, double *result) {
    Reason why = {""};
    if (instance->mode < MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, "derivatives exist after the end of initialization mode");
    for (size_t i = 0; i < unknown_count; i++)
        if (unknowns[i] < instance->ends[1] || unknowns[i] >= instance->ends[2])
            return instance_fail(instance, STATUS_ERROR,
                                 "derivatives exist of ports' outputs only, not of value reference %lu",
                                 (unsigned long)unknowns[i]);
    if (!seeded(instance, knowns, known_count, seed, &why) || !differentiate(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    for (size_t i = 0; i < unknown_count; i++)
        result[i] = cimag(instance->complex_outputs[unknowns[i] - instance->ends[1]]) / FANFOLD_INFINITESIMAL;
    return STATUS_OK;
}
