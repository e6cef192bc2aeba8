/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_FIXED_BASE_LAYOUT_H
#define FANFOLD_FIXED_BASE_LAYOUT_H

#define KIND "fixed_base"
#define LAYOUT_DIGEST "8a66b5da94e32bfc"
#define CONTINUOUS 0
#define CONTINUOUS_PLACES {0}

enum { PARAMETERS = 0 };
enum { STATES = 0 };
enum { U_IMPULSE = 0, OWN_INPUTS = 1 };
enum { OWN_OUTPUTS = 0 };
enum { OBSERVATIONS = 0 };
#define X_STEP_SIZES STATES
#define Z_INTERFACE_FORCE OBSERVATIONS

#endif
