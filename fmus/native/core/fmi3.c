/* FMI 3.0 for co-simulation: the standard's functions on an instance. What is not offered is in
   fmi3_absent.c. */

#include "fmi3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An event that is due already is met after this part of the step, because a step must make progress. */
#define LEAST_PROGRESS 0.01
/* Relative tolerance of times. */
#define SAME_TIME 1e-9

static void log_to_host(void *host, Status status, const char *sentence) {
    const Fmu *fmu = host;
    if (fmu->log && is_wanted(fmu->unwanted, status))
        fmu->log(fmu->environment, (fmi3Status)status, category_of(status), sentence);
}

FMI3_EXPORT const char *FMI3(GetVersion)(void) { return "3.0"; }

FMI3_EXPORT void FMI3(FreeInstance)(fmi3Instance instance) {
    if (!instance)
        return;
    instance_free(core_of(instance));
    free(instance);
}

/* Where variables begin and how many scalars each has; 0 without memory. */
static int map_variables(Fmu *fmu) {
    static const char *const groups[4] = {"parameter", "input", "output", "observation"};
    Instance *instance = fmu->instance;
    Variable variable;
    fmu->scalars = instance->ends[3];
    fmu->sizes = allocate(&instance->memory, (fmu->scalars + 1) * sizeof(uint32_t));
    fmu->positions = allocate(&instance->memory, (fmu->scalars + 1) * sizeof(uint32_t));
    fmu->expanded = allocate(&instance->memory, 2 * (fmu->scalars + 1) * sizeof(uint32_t));
    if (!fmu->sizes || !fmu->positions || !fmu->expanded)
        return 0;
    for (int group = 0; group < 4; group++)
        for (size_t i = 0; i < instance->data.count; i++)
            if (data_variable(&instance->data, i, groups[group], &variable) && variable.size)
                fmu->sizes[(group ? instance->ends[group - 1] : 0) + variable.offset] = (uint32_t)variable.size;
    fmu->sizes[fmu->scalars] = 1;
    for (size_t i = 0; i <= fmu->scalars; i++)
        fmu->positions[i] = (uint32_t)i;
    return 1;
}

/* An instance of any interface type; NULL, with the reason logged, when there is none. */
static Fmu *instantiate(fmi3String name, fmi3String token, fmi3String resources,
                        fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    Fmu *fmu = calloc(1, sizeof *fmu);
    if (!fmu)
        return NULL;
    fmu->environment = environment;
    fmu->log = log;
    if (!name || !*name)
        log_to_host(fmu, STATUS_ERROR, "an instance needs a name");
    else if (!resources)
        log_to_host(fmu, STATUS_ERROR, "the path of the resources is missing");
    else
        fmu->instance = instance_create(name, resources, token, log_to_host, fmu);
    if (fmu->instance && map_variables(fmu))
        return fmu;
    FMI3(FreeInstance)(fmu);
    return NULL;
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateCoSimulation)(
      fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
      fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed, const fmi3ValueReference intermediate[],
      size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
      fmi3IntermediateUpdateCallback update) {
    (void)visible, (void)logging, (void)intermediate, (void)intermediate_count, (void)update;
    Fmu *fmu = instantiate(name, token, resources, environment, log);
    if (fmu) {
        fmu->event_mode_used = event_mode_used;
        fmu->early_return_allowed = early_return_allowed;
    }
    return fmu;
}

FMI3_EXPORT fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t count,
                                             const fmi3String categories[]) {
    if (!instance)
        return fmi3Error;
    for (size_t i = 0; i < count; i++)
        if (!is_category(categories[i]))
            return (fmi3Status)instance_fail(core_of(instance), STATUS_ERROR, "there is no log category %.80s",
                                             categories[i] ? categories[i] : "(null)");
    fmu_of(instance)->unwanted = unwanted_by(on, count, categories);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                                     fmi3Float64 tolerance, fmi3Float64 start,
                                                     fmi3Boolean stop_defined, fmi3Float64 stop) {
    Instance *core = core_of(instance);
    if (!core)
        return fmi3Error;
    const Status status =
        instance_set_experiment(core, tolerance_defined ? &tolerance : NULL, start, stop_defined ? stop : INFINITY);
    if (status > STATUS_WARNING)
        return (fmi3Status)status;
    const Status entered = instance_enter_initialization(core);
    return (fmi3Status)(entered > status ? entered : status);
}

