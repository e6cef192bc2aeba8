/* Rows of results before they are recorded: the last one waits for one step, as components then know some values
   better. */

#ifndef FANFOLD_ROWS_H
#define FANFOLD_ROWS_H

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* Channels of the scene: step size, iterations, stored, dissipated, numerical and supplied energy, residual of the
   balance. */
enum { CHANNELS = 7 };

/* The row held back, and those to hand on: times (room,), values (room, columns + CHANNELS + signals), segments
   (room,). Segments number the stretches of steps between events; the instant after an event lies halfway between two.
   recorded (columns,): places of recorded values among the observations. corrected (corrections, 2): in the held row,
   the second place receives the present value of the first. brought (bringing,): places of what bodies observe of the
   loads that connections bring them; bring (bringing,): room for these. start: energies at the start; signal
   (signals,): present values of FMUs with signals. roughness (corrections,): see rows_note_roughness, zero without an
   event. */
typedef struct {
    double *held_observations, *held_channels, held_time, held_segment;
    double *times, *values, *segments, *start, *signal, *roughness, *bring, last_time;
    const size_t *recorded, *corrected, *brought;
    size_t held, observations, columns, corrections, bringing, signals, count, room;
} Rows;

/* Hold back the row of a step h (s) that was just accepted and ends at `time` (s). continues: whether the held row is
   that of the step before, which receives the values that are known better now. */
void rows_hold(Rows *r, const Network *n, double time, double h, double segment, int continues);
/* Add a row of what was observed last, without holding it back. */
void rows_add(Rows *r, const Network *n, double time, double h, double iterations, double segment);
/* Hand on the held row. */
void rows_release(Rows *r);
/* Note by how much loads of the present instant differ from those of the step that ends there: where steps do not
   resolve the vibration of joints, the instant may be anywhere in its period. After a single step since the last event
   (steps) loads of steps are means from before the event; then the held row receives those of the instant. */
void rows_note_roughness(Rows *r, const Network *n, double time, size_t steps);
void rows_forget_roughness(Rows *r);
/* Subtract the roughness from the loads of the instant after an event, which leaves those before it and their jump. A
   load of zero stays: it is that of a joint that let go. */
void rows_smooth(Rows *r, Network *n);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
