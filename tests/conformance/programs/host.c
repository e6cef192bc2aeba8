/* A host without Python: makes, drives, misuses and frees native instances, to be run under sanitizers.

       host CYCLES PARAMETERS INPUTS OUTPUTS OBSERVATIONS TOKEN RESOURCES [RESOURCES ...]

   Prints how many instances could be made and how many messages were logged. Every call's status is checked
   against what the standard and the FMU's documentation say; exit code 1 with a sentence where one differs. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host.h"

typedef struct {
    size_t parameters, inputs, outputs, observations, all;
    fmi2ValueReference *references;
    double *values, *inputs_at_start, *seed;
} Layout;

/* is_new: whether it was never started before. */
static void start(fmi2Component fmu, const Layout *layout, int is_new) {
    expect(fmi2DoStep(fmu, 0.0, 1e-3, 1), fmi2Error, "a step before initialization");
    expect(fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0), fmi2OK, "setup");
    expect(fmi2EnterInitializationMode(fmu), fmi2OK, "enter initialization");
    expect(fmi2EnterInitializationMode(fmu), fmi2Error, "enter initialization twice");
    if (is_new)
        check_types(fmu, layout->all);
    expect(fmi2GetReal(fmu, layout->references, layout->all, layout->values), fmi2OK, "get in initialization");
    memcpy(layout->inputs_at_start, layout->values + layout->parameters, layout->inputs * sizeof(double));
    expect(fmi2ExitInitializationMode(fmu), fmi2OK, "exit initialization");
    expect(fmi2ExitInitializationMode(fmu), fmi2Error, "exit initialization twice");
}

static void misuse(fmi2Component fmu, const Layout *layout) {
    const double bad = NAN;
    const fmi2ValueReference far = 1000000000u, input = (fmi2ValueReference)layout->parameters;
    const fmi2ValueReference output = (fmi2ValueReference)(layout->parameters + layout->inputs);
    const fmi2Integer order = 1;
    double value = 0.0;
    expect(fmi2DoStep(fmu, 0.0, -1e-3, 1), fmi2Error, "a negative step");
    expect(fmi2DoStep(fmu, 0.0, NAN, 1), fmi2Error, "a step that is no number");
    expect(fmi2GetReal(fmu, &far, 1, &value), fmi2Error, "get of no variable");
    expect(fmi2SetReal(fmu, &far, 1, &value), fmi2Error, "set of no variable");
    expect(fmi2GetReal(fmu, &input, 1, NULL), fmi2Error, "get into nothing");
    expect(fmi2SetReal(fmu, NULL, 1, &value), fmi2Error, "set without references");
    expect(fmi2SetReal(fmu, &output, 1, &value), fmi2Error, "set of an output");
    expect(fmi2SetRealInputDerivatives(fmu, &far, 1, &order, &value), fmi2Error, "derivative of no variable");
    expect(fmi2SetRealInputDerivatives(fmu, &output, 1, &order, &value), fmi2Error, "derivative of an output");
    expect(fmi2SetFMUstate(fmu, NULL), fmi2Error, "restore of nothing");
    if (layout->inputs) {
        expect(fmi2SetReal(fmu, &input, 1, &bad), fmi2Error, "set of a number that is none");
        expect(fmi2SetReal(fmu, &input, 1, layout->inputs_at_start), fmi2OK, "set back");
    }
}

/* Inputs far beyond sense may be refused, but only with a discarded step and with the state kept. */
static void extremes(fmi2Component fmu, const Layout *layout, fmi2FMUstate state) {
    const double sizes[] = {0.0, 1e-300, 1e10, 1e150, 1e300};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        for (size_t i = 0; i < layout->inputs; i++)
            layout->values[i] = (i % 2 ? -1.0 : 1.0) * sizes[k];
        expect(fmi2SetReal(fmu, layout->references + layout->parameters, layout->inputs, layout->values), fmi2OK, "set");
        for (size_t i = 0; i < layout->inputs; i++) { /* some inputs have derivatives */
            const fmi2Integer order = 1;
            fmi2SetRealInputDerivatives(fmu, layout->references + layout->parameters + i, 1, &order, layout->values + i);
        }
        fmi2Status status = fmi2DoStep(fmu, 0.0, 1e-3, 1);
        if (status != fmi2OK)
            expect(status, fmi2Discard, "a step with extreme inputs");
        expect(fmi2SetFMUstate(fmu, state), fmi2OK, "restore");
    }
}