FMI3_EXPORT fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance) {
    Instance *core = core_of(instance);
    if (!core)
        return fmi3Error;
    Status status = instance_exit_initialization(core);
    if (status == STATUS_OK && fmu_of(instance)->event_mode_used)
        status = instance_enter_event_mode(core);
    return (fmi3Status)status;
}

FMI3_EXPORT fmi3Status FMI3(Terminate)(fmi3Instance instance) {
    CALLED(instance_terminate(core));
}

FMI3_EXPORT fmi3Status FMI3(Reset)(fmi3Instance instance) {
    CALLED(instance_reset(core));
}

/* STATUS_OK when the references are those of variables of a kind, which the host calls `type`, with `scalars` scalars in
   all, for which there are values. */
static Status check(Fmu *fmu, VariableKind kind, const char *type, const fmi3ValueReference *references, size_t count,
                    const void *values, size_t scalars) {
    size_t sum = 0;
    if (instance_refuse_missing(fmu->instance, references, values, count) != STATUS_OK ||
        instance_refuse_other(fmu->instance, kind, type, references, count) != STATUS_OK)
        return STATUS_ERROR;
    for (size_t i = 0; i < count; i++) {
        if (references[i] > fmu->scalars || !fmu->sizes[references[i]])
            return instance_fail(fmu->instance, STATUS_ERROR, "there is no variable with value reference %lu",
                                 (unsigned long)references[i]);
        sum += fmu->sizes[references[i]];
    }
    if (sum != scalars)
        return instance_fail(fmu->instance, STATUS_ERROR, "the variables have %lu values; there is room for %lu",
                             (unsigned long)sum, (unsigned long)scalars);
    return STATUS_OK;
}

/* Number of variables from the first on whose scalars follow one another, and of these scalars. Time, which
   is no value of the core, is a run by itself. */
static size_t run_of(const Fmu *fmu, const fmi3ValueReference *references, size_t count, size_t *scalars) {
    size_t length = 1;
    *scalars = fmu->sizes[references[0]];
    while (length < count && references[length] == references[0] + *scalars && references[length] < fmu->scalars)
        *scalars += fmu->sizes[references[length++]];
    return length;
}

FMI3_EXPORT fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                        fmi3Float64 values[], size_t value_count) {
    Fmu *fmu = fmu_of(instance);
    if (!fmu)
        return fmi3Error;
    Status status = check(fmu, KIND_REAL, "Float64", references, count, values, value_count);
    for (size_t i = 0, scalars = 0; status == STATUS_OK && i < count; values += scalars) {
        size_t first = references[i];
        i += run_of(fmu, references + i, count - i, &scalars);
        if (first == fmu->scalars)
            *values = fmu->instance->time;
        else
            status = instance_get(fmu->instance, fmu->positions + first, scalars, values);
    }
    return (fmi3Status)status;
}

FMI3_EXPORT fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                        const fmi3Float64 values[], size_t value_count) {
    Fmu *fmu = fmu_of(instance);
    if (!fmu)
        return fmi3Error;
    Status status = check(fmu, KIND_REAL, "Float64", references, count, values, value_count);
    for (size_t i = 0, scalars = 0; status == STATUS_OK && i < count; values += scalars) {
        size_t first = references[i];
        i += run_of(fmu, references + i, count - i, &scalars);
        if (first == fmu->scalars)
            status = instance_fail(fmu->instance, STATUS_ERROR, "time is the independent variable; it cannot be set");
        else
            status = instance_set(fmu->instance, fmu->positions + first, scalars, values);
    }
    return (fmi3Status)status;
}

