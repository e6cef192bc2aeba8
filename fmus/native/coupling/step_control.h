/* Communication step sizes, the error that a step may make, and the guard of the balance of energy. */

#ifndef FANFOLD_STEP_CONTROL_H
#define FANFOLD_STEP_CONTROL_H

#include <stddef.h>

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

#define TIME_ROUNDING 1e-12 /* s, what sums of step sizes may leave */
#define BREAK_REACHED 1e-9  /* s, a step that ends so little before a break has reached it */
#define STRETCHED 1.001 /* of a size: a smaller remainder becomes one step */
#define SHARED 1.5      /* of a size: a smaller remainder becomes two steps where sizes are chosen */
/* Share of the smallest size for accuracy, down to which steps become smaller in order to converge: friction that
   breaks away below a light body in a lock converges where it moves little in a step. */
#define TO_CONVERGE (1.0 / 1024.0)

/* The grid of communication step sizes (s), largest x sqrt(2)^-level, and the present level.

   A change of size excites stiff joints, so sizes change seldom. A step with an error a little above the allowed one is
   accepted, and the next one is smaller. After a change the size stays for `wait` steps. Errors of the first `stirred`
   steps after a change are those of this excitation, which smaller steps would only renew: they lead to a rejection
   only if they are large, and do not influence the next size. worst: largest error since then, which fades. */
typedef struct {
    double largest, smallest, worst;
    size_t order;
    ptrdiff_t level, wait, stirred;
} StepSizes;

double size_now(const StepSizes *s);
/* Go to the grid size at or below a size (s). stirred: whether the change excites stiff joints; otherwise errors of the
   first steps count like others. */
void restart_sizes(StepSizes *s, double size, int stirred);
/* Go down two levels; 0 if the size is then below a share of the smallest one. */
int shrink_size(StepSizes *s, double share);
/* Whether a step with this error, relative to the allowed one, is accepted; sets the size of the next one. */
int judge_error(StepSizes *s, double error);

/* Allowed error of a step. allowed: of the bend of wrenches, see error_square. resolved: the same at order 2; it sets
   the phase up to which a vibration with all energy is resolved, as motion after an event is no smoother. energy (J):
   the largest of the work that motors will do, the kinetic energy so far, and LEAST_STORED_SHARE of the energy stored
   at the start. jump: of the balance of energy in a step, over the energy in motion. */
#define LEAST_STORED_SHARE 1e-3
#define LEAST_ENERGY 1e-9 /* J */
typedef struct {
    double allowed, resolved, energy, jump;
} ErrorLimit;

/* Share of a step, at most 1, whose error leaves room to grow, where errors are proportional to the step. square: of
   the error of the whole step, see error_square. */
double share_that_fits(const ErrorLimit *limit, double square);

enum { TRIALS = 4 };

/* Rejects spurious roots of the step equations, which do not conserve energy.

   At such a root wrenches and motions agree to the last digit, but constant wrenches on a rotating body do other work,
   and the energy balance jumps. A jump is compared with the energy in motion (J): the largest of the kinetic energy so
   far, a least one, and the energies that change in the step itself. Smaller steps do not remove every jump. One that
   is proportional to the step is a power that a participant does not count; one that stays at the smallest step is
   rounding. Both pass from then on, and the recorded residual shows them. powers (TRIALS,): jump over step size of the
   last attempts, the newest last; trials: how many there are. */
typedef struct {
    double last[ENERGIES], kinetic, powers[TRIALS], power, rounding;
    size_t trials;
} EnergyGuard;

void begin_guard(EnergyGuard *g, const double *energies);
/* Whether a step h (s) from the energies accepted last to these passes. share: largest jump over the energy in motion. */
int guard_allows(EnergyGuard *g, const double *energies, double h, double share);
/* Let jumps pass from now on that are as large as the one at the smallest step. */
void guard_gives_in(EnergyGuard *g, const double *energies);
/* Note the energies at the end of an accepted step. */
void guard_accepts(EnergyGuard *g, const double *energies);

/* parts: of a fixed step, where whole ones do not converge or do not conserve energy; made: steps of this size. Their
   number decreases seldom: sizes that alternate excite stiff joints. */
typedef struct {
    size_t parts, made;
} SubdividedStep;

/* Make four times as many parts; 0 where these are too many. */
int divide_step(SubdividedStep *d);
/* Count an accepted step; after some of them, try half as many parts. */
void step_stood(SubdividedStep *d);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
