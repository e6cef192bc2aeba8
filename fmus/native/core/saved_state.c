/* Saving, restoring and serialising the state of an instance. */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

static size_t known_of(const Instance *instance) { return instance->ends[1] + instance->slopes.count; }

Status instance_save(Instance *instance, SavedState **state) {
    size_t known = known_of(instance), rates = instance->slopes.count;
    SavedState *saved = *state;
    if (saved && (saved->known != known || saved->states != instance->states))
        return instance_fail(instance, STATUS_ERROR, "the FMU state belongs to an FMU of other content");
    if (!saved) {
        saved = malloc(sizeof *saved + (known + instance->states) * sizeof(double));
        if (!saved)
            return instance_fail(instance, STATUS_ERROR, "no memory to save the state");
        memcpy(saved->owner, instance->owner, sizeof saved->owner);
        saved->known = known;
        saved->states = instance->states;
        *state = saved;
    }
    if (instance->kernel->settle)
        instance->kernel->settle(instance->self);
    saved->time = instance->time;
    saved->mode = instance->mode;
    saved->has_state = instance->has_state;
    saved->event_due = instance->event_due;
    saved->exchange = instance->continuous.used;
    saved->interpolates = instance->slopes.used;
    saved->inputs_finite = instance->inputs_finite;
    memcpy(saved->numbers, instance->values, (known - rates) * sizeof(double));
    memcpy(saved->numbers + known - rates, instance->slopes.rates, rates * sizeof(double));
    if (instance->has_state)
        memcpy(saved->numbers + known, instance->x, instance->states * sizeof(double));
    else
        memset(saved->numbers + known, 0, instance->states * sizeof(double));
    return STATUS_OK;
}

Status instance_restore(Instance *instance, const SavedState *state) {
    if (!state)
        return instance_fail(instance, STATUS_ERROR, "there is no FMU state to return to: it is NULL");
    if (state->known != known_of(instance) || state->states != instance->states ||
        memcmp(state->owner, instance->owner, sizeof state->owner) != 0)
        return instance_fail(instance, STATUS_ERROR, "the FMU state belongs to an FMU of other content");
    if (state->exchange != instance->continuous.used)
        return instance_fail(instance, STATUS_ERROR, "the FMU state is that of an instance of the other interface type");
    if (memcmp(instance->values, state->numbers, instance->ends[0] * sizeof(double)) != 0)
        instance->prepared = 0;
    memcpy(instance->values, state->numbers, instance->ends[1] * sizeof(double));
    memcpy(instance->slopes.rates, state->numbers + instance->ends[1], instance->slopes.count * sizeof(double));
    instance->slopes.used = state->interpolates;
    instance->inputs_finite = state->inputs_finite;
    memcpy(instance->x, state->numbers + state->known, state->states * sizeof(double));
    if (instance->kernel->settle)
        instance->kernel->settle(instance->self);
    instance->time = state->time;
    instance->mode = (Mode)state->mode;
    instance->has_state = state->has_state;
    instance->event_due = state->event_due;
    instance->stepped = instance->outputs_known = instance->observations_known = instance->continuous.known = 0;
    return STATUS_OK;
}

Status instance_forget(SavedState **state) {
    if (state) {
        free(*state);
        *state = NULL;
    }
    return STATUS_OK;
}

/* Owner, numbers, check sum of all the rest, values and states. */
#define NUMBERS_BEFORE 8
#define CHECKED (16 + NUMBERS_BEFORE * sizeof(double))
#define HEADER (CHECKED + sizeof(uint64_t))

/* FNV-1a over all bytes but its own: no damaged byte passes for a state. */
static uint64_t check_sum(const unsigned char *bytes, size_t size) {
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < size; i++)
        if (i < CHECKED || i >= HEADER)
            sum = (sum ^ bytes[i]) * UINT64_C(1099511628211);
    return sum;
}

static size_t size_of(const SavedState *state) { return HEADER + (state->known + state->states) * sizeof(double); }

Status instance_serialized_size(Instance *instance, const SavedState *state, size_t *size) {
    if (!state)
        return instance_fail(instance, STATUS_ERROR, "there is no FMU state to serialize");
    *size = size_of(state);
    return STATUS_OK;
}

Status instance_serialize(Instance *instance, const SavedState *state, unsigned char *bytes, size_t size) {
    size_t needed = 0;
    if (instance_serialized_size(instance, state, &needed) != STATUS_OK)
        return STATUS_ERROR;
    if (size < needed)
        return instance_fail(instance, STATUS_ERROR, "%lu bytes are too few for the state", (unsigned long)size);
    double header[NUMBERS_BEFORE] = {state->time,           state->mode,      state->has_state, (double)state->known,
                                     (double)state->states, state->event_due, state->exchange,  state->interpolates};
    memcpy(bytes, state->owner, 16);
    memcpy(bytes + 16, header, sizeof header);
    memcpy(bytes + HEADER, state->numbers, (state->known + state->states) * sizeof(double));
    uint64_t sum = check_sum(bytes, needed);
    memcpy(bytes + CHECKED, &sum, sizeof sum);
    return STATUS_OK;
}

Status instance_deserialize(Instance *instance, const unsigned char *bytes, size_t size, SavedState **made) {
    double header[NUMBERS_BEFORE] = {0.0};
    size_t count = 0;
    uint64_t sum = 0;
    if (bytes && size >= HEADER)
        memcpy(&sum, bytes + CHECKED, sizeof sum);
    if (bytes && size >= HEADER && (size - HEADER) % sizeof(double) == 0 && sum == check_sum(bytes, size)) {
        memcpy(header, bytes + 16, sizeof header);
        count = (size - HEADER) / sizeof(double);
        int known_mode = header[1] >= 0.0 && header[1] <= MODE_TERMINATED && header[1] == floor(header[1]);
        if (!known_mode || !(header[3] >= 0.0 && header[3] <= (double)count) || header[3] + header[4] != (double)count)
            count = 0;
    }
    SavedState *state = *made = count ? malloc(sizeof *state + count * sizeof(double)) : NULL;
    if (!state)
        return instance_fail(instance, STATUS_ERROR,
                             count ? "no memory for the FMU state" : "the bytes are no FMU state");
    memcpy(state->owner, bytes, 16);
    state->time = header[0];
    state->mode = (int)header[1];
    state->has_state = header[2] != 0.0;
    state->known = (size_t)header[3];
    state->states = (size_t)header[4];
    state->event_due = header[5] != 0.0;
    state->exchange = header[6] != 0.0;
    state->interpolates = header[7] != 0.0;
    state->inputs_finite = 0;
    memcpy(state->numbers, bytes + HEADER, count * sizeof(double));
    return STATUS_OK;
}
