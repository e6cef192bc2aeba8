/* What a latch-up changes at a hinge line: the frequency of the rotation that it stiffens, its inertia and its energy.

   All follows from the derivatives of the coupled step. S is the stiffness that the event adds at the hinges, g their
   rotations under torques of 1 N.m held over a step h with all joints in place. The rotations obey theta'' = -(2 g/h^2)
   S theta. Within a small h only the near part of a flexible body moves, so that the frequency belongs to the time
   scale h. */

#ifndef FANFOLD_LATCH_UP_H
#define FANFOLD_LATCH_UP_H

#include "solver.h"

#ifdef __GNUC__
#pragma GCC visibility push(hidden) /* hosts have names of their own */
#endif

enum { HINGE_PORTS = 2, PORT_ROWS = 12 };

/* Derivatives of a hinge's mean wrenches by the poses of its ports: over a step, and over a step so long that damping
   and friction add nothing. */
typedef struct {
    double step[PORT_ROWS * PORT_ROWS], lasting[PORT_ROWS * PORT_ROWS];
} Slope;

/* The rotation at one hinge that an event made stiff, or a translation where no torque is added. Numbers only, as they
   are part of a saved state. connection: number of the participant; first: component of the last port's wrench at which
   its load begins; axis: unit vector in the axes of that port; stiffness (N.m/rad or N/m), with the inertial terms that
   damp unresolved coordinates; damping (N.m.s/rad or N.s/m); wrench: of the hinge on its bodies for a load of 1 N.m or
   1 N about the axis; rotation: its derivative by the motions of the ports. */
typedef struct {
    double connection, first, axis[3], stiffness, damping, wrench[PORT_ROWS], rotation[PORT_ROWS];
} Stiffening;

/* A hinge line that just latched, or what was struck together: angular frequency (rad/s), decay rate (1/s; damping over
   inertia), energy (J) of the rates at the event, and how many of `hinge` there are. */
typedef struct {
    double frequency, decay, energy, hinges;
    Stiffening hinge[];
} StiffenedLine;

/* Rate (1/s) of its first motion, frequency or decay; 0 where nothing turns. */
double fastest_of(const StiffenedLine *line);
/* Stiffnesses of a connection with two ports at the present motions and commands; 0 if it fails. */
int slope_of(Solver *s, size_t connection, double time, double h, Slope *slope);
/* What an event changed at a hinge, from its stiffnesses before and after; 0 where it is no stiffer. */
int stiffening_of(const Network *n, size_t hinge, const Slope *old, const Slope *new, double h, Stiffening *found);
/* Compute how a latched line swings as a whole. Returns the longest step (s), at most `largest`, whose derivatives show
   it and that no participant refuses. room (3, hinges, hinges): work space. */
double note_whole_swing(Solver *s, double time, double largest, StiffenedLine *line, double *room);
/* A step (s), at most h, in which the fastest first vibration of a line advances by at most a phase (rad). size (s):
   the step over which it swings as a whole. The vibration is followed to shorter times, as less inertia may move at
   first than later. */
double resolving_step(Solver *s, double time, StiffenedLine *line, double size, double h, double phase, double *room);
/* Judge the loads of a line's hinges relative to an energy (J); returns how many there are. */
size_t watch_loads(const Network *n, const StiffenedLine *line, double energy, Watched *watched);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#endif
