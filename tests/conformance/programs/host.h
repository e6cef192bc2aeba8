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
