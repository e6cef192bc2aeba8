/* A host without Python that integrates native instances in model exchange, to be run under sanitizers.

       host_model_exchange CYCLES PARAMETERS INPUTS OUTPUTS OBSERVATIONS STATES INDICATORS TOKEN RESOURCES ...

   Prints how many instances could be made and how many messages were logged. Every call's status is checked
   against what the standard and the FMU's documentation say; exit code 1 with a sentence where one differs. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host.h"

/* Numbers of scalars; every array has just the room that its call may use. */
typedef struct {
    size_t parameters, inputs, outputs, observations, states, indicators, all;
    fmi2ValueReference *references;
    double *values, *inputs_at_start, *seed, *x, *rates, *z;
} Layout;

/* is_new: whether it was never started before. */
static void start(fmi2Component fmu, const Layout *layout, int is_new) {
    fmi2EventInfo info;
    fmi2Boolean enter = 0, terminate = 0;
    expect(fmi2GetDerivatives(fmu, layout->rates, layout->states), fmi2Error, "rates before initialization");
    expect(fmi2GetNominalsOfContinuousStates(fmu, layout->x, layout->states), fmi2OK, "nominals");
    expect(fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0), fmi2OK, "setup");
    expect(fmi2EnterInitializationMode(fmu), fmi2OK, "enter initialization");
    if (is_new)
        check_types(fmu, layout->all);
    expect(fmi2GetReal(fmu, layout->references, layout->all, layout->values), fmi2OK, "get in initialization");
    memcpy(layout->inputs_at_start, layout->values + layout->parameters, layout->inputs * sizeof(double));
    expect(fmi2GetDerivatives(fmu, layout->rates, layout->states), fmi2OK, "rates in initialization");
    expect(fmi2EnterContinuousTimeMode(fmu), fmi2Error, "continuous-time mode in initialization");
    expect(fmi2ExitInitializationMode(fmu), fmi2OK, "exit initialization");
    expect(fmi2CompletedIntegratorStep(fmu, 1, &enter, &terminate), fmi2Error, "a completed step in event mode");
    expect(fmi2NewDiscreteStates(fmu, &info), fmi2OK, "new discrete states");
    expect(fmi2EnterContinuousTimeMode(fmu), fmi2OK, "continuous-time mode");
    expect(fmi2NewDiscreteStates(fmu, &info), fmi2Error, "new discrete states in continuous-time mode");
    expect(fmi2DoStep(fmu, 0.0, 1e-3, 1), fmi2Error, "a co-simulation step");
    expect(fmi2SetContinuousStates(fmu, layout->x, layout->states + 1), fmi2Error, "states of another number");
    expect(fmi2GetEventIndicators(fmu, layout->z, layout->indicators + 1), fmi2Error, "indicators of another number");
}

static void evaluate(fmi2Component fmu, const Layout *layout) {
    const fmi2ValueReference *inputs = layout->references + layout->parameters, *outputs = inputs + layout->inputs;
    const fmi2ValueReference *states = outputs + layout->outputs + layout->observations;
    expect(fmi2GetDerivatives(fmu, layout->rates, layout->states), fmi2OK, "rates");
    expect(fmi2GetEventIndicators(fmu, layout->z, layout->indicators), fmi2OK, "indicators");
    expect(fmi2GetReal(fmu, layout->references, layout->all, layout->values), fmi2OK, "get");
    expect(fmi2GetDirectionalDerivative(fmu, outputs, layout->outputs, inputs, layout->inputs, layout->seed,
                                        layout->values), fmi2OK, "derivative of outputs by inputs");
    expect(fmi2GetDirectionalDerivative(fmu, states + layout->states, layout->states, states, layout->states,
                                        layout->seed, layout->rates), fmi2OK, "derivative of rates by states");
}

/* Ten explicit steps with an event after each third. */
static void integrate(fmi2Component fmu, const Layout *layout) {
    const fmi2ValueReference *inputs = layout->references + layout->parameters;
    fmi2EventInfo info;
    fmi2Boolean enter = 0, terminate = 0;
    for (int k = 0; k < 10; k++) {
        expect(fmi2GetContinuousStates(fmu, layout->x, layout->states), fmi2OK, "states");
        expect(fmi2GetDerivatives(fmu, layout->rates, layout->states), fmi2OK, "rates");
        for (size_t i = 0; i < layout->states; i++)
            layout->x[i] += 1e-4 * layout->rates[i];
        expect(fmi2SetTime(fmu, 1e-4 * (k + 1)), fmi2OK, "time");
        expect(fmi2SetContinuousStates(fmu, layout->x, layout->states), fmi2OK, "set states");
        evaluate(fmu, layout);
        expect(fmi2CompletedIntegratorStep(fmu, 1, &enter, &terminate), fmi2OK, "completed step");
        if (k % 3)
            continue;
        expect(fmi2EnterEventMode(fmu), fmi2OK, "event mode");
        expect(fmi2SetReal(fmu, inputs, layout->inputs, layout->inputs_at_start), fmi2OK, "set in event mode");
        if (layout->states)
            expect(fmi2SetContinuousStates(fmu, layout->x, layout->states), fmi2Error, "states in event mode");
        expect(fmi2NewDiscreteStates(fmu, &info), fmi2OK, "new discrete states");
        expect(fmi2EnterContinuousTimeMode(fmu), fmi2OK, "continuous-time mode");
    }
}

