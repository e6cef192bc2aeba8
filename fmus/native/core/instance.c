/* One instance of a component: see instance.h. */

#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "evaluate.h"
#include "input_slopes.h"
#include "layout.h"

/* Relative tolerance of times. */
#define SAME_TIME 1e-9

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
    instance->stop_time = INFINITY;
    instance->prepared = instance->has_state = instance->stepped = instance->event_due = 0;
    instance->outputs_known = instance->observations_known = instance->continuous.known = instance->inputs_finite = 0;
    input_slopes_reset(instance);
    return STATUS_OK;
}

Status instance_terminate(Instance *instance) {
    if (instance->mode == MODE_TERMINATED)
        return instance_fail(instance, STATUS_ERROR, "terminated twice");
    if (instance->mode < MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, "terminated before the end of initialization mode");
    instance->mode = MODE_TERMINATED;
    return STATUS_OK;
}

/* Have the tolerance of the host for a parameter, unless that was set already; hosts without one often give 0. */
static Status take_tolerance(Instance *instance, double tolerance) {
    const size_t place = instance->sizes.parameters - 1;
    if (!instance->kernel->steps_inside || tolerance == 0.0 || instance->values[place] != instance->start[place])
        return STATUS_OK;
    if (!(tolerance >= instance->minimum[place] && tolerance <= instance->maximum[place]))
        return instance_fail(instance, STATUS_WARNING, "the tolerance of the experiment is %g; it must be from %g to %g, "
                             "and stays %g", tolerance, instance->minimum[place], instance->maximum[place],
                             instance->values[place]);
    instance->values[place] = tolerance;
    return STATUS_OK;
}

Status instance_set_experiment(Instance *instance, const double *tolerance, double start_time, double stop_time) {
    if (instance->mode != MODE_INSTANTIATED)
        return instance_fail(instance, STATUS_ERROR,
                             "times are set before initialization mode, which is entered once, after instantiation");
    if (!isfinite(start_time))
        return instance_fail(instance, STATUS_ERROR, "the start time is %g s; it must be finite", start_time);
    if (!(stop_time >= start_time))
        return instance_fail(instance, STATUS_ERROR, "the stop time %g s is before the start time %g s", stop_time,
                             start_time);
    instance->time = start_time;
    instance->stop_time = stop_time;
    return tolerance ? take_tolerance(instance, *tolerance) : STATUS_OK;
}

Status instance_check_stop(Instance *instance, double time) {
    if (time > instance->stop_time + SAME_TIME * (1.0 + fabs(instance->stop_time)))
        return instance_fail(instance, STATUS_ERROR, "%.9g s is after the stop time %.9g s", time,
                             instance->stop_time);
    return STATUS_OK;
}

Status instance_enter_initialization(Instance *instance) {
    if (instance->mode != MODE_INSTANTIATED)
        return instance_fail(instance, STATUS_ERROR, "initialization mode is entered once, after instantiation");
    instance->mode = MODE_INITIALIZATION;
    return STATUS_OK;
}

