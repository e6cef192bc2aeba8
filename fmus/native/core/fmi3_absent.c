/* What FMI 3.0 has and these FMUs do not offer: other types, clocks, structural parameters, adjoint
   derivatives, intermediate outputs, model exchange and scheduled execution. Each is refused with a sentence. */

#include "fmi3.h"

#define NO_TYPE "all variables of this FMU are of type Float64"
#define NO_CLOCK "this FMU has no clocks"
#define NO_EXCHANGE "this FMU is for co-simulation; model exchange is not offered"
#define NO_SCHEDULE "this FMU is for co-simulation; scheduled execution is not offered"

/* Asking for none of what there is not is no error. */
static fmi3Status refused(fmi3Instance instance, size_t count, const char *sentence) {
    Instance *core = core_of(instance);
    if (!core)
        return fmi3Error;
    return count ? (fmi3Status)instance_fail(core, STATUS_ERROR, "%s", sentence) : fmi3OK;
}

#define OTHER_TYPE(Type)                                                                                         \
    FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference references[],           \
                                         size_t count, fmi3##Type values[], size_t value_count) {                \
        (void)references, (void)values, (void)value_count;                                                       \
        return refused(instance, count, NO_TYPE);                                                                \
    }                                                                                                            \
    FMI3_EXPORT fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference references[],           \
                                         size_t count, const fmi3##Type values[], size_t value_count) {          \
        (void)references, (void)values, (void)value_count;                                                       \
        return refused(instance, count, NO_TYPE);                                                                \
    }

OTHER_TYPE(Float32)
OTHER_TYPE(Int8)
OTHER_TYPE(UInt8)
OTHER_TYPE(Int16)
OTHER_TYPE(UInt16)
OTHER_TYPE(Int32)
OTHER_TYPE(UInt32)
OTHER_TYPE(Int64)
OTHER_TYPE(UInt64)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                     size_t sizes[], fmi3Binary values[], size_t value_count) {
    (void)references, (void)sizes, (void)values, (void)value_count;
    return refused(instance, count, NO_TYPE);
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                     const size_t sizes[], const fmi3Binary values[], size_t value_count) {
    (void)references, (void)sizes, (void)values, (void)value_count;
    return refused(instance, count, NO_TYPE);
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                    fmi3Clock values[]) {
    (void)references, (void)values;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                    const fmi3Clock values[]) {
    (void)references, (void)values;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                                              size_t count, fmi3Float64 intervals[],
                                              fmi3IntervalQualifier qualifiers[]) {
    (void)references, (void)intervals, (void)qualifiers;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference references[],
                                               size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                               fmi3IntervalQualifier qualifiers[]) {
    (void)references, (void)counters, (void)resolutions, (void)qualifiers;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                                           size_t count, fmi3Float64 shifts[]) {
    (void)references, (void)shifts;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference references[],
                                            size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[]) {
    (void)references, (void)counters, (void)resolutions;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                                              size_t count, const fmi3Float64 intervals[]) {
    (void)references, (void)intervals;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference references[],
                                               size_t count, const fmi3UInt64 counters[],
                                               const fmi3UInt64 resolutions[]) {
    (void)references, (void)counters, (void)resolutions;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                                           size_t count, const fmi3Float64 shifts[]) {
    (void)references, (void)shifts;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference references[],
                                            size_t count, const fmi3UInt64 counters[],
                                            const fmi3UInt64 resolutions[]) {
    (void)references, (void)counters, (void)resolutions;
    return refused(instance, count, NO_CLOCK);
}

FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
    return refused(instance, 1, "discrete states are updated, but not evaluated in advance");
}

FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
    return refused(instance, 1, "this FMU has no structural parameters");
}

FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
    return refused(instance, 1, "this FMU has no structural parameters");
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference,
                                                           size_t *count) {
    (void)reference, (void)count;
    return refused(instance, 1, "dependencies are in the model description; they are not given for each element");
}

FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                                   size_t dependent_elements[], fmi3ValueReference independents[],
                                                   size_t independent_elements[], fmi3DependencyKind kinds[],
                                                   size_t count) {
    (void)dependent, (void)dependent_elements, (void)independents, (void)independent_elements, (void)kinds;
    (void)count;
    return refused(instance, 1, "dependencies are in the model description; they are not given for each element");
}

FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                                size_t unknown_count, const fmi3ValueReference knowns[],
                                                size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                fmi3Float64 sensitivity[], size_t sensitivity_count) {
    (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed, (void)seed_count;
    (void)sensitivity, (void)sensitivity_count;
    return refused(instance, 1, "adjoint derivatives are not offered; directional derivatives are");
}

FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference references[],
                                                size_t count, const fmi3Int32 orders[], fmi3Float64 values[],
                                                size_t value_count) {
    (void)references, (void)orders, (void)values, (void)value_count;
    return refused(instance, count, "derivatives of outputs by time are not offered");
}

/* Model exchange. */

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    if (log)
        log(environment, fmi3Error, "logStatusError", NO_EXCHANGE);
    return NULL;
}

FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
    return refused(instance, 1, NO_EXCHANGE);
}

FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_return,
                                                   fmi3Boolean *enter_event_mode, fmi3Boolean *terminate) {
    (void)no_return, (void)enter_event_mode, (void)terminate;
    return refused(instance, 1, NO_EXCHANGE);
}

FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
    (void)time;
    return refused(instance, 1, NO_EXCHANGE);
}

FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t count) {
    (void)states, (void)count;
    return refused(instance, 1, NO_EXCHANGE);
}

#define READ_CONTINUOUS(What)                                                                                    \
    FMI3_EXPORT fmi3Status fmi3Get##What(fmi3Instance instance, fmi3Float64 values[], size_t count) {            \
        (void)values, (void)count;                                                                               \
        return refused(instance, 1, NO_EXCHANGE);                                                                \
    }

READ_CONTINUOUS(ContinuousStateDerivatives)
READ_CONTINUOUS(EventIndicators)
READ_CONTINUOUS(ContinuousStates)
READ_CONTINUOUS(NominalsOfContinuousStates)

FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count) {
    (void)count;
    return refused(instance, 1, NO_EXCHANGE);
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count) {
    (void)count;
    return refused(instance, 1, NO_EXCHANGE);
}

/* Scheduled execution. */

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock_update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock_update;
    (void)lock, (void)unlock;
    if (log)
        log(environment, fmi3Error, "logStatusError", NO_SCHEDULE);
    return NULL;
}

FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock,
                                                  fmi3Float64 time) {
    (void)clock, (void)time;
    return refused(instance, 1, NO_SCHEDULE);
}
