/* FMI 2.0 for model exchange: the standard's functions that co-simulation does not have. */

#include <math.h>

#include "continuous.h"
#include "fmi2.h"
#include "fmi2_instance.h"

FMI2_EXPORT fmi2Status FMI2(EnterEventMode)(fmi2Component component) { CALLED(continuous_enter_event_mode(instance)); }

FMI2_EXPORT fmi2Status FMI2(EnterContinuousTimeMode)(fmi2Component component) {
    CALLED(continuous_enter_continuous_time_mode(instance));
}

/* One update is enough, and none moves a continuous state; the next event that is known is the next break of a law. */
FMI2_EXPORT fmi2Status FMI2(NewDiscreteStates)(fmi2Component component, fmi2EventInfo *info) {
    Instance *instance = fmi2_instance_of(component);
    *info = (fmi2EventInfo){0, 0, 0, 0, 0, 0.0};
    if (!instance) return fmi2Error;
    const Status status = continuous_update_discrete_states(instance);
    const double left = status == STATUS_OK ? continuous_time_to_break(instance) : INFINITY;
    if (isfinite(left)) {
        info->nextEventTimeDefined = 1;
        info->nextEventTime = instance->time + left;
    }
    return (fmi2Status)status;
}

FMI2_EXPORT fmi2Status FMI2(CompletedIntegratorStep)(fmi2Component component, fmi2Boolean no_return,
                                                     fmi2Boolean *enter_event_mode, fmi2Boolean *terminate) {
    (void)no_return;
    *enter_event_mode = *terminate = 0;
    CALLED(continuous_complete_step(instance, enter_event_mode));
}

FMI2_EXPORT fmi2Status FMI2(SetTime)(fmi2Component component, fmi2Real time) {
    CALLED(continuous_set_time(instance, time));
}

FMI2_EXPORT fmi2Status FMI2(SetContinuousStates)(fmi2Component component, const fmi2Real states[], size_t count) {
    CALLED(continuous_set_states(instance, states, count));
}

FMI2_EXPORT fmi2Status FMI2(GetDerivatives)(fmi2Component component, fmi2Real derivatives[], size_t count) {
    CALLED(continuous_get_rates(instance, derivatives, count));
}

FMI2_EXPORT fmi2Status FMI2(GetEventIndicators)(fmi2Component component, fmi2Real indicators[], size_t count) {
    CALLED(continuous_get_indicators(instance, indicators, count));
}

FMI2_EXPORT fmi2Status FMI2(GetContinuousStates)(fmi2Component component, fmi2Real states[], size_t count) {
    CALLED(continuous_get_states(instance, states, count));
}

FMI2_EXPORT fmi2Status FMI2(GetNominalsOfContinuousStates)(fmi2Component component, fmi2Real nominals[],
                                                           size_t count) {
    CALLED(continuous_get_nominals(instance, nominals, count));
}
