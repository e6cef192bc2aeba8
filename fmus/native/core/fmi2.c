/* FMI 2.0: the standard's functions on an instance; those of model exchange alone are in fmi2_model_exchange.c. */

#include "fmi2.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "continuous.h"
#include "fmi2_instance.h"
#include "input_slopes.h"
#include "log_categories.h"
#include "resources.h"

/* An instance and the host it reports to. */
typedef struct {
    Instance *instance;
    fmi2CallbackFunctions callbacks;
    char *name;
    Unwanted unwanted;
} Slave;

/* A host may take the message as a format. */
static void double_percent_signs(const char *sentence, char *message, size_t size) {
    size_t length = 0;
    for (; *sentence && length + 3 < size; sentence++) {
        if (*sentence == '%')
            message[length++] = '%';
        message[length++] = *sentence;
    }
    message[length] = '\0';
}

static void log_to_host(void *host, Status status, const char *sentence) {
    const Slave *slave = host;
    char message[1600];
    if (!slave->callbacks.logger || !is_wanted(slave->unwanted, status))
        return;
    double_percent_signs(sentence, message, sizeof message);
    slave->callbacks.logger(slave->callbacks.componentEnvironment, slave->name, (fmi2Status)status,
                             category_of(status), message);
}

static Slave *slave_of(fmi2Component component) { return component; }

Instance *fmi2_instance_of(fmi2Component component) { return component ? slave_of(component)->instance : NULL; }

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT void fmi2FreeInstance(fmi2Component component) {
    Slave *slave = slave_of(component);
    if (!slave)
        return;
    instance_free(slave->instance);
    free(slave->name);
    free(slave);
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    (void)visible, (void)logging;
    char path[4096];
    Slave *slave = calloc(1, sizeof *slave);
    if (!slave)
        return NULL;
    name = name ? name : "";
    if (callbacks)
        slave->callbacks = *callbacks;
    slave->name = malloc(strlen(name) + 1);
    if (slave->name)
        strcpy(slave->name, name);
    if (!slave->name || !*name)
        log_to_host(slave, STATUS_ERROR, "an instance needs a name");
    else if (type != fmi2CoSimulation && type != fmi2ModelExchange)
        log_to_host(slave, STATUS_ERROR, "an instance is for model exchange or for co-simulation");
    else if (!location || !resources_path(location, path, sizeof path))
        log_to_host(slave, STATUS_ERROR, "the resource location is missing or longer than 4095 characters");
    else
        slave->instance = instance_create(name, path, guid, log_to_host, slave);
    if (slave->instance && (type == fmi2CoSimulation || continuous_use(slave->instance)))
        return slave;
    fmi2FreeInstance(slave);
    return NULL;
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                                           const fmi2String categories[]) {
    if (!component)
        return fmi2Error;
    slave_of(component)->unwanted = unwanted_by(on, count, categories);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined,
                                           fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                                           fmi2Real stop) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_set_experiment(instance, tolerance_defined ? &tolerance : NULL, start,
                                                          stop_defined ? stop : INFINITY)
                    : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_enter_initialization(instance) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_exit_initialization(instance) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_terminate(instance) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_reset(instance) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   fmi2Real values[]) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || instance_refuse_missing(instance, references, values, count) != STATUS_OK)
        return fmi2Error;
    return (fmi2Status)instance_get(instance, references, count, values);
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   const fmi2Real values[]) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || instance_refuse_missing(instance, references, values, count) != STATUS_OK)
        return fmi2Error;
    return (fmi2Status)instance_set(instance, references, count, values);
}

/* There are no variables of other types; asking for none of them is no error. */
static fmi2Status other_type(fmi2Component component, size_t count) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance)
        return fmi2Error;
    return count ? (fmi2Status)instance_fail(instance, STATUS_ERROR, "all variables of this FMU are of type Real")
                 : fmi2OK;
}

#define OTHER_TYPE(Type)                                                                                         \
    FMI2_EXPORT fmi2Status fmi2Get##Type(fmi2Component component, const fmi2ValueReference references[],         \
                                         size_t count, fmi2##Type values[]) {                                    \
        (void)references, (void)values;                                                                          \
        return other_type(component, count);                                                                     \
    }                                                                                                            \
    FMI2_EXPORT fmi2Status fmi2Set##Type(fmi2Component component, const fmi2ValueReference references[],         \
                                         size_t count, const fmi2##Type values[]) {                              \
        (void)references, (void)values;                                                                          \
        return other_type(component, count);                                                                     \
    }

OTHER_TYPE(Integer)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance)
        return fmi2Error;
    SavedState *saved = *state;
    Status status = instance_save(instance, &saved);
    *state = saved;
    return (fmi2Status)status;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_restore(instance, state) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
    if (!component)
        return fmi2Error;
    if (state) {
        instance_forget(*state);
        *state = NULL;
    }
    return fmi2OK;
}

static fmi2Status no_state(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_fail(instance, STATUS_ERROR, "there is no FMU state to serialize") : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
    if (!component || !state)
        return no_state(component);
    *size = instance_serialized_size(state);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                             size_t size) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || !state)
        return no_state(component);
    if (size < instance_serialized_size(state))
        return (fmi2Status)instance_fail(instance, STATUS_ERROR, "%lu bytes are too few for the state",
                                         (unsigned long)size);
    instance_serialize(state, (unsigned char *)bytes);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance)
        return fmi2Error;
    *state = instance_deserialize(instance, (const unsigned char *)bytes, size);
    return *state ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component component,
                                                    const fmi2ValueReference unknowns[], size_t unknown_count,
                                                    const fmi2ValueReference knowns[], size_t known_count,
                                                    const fmi2Real seed[], fmi2Real result[]) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_derivative(instance, unknowns, unknown_count, knowns, known_count, seed, result)
                    : fmi2Error;
}

FMI2_EXPORT fmi2Status fanfoldGetPortStiffness(fmi2Component component, size_t ports, fmi2Real stiffness[]) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_port_stiffness(instance, ports, stiffness) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real h, fmi2Boolean no_return) {
    (void)no_return;
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_step(instance, time, h) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)instance_fail(instance, STATUS_ERROR, "no step runs that could be cancelled")
                    : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[],
                                                   size_t count, const fmi2Integer orders[],
                                                   const fmi2Real values[]) {
    Instance *instance = fmi2_instance_of(component);
    return instance ? (fmi2Status)input_slopes_set(instance, references, count, orders, values) : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[],
                                                    size_t count, const fmi2Integer orders[], fmi2Real values[]) {
    (void)references, (void)orders, (void)values;
    Instance *instance = fmi2_instance_of(component);
    if (!instance)
        return fmi2Error;
    return count ? (fmi2Status)instance_fail(instance, STATUS_ERROR, "derivatives of outputs are not offered") : fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component component, fmi2StatusKind kind, fmi2Status *value) {
    (void)component, (void)kind, (void)value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind kind, fmi2Real *value) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = instance->time;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component component, fmi2StatusKind kind, fmi2Integer *value) {
    (void)component, (void)kind, (void)value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind kind, fmi2Boolean *value) {
    if (!component || kind != fmi2Terminated)
        return fmi2Discard;
    *value = 0;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component component, fmi2StatusKind kind, fmi2String *value) {
    (void)component, (void)kind, (void)value;
    return fmi2Discard;
}
