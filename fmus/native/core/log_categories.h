/* Which messages a host wants: the log categories of both versions of FMI. What fails is always said. */

#ifndef FANFOLD_LOG_CATEGORIES_H
#define FANFOLD_LOG_CATEGORIES_H

#include <stddef.h>
#include <string.h>

#include "instance.h"

enum { LOG_CATEGORIES = STATUS_FATAL + 1 };

/* Warnings and discarded steps that a host has switched off, a bit a status; none at the start. */
typedef unsigned Unwanted;

/* Name of the category of a status; that of OK is the one of all. */
static inline const char *category_of(int status) {
    static const char *const names[LOG_CATEGORIES] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                                      "logStatusError", "logStatusFatal"};
    return names[status];
}

static inline int is_category(const char *name) {
    for (int status = 0; name && status < LOG_CATEGORIES; status++)
        if (strcmp(name, category_of(status)) == 0) return 1;
    return 0;
}

static inline int is_wanted(Unwanted unwanted, Status status) { return !(unwanted >> status & 1u); }

/* What a host does not want that switches logging off, or on for these categories; for all where it names none. */
static inline Unwanted unwanted_by(int on, size_t count, const char *const categories[]) {
    const Status choices[2] = {STATUS_WARNING, STATUS_DISCARD};
    Unwanted unwanted = 0;
    for (size_t c = 0; c < 2; c++) {
        int named = count == 0;
        for (size_t i = 0; i < count && categories; i++)
            named |= categories[i] && (strcmp(categories[i], category_of(choices[c])) == 0 ||
                                       strcmp(categories[i], category_of(0)) == 0);
        if (!on || !named) unwanted |= 1u << choices[c];
    }
    return unwanted;
}

#endif
