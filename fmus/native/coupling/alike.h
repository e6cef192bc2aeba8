/* Steps that one run notes and others repeat with other parameters or drives. The difference of both contains no error
   of step sizes or iterations, so that it is a derivative. */

#ifndef FANFOLD_ALIKE_H
#define FANFOLD_ALIKE_H

#include "sequence.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* MOST_NOTED: steps of the master within one communication step. */
enum { MOST_NOTED = 4096 };
/* Correction over the largest wrench at which iterations of repeated steps end, and the one that rounding of stiff
   joints may leave. Events are located as usual: from the same side. */
#define ALIKE_ITERATED 1e-12
#define ALIKE_STALLED 1e-7

/* Size (s) of a step as it was tried, and whether an event ended it. */
typedef struct {
    double size, meets;
} NotedStep;

enum { IS_PLAIN, NOTES_STEPS, REPEATS_STEPS };

/* step (MOST_NOTED,); wanted (parameters,): values that the host had set in the noted run; mode: what the run does with
   steps; acts: whether values of the host act even where they have not changed; gives: whether the host provides
   accelerations of a base, negative until the first run that repeats steps. */
typedef struct {
    NotedStep *step;
    double *wanted;
    size_t count, at;
    int mode, acts, gives;
} NotedSteps;

/* Prescribe the noted size for the next turn. */
void tell_size(const NotedSteps *noted, Coupling *c);
/* Note the step just made, or check that it is like the noted one. 0 where it is not, or where there is no room, which
   `said` then states. */
int note_step(NotedSteps *noted, const Coupling *c, int meets, char *said, size_t size);
/* Whether noted steps are left to repeat. */
int has_left(const NotedSteps *noted);

/* How exactly a run solves its steps: tolerance.relative, stalled and repeats of a coupling. */
typedef struct {
    double iterated, stalled;
    size_t repeats;
} Exactness;

/* Set them; returns the values before. */
Exactness set_exactness(Coupling *c, Exactness wanted);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
