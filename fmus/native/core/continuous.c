/* The continuous states of an instance: see continuous.h. */

#include "continuous.h"

#include <math.h>
#include <string.h>

#include "differences.h"
#include "evaluate.h"
#include "real.h"

int continuous_create(Instance *instance, Reason *why) {
    const Kernel *kernel = instance->kernel;
    Continuous *continuous = &instance->continuous;
    if (!continuous->offered)
        return 1;
    size_t count = kernel->continuous ? kernel->continuous(instance->self, NULL) : 0;
    size_t indicators = kernel->indicators ? kernel->indicators(instance->self, NULL, NULL, NULL) : 0;
    if (!kernel->continuous || count != continuous->count || indicators != continuous->indicators)
        return refuse(why, "the component has %lu continuous states and %lu event indicators; the data give %lu and %lu",
                      (unsigned long)count, (unsigned long)indicators, (unsigned long)continuous->count,
                      (unsigned long)continuous->indicators);
    continuous->places = allocate(&instance->memory, (count + 1) * sizeof(size_t));
    if (!continuous->places)
        return refuse(why, "no memory for %lu continuous states", (unsigned long)count);
    kernel->continuous(instance->self, continuous->places);
    return 1;
}

int continuous_use(Instance *instance) {
    Continuous *continuous = &instance->continuous;
    Memory *memory = &instance->memory;
    if (!continuous->offered) {
        instance_fail(instance, STATUS_ERROR, "this FMU is for co-simulation; model exchange is not offered");
        return 0;
    }
    size_t numbers = instance->states + 1;
    continuous->completed = allocate(memory, numbers * sizeof(double));
    continuous->complex_raw = allocate(memory, numbers * sizeof(double complex));
    continuous->complex_rates = allocate(memory, (continuous->count + 1) * sizeof(double complex));
    if (!continuous->completed || !continuous->complex_raw || !continuous->complex_rates) {
        instance_fail(instance, STATUS_ERROR, "no memory for model exchange");
        return 0;
    }
    continuous->used = 1;
    return 1;
}

/* STATUS_OK when an instance for model exchange is in one of two modes; `wanted` says what they allow. */
static Status check_mode(Instance *instance, Mode one, Mode other, const char *wanted) {
    if (!instance->continuous.used)
        return instance_fail(instance, STATUS_ERROR, "this instance is for co-simulation; it has no solver outside");
    if (instance->mode != one && instance->mode != other)
        return instance_fail(instance, STATUS_ERROR, "%s", wanted);
    return STATUS_OK;
}

/* STATUS_OK when there is a state to ask about, and as many numbers of a kind as the caller thinks. */
static Status check_query(Instance *instance, size_t own, size_t count, const char *kind) {
    if (!instance->continuous.used)
        return instance_fail(instance, STATUS_ERROR, "this instance is for co-simulation; it has no solver outside");
    if (instance->mode == MODE_INSTANTIATED)
        return instance_fail(instance, STATUS_ERROR, "%s exist from initialization mode on", kind);
    if (own != count)
        return instance_fail(instance, STATUS_ERROR, "there are %lu %s, not %lu", (unsigned long)own, kind,
                             (unsigned long)count);
    return STATUS_OK;
}

/* What follows from the state is to be computed anew. */
static void state_changed(Instance *instance) {
    instance->continuous.known = instance->outputs_known = instance->observations_known = 0;
}

Status continuous_set_time(Instance *instance, double time) {
    Status status = check_mode(instance, MODE_EVENT, MODE_CONTINUOUS, "time is set in event or continuous-time mode");
    if (status != STATUS_OK)
        return status;
    if (!isfinite(time))
        return instance_fail(instance, STATUS_ERROR, "the time is %g s; it must be finite", time);
    instance->time = time; /* beyond the stop time too: a multi-step solver looks there before it interpolates back */
    return STATUS_OK;
}