Status instance_exit_initialization(Instance *instance) {
    Reason why = {""};
    if (instance->mode != MODE_INITIALIZATION)
        return instance_fail(instance, STATUS_ERROR, "initialization mode ends only where it has begun");
    if (!evaluate_initial(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    instance->mode = instance->continuous.used ? MODE_EVENT : MODE_STEP;
    return STATUS_OK;
}

/* Whether the references are one range, as those of a port or of all inputs are. */
static int contiguous(const uint32_t *references, size_t count) {
    uint32_t apart = 0;
    for (size_t i = 0; i < count; i++)
        apart |= references[i] ^ (references[0] + (uint32_t)i);
    return count > 0 && !apart && references[0] <= references[count - 1];
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

static Status not_finite(Instance *instance, uint32_t reference, double value) {
    char name[200];
    if (reference >= instance->ends[3])
        return settable(instance, reference);
    layout_scalar_name(instance, reference, name, sizeof name);
    const Status status = instance->mode == MODE_CONTINUOUS ? STATUS_DISCARD : STATUS_ERROR; /* a solver's trial, or not */
    return instance_fail(instance, status, "%s cannot be set to %g; it must be a finite number", name, value);
}

/* Sets one value between events. STATUS_WARNING for a discrete input that would change: it keeps its value until
   event mode, because a solver looks ahead, and hosts then set inputs of times to come. */
static Status set_between_events(Instance *instance, uint32_t reference, double value) {
    char name[200];
    if (!instance->tunable[reference] || value == instance->values[reference]) {
        instance->values[reference] = value;
        return STATUS_OK;
    }
    layout_scalar_name(instance, reference, name, sizeof name);
    if (reference < instance->ends[0])
        return instance_fail(instance, STATUS_ERROR, "%s changes in event mode only", name);
    return instance_fail(instance, STATUS_WARNING, "%s changes in event mode only; it stays %g", name,
                         instance->values[reference]);
}

Status instance_refuse_missing(Instance *instance, const void *references, const void *values, size_t count) {
    if (count == 0 || (references && values)) return STATUS_OK;
    return instance_fail(instance, STATUS_ERROR, "%s of %lu variables are missing: their array is NULL",
                         references ? "values" : "value references", (unsigned long)count);
}

Status instance_refuse_other(Instance *instance, VariableKind kind, const char *type, const uint32_t *references,
                             size_t count) {
    static const char *const words[] = {"a real number", "a Boolean", "an integer"};
    char name[200];
    if (kind == KIND_REAL && instance->accepts_numbers)
        return STATUS_OK;
    for (size_t i = 0; i < count; i++) {
        if (references[i] >= instance->ends[4]) /* time, or none: said elsewhere */
            continue;
        const unsigned char own = instance->kinds[references[i]];
        if (own == kind)
            continue;
        if (references[i] < instance->ends[3])
            layout_scalar_name(instance, references[i], name, sizeof name);
        else
            snprintf(name, sizeof name, "value reference %lu", (unsigned long)references[i]);
        return instance_fail(instance, STATUS_ERROR, "%s is %s; it has no value of type %s", name, words[own], type);
    }
    return STATUS_OK;
}

Status instance_set(Instance *instance, const uint32_t *references, size_t count, const double *values) {
    int parameters = 0, continuous = instance->mode == MODE_CONTINUOUS;
    Status status = STATUS_OK, worst = STATUS_OK;
    size_t bad = 0;
    if (!evaluate_all_finite(values, count, &bad))
        return not_finite(instance, references[bad], values[bad]);
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
            else if ((status = set_between_events(instance, references[i], values[i])) > worst)
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

/* What is computed before values of a range of references are read. */
enum { OF_OUTPUTS = 1, OF_OBSERVATIONS = 2, OF_CONTINUOUS = 4 };

static int computed_of(const Instance *instance, uint32_t first, uint32_t last) {
    const size_t *ends = instance->ends;
    return (last >= ends[1] && first < ends[2] ? OF_OUTPUTS : 0) |
           (last >= ends[2] && first < ends[3] ? OF_OBSERVATIONS : 0) | (last >= ends[3] ? OF_CONTINUOUS : 0);
}

Status instance_get(Instance *instance, const uint32_t *references, size_t count, double *values) {
    Reason why;
    *why.text = '\0'; /* alone: to clear all of it takes long */
    int computed = 0;
    const int one_range = contiguous(references, count) && references[count - 1] < instance->ends[4];
    if (one_range)
        computed = computed_of(instance, references[0], references[count - 1]);
    for (size_t i = 0; i < count && !one_range; i++) {
        if (references[i] >= instance->ends[4])
            return no_such_reference(instance, references[i]);
        computed |= computed_of(instance, references[i], references[i]);
    }
    if ((computed & OF_OUTPUTS && !evaluate_outputs(instance, &why)) ||
        (computed & OF_OBSERVATIONS && !evaluate_observations(instance, &why)) ||
        (computed & OF_CONTINUOUS && !evaluate_continuous(instance, &why)))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    if (one_range)
        memcpy(values, instance->values + references[0], count * sizeof(double));
    else
        for (size_t i = 0; i < count; i++)
            values[i] = instance->values[references[i]];
    return STATUS_OK;
}

/* From the state to the next one; to_event: to an event that is met before, h then being how far that is. */
static int step_kernel(Instance *instance, double *h, int to_event, int *due, double *next, Reason *why) {
    const Kernel *kernel = instance->kernel;
    const double *u = input_slopes_over_step(instance, *h);
    return to_event && kernel->step_to_event
               ? kernel->step_to_event(instance->self, instance->x, u, h, due, next, why)
               : kernel->step(instance->self, instance->x, u, *h, next, why);
}

/* One step; instance->time is its start already; stands_at (s): where the state is. */
static Status make_step(Instance *instance, double stands_at, double *step_size, int to_event, int *due) {
    const double h = *step_size;
    Reason why;
    *why.text = '\0'; /* alone: to clear all of it takes long */
    double *next = instance->before;
    if (instance->mode != MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, "%s",
                             instance->continuous.used ? "this instance is for model exchange; a solver outside makes the steps"
                             : instance->mode == MODE_TERMINATED ? "a step after termination"
                                                                 : "a step before the end of initialization mode");
    if (!isfinite(instance->time))
        return instance_fail(instance, STATUS_ERROR, "the communication point must be a finite number");
    if (instance->kernel->steps_inside && fabs(instance->time - stands_at) > SAME_TIME * (1.0 + fabs(stands_at)))
        return instance_fail(instance, STATUS_ERROR, "the communication point is %.9g s; the last step ended at %.9g s, "
                             "where the next one begins", instance->time, stands_at);
    if (!(h > 0.0 && isfinite(h)))
        return instance_fail(instance, STATUS_ERROR, "the communication step size is %g s; it must be positive", h);
    if (instance->time + h == instance->time)
        return instance_fail(instance, STATUS_ERROR, "the communication step size %g s is lost in the rounding of the time %g s",
                             h, instance->time);
    if (instance_check_stop(instance, instance->time + h) != STATUS_OK)
        return STATUS_ERROR;
    if (evaluate_ready(instance, &why) &&
        step_kernel(instance, step_size, to_event, due, next, &why) &&
        evaluate_state_finite(instance, next, &why)) {
        if (*why.text) instance_fail(instance, STATUS_WARNING, "%s", why.text); /* said; the step stands */
        return STATUS_OK;
    }
    instance->stepped = 0;
    return instance_fail(instance, STATUS_DISCARD, "%s", why.text);
}

static Status step_from(Instance *instance, double time, double *h, int to_event) {
    const double before = instance->time;
    instance->time = time; /* for what is said of a failure */
    int due = 0;
    Status status = make_step(instance, before, h, to_event, &due);
    if (status != STATUS_OK) {
        instance->time = before;
        return status;
    }
    double *next = instance->before;
    instance->before = instance->x;
    instance->x = next;
    instance->time = time + *h;
    instance->step_size = *h;
    instance->stepped = 1;
    instance->event_due = due;
    instance->outputs_known = instance->observations_known = 0;
    return STATUS_OK;
}

Status instance_step(Instance *instance, double time, double h) { return step_from(instance, time, &h, 0); }

Status instance_step_to_event(Instance *instance, double time, double *h) { return step_from(instance, time, h, 1); }

double instance_next_event(Instance *instance) {
    Reason why = {""};
    const Kernel *kernel = instance->kernel;
    if (!kernel->next_event || !instance->has_state || !evaluate_ready(instance, &why))
        return INFINITY;
    return kernel->next_event(instance->self, instance->x, evaluate_inputs(instance));
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
    if (instance->mode != MODE_EVENT)
        return instance_fail(instance, STATUS_ERROR, "discrete states are updated in event mode");
    return instance_let_happen(instance);
}

Status instance_let_happen(Instance *instance) {
    Reason why = {""};
    const Kernel *kernel = instance->kernel;
    if (!kernel->event)
        return STATUS_OK;
    if (!evaluate_ready(instance, &why))
        return instance_fail(instance, STATUS_ERROR, "%s", why.text);
    double *next = instance->before;
    kernel->event(instance->self, instance->x, evaluate_inputs(instance), instance->event_due, next);
    instance->before = instance->x;
    instance->x = next;
    instance->event_due = instance->stepped = 0;
    instance->outputs_known = instance->observations_known = 0;
    return STATUS_OK;
}
