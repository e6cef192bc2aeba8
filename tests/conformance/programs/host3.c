/* A host of FMI 3.0 without Python, to be run under sanitizers: makes, drives, misuses and frees instances.

       host3 CYCLES TOKEN SCALARS RESOURCES [RESOURCES ...]

   Prints how many instances could be made and how many messages were logged. Exit code 1 with a sentence where
   a status is not what it must be. It knows nothing of the variables: it tries every value reference. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi3.h"

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference[], size_t, fmi3InstanceEnvironment,
                                         fmi3LogMessageCallback, fmi3IntermediateUpdateCallback);
void fmi3FreeInstance(fmi3Instance);
fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64);
fmi3Status fmi3ExitInitializationMode(fmi3Instance);
fmi3Status fmi3EnterEventMode(fmi3Instance);
fmi3Status fmi3EnterStepMode(fmi3Instance);
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *,
                                    fmi3Boolean *, fmi3Float64 *);
fmi3Status fmi3Terminate(fmi3Instance);
fmi3Status fmi3Reset(fmi3Instance);
fmi3Status fmi3GetFloat64(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Float64[], size_t);
fmi3Status fmi3SetFloat64(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3Float64[], size_t);
fmi3Status fmi3GetBoolean(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Boolean[], size_t);
fmi3Status fmi3SetBoolean(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3Boolean[], size_t);
fmi3Status fmi3GetInt32(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Int32[], size_t);
fmi3Status fmi3SetInt32(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3Int32[], size_t);
fmi3Status fmi3GetFMUState(fmi3Instance, fmi3FMUState *);
fmi3Status fmi3SetFMUState(fmi3Instance, fmi3FMUState);
fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState *);
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, size_t *);
fmi3Status fmi3SerializeFMUState(fmi3Instance, fmi3FMUState, fmi3Byte[], size_t);
fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte[], size_t, fmi3FMUState *);
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3ValueReference[],
                                        size_t, const fmi3Float64[], size_t, fmi3Float64[], size_t);
fmi3Status fmi3DoStep(fmi3Instance, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Boolean *, fmi3Boolean *,
                      fmi3Boolean *, fmi3Float64 *);

enum { MOST_VALUES = 64 };

static int messages;

static void note(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)status, (void)category;
    messages += message && *message;
}

static void expect(fmi3Status found, fmi3Status wanted, const char *call) {
    if (found == wanted)
        return;
    printf("%s gave status %d, not %d\n", call, (int)found, (int)wanted);
    exit(1);
}

static fmi3Status step(fmi3Instance fmu, double time, double h) {
    fmi3Boolean event, terminate, early;
    double last;
    return fmi3DoStep(fmu, time, h, true, &event, &terminate, &early, &last);
}

static fmi3Status update(fmi3Instance fmu) {
    fmi3Boolean needed, terminate, nominals, values, defined;
    double time;
    return fmi3UpdateDiscreteStates(fmu, &needed, &terminate, &nominals, &values, &defined, &time);
}

/* Reads every value reference, the ones there are not included, with every number of values. */
static void try_references(fmi3Instance fmu, uint32_t scalars) {
    double values[MOST_VALUES] = {0.0}, seed[MOST_VALUES] = {1.0};
    fmi3Boolean truths[MOST_VALUES] = {false};
    fmi3Int32 wholes[MOST_VALUES] = {0};
    for (uint32_t reference = 0; reference < scalars + 3; reference++)
        for (size_t count = 0; count < 8; count++) {
            if (fmi3GetFloat64(fmu, &reference, 1, values, count) == fmi3OK)
                (void)fmi3SetFloat64(fmu, &reference, 1, values, count);
            if (fmi3GetBoolean(fmu, &reference, 1, truths, count) == fmi3OK)
                (void)fmi3SetBoolean(fmu, &reference, 1, truths, count);
            if (fmi3GetInt32(fmu, &reference, 1, wholes, count) == fmi3OK)
                (void)fmi3SetInt32(fmu, &reference, 1, wholes, count);
            (void)fmi3GetDirectionalDerivative(fmu, &reference, 1, &reference, 1, seed, count, values, count);
        }
    const fmi3ValueReference twice[2] = {scalars, scalars};
    expect(fmi3GetFloat64(fmu, twice, 2, values, 2), fmi3OK, "time twice");
}

