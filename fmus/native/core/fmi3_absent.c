/* What FMI 3.0 has and these FMUs do not offer: other types, clocks, structural parameters, adjoint
   derivatives, intermediate outputs, model exchange and scheduled execution. Each is refused with a sentence. */

#include "fmi3.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define NO_TYPE "variables of this FMU are of the types Float64, Boolean and Int32"
#define NO_CLOCK "this FMU has no clocks"
#define NO_STRUCTURE "this FMU has no structural parameters"
#define NO_DEPENDENCIES "dependencies are in the model description; they are not given for each element"
#define NO_EXCHANGE "this FMU is for co-simulation; model exchange is not offered"
#define NO_SCHEDULE "this FMU is for co-simulation; scheduled execution is not offered"

/* Asking for none of what there is not is no error. */
static Status refused(Instance *core, size_t count, const char *sentence) {
    return count ? instance_fail(core, STATUS_ERROR, "%s", sentence) : STATUS_OK;
}

/* A function that is refused, with its arguments behind the instance. */
#define ABSENT(Name, sentence, ...)                                                                              \
    FMI3_EXPORT fmi3Status FMI3(Name)(fmi3Instance instance, __VA_ARGS__) { CALLED(refused(core, 1, sentence)); }
#define ABSENT_MODE(Name, sentence)                                                                              \
    FMI3_EXPORT fmi3Status FMI3(Name)(fmi3Instance instance) { CALLED(refused(core, 1, sentence)); }
/* The same of a function for `count` variables, by their references. */
#define ABSENT_VALUES(Name, sentence, ...)                                                                       \
    FMI3_EXPORT fmi3Status FMI3(Name)(fmi3Instance instance, const fmi3ValueReference references[],              \
                                      size_t count, __VA_ARGS__) {                                               \
        CALLED(refused(core, count, sentence));                                                                  \
    }
/* Of both functions of a type. */
#define ABSENT_TYPE(Type)                                                                                        \
    ABSENT_VALUES(Get##Type, NO_TYPE, fmi3##Type values[], size_t value_count)                                   \
    ABSENT_VALUES(Set##Type, NO_TYPE, const fmi3##Type values[], size_t value_count)

ABSENT_TYPE(Float32)
ABSENT_TYPE(Int8)
ABSENT_TYPE(UInt8)
ABSENT_TYPE(Int16)
ABSENT_TYPE(UInt16)
ABSENT_TYPE(UInt32)
ABSENT_TYPE(Int64)
ABSENT_TYPE(UInt64)
ABSENT_TYPE(String)
ABSENT_VALUES(GetBinary, NO_TYPE, size_t sizes[], fmi3Binary values[], size_t value_count)
ABSENT_VALUES(SetBinary, NO_TYPE, const size_t sizes[], const fmi3Binary values[], size_t value_count)

ABSENT_VALUES(GetClock, NO_CLOCK, fmi3Clock values[])
ABSENT_VALUES(SetClock, NO_CLOCK, const fmi3Clock values[])
ABSENT_VALUES(GetIntervalDecimal, NO_CLOCK, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
ABSENT_VALUES(GetIntervalFraction, NO_CLOCK, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
              fmi3IntervalQualifier qualifiers[])
ABSENT_VALUES(GetShiftDecimal, NO_CLOCK, fmi3Float64 shifts[])
ABSENT_VALUES(GetShiftFraction, NO_CLOCK, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT_VALUES(SetIntervalDecimal, NO_CLOCK, const fmi3Float64 intervals[])
ABSENT_VALUES(SetIntervalFraction, NO_CLOCK, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT_VALUES(SetShiftDecimal, NO_CLOCK, const fmi3Float64 shifts[])
ABSENT_VALUES(SetShiftFraction, NO_CLOCK, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])

ABSENT_MODE(EvaluateDiscreteStates, "discrete states are updated, but not evaluated in advance")
ABSENT_MODE(EnterConfigurationMode, NO_STRUCTURE)
ABSENT_MODE(ExitConfigurationMode, NO_STRUCTURE)
ABSENT(GetNumberOfVariableDependencies, NO_DEPENDENCIES, fmi3ValueReference reference, size_t *count)
ABSENT(GetVariableDependencies, NO_DEPENDENCIES, fmi3ValueReference dependent, size_t dependent_elements[],
       fmi3ValueReference independents[], size_t independent_elements[], fmi3DependencyKind kinds[], size_t count)
ABSENT(GetAdjointDerivative, "adjoint derivatives are not offered; directional derivatives are",
       const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[],
       size_t known_count, const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[],
       size_t sensitivity_count)
ABSENT_VALUES(GetOutputDerivatives, "derivatives of outputs by time are not offered", const fmi3Int32 orders[],
              fmi3Float64 values[], size_t value_count)

ABSENT_MODE(EnterContinuousTimeMode, NO_EXCHANGE)
ABSENT(CompletedIntegratorStep, NO_EXCHANGE, fmi3Boolean no_return, fmi3Boolean *enter_event_mode,
       fmi3Boolean *terminate)
ABSENT(SetTime, NO_EXCHANGE, fmi3Float64 time)
ABSENT(SetContinuousStates, NO_EXCHANGE, const fmi3Float64 states[], size_t count)
ABSENT(GetContinuousStateDerivatives, NO_EXCHANGE, fmi3Float64 values[], size_t count)
ABSENT(GetEventIndicators, NO_EXCHANGE, fmi3Float64 values[], size_t count)
ABSENT(GetContinuousStates, NO_EXCHANGE, fmi3Float64 values[], size_t count)
ABSENT(GetNominalsOfContinuousStates, NO_EXCHANGE, fmi3Float64 values[], size_t count)
ABSENT(GetNumberOfEventIndicators, NO_EXCHANGE, size_t *count)
ABSENT(GetNumberOfContinuousStates, NO_EXCHANGE, size_t *count)
ABSENT(ActivateModelPartition, NO_SCHEDULE, fmi3ValueReference clock, fmi3Float64 time)

/* No instance of another interface type. */
static fmi3Instance none(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char *sentence) {
    if (log)
        log(environment, fmi3Error, "logStatusError", sentence);
    return NULL;
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                        fmi3Boolean visible, fmi3Boolean logging,
                                                        fmi3InstanceEnvironment environment,
                                                        fmi3LogMessageCallback log) {
    return none(environment, log, NO_EXCHANGE);
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock_update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    return none(environment, log, NO_SCHEDULE);
}
