/* Making an instance from resources that are not trusted. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "continuous.h"
#include "input_slopes.h"
#include "layout.h"

static int find_kernel(Instance *instance, Reason *why) {
    const char *kind = data_text(&instance->data, "kind");
    for (size_t i = 0; kind && i < kernel_count; i++)
        if (strcmp(kind, kernels[i]->kind) == 0)
            instance->kernel = kernels[i];
    if (!instance->kernel)
        return refuse(why, "this binary knows no component %.100s", kind ? kind : "without a kind");
    const char *layout = data_text(&instance->data, "layout");
    if (instance->kernel->layout && (!layout || strcmp(layout, instance->kernel->layout) != 0))
        return refuse(why, "the data are of another version of %s than this binary; install Fanfold again (pip install), "
                           "or export the FMU anew", kind);
    return 1;
}

static int make_state(Instance *instance, Reason *why) {
    Memory *memory = &instance->memory;
    instance->self =
        instance->kernel->create(&instance->data, &instance->sizes, memory, &instance->states, why);
    if (!instance->self)
        return 0;
    instance->x = allocate(memory, (instance->states + 1) * sizeof(double));
    instance->before = allocate(memory, (instance->states + 1) * sizeof(double));
    instance->complex_inputs = allocate(memory, (instance->sizes.inputs + 1) * sizeof(double complex));
    instance->complex_state = allocate(memory, (instance->states + 1) * sizeof(double complex));
    instance->complex_outputs = allocate(memory, (instance->sizes.outputs + 1) * sizeof(double complex));
    instance->apart = allocate(memory, (2 * instance->ends[4] + instance->states + 1) * sizeof(double));
    if (!instance->x || !instance->before || !instance->apart || !instance->complex_inputs || !instance->complex_state ||
        !instance->complex_outputs)
        return refuse(why, "no memory for %lu states", (unsigned long)instance->states);
    return input_slopes_create(instance, why) && continuous_create(instance, why);
}

static int check_token(Instance *instance, const char *token, Reason *why) {
    const char *own = data_text(&instance->data, "token");
    if (!own || strlen(own) < 16)
        return refuse(why, "the component's data have no instantiation token");
    if (!token || strcmp(own, token) != 0)
        return refuse(why, "the model description has the token %.80s, the resources have %.80s; they do not "
                           "belong together", token ? token : "(none)", own);
    memcpy(instance->owner, own + strlen(own) - sizeof instance->owner, sizeof instance->owner);
    return 1;
}

/* A new one with its name; NULL where there is no memory. */
static Instance *allocate_instance(const char *name, Logger logger, void *host) {
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance)
        return NULL;
    instance->logger = logger;
    instance->host = host;
    char *own_name = allocate(&instance->memory, strlen(name) + 1);
    instance->name = own_name ? strcpy(own_name, name) : "";
    return instance;
}

/* All that follows from its data, where it has them. */
static Instance *furnish(Instance *instance, int has_data, Reason *why) {
    if (has_data && find_kernel(instance, why) && layout_read(instance, why) && make_state(instance, why)) {
        instance_reset(instance);
        return instance;
    }
    instance_fail(instance, STATUS_ERROR, "%s", why->text[0] ? why->text : "no memory");
    instance_free(instance);
    return NULL;
}

Instance *instance_create(const char *name, const char *resources, const char *token, Logger logger, void *host) {
    Instance *instance = allocate_instance(name, logger, host);
    if (!instance)
        return NULL;
    Reason why = {""};
    size_t length = strlen(resources);
    char *path = allocate(&instance->memory, length + 20);
    if (path) {
        const char *separator = length && (resources[length - 1] == '/' || resources[length - 1] == '\\') ? "" : "/";
        snprintf(path, length + 20, "%s%scomponent.bin", resources, separator);
    }
    return furnish(instance, path && data_read(&instance->data, path, &instance->memory, &why) &&
                                 check_token(instance, token, &why), &why);
}

Instance *instance_create_inside(const char *name, const char *bytes, size_t size, Logger logger, void *host) {
    Instance *instance = allocate_instance(name, logger, host);
    if (!instance)
        return NULL;
    Reason why = {""};
    return furnish(instance, data_parse(&instance->data, name, (const unsigned char *)bytes, size, &instance->memory,
                                        &why), &why);
}

void instance_free(Instance *instance) {
    if (!instance)
        return;
    if (instance->self && instance->kernel->destroy)
        instance->kernel->destroy(instance->self);
    release(&instance->memory);
    free(instance);
}
