/* Whether a host that drives the base is unstable: its accelerations swing from step to step and grow.

   Over windows of steps, the squares of the changes of acceleration are added up, and those of the changes of these. For
   a vibration at w over steps h the second sum is 4 sin(w h / 2)^2 times the first one. So it is the larger one where a
   swing takes fewer than six steps, which no stable host resolves. A swing that doubles its power in each of several
   windows grows by itself; what latches or strikes does so in one. */

#ifndef FANFOLD_HOST_STABILITY_H
#define FANFOLD_HOST_STABILITY_H

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { SWING_AXES = 3, SWING_NUMBERS = 11 };

/* Of translation or rotation, all numbers: acceleration and its change in the last step, how many steps the window has, its sums,
   the sum of the last window, and how many windows have grown one after the other. */
typedef struct {
    double acceleration[SWING_AXES], change[SWING_AXES], steps, changes, bends, last, grown;
} Swing;

/* Follow one more step with a mean acceleration (SWING_AXES,); whether it is unstable. */
int swing_grows(Swing *s, const double *acceleration);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