/* Values that are no real numbers for a host, but are numbers inside. Time is none. */
#define TYPE_OF_NUMBERS(Type, kind, value_of_number)                                                             \
    FMI3_EXPORT fmi3Status FMI3(Get##Type)(fmi3Instance instance, const fmi3ValueReference references[],         \
                                           size_t count, fmi3##Type values[], size_t value_count) {              \
        Fmu *fmu = fmu_of(instance);                                                                             \
        if (!fmu)                                                                                                \
            return fmi3Error;                                                                                    \
        Status status = check(fmu, kind, #Type, references, count, values, value_count);                         \
        for (size_t i = 0; status == STATUS_OK && i < count; i++)                                                \
            for (uint32_t k = 0; status == STATUS_OK && k < fmu->sizes[references[i]]; k++) {                    \
                double number = 0.0;                                                                             \
                status = instance_get(fmu->instance, fmu->positions + references[i] + k, 1, &number);            \
                *values++ = value_of_number;                                                                     \
            }                                                                                                    \
        return (fmi3Status)status;                                                                               \
    }                                                                                                            \
    FMI3_EXPORT fmi3Status FMI3(Set##Type)(fmi3Instance instance, const fmi3ValueReference references[],         \
                                           size_t count, const fmi3##Type values[], size_t value_count) {        \
        Fmu *fmu = fmu_of(instance);                                                                             \
        if (!fmu)                                                                                                \
            return fmi3Error;                                                                                    \
        Status status = check(fmu, kind, #Type, references, count, values, value_count);                         \
        for (size_t i = 0; status <= STATUS_WARNING && i < count; i++)                                           \
            for (uint32_t k = 0; status <= STATUS_WARNING && k < fmu->sizes[references[i]]; k++) {               \
                const double number = *values++;                                                                 \
                status = instance_set(fmu->instance, fmu->positions + references[i] + k, 1, &number);            \
            }                                                                                                    \
        return (fmi3Status)status;                                                                               \
    }

TYPE_OF_NUMBERS(Int32, KIND_INTEGER, (fmi3Int32)number)
TYPE_OF_NUMBERS(Boolean, KIND_BOOLEAN, number > 0.5)

FMI3_EXPORT fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *state) {
    CALLED(instance_save(core, (SavedState **)state));
}

FMI3_EXPORT fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state) {
    CALLED(instance_restore(core, state));
}

FMI3_EXPORT fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *state) {
    CALLED(instance_forget((SavedState **)state));
}

FMI3_EXPORT fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state,
                                                   size_t *size) {
    CALLED(instance_serialized_size(core, state, size));
}

FMI3_EXPORT fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state,
                                              fmi3Byte bytes[], size_t size) {
    CALLED(instance_serialize(core, state, bytes, size));
}

FMI3_EXPORT fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[],
                                                size_t size, fmi3FMUState *state) {
    CALLED(instance_deserialize(core, bytes, size, (SavedState **)state));
}

/* References of all scalars of variables whose sizes were checked; there is room for each variable once. */
static Status expand(Fmu *fmu, const fmi3ValueReference *references, size_t count, size_t scalars, uint32_t *room) {
    if (scalars > fmu->scalars + 1)
        return instance_fail(fmu->instance, STATUS_ERROR, "a variable is listed twice");
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < fmu->sizes[references[i]]; k++)
            *room++ = references[i] + k;
    return STATUS_OK;
}