Status continuous_set_states(Instance *instance, const double *states, size_t count) {
    Status status = check_query(instance, instance->continuous.count, count, "continuous states");
    if (status == STATUS_OK)
        status = check_mode(instance, MODE_CONTINUOUS, MODE_CONTINUOUS,
                            "continuous states are set in continuous-time mode");
    if (status != STATUS_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        instance->x[instance->continuous.places[i]] = states[i];
    state_changed(instance);
    return STATUS_OK;
}

Status continuous_get_states(Instance *instance, double *states, size_t count) {
    Reason why = {""};
    Status status = check_query(instance, instance->continuous.count, count, "continuous states");
    if (status != STATUS_OK)
        return status;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    evaluate_states(instance, states);
    return STATUS_OK;
}

Status continuous_get_nominals(Instance *instance, double *nominals, size_t count) {
    if (!instance->continuous.used || instance->continuous.count != count)
        return check_query(instance, instance->continuous.count, count, "continuous states");
    memcpy(nominals, instance->continuous.nominals, count * sizeof(double));
    return STATUS_OK;
}

/* STATUS_DISCARD and a sentence where one of the numbers is not finite: a solver may try a smaller step. */
static Status check_finite(Instance *instance, const double *numbers, size_t count, const char *kind) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            return instance_fail(instance, STATUS_DISCARD, "%s %lu is %g", kind, (unsigned long)i + 1, numbers[i]);
    return STATUS_OK;
}

Status continuous_get_rates(Instance *instance, double *rates, size_t count) {
    Reason why = {""};
    Status status = check_query(instance, instance->continuous.count, count, "continuous states");
    if (status != STATUS_OK)
        return status;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_DISCARD, "%s", why.text);
    if (!evaluate_rates(instance, rates, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    return check_finite(instance, rates, count, "the rate of continuous state");
}

Status continuous_get_indicators(Instance *instance, double *indicators, size_t count) {
    Reason why = {""};
    Status status = check_query(instance, instance->continuous.indicators, count, "event indicators");
    if (status != STATUS_OK || !count)
        return status;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_DISCARD, "%s", why.text);
    instance->kernel->indicators(instance->self, evaluate_state(instance), instance->values + instance->ends[0],
                                 indicators);
    return check_finite(instance, indicators, count, "event indicator");
}

/* Lets the component remember the present instant, or act in it. */
static Status update(Instance *instance, int at_event) {
    Reason why = {""};
    if (!instance->kernel->update)
        return STATUS_OK;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    double *next = instance->before;
    instance->kernel->update(instance->self, instance->x, instance->values + instance->ends[0], at_event, next);
    instance->before = instance->x;
    instance->x = next;
    state_changed(instance);
    return STATUS_OK;
}

Status continuous_enter_event_mode(Instance *instance) {
    Status status = check_mode(instance, MODE_CONTINUOUS, MODE_EVENT, "event mode is entered from continuous-time mode");
    /* the commands still are those of the time before the event */
    if (status == STATUS_OK && instance->mode == MODE_CONTINUOUS)
        status = update(instance, 0);
    if (status == STATUS_OK)
        instance->mode = MODE_EVENT;
    return status;
}

Status continuous_enter_continuous_time_mode(Instance *instance) {
    Status status = check_mode(instance, MODE_EVENT, MODE_EVENT, "continuous-time mode is entered from event mode");
    if (status == STATUS_OK)
        instance->mode = MODE_CONTINUOUS;
    return status;
}

Status continuous_update_discrete_states(Instance *instance) {
    Status status = check_mode(instance, MODE_EVENT, MODE_EVENT, "discrete states are updated in event mode");
    return status == STATUS_OK ? update(instance, 1) : status;
}

double continuous_time_to_break(Instance *instance) {
    Reason why = {""};
    if (!instance->kernel->time_to_break || !evaluate_ready(instance, &why))
        return INFINITY;
    return instance->kernel->time_to_break(instance->self, evaluate_state(instance),
                                           instance->values + instance->ends[0]);
}