static void drive(fmi2Component fmu, const Layout *layout) {
    const fmi2ValueReference *inputs = layout->references + layout->parameters, *outputs = inputs + layout->inputs;
    fmi2FMUstate state = NULL, copy = NULL;
    size_t size = 0;
    expect(fmi2GetFMUstate(fmu, &state), fmi2OK, "save");
    for (int k = 0; k < 20; k++) {
        expect(fmi2SetReal(fmu, inputs, layout->inputs, layout->inputs_at_start), fmi2OK, "set");
        expect(fmi2DoStep(fmu, 1e-3 * k, 1e-3, 1), fmi2OK, "step");
        expect(fmi2GetReal(fmu, layout->references, layout->all, layout->values), fmi2OK, "get");
        if (layout->inputs)
            expect(fmi2GetDirectionalDerivative(fmu, outputs, layout->outputs, inputs, layout->inputs, layout->seed,
                                                layout->values), fmi2OK, "derivative");
    }
    expect(fmi2SerializedFMUstateSize(fmu, state, &size), fmi2OK, "size");
    char *bytes = malloc(size);
    expect(fmi2SerializeFMUstate(fmu, state, bytes, size), fmi2OK, "serialize");
    for (size_t length = 0; length < size; length += 1 + size / 50)
        expect(fmi2DeSerializeFMUstate(fmu, bytes, length, &copy), fmi2Error, "deserialize a part");
    expect(fmi2DeSerializeFMUstate(fmu, bytes, size, &copy), fmi2OK, "deserialize");
    expect(fmi2SetFMUstate(fmu, copy), fmi2OK, "restore");
    expect(fmi2FreeFMUstate(fmu, &copy), fmi2OK, "free a state");
    expect(fmi2GetFMUstate(fmu, &state), fmi2OK, "save again");
    extremes(fmu, layout, state);
    expect(fmi2FreeFMUstate(fmu, &state), fmi2OK, "free a state");
    free(bytes);
}

static Layout layout_of(char **counts) {
    Layout layout = {strtoul(counts[0], NULL, 10), strtoul(counts[1], NULL, 10), strtoul(counts[2], NULL, 10),
                     strtoul(counts[3], NULL, 10), 0, NULL, NULL, NULL, NULL};
    layout.all = layout.parameters + layout.inputs + layout.outputs + layout.observations;
    layout.references = calloc(layout.all + 1, sizeof *layout.references);
    layout.values = calloc(layout.all + 1, sizeof(double));
    layout.inputs_at_start = calloc(layout.inputs + 1, sizeof(double));
    layout.seed = calloc(layout.inputs + 1, sizeof(double));
    for (size_t i = 0; i < layout.all; i++)
        layout.references[i] = (fmi2ValueReference)i;
    for (size_t i = 0; i < layout.inputs; i++)
        layout.seed[i] = 1.0 + (double)i;
    return layout;
}

int main(int count, char **arguments) {
    if (count < 8)
        return 2;
    fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    Layout layout = layout_of(arguments + 2);
    long cycles = strtol(arguments[1], NULL, 10);
    int made = 0;
    for (long cycle = 0; cycle < cycles; cycle++)
        for (int k = 7; k < count; k++) {
            fmi2Component fmu =
                fmi2Instantiate("instance", fmi2CoSimulation, arguments[6], arguments[k], &callbacks, 0, 0);
            if (!fmu)
                continue;
            made++;
            if (count == 8) {
                start(fmu, &layout, 1);
                misuse(fmu, &layout);
                drive(fmu, &layout);
                expect(fmi2Terminate(fmu), fmi2OK, "terminate");
                expect(fmi2Terminate(fmu), fmi2Error, "terminate twice");
                expect(fmi2Reset(fmu), fmi2OK, "reset");
                start(fmu, &layout, 0);
            } else if (fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0) == fmi2OK &&
                       fmi2EnterInitializationMode(fmu) == fmi2OK && fmi2ExitInitializationMode(fmu) == fmi2OK) {
                fmi2DoStep(fmu, 0.0, 1e-3, 1);
            }
            fmi2FreeInstance(fmu);
        }
    free(layout.references), free(layout.values), free(layout.inputs_at_start), free(layout.seed);
    printf("%d made, %d messages\n", made, messages);
    return 0;
}