FMI3_EXPORT fmi3Status FMI3(GetDirectionalDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                                      size_t unknown_count, const fmi3ValueReference knowns[],
                                                      size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                      fmi3Float64 sensitivity[], size_t sensitivity_count) {
    Fmu *fmu = fmu_of(instance);
    if (!fmu)
        return fmi3Error;
    uint32_t *of = fmu->expanded, *by = fmu->expanded + fmu->scalars + 1;
    Status status = check(fmu, KIND_REAL, "Float64", unknowns, unknown_count, sensitivity, sensitivity_count);
    if (status == STATUS_OK)
        status = check(fmu, KIND_REAL, "Float64", knowns, known_count, seed, seed_count);
    if (status == STATUS_OK)
        status = expand(fmu, unknowns, unknown_count, sensitivity_count, of);
    if (status == STATUS_OK)
        status = expand(fmu, knowns, known_count, seed_count, by);
    if (status == STATUS_OK)
        status = instance_derivative(fmu->instance, of, sensitivity_count, by, seed_count, seed, sensitivity);
    return (fmi3Status)status;
}

FMI3_EXPORT fmi3Status FMI3(EnterEventMode)(fmi3Instance instance) {
    Instance *core = core_of(instance);
    if (!core)
        return fmi3Error;
    if (!fmu_of(instance)->event_mode_used)
        return (fmi3Status)instance_fail(core, STATUS_ERROR, "event mode was not asked for at instantiation");
    return (fmi3Status)instance_enter_event_mode(core);
}

FMI3_EXPORT fmi3Status FMI3(EnterStepMode)(fmi3Instance instance) {
    CALLED(instance_enter_step_mode(core));
}

FMI3_EXPORT fmi3Status FMI3(UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *needs_update,
                                                  fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                                  fmi3Boolean *values_changed, fmi3Boolean *next_event_time_defined,
                                                  fmi3Float64 *next_event_time) {
    Instance *core = core_of(instance);
    *needs_update = *terminate = *nominals_changed = *values_changed = *next_event_time_defined = false;
    *next_event_time = 0.0;
    return core ? (fmi3Status)instance_update_discrete_states(core) : fmi3Error;
}

/* Size of the step to take: up to the event that is foreseen in it, if the host lets it return early. */
static double size_up_to_event(const Fmu *fmu, double h, int *due) {
    *due = 0;
    if (!fmu->event_mode_used)
        return h;
    double until_event = instance_next_event(fmu->instance);
    *due = until_event <= h;
    if (!*due || !fmu->early_return_allowed || until_event >= (1.0 - SAME_TIME) * h)
        return h;
    return fmax(until_event, LEAST_PROGRESS * h);
}

/* STATUS_OK when a step may be made now. */
static Status check_step(Fmu *fmu, double end) {
    Instance *core = fmu->instance;
    if (core->mode == MODE_EVENT || core->mode == MODE_TERMINATED)
        return instance_fail(core, STATUS_ERROR, "a step is made in step mode");
    return instance_check_stop(core, end); /* which an early return must not hide */
}

FMI3_EXPORT fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 time, fmi3Float64 h, fmi3Boolean no_return,
                                    fmi3Boolean *event_handling_needed, fmi3Boolean *terminate,
                                    fmi3Boolean *early_return, fmi3Float64 *last_successful_time) {
    (void)no_return;
    Fmu *fmu = fmu_of(instance);
    *event_handling_needed = *terminate = *early_return = false;
    *last_successful_time = time;
    if (!fmu)
        return fmi3Error;
    int due = 0;
    Status status = check_step(fmu, time + h);
    if (status != STATUS_OK)
        return (fmi3Status)status;
    double size = size_up_to_event(fmu, h, &due);
    status = fmu->early_return_allowed ? instance_step_to_event(fmu->instance, time, &size)
                                       : instance_step(fmu->instance, time, size);
    if (status != STATUS_OK)
        return (fmi3Status)status;
    fmu->instance->event_due |= due;
    *event_handling_needed = fmu->event_mode_used && fmu->instance->event_due;
    *early_return = size < h;
    if (fmu->instance->event_due && !fmu->event_mode_used)
        status = instance_let_happen(fmu->instance);
    *last_successful_time = fmu->instance->time;
    return (fmi3Status)status;
}
