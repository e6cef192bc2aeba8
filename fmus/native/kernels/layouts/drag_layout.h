/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_DRAG_LAYOUT_H
#define FANFOLD_DRAG_LAYOUT_H

#define KIND "drag"
#define LAYOUT_DIGEST "72ec5332a9e0b15c"
#define MOMENTS 0
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_START = 0, P_END = 1, P_WIDTH = 2, P_AIR_DENSITY = 3, P_DRAG_COEFFICIENT = 4, PARAMETERS = 5 };
enum { X_POSITION = 0, X_ORIENTATION = 3, X_NORMAL_RATE = 7, X_TURN_RATE = 11, X_HEAT = 15, X_WRENCH = 16, STATES = 22 };
enum { U_IMPULSE = 13, INPUTS = 14 };
enum { OUTPUTS = 6 };
enum { Z_DRAG_FORCE = 0, Z_DRAG_TORQUE = 1, Z_NORMAL_VELOCITY = 2, Z_DISSIPATED_ENERGY = 3, OBSERVATIONS = 4 };
#define LAGGED_LOADS 0

#endif
