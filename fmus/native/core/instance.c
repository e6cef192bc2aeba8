/* One instance of a component: see instance.h. */

#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "continuous.h"
#include "real.h"

static const char *const GROUPS[4] = {"parameter", "input", "output", "observation"};

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

/* The declared variable that holds the scalar at a position of a group; 0 where there is none. */
static int variable_at(const Instance *instance, int group, size_t position, Variable *variable) {
    for (size_t i = 0; i < instance->data.count; i++)
        if (data_variable(&instance->data, i, GROUPS[group], variable) && position >= variable->offset &&
            position - variable->offset < variable->size)
            return 1;
    return 0;
}

/* Name of the scalar at a position of a group, with its index where the variable has several. */
static void scalar_name(const Instance *instance, int group, size_t position, char *name, size_t size) {
    Variable variable;
    if (!variable_at(instance, group, position, &variable))
        snprintf(name, size, "%s %lu", GROUPS[group], (unsigned long)position);
    else if (variable.size == 1)
        snprintf(name, size, "%s", variable.name);
    else
        snprintf(name, size, "%s[%lu]", variable.name, (unsigned long)(position - variable.offset + 1));
}

void instance_scalar_name(const Instance *instance, uint32_t reference, char *name, size_t size) {
    int group = reference >= instance->ends[0];
    scalar_name(instance, group, reference - (group ? instance->ends[0] : 0), name, size);
}

/* Unit of the parameter at a position; empty where it is not known. */
static const char *unit_of(const Instance *instance, size_t position) {
    Variable variable;
    char entry[200];
    if (!variable_at(instance, 0, position, &variable))
        return "";
    snprintf(entry, sizeof entry, "unit:%s", variable.name);
    const char *unit = data_text(&instance->data, entry);
    return unit ? unit : "";
}

/* Sizes, ranges and start values; every declared variable must lie within its group. */
static int read_layout(Instance *instance, Reason *why) {
    const Data *data = &instance->data;
    const double *counts = data_array(data, "sizes", 4, why);
    const double *feedthrough = data_array(data, "feedthrough", 1, why);
    if (!counts || !feedthrough)
        return 0;
    size_t total = 0;
    for (int group = 0; group < 4; group++) {
        if (!(counts[group] >= 0.0 && counts[group] < 1e7 && floor(counts[group]) == counts[group]))
            return refuse(why, "the component's data declare %g scalars of a kind", counts[group]);
        total += (size_t)counts[group];
        instance->ends[group] = total;
    }
    if (!continuous_read(instance, why))
        return 0;
    total += 2 * instance->continuous.count;
    instance->ends[4] = total;
    instance->feedthrough = feedthrough[0] != 0.0;
    instance->sizes = (Sizes){(size_t)counts[0], (size_t)counts[1], (size_t)counts[2], (size_t)counts[3]};
    instance->start = data_array(data, "start", instance->ends[1], why);
    if (!instance->start)
        return 0;
    instance->values = allocate(&instance->memory, (total + 1) * sizeof(double));
    instance->minimum = allocate(&instance->memory, (instance->sizes.parameters + 1) * sizeof(double));
    instance->maximum = allocate(&instance->memory, (instance->sizes.parameters + 1) * sizeof(double));
    instance->tunable = allocate(&instance->memory, instance->ends[1] + 1);
    if (!instance->values || !instance->minimum || !instance->maximum || !instance->tunable)
        return refuse(why, "no memory for %lu values", (unsigned long)total);
    Variable variable;
    for (int group = 0; group < 4; group++) {
        size_t size = instance->ends[group] - (group ? instance->ends[group - 1] : 0);
        for (size_t i = 0; i < data->count; i++) {
            if (!data_variable(data, i, GROUPS[group], &variable))
                continue;
            if (variable.offset > size || variable.size > size - variable.offset)
                return refuse(why, "%s %.100s lies outside of what is declared", GROUPS[group], variable.name);
            for (size_t k = variable.offset; group < 2 && k < variable.offset + variable.size; k++) {
                instance->tunable[k + (group ? instance->ends[0] : 0)] = (unsigned char)variable.tunable;
                if (group)
                    continue;
                instance->minimum[k] = variable.minimum;
                instance->maximum[k] = variable.maximum;
            }
        }
    }
    return 1;
}

static int find_kernel(Instance *instance, Reason *why) {
    const char *kind = data_text(&instance->data, "kind");
    for (size_t i = 0; kind && i < kernel_count; i++)
        if (strcmp(kind, kernels[i]->kind) == 0)
            instance->kernel = kernels[i];
    if (!instance->kernel)
        return refuse(why, "this binary knows no component %.100s", kind ? kind : "without a kind");
    return 1;
}

