/* What hosts of FMI 2.0 share: they count messages and end where a status is not what it must be. */

#include <stdio.h>
#include <stdlib.h>

#include "fmi2.h"

static int messages;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
    (void)environment, (void)name, (void)status, (void)category;
    messages += message && *message;
}

static void expect(fmi2Status found, fmi2Status wanted, const char *call) {
    if (found == wanted)
        return;
    printf("%s gave status %d, not %d\n", call, (int)found, (int)wanted);
    exit(1);
}

/* Every variable is read by the functions of one type alone, and as a number of any type once that is asked for. */
static inline void check_types(fmi2Component fmu, size_t count) {
    for (fmi2ValueReference i = 0; i < count; i++) {
        fmi2Real real;
        fmi2Boolean truth;
        fmi2Integer whole;
        const int found = (fmi2GetReal(fmu, &i, 1, &real) == fmi2OK) + (fmi2GetBoolean(fmu, &i, 1, &truth) == fmi2OK) +
                          (fmi2GetInteger(fmu, &i, 1, &whole) == fmi2OK);
        expect(found == 1 ? fmi2OK : fmi2Error, fmi2OK, "get by the functions of all types");
    }
    expect(ACCEPT_NUMBERS(fmu), fmi2OK, "accept numbers");
}
