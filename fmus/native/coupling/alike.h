/* Steps of a run that others make again, which differ from it by parameters or drives: what those differ by holds no
   error of step sizes or of iterations, and so tells derivatives. */

#ifndef FANFOLD_ALIKE_H
#define FANFOLD_ALIKE_H

#include "master.h"

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
static void tell_size(const NotedSteps *noted, Loop *l) {
    l->plan = NULL;
    if (noted->mode != REPEATS_STEPS || !noted->count) return;
    l->plan = &noted->step[noted->at < noted->count ? noted->at : noted->count - 1].size;
    l->planned = 1;
}

/* Note a step just made, or that it is as it was noted; 0 where it is not, or where there is no room. */
static int note_step(NotedSteps *noted, Master *m, int meets) {
    if (noted->mode == NOTES_STEPS) {
        if (noted->count == MOST_NOTED) {
            snprintf(m->said, sizeof m->said, "derivatives are those of %d steps of the master at the most; this "
                     "communication step has more", MOST_NOTED);
            return 0;
        }
        noted->step[noted->count++] = (NotedStep){m->tried, meets};
    } else if (noted->mode == REPEATS_STEPS) {
        if (noted->at == noted->count || (noted->step[noted->at].meets != 0.0) != meets) return 0;
        noted->at++;
    }
    return 1;
}

/* Whether a run that repeats steps has any left. */
static int has_left(const NotedSteps *noted) { return noted->at < noted->count; }

/* How exactly a run solves its steps, and whether it repeats others. */
typedef struct {
    double iterated, stalled;
    size_t repeats;
} Exactness;

static Exactness set_exactness(Master *m, Exactness wanted) {
    const Exactness before = {m->usual_relative, m->stalled, m->repeats};
    m->usual_relative = m->network.tolerance.relative = wanted.iterated;
    m->stalled = wanted.stalled;
    m->repeats = wanted.repeats;
    return before;
}

#endif
