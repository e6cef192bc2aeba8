/* What happens when in one FMU of a scene: the sequence of orchestrator/cosim/master.py over the same functions. */

#ifndef FANFOLD_SEQUENCE_H
#define FANFOLD_SEQUENCE_H

#include "coupling.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* A value of a parameter: `place` among those of its participant. */
typedef struct {
    size_t participant, place;
    double value;
} Setting;

/* An event. time (s): NaN where it waits for a condition, whose `crossing` is then set. release (releases,): inputs;
   latch (latches,): lines; unlatch (unlatches, 2): lines, and 1 to open their latches or 0 to make them ready again;
   setting (settings,). pending is part of a saved state. */
typedef struct {
    double time;
    const Crossing *crossing;
    size_t releases, latches, unlatches, settings;
    const Place *release;
    const size_t *latch, *unlatch;
    const Setting *setting;
    double *pending;
} Event;

/* latch_time, unlatch_time (s, of the last time; negative before), latch_rate (rad/s just before latch-up; 0 before): by
   line, part of a saved state.
   angular_rate (participants,): places among the observations. row: receives each row; set_parameter: sets one of a
   participant; both receive `taker`. steps, rejected, happened: counts. event_time (s): of the last event or latch-up,
   negative before the first; is_crossed: whether a distance fell through zero for it. */
typedef struct {
    Coupling coupling;
    Event *event;
    const size_t *angular_rate;
    void (*row)(void *taker, double time, double segment, const double *values);
    int (*set_parameter)(void *taker, size_t participant, size_t place, double value);
    void *taker;
    double *latch_time, *unlatch_time, *latch_rate;
    double event_time, is_crossed;
    size_t events, steps, rejected, happened;
} Sequence;

/* Begin a run with initialised participants whose outputs have been read; `accepted` contains the wrenches there.
   Returns an event whose condition is met from the start, NULL for none. fine: whether participants did not fail. */
const Event *begin_run(Sequence *s, int *fine);
/* One turn of a run that goes to `until` of the request: an event, a step, or a rejected attempt at one; 0 where it
   cannot go on. */
int take_turn(Sequence *s);
/* An event whose time has come, or whose condition is met; NULL for none. */
Event *due_event(Sequence *s);
/* Release a participant by an input. */
void release_one(Sequence *s, const Place *release);
/* Open the latches of a line, or make them ready again. */
void unlatch_line(Sequence *s, size_t line, int open);
/* Go on after something jumped; lines that are to latch with it engage at once. */
int go_on(Sequence *s, const size_t *latch, size_t latches);
void hand_on_rows(Sequence *s);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
