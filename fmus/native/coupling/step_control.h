/* Communication step sizes, the error that a step may make, and the guard of the balance of energy. */

#ifndef FANFOLD_STEP_CONTROL_H
#define FANFOLD_STEP_CONTROL_H

#include <stddef.h>

#include "network.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

#define TIME_ROUNDING 1e-12 /* s, what sums of step sizes may leave */
#define BREAK_REACHED 1e-9  /* s, the same before a time that steps are to end at */
#define STRETCHED 1.001 /* steps in which a remainder that would be a tiny step is taken in one, */
#define SHARED 1.5      /* or where a step may be chosen in two */
#define TO_CONVERGE (1.0 / 1024.0) /* of the smallest step for accuracy, that convergence may ask for: friction that breaks
                                      away below a light body in a lock converges where it moves little in a step */

/* The geometric grid of communication step sizes (s), largest x sqrt(2)^-level, and where we are on it.

   A change of step stirs up whatever is stiff, so steps change seldom: an error a little above what is allowed is accepted
   and the next step made smaller, and after a change the size stays for a while (wait). Errors of the first steps after a
   change are those of the stirring (stirred), which smaller steps would only renew: they stand unless they are large, and say
   nothing about the next size. worst: of the errors since, fading. */
typedef struct {
    double largest, smallest, worst;
    size_t order;
    ptrdiff_t level, wait, stirred;
} StepSizes;

double size_now(const StepSizes *s);
/* Go to the grid size at or below a size (s); not stirred: errors of the first steps count like others. */
void restart_sizes(StepSizes *s, double size, int stirred);
/* Go down two levels; 0 where that is below a share of the smallest size. */
int shrink_size(StepSizes *s, double share);
/* Whether a step with this error (over what is allowed) stands; chooses the size of the next one. */
int judge_error(StepSizes *s, double error);

/* Error of a step that may be allowed, from the wrenches h^2 u'' or what is left of them; resolved: the same by order 2, for
   the phase up to which a vibration that holds all energy is followed well, as what an event starts is no smoother. energy
   (J): the largest of what motors will put through the scene, of the kinetic energy seen, and of a thousandth of what is
   stored at the start. */
#define LEAST_STORED_SHARE 1e-3
#define LEAST_ENERGY 1e-9 /* J */
typedef struct {
    double allowed, resolved, energy;
} ErrorLimit;

/* Part of a step, at most all of it, whose error leaves room to grow, where errors go with the step; square: of the relative
   error that it makes, see error_square. */
double share_that_fits(const ErrorLimit *limit, double square);

enum { TRIALS = 4 };

/* Rejects spurious roots of the step equations, which do not conserve energy.

   At such a root wrenches and motions agree to the last digit, but the work of constant wrenches on a rotating body does not:
   the balance jumps. A jump is measured against the energy in motion (J): the largest kinetic energy so far, a least one, or
   what changes hands in the step itself, whichever is more. What smaller steps do not cure is not for them to cure: a jump
   that goes with the length of the step is a power that a participant does not account for, and one that stays at the
   smallest step is rounding. Both are let pass from then on, and the recorded residual shows them. powers: the newest last;
   trials: how many there are. */
typedef struct {
    double last[ENERGIES], kinetic, powers[TRIALS], power, rounding;
    size_t trials;
} EnergyGuard;

void begin_guard(EnergyGuard *g, const double *energies);
/* Whether a step h (s) from the last accepted one to these energies stands. */
int guard_allows(EnergyGuard *g, const double *energies, double h);
/* Let pass from now on what the smallest step leaves open. */
void guard_gives_in(EnergyGuard *g, const double *energies);
/* Take note of the energies that an accepted step ends with. */
void guard_accepts(EnergyGuard *g, const double *energies);

/* Parts that a fixed step is made in, as whole ones did not converge or gained energy; made: steps of this size. Parts become
   fewer seldom: steps that are larger and smaller in turn pump what is stiff. */
typedef struct {
    size_t parts, made;
} SubdividedStep;

/* Four parts of each; 0 where these are too many. */
int divide_step(SubdividedStep *d);
/* Count a step that stands, and try half the parts after some. */
void step_stood(SubdividedStep *d);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