/* Numbers beyond sense may be refused, but only as values, and the saved state comes back. */
static void extremes(fmi2Component fmu, const Layout *layout, fmi2FMUstate state) {
    const fmi2ValueReference *inputs = layout->references + layout->parameters;
    const double sizes[] = {0.0, 1e-300, 1e10, 1e150, 1e300, INFINITY, NAN};
    fmi2Boolean enter = 0, terminate = 0;
    for (size_t k = 0; k < 2 * sizeof sizes / sizeof *sizes; k++) {
        double size = sizes[k / 2];
        for (size_t i = 0; i < layout->inputs; i++)
            layout->values[i] = k % 2 ? (i % 2 ? -size : size) : layout->inputs_at_start[i];
        for (size_t i = 0; i < layout->states; i++)
            layout->x[i] = k % 2 ? 1.0 : (i % 3 ? -size : size);
        fmi2Status status = fmi2SetReal(fmu, inputs, layout->inputs, layout->values);
        if (status != fmi2OK)
            expect(status, k % 2 && !isfinite(size) ? fmi2Discard : fmi2Warning, "set of extreme inputs");
        expect(fmi2SetContinuousStates(fmu, layout->x, layout->states), fmi2OK, "set of extreme states");
        status = fmi2GetDerivatives(fmu, layout->rates, layout->states);
        if (status != fmi2OK)
            expect(status, fmi2Discard, "rates at extremes");
        status = fmi2GetEventIndicators(fmu, layout->z, layout->indicators);
        if (status != fmi2OK)
            expect(status, fmi2Discard, "indicators at extremes");
        (void)fmi2GetReal(fmu, layout->references, layout->all, layout->values);
        (void)fmi2CompletedIntegratorStep(fmu, 1, &enter, &terminate);
        expect(fmi2SetFMUstate(fmu, state), fmi2OK, "restore");
        evaluate(fmu, layout);
    }
}

static void drive(fmi2Component fmu, const Layout *layout) {
    fmi2FMUstate state = NULL, copy = NULL;
    size_t size = 0;
    integrate(fmu, layout);
    expect(fmi2GetFMUstate(fmu, &state), fmi2OK, "save");
    extremes(fmu, layout, state);
    expect(fmi2SerializedFMUstateSize(fmu, state, &size), fmi2OK, "size");
    char *bytes = malloc(size);
    expect(fmi2SerializeFMUstate(fmu, state, bytes, size), fmi2OK, "serialize");
    expect(fmi2DeSerializeFMUstate(fmu, bytes, size, &copy), fmi2OK, "deserialize");
    integrate(fmu, layout);
    expect(fmi2SetFMUstate(fmu, copy), fmi2OK, "restore the copy");
    evaluate(fmu, layout);
    expect(fmi2FreeFMUstate(fmu, &copy), fmi2OK, "free a state");
    expect(fmi2FreeFMUstate(fmu, &state), fmi2OK, "free a state");
    free(bytes);
}

static double *numbers(size_t count) { return calloc(count ? count : 1, sizeof(double)); }

static Layout layout_of(char **counts) {
    Layout layout = {0};
    size_t *all[6] = {&layout.parameters, &layout.inputs, &layout.outputs, &layout.observations, &layout.states,
                      &layout.indicators};
    for (int i = 0; i < 6; i++)
        *all[i] = strtoul(counts[i], NULL, 10);
    layout.all = layout.parameters + layout.inputs + layout.outputs + layout.observations + 2 * layout.states;
    layout.references = calloc(layout.all + 1, sizeof *layout.references);
    layout.values = numbers(layout.all);
    layout.inputs_at_start = numbers(layout.inputs);
    layout.seed = numbers(layout.inputs + layout.states);
    layout.x = numbers(layout.states);
    layout.rates = numbers(layout.states);
    layout.z = numbers(layout.indicators);
    for (size_t i = 0; i < layout.all; i++)
        layout.references[i] = (fmi2ValueReference)i;
    for (size_t i = 0; i < layout.inputs + layout.states; i++)
        layout.seed[i] = 1.0 + (double)i;
    return layout;
}

static void release_layout(Layout *layout) {
    free(layout->references), free(layout->values), free(layout->inputs_at_start), free(layout->seed);
    free(layout->x), free(layout->rates), free(layout->z);
}

int main(int count, char **arguments) {
    if (count < 10)
        return 2;
    fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    Layout layout = layout_of(arguments + 2);
    long cycles = strtol(arguments[1], NULL, 10);
    int made = 0;
    for (long cycle = 0; cycle < cycles; cycle++)
        for (int k = 9; k < count; k++) {
            fmi2Component fmu =
                fmi2Instantiate("instance", fmi2ModelExchange, arguments[8], arguments[k], &callbacks, 0, 0);
            if (!fmu)
                continue;
            made++;
            if (count == 10) {
                start(fmu, &layout, 1);
                drive(fmu, &layout);
                expect(fmi2Terminate(fmu), fmi2OK, "terminate");
                expect(fmi2Terminate(fmu), fmi2Error, "terminate twice");
                expect(fmi2Reset(fmu), fmi2OK, "reset");
                start(fmu, &layout, 0);
            } else if (fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0) == fmi2OK &&
                       fmi2EnterInitializationMode(fmu) == fmi2OK && fmi2ExitInitializationMode(fmu) == fmi2OK &&
                       fmi2EnterContinuousTimeMode(fmu) == fmi2OK) {
                (void)fmi2GetContinuousStates(fmu, layout.x, layout.states);
                (void)fmi2GetDerivatives(fmu, layout.rates, layout.states);
                (void)fmi2GetEventIndicators(fmu, layout.z, layout.indicators);
                (void)fmi2EnterEventMode(fmu);
            }
            fmi2FreeInstance(fmu);
        }
    release_layout(&layout);
    printf("%d made, %d messages\n", made, messages);
    return 0;
}
