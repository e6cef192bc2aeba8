/* Steps of a run that others make again, which differ from it by parameters or drives: what those differ by holds no
   error of step sizes or of iterations, and so tells derivatives. */

#ifndef FANFOLD_ALIKE_H
#define FANFOLD_ALIKE_H

#include "sequence.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* MOST_NOTED: steps of the master within one communication step. */
enum { MOST_NOTED = 4096 };
/* Of iterations, over the largest wrench, and where rounding of stiff joints lets them come no further: what the
   difference may hold of them. Events are met as usual: from the same side. */
#define ALIKE_ITERATED 1e-12
#define ALIKE_STALLED 1e-7

/* A step as it was tried, and whether something crossed in it. */
typedef struct {
    double size, meets;
} NotedStep;

enum { IS_PLAIN, NOTES_STEPS, REPEATS_STEPS };

/* step (MOST_NOTED,); wanted (parameters,): those that the host had set in the run that others repeat; mode: what a run
   does with them; acts: whether what the host may change acts, changed or not; gives: whether the host gives
   accelerations of a base, negative until the first run that repeats has told. */
typedef struct {
    NotedStep *step;
    double *wanted;
    size_t count, at;
    int mode, acts, gives;
} NotedSteps;

/* Have the next turn try the size that was noted. */
void tell_size(const NotedSteps *noted, Coupling *c);
/* Note a step just made, or that it is as it was noted; 0 and a sentence where it is not, or where there is no room. */
int note_step(NotedSteps *noted, const Coupling *c, int meets, char *said, size_t size);
/* Whether a run that repeats steps has any left. */
int has_left(const NotedSteps *noted);

/* How exactly a run solves its steps, and whether it repeats others. */
typedef struct {
    double iterated, stalled;
    size_t repeats;
} Exactness;

/* From now on, as wanted; what was before. */
Exactness set_exactness(Coupling *c, Exactness wanted);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
