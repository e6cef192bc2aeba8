/* Steps that one run notes and others repeat. */

#include "alike.h"

#include <stdio.h>

void tell_size(const NotedSteps *noted, Coupling *c) {
    c->request.plan = NULL;
    if (noted->mode != REPEATS_STEPS || !noted->count) return;
    c->request.plan = &noted->step[noted->at < noted->count ? noted->at : noted->count - 1].size;
    c->request.planned = 1;
}

int note_step(NotedSteps *noted, const Coupling *c, int meets, char *said, size_t size) {
    if (noted->mode == NOTES_STEPS) {
        if (noted->count == MOST_NOTED) {
            snprintf(said, size, "derivatives are those of at most %d steps of the master; this communication step has more",
                     MOST_NOTED);
            return 0;
        }
        noted->step[noted->count++] = (NotedStep){c->progress.tried, meets};
    } else if (noted->mode == REPEATS_STEPS) {
        if (noted->at == noted->count || (noted->step[noted->at].meets != 0.0) != meets) return 0;
        noted->at++;
    }
    return 1;
}

int has_left(const NotedSteps *noted) { return noted->at < noted->count; }

Exactness set_exactness(Coupling *c, Exactness wanted) {
    const Exactness before = {c->network.tolerance.relative, c->stalled, c->repeats};
    c->network.tolerance.relative = wanted.iterated;
    c->stalled = wanted.stalled;
    c->repeats = wanted.repeats;
    return before;
}
