/* The content of resources/component.bin, as fmus/native/binary_data.py writes it.

   After eight bytes of magic come entries until the end of the file, all numbers little-endian:

       1 byte   'd' for doubles, 's' for text
       4 bytes  length of the name, 8 bytes number of elements
       name, then the elements (8 bytes each, or 1 for text) */

#ifndef FANFOLD_DATA_H
#define FANFOLD_DATA_H

#include "kernel.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

typedef struct {
    const char *name;
    size_t count;
    const double *numbers;
    const char *text;
} Entry;

struct Data {
    Entry *entries;
    size_t count;
};

/* What a variable is to a host; its values are numbers inside, 0 or 1 for a Boolean. */
typedef enum { KIND_REAL, KIND_BOOLEAN, KIND_INTEGER } VariableKind;

/* A declared variable: where its scalars are within their group, and the range of each. */
typedef struct {
    const char *name;
    size_t offset, size;
    double minimum, maximum;
    int tunable;
    VariableKind kind;
} Variable;

/* Reads a file; 0 and a sentence when it is not what it should be. */
int data_read(Data *data, const char *path, Memory *memory, Reason *why);
/* The same from the bytes of such a file, called `source` in the sentence. */
int data_parse(Data *data, const char *source, const unsigned char *bytes, size_t size, Memory *memory, Reason *why);
/* The bytes of a text and their number; NULL when there is none. */
const char *data_bytes(const Data *data, const char *name, size_t *count);
/* The text of that name; NULL when there is none. */
const char *data_text(const Data *data, const char *name);
/* The declared variable of entry `index` if it is one of `group`; 0 otherwise. */
int data_variable(const Data *data, size_t index, const char *group, Variable *variable);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
