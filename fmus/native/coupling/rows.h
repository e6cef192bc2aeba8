/* Rows of results on their way out: the last one waits for what components know better one step later. */

#ifndef FANFOLD_ROWS_H
#define FANFOLD_ROWS_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Channels of the scene: step size, iterations, stored, dissipated, numerical and supplied energy, residual. */
enum { CHANNELS = 7 };

/* The row held back, and those to hand on: times (room,), values (room, columns + CHANNELS + signals), segments (room,). A
   segment is a stretch of steps between events; that of the instant after an event lies between two, and that of a state
   between the impulses of a lock is negative. recorded (columns,): places of what is recorded among the observations. Of
   corrected (corrections, 2) a held observation takes the value of the other now. brought (bringing,): what bodies observe
   of the loads that connections bring them; bring (bringing,): room for it. start: energies at the start; signal (signals,): of FMUs with signals, now.
   roughness (corrections,): of loads before an event, zero without one. */
typedef struct {
    double *held_observations, *held_channels, held_time, held_segment;
    double *times, *values, *segments, *start, *signal, *roughness, *bring, last_time;
    const size_t *recorded, *corrected, *brought;
    size_t held, observations, columns, corrections, bringing, signals, count, room;
} Rows;

/* Hold back the row of a step h that was just accepted, to `time`; continues: the row before comes right before, and takes
   what is known better now. */
void rows_hold(Rows *r, const Network *n, double time, double h, double segment, int continues);
/* A row that stands as it is, of what was observed last. */
void rows_add(Rows *r, const Network *n, double time, double h, double iterations, double segment);
/* Hand on what is held. */
void rows_release(Rows *r);
/* Note how far loads of the present instant are from those of the step that ends there, if steps do tell them: where they do
   not resolve the vibration of joints, an instant may be anywhere in its period. After one step alone (steps, since the last
   event) loads are means from before the event, and the instant is right. */
void rows_note_roughness(Rows *r, const Network *n, double time, size_t steps);
void rows_forget_roughness(Rows *r);
/* Loads of the instant after an event are those before it and its jump; one of zero is that of a joint that let go. */
void rows_smooth(Rows *r, Network *n);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
