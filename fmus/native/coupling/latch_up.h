/* What a latch-up makes of a hinge line: the frequency of the rotation it stiffens, its inertia and its energy.

   Found from the derivatives of the coupled step. With S the stiffness that the event adds at its hinges and g how far they
   turn under torques of 1 N.m held over a step h, all joints in place, the rotations obey theta'' = -(2 g/h^2) S theta. At a
   small h more of a flexible body's inertia stays behind: the frequency is that of the step's own time scale. */

#ifndef FANFOLD_LATCH_UP_H
#define FANFOLD_LATCH_UP_H

#include "solver.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { HINGE_PORTS = 2, PORT_ROWS = 12 };

/* Mean wrenches of a hinge by the poses of its ports: over the step asked for, and over one so long that damping and friction
   add nothing. */
typedef struct {
    double step[PORT_ROWS * PORT_ROWS], lasting[PORT_ROWS * PORT_ROWS];
} Slope;

/* The rotation at one hinge that an event made stiff, or a motion along an axis where nothing turns against a torque; numbers
   only, as they are part of a saved state. connection: its number among participants; first: component of its last port's
   wrench that its load starts at; axis: unit vector, axes of that port; stiffness (N.m/rad or N/m), with the inertial terms
   that damp unresolved coordinates; damping (N.m.s/rad or N.s/m); wrench: of the hinge on its bodies for a load of 1 N.m or
   N about the axis; rotation: by motions of its ports. */
typedef struct {
    double connection, first, axis[3], stiffness, damping, wrench[PORT_ROWS], rotation[PORT_ROWS];
} Stiffening;

/* A hinge line just latched, or what was struck together: angular frequency (rad/s), rate of decay (1/s), damping over
   inertia, energy (J) of the rate that it latches with, and how many of `hinge` there are. */
typedef struct {
    double frequency, decay, energy, hinges;
    Stiffening hinge[];
} StiffenedLine;

/* How fast it starts (1/s): by its frequency or its decay; 0 where nothing turns. */
double fastest_of(const StiffenedLine *line);
/* Stiffnesses of a connection with two ports at the motions and under the commands of now; 0 where it fails. */
int slope_of(Solver *s, size_t connection, double time, double h, Slope *slope);
/* What an event changed at a hinge, from its slopes before and after; 0 where it is no stiffer. */
int stiffening_of(const Network *n, size_t hinge, const Slope *old, const Slope *new, double h, Stiffening *found);
/* How a latched line swings as a whole, and the step (s), `largest` at the most, that tells: the longest that does, and that
   no participant refuses. room (3, hinges, hinges): to work in. */
double note_whole_swing(Solver *s, double time, double largest, StiffenedLine *line, double *room);
/* A step (s), h at the most, in which the fastest initial vibration of a line advances by a phase (rad), from how it swings
   in a size (s). The inertia that moves at first may be much less than that of later vibrations, so the vibration is followed
   to shorter times. */
double resolving_step(Solver *s, double time, StiffenedLine *line, double size, double h, double phase, double *room);
/* Judge the loads of a line's hinges beside an energy (J); how many there are. */
size_t watch_loads(const Network *n, const StiffenedLine *line, double energy, Watched *watched);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
