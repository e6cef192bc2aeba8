/* Declared variables of an instance: see layout.h. */

#include "layout.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const GROUPS[4] = {"parameter", "input", "output", "observation"};

/* The declared variable that holds the scalar at a position of a group; 0 where there is none. */
static int variable_at(const Instance *instance, int group, size_t position, Variable *variable) {
    for (size_t i = 0; i < instance->data.count; i++)
        if (data_variable(&instance->data, i, GROUPS[group], variable) && position >= variable->offset &&
            position - variable->offset < variable->size)
            return 1;
    return 0;
}

void layout_scalar_name(const Instance *instance, uint32_t reference, char *name, size_t size) {
    Variable variable;
    int group = 0;
    while (group < 3 && reference >= instance->ends[group])
        group++;
    size_t position = reference - (group ? instance->ends[group - 1] : 0);
    if (!variable_at(instance, group, position, &variable))
        snprintf(name, size, "%s %lu", GROUPS[group], (unsigned long)position);
    else if (variable.size == 1)
        snprintf(name, size, "%s", variable.name);
    else
        snprintf(name, size, "%s[%lu]", variable.name, (unsigned long)(position - variable.offset + 1));
}

/* Unit of the parameter at a position; empty where it is not known or there is none. */
static const char *unit_of(const Instance *instance, size_t position) {
    Variable variable;
    char entry[200];
    if (!variable_at(instance, 0, position, &variable))
        return "";
    snprintf(entry, sizeof entry, "unit:%s", variable.name);
    const char *unit = data_text(&instance->data, entry);
    return unit && strcmp(unit, "1") != 0 ? unit : "";
}

int layout_ranges_hold(const Instance *instance, Reason *why) {
    char name[200];
    for (size_t i = 0; i < instance->sizes.parameters; i++) {
        double value = instance->values[i];
        if (isfinite(value) && value >= instance->minimum[i] && value <= instance->maximum[i])
            continue;
        layout_scalar_name(instance, (uint32_t)i, name, sizeof name);
        if (!isfinite(value))
            return refuse(why, "%s is %g; it must be a finite number", name, value);
        int low = value < instance->minimum[i];
        const char *unit = unit_of(instance, i);
        return refuse(why, "%s = %g%s%.40s; it must be at %s %g", name, value, *unit ? " " : "", unit,
                      low ? "least" : "most", low ? instance->minimum[i] : instance->maximum[i]);
    }
    return 1;
}

/* More than any component has; what damaged data may ask for stays small. */
#define MOST 1e6

static int is_count(double number) { return number >= 0.0 && number <= MOST && floor(number) == number; }

/* Numbers of continuous states and indicators, where the component has them. */
static int read_continuous(Instance *instance, Reason *why) {
    Continuous *continuous = &instance->continuous;
    Reason absent;
    const double *counts = data_array(&instance->data, "continuous", 2, &absent);
    if (!counts)
        return 1;
    if (!is_count(counts[0]) || !is_count(counts[1]))
        return refuse(why, "the component's data declare %g continuous states and %g event indicators", counts[0],
                      counts[1]);
    continuous->offered = 1;
    continuous->count = (size_t)counts[0];
    continuous->indicators = (size_t)counts[1];
    continuous->nominals = data_array(&instance->data, "nominals", continuous->count, why);
    return continuous->nominals != NULL;
}

int layout_read(Instance *instance, Reason *why) {
    const Data *data = &instance->data;
    const double *counts = data_array(data, "sizes", 4, why);
    const double *feedthrough = data_array(data, "feedthrough", 1, why);
    if (!counts || !feedthrough)
        return 0;
    size_t total = 0;
    for (int group = 0; group < 4; group++) {
        if (!(counts[group] >= 0.0 && counts[group] < 1e7 && floor(counts[group]) == counts[group]))
            return refuse(why, "the component's data declare %g scalars of a kind", counts[group]);
        total += (size_t)counts[group];
        instance->ends[group] = total;
    }
    if (!read_continuous(instance, why))
        return 0;
    total += 2 * instance->continuous.count;
    instance->ends[4] = total;
    instance->feedthrough = feedthrough[0] != 0.0;
    instance->sizes = (Sizes){(size_t)counts[0], (size_t)counts[1], (size_t)counts[2], (size_t)counts[3]};
    instance->start = data_array(data, "start", instance->ends[1], why);
    if (!instance->start)
        return 0;
    instance->values = allocate(&instance->memory, (total + 1) * sizeof(double));
    instance->minimum = allocate(&instance->memory, (instance->sizes.parameters + 1) * sizeof(double));
    instance->maximum = allocate(&instance->memory, (instance->sizes.parameters + 1) * sizeof(double));
    instance->tunable = allocate(&instance->memory, instance->ends[1] + 1);
    instance->kinds = allocate(&instance->memory, total + 1);
    if (!instance->kinds || !instance->values || !instance->minimum || !instance->maximum || !instance->tunable)
        return refuse(why, "no memory for %lu values", (unsigned long)total);
    Variable variable;
    for (int group = 0; group < 4; group++) {
        size_t size = instance->ends[group] - (group ? instance->ends[group - 1] : 0);
        for (size_t i = 0; i < data->count; i++) {
            if (!data_variable(data, i, GROUPS[group], &variable))
                continue;
            if (variable.offset > size || variable.size > size - variable.offset)
                return refuse(why, "%s %.100s lies outside of what is declared", GROUPS[group], variable.name);
            memset(instance->kinds + variable.offset + (group ? instance->ends[group - 1] : 0), variable.kind, variable.size);
            for (size_t k = variable.offset; group < 2 && k < variable.offset + variable.size; k++) {
                instance->tunable[k + (group ? instance->ends[0] : 0)] = (unsigned char)variable.tunable;
                if (group)
                    continue;
                instance->minimum[k] = variable.minimum;
                instance->maximum[k] = variable.maximum;
            }
        }
    }
    return 1;
}
