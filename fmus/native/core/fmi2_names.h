/* Names of the FMI 2.0 functions with a prefix, for hosts that link several FMUs statically and define
   FMI2_FUNCTION_PREFIX (FMI 2.0, section 2.1.1). */

#ifndef FANFOLD_FMI2_NAMES_H
#define FANFOLD_FMI2_NAMES_H

#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOIN(prefix, name) prefix##name
#define FMI2_NAME(prefix, name) FMI2_JOIN(prefix, name)
#define fanfoldGetPortStiffness FMI2_NAME(FMI2_FUNCTION_PREFIX, fanfoldGetPortStiffness)
#define fmi2CancelStep FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2CancelStep)
#define fmi2CompletedIntegratorStep FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2CompletedIntegratorStep)
#define fmi2DeSerializeFMUstate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2DeSerializeFMUstate)
#define fmi2DoStep FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2DoStep)
#define fmi2EnterContinuousTimeMode FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2EnterContinuousTimeMode)
#define fmi2EnterEventMode FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2EnterEventMode)
#define fmi2EnterInitializationMode FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2EnterInitializationMode)
#define fmi2ExitInitializationMode FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2ExitInitializationMode)
#define fmi2FreeFMUstate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2FreeFMUstate)
#define fmi2FreeInstance FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2FreeInstance)
#define fmi2GetBoolean FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetBoolean)
#define fmi2GetBooleanStatus FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetBooleanStatus)
#define fmi2GetContinuousStates FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetContinuousStates)
#define fmi2GetDerivatives FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetDerivatives)
#define fmi2GetDirectionalDerivative FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetDirectionalDerivative)
#define fmi2GetEventIndicators FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetEventIndicators)
#define fmi2GetFMUstate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetFMUstate)
#define fmi2GetInteger FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetInteger)
#define fmi2GetIntegerStatus FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetIntegerStatus)
#define fmi2GetNominalsOfContinuousStates FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetNominalsOfContinuousStates)
#define fmi2GetReal FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetReal)
#define fmi2GetRealOutputDerivatives FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetRealOutputDerivatives)
#define fmi2GetRealStatus FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetRealStatus)
#define fmi2GetStatus FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetStatus)
#define fmi2GetString FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetString)
#define fmi2GetStringStatus FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetStringStatus)
#define fmi2GetTypesPlatform FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetTypesPlatform)
#define fmi2GetVersion FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2GetVersion)
#define fmi2Instantiate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2Instantiate)
#define fmi2NewDiscreteStates FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2NewDiscreteStates)
#define fmi2Reset FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2Reset)
#define fmi2SerializeFMUstate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SerializeFMUstate)
#define fmi2SerializedFMUstateSize FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SerializedFMUstateSize)
#define fmi2SetBoolean FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetBoolean)
#define fmi2SetContinuousStates FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetContinuousStates)
#define fmi2SetDebugLogging FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetDebugLogging)
#define fmi2SetFMUstate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetFMUstate)
#define fmi2SetInteger FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetInteger)
#define fmi2SetReal FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetReal)
#define fmi2SetRealInputDerivatives FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetRealInputDerivatives)
#define fmi2SetString FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetString)
#define fmi2SetTime FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetTime)
#define fmi2SetupExperiment FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2SetupExperiment)
#define fmi2Terminate FMI2_NAME(FMI2_FUNCTION_PREFIX, fmi2Terminate)
#endif

#endif