static int make_state(Instance *instance, Reason *why) {
    Memory *memory = &instance->memory;
    instance->self =
        instance->kernel->create(&instance->data, &instance->sizes, memory, &instance->states, why);
    if (!instance->self)
        return 0;
    instance->x = allocate(memory, (instance->states + 1) * sizeof(double));
    instance->before = allocate(memory, (instance->states + 1) * sizeof(double));
    instance->complex_inputs = allocate(memory, (instance->sizes.inputs + 1) * sizeof(double complex));
    instance->complex_state = allocate(memory, (instance->states + 1) * sizeof(double complex));
    instance->complex_outputs = allocate(memory, (instance->sizes.outputs + 1) * sizeof(double complex));
    if (!instance->x || !instance->before || !instance->complex_inputs || !instance->complex_state ||
        !instance->complex_outputs)
        return refuse(why, "no memory for %lu states", (unsigned long)instance->states);
    return continuous_create(instance, why);
}

static int check_token(const Instance *instance, const char *token, Reason *why) {
    const char *own = data_text(&instance->data, "token");
    if (!own || strlen(own) < 16)
        return refuse(why, "the component's data have no instantiation token");
    if (!token || strcmp(own, token) != 0)
        return refuse(why, "the model description has the token %.80s, the resources have %.80s; they do not "
                           "belong together", token ? token : "(none)", own);
    return 1;
}

Instance *instance_create(const char *name, const char *resources, const char *token, Logger logger, void *host) {
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance)
        return NULL;
    instance->logger = logger;
    instance->host = host;
    Reason why = {""};
    char *own_name = allocate(&instance->memory, strlen(name) + 1);
    size_t length = strlen(resources);
    char *path = allocate(&instance->memory, length + 20);
    instance->name = own_name ? strcpy(own_name, name) : "";
    int done = own_name && path;
    if (done) {
        const char *separator = length && (resources[length - 1] == '/' || resources[length - 1] == '\\') ? "" : "/";
        snprintf(path, length + 20, "%s%scomponent.bin", resources, separator);
        done = data_read(&instance->data, path, &instance->memory, &why) && check_token(instance, token, &why) &&
               find_kernel(instance, &why) && read_layout(instance, &why) && make_state(instance, &why);
    }
    if (!done) {
        instance_fail(instance, STATUS_ERROR, "%s", why.text[0] ? why.text : "no memory");
        instance_free(instance);
        return NULL;
    }
    instance_reset(instance);
    return instance;
}

