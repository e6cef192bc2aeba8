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

#define NO_TEXTS "this FMU has no variables of type String"

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

FMI2_EXPORT const char *FMI2(GetTypesPlatform)(void) { return "default"; }
FMI2_EXPORT const char *FMI2(GetVersion)(void) { return "2.0"; }

FMI2_EXPORT void FMI2(FreeInstance)(fmi2Component component) {
    Slave *slave = slave_of(component);
    if (!slave)
        return;
    instance_free(slave->instance);
    free(slave->name);
    free(slave);
}

FMI2_EXPORT fmi2Component FMI2(Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
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
    FMI2(FreeInstance)(slave);
    return NULL;
}

FMI2_EXPORT fmi2Status FMI2(SetDebugLogging)(fmi2Component component, fmi2Boolean on, size_t count,
                                             const fmi2String categories[]) {
    if (!component)
        return fmi2Error;
    slave_of(component)->unwanted = unwanted_by(on, count, categories);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(SetupExperiment)(fmi2Component component, fmi2Boolean tolerance_defined,
                                             fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                                             fmi2Real stop) {
    CALLED(instance_set_experiment(instance, tolerance_defined ? &tolerance : NULL, start,
                                   stop_defined ? stop : INFINITY));
}

FMI2_EXPORT fmi2Status FMI2(EnterInitializationMode)(fmi2Component component) {
    CALLED(instance_enter_initialization(instance));
}

FMI2_EXPORT fmi2Status FMI2(ExitInitializationMode)(fmi2Component component) {
    CALLED(instance_exit_initialization(instance));
}

FMI2_EXPORT fmi2Status FMI2(Terminate)(fmi2Component component) {
    CALLED(instance_terminate(instance));
}

FMI2_EXPORT fmi2Status FMI2(Reset)(fmi2Component component) {
    CALLED(instance_reset(instance));
}

/* STATUS_OK where there are arrays for variables of a kind. */
static Status check(Instance *instance, VariableKind kind, const char *type, const fmi2ValueReference *references,
                     const void *values, size_t count) {
    const Status status = instance_refuse_missing(instance, references, values, count);
    return status == STATUS_OK ? instance_refuse_other(instance, kind, type, references, count) : status;
}

FMI2_EXPORT fmi2Status FMI2(GetReal)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                     fmi2Real values[]) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || check(instance, KIND_REAL, "Real", references, values, count) != STATUS_OK)
        return fmi2Error;
    return (fmi2Status)instance_get(instance, references, count, values);
}

FMI2_EXPORT fmi2Status FMI2(SetReal)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                     const fmi2Real values[]) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || check(instance, KIND_REAL, "Real", references, values, count) != STATUS_OK)
        return fmi2Error;
    return (fmi2Status)instance_set(instance, references, count, values);
}

/* Asking for none of what there is not is no error. */
static Status refused(Instance *instance, size_t count, const char *sentence) {
    return count ? instance_fail(instance, STATUS_ERROR, "%s", sentence) : STATUS_OK;
}

/* Values that are no real numbers for a host, but are numbers inside. */
#define TYPE_OF_NUMBERS(Type, kind, value_of_number)                                                             \
    FMI2_EXPORT fmi2Status FMI2(Get##Type)(fmi2Component component, const fmi2ValueReference references[],       \
                                           size_t count, fmi2##Type values[]) {                                  \
        Instance *instance = fmi2_instance_of(component);                                                        \
        if (!instance || check(instance, kind, #Type, references, values, count) != STATUS_OK)                  \
            return fmi2Error;                                                                                    \
        Status status = STATUS_OK;                                                                               \
        for (size_t i = 0; i < count && status == STATUS_OK; i++) {                                              \
            double number = 0.0;                                                                                 \
            status = instance_get(instance, references + i, 1, &number);                                         \
            values[i] = value_of_number;                                                                         \
        }                                                                                                        \
        return (fmi2Status)status;                                                                               \
    }                                                                                                            \
    FMI2_EXPORT fmi2Status FMI2(Set##Type)(fmi2Component component, const fmi2ValueReference references[],       \
                                           size_t count, const fmi2##Type values[]) {                            \
        Instance *instance = fmi2_instance_of(component);                                                        \
        if (!instance || check(instance, kind, #Type, references, values, count) != STATUS_OK)                  \
            return fmi2Error;                                                                                    \
        Status status = STATUS_OK, worst = STATUS_OK;                                                            \
        for (size_t i = 0; i < count && worst <= STATUS_WARNING; i++) {                                          \
            const double number = kind == KIND_BOOLEAN ? values[i] != 0 : values[i];                             \
            if ((status = instance_set(instance, references + i, 1, &number)) > worst)                           \
                worst = status;                                                                                  \
        }                                                                                                        \
        return (fmi2Status)worst;                                                                                \
    }

TYPE_OF_NUMBERS(Integer, KIND_INTEGER, (fmi2Integer)number)
TYPE_OF_NUMBERS(Boolean, KIND_BOOLEAN, number > 0.5)

FMI2_EXPORT fmi2Status FMI2(GetString)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       fmi2String values[]) {
    (void)references, (void)values;
    CALLED(refused(instance, count, NO_TEXTS));
}

FMI2_EXPORT fmi2Status FMI2(SetString)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                       const fmi2String values[]) {
    (void)references, (void)values;
    CALLED(refused(instance, count, NO_TEXTS));
}

FMI2_EXPORT fmi2Status ACCEPT_NUMBERS(fmi2Component component) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance)
        return fmi2Error;
    instance->accepts_numbers = 1;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(GetFMUstate)(fmi2Component component, fmi2FMUstate *state) {
    CALLED(instance_save(instance, (SavedState **)state));
}

FMI2_EXPORT fmi2Status FMI2(SetFMUstate)(fmi2Component component, fmi2FMUstate state) {
    CALLED(instance_restore(instance, state));
}

FMI2_EXPORT fmi2Status FMI2(FreeFMUstate)(fmi2Component component, fmi2FMUstate *state) {
    CALLED(instance_forget((SavedState **)state));
}

FMI2_EXPORT fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state,
                                                   size_t *size) {
    CALLED(instance_serialized_size(instance, state, size));
}