static void start(fmi3Instance fmu) {
    expect(step(fmu, 0.0, 1e-3), fmi3Error, "a step before initialization");
    expect(fmi3EnterInitializationMode(fmu, false, 0.0, 0.0, false, 0.0), fmi3OK, "enter initialization");
    expect(fmi3ExitInitializationMode(fmu), fmi3OK, "exit initialization");
    expect(step(fmu, 0.0, 1e-3), fmi3Error, "a step in event mode");
    expect(update(fmu), fmi3OK, "update");
    expect(fmi3EnterStepMode(fmu), fmi3OK, "enter step mode");
}

static void drive(fmi3Instance fmu, uint32_t scalars) {
    fmi3FMUState state = NULL, copy = NULL;
    size_t size = 0;
    expect(fmi3GetFMUState(fmu, &state), fmi3OK, "save");
    for (int k = 0; k < 10; k++) {
        expect(step(fmu, 1e-3 * k, 1e-3), fmi3OK, "step");
        expect(fmi3EnterEventMode(fmu), fmi3OK, "enter event mode");
        expect(update(fmu), fmi3OK, "update");
        expect(fmi3EnterStepMode(fmu), fmi3OK, "enter step mode");
    }
    expect(step(fmu, 0.0, NAN), fmi3Error, "a step that is no number");
    expect(fmi3SerializedFMUStateSize(fmu, state, &size), fmi3OK, "size");
    fmi3Byte *bytes = malloc(size);
    expect(fmi3SerializeFMUState(fmu, state, bytes, size - 1), fmi3Error, "serialize into too little");
    expect(fmi3SerializeFMUState(fmu, state, bytes, size), fmi3OK, "serialize");
    for (size_t length = 0; length < size; length += 1 + size / 50)
        expect(fmi3DeserializeFMUState(fmu, bytes, length, &copy), fmi3Error, "deserialize a part");
    expect(fmi3DeserializeFMUState(fmu, bytes, size, &copy), fmi3OK, "deserialize");
    expect(fmi3SetFMUState(fmu, copy), fmi3OK, "restore");
    expect(fmi3SetFMUState(fmu, NULL), fmi3Error, "restore of nothing");
    try_references(fmu, scalars);
    expect(fmi3FreeFMUState(fmu, &copy), fmi3OK, "free a state");
    expect(fmi3FreeFMUState(fmu, &state), fmi3OK, "free a state");
    free(bytes);
}

int main(int count, char **arguments) {
    if (count < 5)
        return 2;
    uint32_t scalars = (uint32_t)strtoul(arguments[3], NULL, 10);
    int made = 0;
    for (long cycle = strtol(arguments[1], NULL, 10); cycle > 0; cycle--)
        for (int k = 4; k < count; k++) {
            fmi3Instance fmu = fmi3InstantiateCoSimulation("instance", arguments[2], arguments[k], false, false, true,
                                                           true, NULL, 0, NULL, note, NULL);
            if (!fmu)
                continue;
            made++;
            if (count == 5) {
                start(fmu);
                drive(fmu, scalars);
                expect(fmi3Terminate(fmu), fmi3OK, "terminate");
                expect(fmi3Reset(fmu), fmi3OK, "reset");
                start(fmu);
            } else if (fmi3EnterInitializationMode(fmu, false, 0.0, 0.0, false, 0.0) == fmi3OK &&
                       fmi3ExitInitializationMode(fmu) == fmi3OK && update(fmu) == fmi3OK &&
                       fmi3EnterStepMode(fmu) == fmi3OK) {
                (void)step(fmu, 0.0, 1e-3);
                double value;
                for (uint32_t i = 0; i < scalars; i++)
                    (void)fmi3GetFloat64(fmu, &i, 1, &value, 1);
            }
            fmi3FreeInstance(fmu);
        }
    printf("%d made, %d messages\n", made, messages);
    return 0;
}
