/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_FIXED_BASE_LAYOUT_H
#define FANFOLD_FIXED_BASE_LAYOUT_H

#define KIND "fixed_base"
#define LAYOUT_DIGEST "6b9b65c92692f95d"
#define STOPPED -1.0
#define CONTINUOUS 0
#define CONTINUOUS_PLACES {0}

enum { PARAMETERS = 0 };
enum { X_LOAD = 0, X_SLOPE = 6, X_H = 12, X_PREVIOUS_LOAD = 13, X_PREVIOUS_SLOPE = 19, X_PREVIOUS_H = 25, STATES = 26 };
enum { U_IMPULSE = 0, OWN_INPUTS = 1 };
enum { OWN_OUTPUTS = 0 };
enum { Z_INTERFACE_FORCE = 0, Z_INTERFACE_TORQUE = 3, Z_INTERFACE_FORCE_LAGGED = 6, Z_INTERFACE_TORQUE_LAGGED = 9,
       OBSERVATIONS = 12 };

#endif
