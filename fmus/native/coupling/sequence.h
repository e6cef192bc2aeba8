/* What happens when, inside of one FMU of a scene: the sequence of orchestrator/cosim/master.py over the same functions. */

#ifndef FANFOLD_SEQUENCE_H
#define FANFOLD_SEQUENCE_H

#include "coupling.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* A value for a parameter: `place` among those of its participant. */
typedef struct {
    size_t participant, place;
    double value;
} Setting;

/* time (s): not a number where a condition is waited for, whose crossing it is then. releases: commands; latches: lines.
   pending is part of a saved state. */
typedef struct {
    double time;
    const Crossing *crossing;
    size_t releases, latches, settings;
    const Place *release;
    const size_t *latch;
    const Setting *setting;
    double *pending;
} Event;

/* latch_time (s; negative before), latch_rate (rad/s just before latch-up, 0 until then): by line, part of a saved state.
   angular_rate: place among the observations, by participant that has it. row: takes rows as they come; set_parameter: of a
   participant. steps, rejected, happened: counts. event_time (s): of the last event or latch-up, negative before;
   is_crossed: whether a distance was to be met for it. */
typedef struct {
    Coupling coupling;
    Event *event;
    const size_t *angular_rate;
    void (*row)(void *taker, double time, double segment, const double *values);
    int (*set_parameter)(void *taker, size_t participant, size_t place, double value);
    void *taker;
    double *latch_time, *latch_rate;
    double event_time, is_crossed;
    size_t events, steps, rejected, happened;
} Sequence;

/* Begin a run with participants that are initialised and hold their first outputs, `accepted` being the wrenches there. An
   event whose condition holds from the start, NULL for none; fine: whether participants can. */
const Event *begin_run(Sequence *s, int *fine);
/* One turn of a run that goes to `until` of the request: an event, a step, or a step that has to be smaller; 0 where it
   cannot go on. */
int take_turn(Sequence *s);
/* An event whose time has come, or whose condition holds. */
Event *due_event(Sequence *s);
/* Let go of a participant by an input. */
void release_one(Sequence *s, const Place *release);
/* Go on after something jumped: latches that were commanded with it engage at once. */
int go_on(Sequence *s, const size_t *latch, size_t latches);
void hand_on_rows(Sequence *s);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