void instance_free(Instance *instance) {
    if (!instance)
        return;
    release(&instance->memory);
    free(instance);
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

static int ranges_hold(const Instance *instance, Reason *why) {
    char name[200];
    for (size_t i = 0; i < instance->sizes.parameters; i++) {
        double value = instance->values[i];
        if (isfinite(value) && value >= instance->minimum[i] && value <= instance->maximum[i])
            continue;
        scalar_name(instance, 0, i, name, sizeof name);
        if (!isfinite(value))
            return refuse(why, "%s is %g; it must be a finite number", name, value);
        int low = value < instance->minimum[i];
        return refuse(why, "%s = %g %.40s; it must be at %s %g", name, value, unit_of(instance, i),
                      low ? "least" : "most", low ? instance->minimum[i] : instance->maximum[i]);
    }
    return 1;
}

static int prepare(Instance *instance, Reason *why) {
    if (!instance->prepared)
        instance->prepared =
            ranges_hold(instance, why) && instance->kernel->prepare(instance->self, instance->values, why);
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
    scalar_name(instance, 1, bad, name, sizeof name);
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
        int group = reference >= instance->ends[2] ? 3 : 2;
        scalar_name(instance, group, reference - instance->ends[group - 1], name, sizeof name);
        return instance_fail(instance, STATUS_ERROR, "%s is an output; it cannot be set", name);
    }
    if (instance->mode >= MODE_STEP && reference < instance->ends[0] && !instance->tunable[reference]) {
        scalar_name(instance, 0, reference, name, sizeof name);
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
    instance->time = time;
    if (instance->mode != MODE_STEP)
        return instance_fail(instance, STATUS_ERROR, instance->continuous.used
                                 ? "this instance is for model exchange; a solver outside makes the steps"
                                 : "a step before the end of initialization mode");
    if (!(h > 0.0 && isfinite(h)))
        return instance_fail(instance, STATUS_DISCARD, "the communication step size is %g s; it must be positive", h);
    double *next = instance->before;
    if (!inputs_finite(instance, &why) || !prepare(instance, &why) ||
        !instance->kernel->step(instance->self, instance->x, inputs_of(instance), h, next, &why) ||
        !state_finite(instance, next, &why)) {
        instance->stepped = 0;
        return instance_fail(instance, STATUS_DISCARD, "%s", why.text);
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

/* What makes two instances' states interchangeable: the content of their resources. */
static void write_owner(const Instance *instance, char *owner) {
    const char *token = data_text(&instance->data, "token");
    memcpy(owner, token + strlen(token) - 16, 16);
}

Status instance_save(Instance *instance, SavedState **state) {
    size_t known = instance->ends[1];
    SavedState *saved = *state;
    if (saved && (saved->known != known || saved->states != instance->states))
        return instance_fail(instance, STATUS_ERROR, "the FMU state belongs to an FMU of other content");
    if (!saved) {
        saved = malloc(sizeof *saved + (known + instance->states) * sizeof(double));
        if (!saved)
            return instance_fail(instance, STATUS_ERROR, "no memory to save the state");
        write_owner(instance, saved->owner);
        saved->known = known;
        saved->states = instance->states;
        *state = saved;
    }
    saved->time = instance->time;
    saved->mode = instance->mode;
    saved->has_state = instance->has_state;
    saved->event_due = instance->event_due;
    memcpy(saved->numbers, instance->values, known * sizeof(double));
    if (instance->has_state)
        memcpy(saved->numbers + known, instance->x, instance->states * sizeof(double));
    else
        memset(saved->numbers + known, 0, instance->states * sizeof(double));
    return STATUS_OK;
}

Status instance_restore(Instance *instance, const SavedState *state) {
    char owner[16];
    write_owner(instance, owner);
    if (!state || state->known != instance->ends[1] || state->states != instance->states ||
        memcmp(state->owner, owner, sizeof owner) != 0)
        return instance_fail(instance, STATUS_ERROR, "the FMU state belongs to an FMU of other content");
    if (state->mode == (instance->continuous.used ? MODE_STEP : MODE_CONTINUOUS))
        return instance_fail(instance, STATUS_ERROR, "the FMU state is that of an instance of the other interface type");
    if (memcmp(instance->values, state->numbers, instance->ends[0] * sizeof(double)) != 0)
        instance->prepared = 0;
    memcpy(instance->values, state->numbers, state->known * sizeof(double));
    memcpy(instance->x, state->numbers + state->known, state->states * sizeof(double));
    instance->time = state->time;
    instance->mode = (Mode)state->mode;
    instance->has_state = state->has_state;
    instance->event_due = state->event_due;
    instance->stepped = instance->outputs_known = instance->observations_known = instance->continuous.known = 0;
    return STATUS_OK;
}

void instance_forget(SavedState *state) { free(state); }

#define HEADER (16 + 6 * sizeof(double))

size_t instance_serialized_size(const SavedState *state) {
    return HEADER + (state->known + state->states) * sizeof(double);
}

void instance_serialize(const SavedState *state, unsigned char *bytes) {
    double header[6] = {state->time,           state->mode,          state->has_state,
                        (double)state->known, (double)state->states, state->event_due};
    memcpy(bytes, state->owner, 16);
    memcpy(bytes + 16, header, sizeof header);
    memcpy(bytes + HEADER, state->numbers, (state->known + state->states) * sizeof(double));
}

SavedState *instance_deserialize(const unsigned char *bytes, size_t size) {
    double header[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    size_t count = 0;
    if (size >= HEADER && (size - HEADER) % sizeof(double) == 0) {
        memcpy(header, bytes + 16, sizeof header);
        count = (size - HEADER) / sizeof(double);
        int known_mode = header[1] >= 0.0 && header[1] <= MODE_TERMINATED && header[1] == floor(header[1]);
        if (!known_mode || !(header[3] >= 0.0 && header[3] <= (double)count) || header[3] + header[4] != (double)count)
            count = 0;
    }
    SavedState *state = malloc(sizeof *state + (count + 1) * sizeof(double));
    if (!state)
        return NULL;
    memset(state, 0, sizeof *state);
    if (count) {
        memcpy(state->owner, bytes, 16);
        state->time = header[0];
        state->mode = (int)header[1];
        state->has_state = header[2] != 0.0;
        state->known = (size_t)header[3];
        state->states = (size_t)header[4];
        state->event_due = header[5] != 0.0;
        memcpy(state->numbers, bytes + HEADER, count * sizeof(double));
    }
    return state;
}
