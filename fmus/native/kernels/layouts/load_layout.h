/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_LOAD_LAYOUT_H
#define FANFOLD_LOAD_LAYOUT_H

#define KIND "load"
#define LAYOUT_DIGEST "9dd4764c370e4dd6"
#define MOMENTS 6
#define CONTINUOUS 2
#define CONTINUOUS_PLACES {X_CLOCK, X_WORK}

enum { P_ADDED_FORCE = 0, P_ADDED_TORQUE = 1, P_ORDER = 2, PARAMETERS = 3 };
enum { X_POSITION = 0, X_ORIENTATION = 3, X_CLOCK = 7, X_WORK = 8, X_WRENCH = 9, X_SLOPES = 15, STATES = 21 };
enum { U_IMPULSE = 13, U_HOLD = 14, INPUTS = 15 };
enum { Y_TIME_TO_BREAK = 6, OUTPUTS = 7 };
enum { Z_APPLIED_FORCE = 0, Z_APPLIED_TORQUE = 1, Z_SUPPLIED_ENERGY = 2, OBSERVATIONS = 3 };
#define LAGGED_LOADS 0

#endif
