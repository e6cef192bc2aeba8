/* Types of the FMI 3.0 standard that its functions take, by the standard's names, and what is behind an
   fmi3Instance. */

#ifndef FANFOLD_FMI3_H
#define FANFOLD_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "instance.h"
#include "log_categories.h"

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

/* Names of functions with a prefix, for hosts that link several FMUs statically and define
   FMI3_FUNCTION_PREFIX (FMI 3.0, section 2.2.2). */
#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_FUNCTION_PREFIX
#endif
#define FMI3_JOIN(prefix, name) prefix##name
#define FMI3_PREFIXED(prefix, name) FMI3_JOIN(prefix, name)
#define FMI3(name) FMI3_PREFIXED(FMI3_FUNCTION_PREFIX, fmi3##name)

#if defined(_WIN32)
#define FMI3_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_EXPORT __attribute__((visibility("default")))
#else
#define FMI3_EXPORT
#endif

/* An instance and the host it reports to. A variable's value reference is that of its first scalar, so the
   references between are none; time has the one after all others. */
typedef struct {
    Instance *instance;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    Unwanted unwanted;
    int event_mode_used, early_return_allowed;
    size_t scalars;
    uint32_t *sizes;     /* number of scalars of the variable at a reference; 0 where there is none */
    uint32_t *positions; /* 0, 1, 2, ...: what a run of scalars is read and written with */
    uint32_t *expanded;  /* room for the scalars of two lists of variables */
} Fmu;

static inline Fmu *fmu_of(fmi3Instance instance) { return instance; }

static inline Instance *core_of(fmi3Instance instance) { return instance ? fmu_of(instance)->instance : NULL; }

/* The body of a function that is a call of the core, named `core`. */
#define CALLED(call)                                                                                             \
    Instance *core = core_of(instance);                                                                          \
    return core ? (fmi3Status)(call) : fmi3Error

#endif
