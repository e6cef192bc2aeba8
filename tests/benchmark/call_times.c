/* Time of the calls of one native FMU, measured inside C; the best of several rounds, in nanoseconds a call.

       call_times ROUNDS CALLS PARAMETERS INPUTS OUTPUTS TOKEN RESOURCES

   Prints: doStep, its outputs, set of all inputs, restore, and a directional derivative, without one another. */

#define _POSIX_C_SOURCE 199309L

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2.h"

typedef struct {
    fmi2Component fmu;
    size_t inputs, outputs;
    fmi2ValueReference *references, *output_references;
    double *values, *found, *seed;
    fmi2FMUstate state;
} Subject;

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

static void restore(Subject *s) { fmi2SetFMUstate(s->fmu, s->state); }

static void set(Subject *s) { fmi2SetReal(s->fmu, s->references, s->inputs, s->values); }

static void restore_and_step(Subject *s) {
    restore(s);
    set(s);
    fmi2DoStep(s->fmu, 0.0, 1e-3, 1);
}

static void restore_step_and_read(Subject *s) {
    restore_and_step(s);
    fmi2GetReal(s->fmu, s->output_references, s->outputs, s->found);
}

static void differentiate(Subject *s) {
    fmi2GetDirectionalDerivative(s->fmu, s->output_references, s->outputs, s->references, s->inputs, s->seed, s->found);
}

static double best(Subject *s, void (*call)(Subject *), long rounds, long calls) {
    double shortest = 1e300;
    for (long round = 0; round < rounds; round++) {
        double start = now();
        for (long i = 0; i < calls; i++)
            call(s);
        double time = (now() - start) / (double)calls;
        shortest = time < shortest ? time : shortest;
    }
    return shortest;
}

int main(int count, char **arguments) {
    fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, NULL};
    if (count < 8)
        return 2;
    long rounds = strtol(arguments[1], NULL, 10), calls = strtol(arguments[2], NULL, 10);
    fmi2ValueReference first = (fmi2ValueReference)strtoul(arguments[3], NULL, 10);
    Subject s = {NULL, strtoul(arguments[4], NULL, 10), strtoul(arguments[5], NULL, 10), NULL, NULL, NULL, NULL, NULL,
                 NULL};
    s.references = calloc(s.inputs + 1, sizeof *s.references);
    s.output_references = calloc(s.outputs + 1, sizeof *s.references);
    s.values = calloc(s.inputs + 1, sizeof(double));
    s.found = calloc(s.outputs + 1, sizeof(double));
    s.seed = calloc(s.inputs + 1, sizeof(double));
    for (size_t i = 0; i < s.inputs; i++)
        s.references[i] = first + (fmi2ValueReference)i, s.seed[i] = 1.0;
    for (size_t i = 0; i < s.outputs; i++)
        s.output_references[i] = first + (fmi2ValueReference)(s.inputs + i);
    s.fmu = fmi2Instantiate("subject", fmi2CoSimulation, arguments[6], arguments[7], &callbacks, 0, 0);
    if (!s.fmu || fmi2EnterInitializationMode(s.fmu) || fmi2GetReal(s.fmu, s.references, s.inputs, s.values) ||
        fmi2ExitInitializationMode(s.fmu))
        return 1;
    for (size_t i = 0; i < s.inputs; i++) /* in motion, so that no iteration ends at once */
        s.values[i] += 0.01 * (double)(i % 7);
    for (int i = 0; i < 10; i++)
        set(&s), fmi2DoStep(s.fmu, 1e-3 * i, 1e-3, 1);
    fmi2GetFMUstate(s.fmu, &s.state);
    double restoring = best(&s, restore, rounds, calls), setting = best(&s, set, rounds, calls);
    double stepping = best(&s, restore_and_step, rounds, calls);
    double reading = best(&s, restore_step_and_read, rounds, calls);
    double derivative = best(&s, differentiate, rounds, calls / 10 + 1);
    printf("%.0f %.0f %.0f %.0f %.0f\n", stepping - restoring - setting, reading - stepping, setting, restoring,
           derivative);
    fmi2FreeFMUstate(s.fmu, &s.state);
    fmi2FreeInstance(s.fmu);
    free(s.references), free(s.output_references), free(s.values), free(s.found), free(s.seed);
    return 0;
}