Status continuous_complete_step(Instance *instance, int *event) {
    double indicators[8];
    size_t count = instance->continuous.indicators;
    Status status = check_mode(instance, MODE_CONTINUOUS, MODE_CONTINUOUS,
                               "integrator steps are completed in continuous-time mode");
    if (status == STATUS_OK)
        status = instance_check_stop(instance, instance->time);
    if (status == STATUS_OK)
        status = update(instance, 0);
    *event = 0;
    if (status != STATUS_OK || !count || count > sizeof indicators / sizeof *indicators)
        return status;
    status = continuous_get_indicators(instance, indicators, count);
    for (size_t i = 0; status == STATUS_OK && i < count; i++)
        *event |= indicators[i] < 0.0;
    return status;
}

/* Inputs and state with the seed as their imaginary part. */
static void seeded(Instance *instance, const uint32_t *knowns, size_t count, const double *seed) {
    const Continuous *continuous = &instance->continuous;
    const double *u = instance->values + instance->ends[0];
    for (size_t i = 0; i < instance->sizes.inputs; i++)
        instance->complex_inputs[i] = u[i];
    for (size_t i = 0; i < instance->states; i++)
        continuous->complex_raw[i] = instance->x[i];
    for (size_t i = 0; i < count; i++) {
        double slope = FANFOLD_INFINITESIMAL * seed[i];
        if (knowns[i] >= instance->ends[0] && knowns[i] < instance->ends[1]) {
            size_t place = knowns[i] - instance->ends[0];
            instance->complex_inputs[place] = complex_of(u[place], slope);
        } else {
            size_t place = continuous->places[knowns[i] - instance->ends[3]];
            continuous->complex_raw[place] = complex_of(instance->x[place], slope);
        }
    }
}

static int differentiate(Instance *instance, Reason *why) {
    const Kernel *kernel = instance->kernel;
    const Continuous *continuous = &instance->continuous;
    memcpy(instance->complex_state, continuous->complex_raw, instance->states * sizeof(double complex));
    if (kernel->complete_complex)
        kernel->complete_complex(instance->self, instance->complex_state);
    kernel->outputs_complex(instance->self, instance->complex_state, instance->complex_inputs,
                            instance->complex_outputs);
    return kernel->rates_complex(instance->self, continuous->complex_raw, instance->complex_state,
                                 instance->complex_inputs, continuous->complex_rates, why);
}

/* Complex equations give the derivatives of ports' outputs and of rates, by inputs and states. */
static ExactRanges exact_ranges(const Instance *instance, const uint32_t *knowns, size_t known_count) {
    const size_t *ends = instance->ends, first_rate = ends[3] + instance->continuous.count;
    const ExactRanges none = {{0, 0}, {0, 0}}, all = {{ends[1], first_rate}, {ends[2], ends[4]}};
    for (size_t i = 0; i < known_count; i++)
        if (knowns[i] < ends[0] || (knowns[i] >= ends[1] && knowns[i] < ends[3]) || knowns[i] >= first_rate)
            return none;
    return instance->mode >= MODE_STEP ? all : none;
}

Status continuous_derivative(Instance *instance, const uint32_t *unknowns, size_t unknown_count,
                             const uint32_t *knowns, size_t known_count, const double *seed, double *result) {
    Reason why = {""};
    const size_t *ends = instance->ends, first_rate = ends[3] + instance->continuous.count;
    const ExactRanges exact = exact_ranges(instance, knowns, known_count);
    Status status = differences_fill(instance, &exact, unknowns, unknown_count, knowns, known_count, seed, result);
    if (status != STATUS_OK || exact.end[0] == 0)
        return status;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    seeded(instance, knowns, known_count, seed);
    if (!differentiate(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    for (size_t i = 0; i < unknown_count; i++) {
        if (!is_exact(&exact, unknowns[i]))
            continue;
        double complex number = unknowns[i] < ends[2] ? instance->complex_outputs[unknowns[i] - ends[1]]
                                                      : instance->continuous.complex_rates[unknowns[i] - first_rate];
        result[i] = cimag(number) / FANFOLD_INFINITESIMAL;
    }
    return STATUS_OK;
}
