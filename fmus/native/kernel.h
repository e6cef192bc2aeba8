/* What the FMI core knows of a component: its data, its memory, and its equations.

   A component is one equations file. Where its variables lie stands in kernels/layouts/NAME_layout.h, written from the
   declarations in Python by `python -m fmus.native`; what connections share, in shared/connection.h. It reads named
   arrays of doubles (what the Python component gives as `native_data`), and computes on flat arrays in the declared order
   of the Python component: parameters p, inputs u, state x, outputs y, observations z. Only `create` allocates. Nothing
   is global. */

#ifndef FANFOLD_KERNEL_H
#define FANFOLD_KERNEL_H

#include <complex.h>
#include <stddef.h>

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

/* A sentence for the user. */
typedef struct {
    char text[512];
} Reason;

/* Writes the sentence and returns 0, so that a failing function can `return refuse(why, ...)`. */
int refuse(Reason *why, const char *format, ...);

/* Memory that lives as long as an instance; NULL when there is none left. Zeroed, aligned for SIMD. */
typedef struct Memory Memory;
void *allocate(Memory *memory, size_t bytes);

/* Named arrays of doubles from resources/component.bin. */
typedef struct Data Data;

/* The array of that name with exactly `count` elements; NULL and a sentence otherwise. */
const double *data_array(const Data *data, const char *name, size_t count, Reason *why);
/* The array of that name and its number of elements; NULL and a sentence when there is none. */
const double *data_any(const Data *data, const char *name, size_t *count, Reason *why);
/* Offset of a parameter, input, output or observation ("parameter", "latch_stiffness") in its flat array,
   with exactly `size` scalars; -1 and a sentence otherwise. */
long data_offset(const Data *data, const char *group, const char *name, size_t size, Reason *why);

/* Numbers of scalars: state, ports come from the kernel; the other four from the data. */
typedef struct {
    size_t parameters, inputs, outputs, observations;
} Sizes;

/* The equations of a component. Functions that can fail return 1 when they succeed and 0 with a sentence.
   `self` is what `create` returned; `step` and `outputs` exist for both number types. */
typedef struct {
    const char *kind;
    /* Reads the data and allocates all that is ever needed; sets the number of states. NULL and a sentence
       when the data are unusable: nothing in them may be trusted. */
    void *(*create)(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why);
    /* Derives constants from parameters whose ranges were checked already. */
    int (*prepare)(void *self, const double *p, Reason *why);
    int (*initial)(void *self, const double *u, double *x, Reason *why);
    /* From x to x_next over h > 0; the arrays differ. Values may end up not finite: the core checks. A sentence of a step
       that succeeds is a warning to the host. */
    int (*step)(void *self, const double *x, const double *u, double h, double *x_next, Reason *why);
    void (*outputs)(void *self, const double *x, const double *u, double *y);
    void (*observe)(void *self, const double *x, const double *u, double *z);
    int (*step_complex)(void *self, const double *x, const double complex *u, double h,
                        double complex *x_next, Reason *why);
    void (*outputs_complex)(void *self, const double complex *x, const double complex *u, double complex *y);
    /* Derivatives of the wrenches of all ports, with slopes, over the step from x by the motions of the ports at its end:
       a row for each of a port's force, torque and their slopes, a column for each of its position, rotation vector,
       first moments of velocity and angular velocity, velocity, angular velocity, world axes. 0 where there are none for
       this step or for so many ports; NULL where there never are, and the core takes a step for every column. */
    int (*stiffness)(void *self, const double *x, const double *u, double h, size_t ports, double *matrix);
    /* NULL where steps end early for no event. Like `step`, but to the first event inside of it, if there is one: h is how
       far it came then, and the event is `due`; next_event is NULL. */
    int (*step_to_event)(void *self, const double *x, const double *u, double *h, int *due, double *x_next, Reason *why);
    /* NULL where steps choose no sizes inside. Like `step`, for differences: again: by the sizes that the call before chose
       which was not `again`; acts: parameters differ among the calls. What follows depends on the state alone. */
    int (*step_alike)(void *self, const double *x, const double *u, double h, int again, int acts, double *x_next,
                      Reason *why);
    /* Both NULL for components without events. Time until the next event if the motion of the inputs goes on:
       0 when it is due already, INFINITY when none is coming. */
    double (*next_event)(void *self, const double *x, const double *u);
    /* From x to x_next at one instant; `due` when the time that `next_event` gave has come, or `step_to_event` said so. */
    void (*event)(void *self, const double *x, const double *u, int due, double *x_next);
    /* Model exchange; `continuous` is NULL for components without it. Number of continuous states and, where
       wanted, their positions in the state. */
    size_t (*continuous)(const void *self, size_t *places);
    /* Makes what depends on the continuous states fit those that a solver put into x; NULL where nothing does. */
    void (*complete)(void *self, double *x);
    void (*complete_complex)(void *self, double complex *x);
    /* Rates of the continuous states at the completed state x; `raw` is the same before completion. */
    int (*rates)(void *self, const double *raw, const double *x, const double *u, double *rates, Reason *why);
    int (*rates_complex)(void *self, const double complex *raw, const double complex *x, const double complex *u,
                         double complex *rates, Reason *why);
    /* Number of event indicators and, where wanted, their values; NULL for none. */
    size_t (*indicators)(void *self, const double *x, const double *u, double *indicators);
    /* Time until a law changes its form, INFINITY where none does any more; NULL for components without such laws. */
    double (*time_to_break)(void *self, const double *x, const double *u);
    /* What the state remembers of an accepted step of the solver and, at an event, what happens; NULL for nothing. */
    void (*update)(void *self, const double *x, const double *u, int at_event, double *x_next);
    /* Both NULL for components that keep nothing outside of their state. What follows a state that was saved or put back
       depends on the state alone; and what `create` has made is no longer needed. */
    void (*settle)(void *self);
    void (*destroy)(void *self);
    int checks_itself; /* whether a state that is not finite never comes out of `step` */
    /* Whether it chooses steps of its own inside: its last parameter is the relative tolerance, which hosts may give as well,
       and its state is that of a time, at which the next step begins. */
    int steps_inside;
    const char *layout; /* digest of the declared layout that the kernel was written for */
} Kernel;

/* Every component of this binary; the build writes the list, and declares it, from the equations files there are. */
extern const Kernel *const kernels[];
extern const size_t kernel_count;

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