FMI2_EXPORT fmi2Status FMI2(SerializeFMUstate)(fmi2Component component, fmi2FMUstate state,
                                              fmi2Byte bytes[], size_t size) {
    CALLED(instance_serialize(instance, state, (unsigned char *)bytes, size));
}

FMI2_EXPORT fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component component, const fmi2Byte bytes[],
                                                size_t size, fmi2FMUstate *state) {
    CALLED(instance_deserialize(instance, (const unsigned char *)bytes, size, (SavedState **)state));
}

FMI2_EXPORT fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component component,
                                                      const fmi2ValueReference unknowns[], size_t unknown_count,
                                                      const fmi2ValueReference knowns[], size_t known_count,
                                                      const fmi2Real seed[], fmi2Real result[]) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || instance_refuse_other(instance, KIND_REAL, "Real", unknowns, unknown_count) != STATUS_OK ||
        instance_refuse_other(instance, KIND_REAL, "Real", knowns, known_count) != STATUS_OK)
        return fmi2Error;
    return (fmi2Status)instance_derivative(instance, unknowns, unknown_count, knowns, known_count, seed, result);
}

FMI2_EXPORT fmi2Status PORT_STIFFNESS(fmi2Component component, size_t ports, fmi2Real stiffness[]) {
    CALLED(instance_port_stiffness(instance, ports, stiffness));
}

FMI2_EXPORT fmi2Status FMI2(DoStep)(fmi2Component component, fmi2Real time, fmi2Real h, fmi2Boolean no_return) {
    (void)no_return;
    CALLED(instance_step(instance, time, h));
}

FMI2_EXPORT fmi2Status FMI2(CancelStep)(fmi2Component component) {
    CALLED(instance_fail(instance, STATUS_ERROR, "no step runs that could be cancelled"));
}

FMI2_EXPORT fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component component, const fmi2ValueReference references[],
                                                     size_t count, const fmi2Integer orders[],
                                                     const fmi2Real values[]) {
    CALLED(input_slopes_set(instance, references, count, orders, values));
}

FMI2_EXPORT fmi2Status FMI2(GetRealOutputDerivatives)(fmi2Component component, const fmi2ValueReference references[],
                                                      size_t count, const fmi2Integer orders[], fmi2Real values[]) {
    (void)references, (void)orders, (void)values;
    CALLED(refused(instance, count, "derivatives of outputs are not offered"));
}

/* Nothing is pending, and there is no status of these types. */
#define NO_STATUS(Name, Type)                                                                                    \
    FMI2_EXPORT fmi2Status FMI2(Name)(fmi2Component component, fmi2StatusKind kind, Type *value) {               \
        (void)component, (void)kind, (void)value;                                                                \
        return fmi2Discard;                                                                                      \
    }

NO_STATUS(GetStatus, fmi2Status)
NO_STATUS(GetIntegerStatus, fmi2Integer)
NO_STATUS(GetStringStatus, fmi2String)

FMI2_EXPORT fmi2Status FMI2(GetRealStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Real *value) {
    Instance *instance = fmi2_instance_of(component);
    if (!instance || kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = instance->time;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(GetBooleanStatus)(fmi2Component component, fmi2StatusKind kind, fmi2Boolean *value) {
    if (!component || kind != fmi2Terminated)
        return fmi2Discard;
    *value = 0;
    return fmi2OK;
}
