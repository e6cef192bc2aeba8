/* Types of the FMI 2.0.5 standard that its functions take, by the standard's names. */

#ifndef FANFOLD_FMI2_H
#define FANFOLD_FMI2_H

#include <stddef.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);

typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

/* Names of functions with a prefix, for hosts that link several FMUs statically and define
   FMI2_FUNCTION_PREFIX (FMI 2.0, section 2.1.1). */
#ifndef FMI2_FUNCTION_PREFIX
#define FMI2_FUNCTION_PREFIX
#endif
#define FMI2_JOIN(prefix, name) prefix##name
#define FMI2_PREFIXED(prefix, name) FMI2_JOIN(prefix, name)
#define FMI2(name) FMI2_PREFIXED(FMI2_FUNCTION_PREFIX, fmi2##name)

#if defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

/* The functions that hosts call; the remaining ones of the standard are defined in fmi2.c. */
FMI2_EXPORT fmi2Component FMI2(Instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String, const
    fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
FMI2_EXPORT void FMI2(FreeInstance)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(SetupExperiment)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean,
    fmi2Real);
FMI2_EXPORT fmi2Status FMI2(EnterInitializationMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(ExitInitializationMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(Terminate)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(Reset)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(GetReal)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
FMI2_EXPORT fmi2Status FMI2(SetReal)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
FMI2_EXPORT fmi2Status FMI2(GetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Boolean[]);
FMI2_EXPORT fmi2Status FMI2(SetBoolean)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Boolean[]);
FMI2_EXPORT fmi2Status FMI2(GetInteger)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Integer[]);
FMI2_EXPORT fmi2Status FMI2(SetInteger)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Integer[]);
FMI2_EXPORT fmi2Status FMI2(SetRealInputDerivatives)(fmi2Component, const fmi2ValueReference[], size_t,
                                                     const fmi2Integer[], const fmi2Real[]);
FMI2_EXPORT fmi2Status FMI2(GetFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_EXPORT fmi2Status FMI2(SetFMUstate)(fmi2Component, fmi2FMUstate);
FMI2_EXPORT fmi2Status FMI2(FreeFMUstate)(fmi2Component, fmi2FMUstate *);
FMI2_EXPORT fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component, fmi2FMUstate, size_t *);
FMI2_EXPORT fmi2Status FMI2(SerializeFMUstate)(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
FMI2_EXPORT fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);
FMI2_EXPORT fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component, const fmi2ValueReference[], size_t, const
    fmi2ValueReference[], size_t, const fmi2Real[], fmi2Real[]);
/* Not of the standard: what as many calls of fmi2GetDirectionalDerivative as there are columns give, at once. Right after
   a step of a connection with so many ports, the derivatives of their wrenches by their motions at its end, as
   instance_port_stiffness of instance.h says; fmi2Discard where the FMU offers none for this step. */
#define PORT_STIFFNESS FMI2_PREFIXED(FMI2_FUNCTION_PREFIX, fanfoldGetPortStiffness)
FMI2_EXPORT fmi2Status PORT_STIFFNESS(fmi2Component, size_t ports, fmi2Real stiffness[]);
/* Not of the standard: from now on fmi2GetReal, fmi2SetReal and fmi2GetDirectionalDerivative of this instance take
   variables of all types, as numbers, so that a master exchanges all of them in one call. */
#define ACCEPT_NUMBERS FMI2_PREFIXED(FMI2_FUNCTION_PREFIX, fanfoldAcceptNumbers)
FMI2_EXPORT fmi2Status ACCEPT_NUMBERS(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(DoStep)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
FMI2_EXPORT fmi2Status FMI2(EnterEventMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(NewDiscreteStates)(fmi2Component, fmi2EventInfo *);
FMI2_EXPORT fmi2Status FMI2(EnterContinuousTimeMode)(fmi2Component);
FMI2_EXPORT fmi2Status FMI2(CompletedIntegratorStep)(fmi2Component, fmi2Boolean, fmi2Boolean *, fmi2Boolean *);
FMI2_EXPORT fmi2Status FMI2(SetTime)(fmi2Component, fmi2Real);
FMI2_EXPORT fmi2Status FMI2(SetContinuousStates)(fmi2Component, const fmi2Real[], size_t);
FMI2_EXPORT fmi2Status FMI2(GetDerivatives)(fmi2Component, fmi2Real[], size_t);
FMI2_EXPORT fmi2Status FMI2(GetEventIndicators)(fmi2Component, fmi2Real[], size_t);
FMI2_EXPORT fmi2Status FMI2(GetContinuousStates)(fmi2Component, fmi2Real[], size_t);
FMI2_EXPORT fmi2Status FMI2(GetNominalsOfContinuousStates)(fmi2Component, fmi2Real[], size_t);

#endif
