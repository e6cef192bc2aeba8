/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_MOVING_BASE_LAYOUT_H
#define FANFOLD_MOVING_BASE_LAYOUT_H

#define KIND "moving_base"
#define LAYOUT_DIGEST "b31106a474b2c542"
#define CONTINUOUS 2
#define CONTINUOUS_PLACES {X_CLOCK, X_WORK}

enum { PARAMETERS = 0 };
enum { X_CLOCK = 0, X_PASSED = 1, X_WORK = 2, STATES = 3 };
enum { U_IMPULSE = 0, U_HOLD = 1, OWN_INPUTS = 2 };
enum { Y_TIME_TO_BREAK = 0, OWN_OUTPUTS = 1 };
enum { Z_SHIFT = 0, Z_TURN = 1, Z_FRAME_POSITION = 2, Z_FRAME_ORIENTATION = 5, Z_SUPPLIED_ENERGY = 9, OBSERVATIONS = 10 };
#define X_STEP_SIZES STATES
#define Z_INTERFACE_FORCE OBSERVATIONS

#endif
