/* A coupling from tables that orchestrator/cosim/tables.py writes. Every index in them is checked. */

#ifndef FANFOLD_TABLES_H
#define FANFOLD_TABLES_H

#include "coupling.h"
#include "kernel.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Create a coupling of participants, whose functions and arrays the caller provides, with room for so many rows; 0 and
   a sentence where the tables are unusable. `coupling_arrange` then places the state. */
int coupling_create(Coupling *c, const Data *data, const Participant *given, size_t count, size_t room, Memory *memory,
                    Reason *why);

/* Whole numbers of the data as indices; NULL and a sentence where they are not whole numbers. */
const size_t *whole_numbers(const Data *data, const char *name, size_t *count, Memory *memory, Reason *why);
/* The same, exactly `count` of them. */
const size_t *counted_numbers(const Data *data, const char *name, size_t count, Memory *memory, Reason *why);
/* Whether all of `count` indices, each `apart` from the next, are below `end`. */
int are_below(const size_t *indices, size_t count, size_t apart, size_t end);
/* Whether a place is an input of a participant that is exchanged in every sweep. */
int is_input(const Network *n, Place at);

/* A list of numbers that is read in order: a count, as many numbers, and so on. */
typedef struct {
    const size_t *numbers;
    size_t left;
} Reader;

size_t next_number(Reader *r);
const size_t *next_numbers(Reader *r, size_t count);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
