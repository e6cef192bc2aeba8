/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_DAMPER_LAYOUT_H
#define FANFOLD_DAMPER_LAYOUT_H

#define KIND "eddy_current_damper"
#define LAYOUT_DIGEST "ad97df2c0edd15c5"
#define MOMENTS 12
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_DAMPING_COEFFICIENT = 0, P_PEAK_RATE = 1, P_ORDER = 2, PARAMETERS = 3 };
enum { X_ANGLE = 0, X_FRAME = 1, X_SWING = 5, X_WRENCH = 7, X_SLOPES = 19, X_RATE = 31, X_HEAT = 35, STATES = 36 };
enum { U_IMPULSE = 26, INPUTS = 27 };
enum { OUTPUTS = 12 };
enum { Z_ANGULAR_RATE = 0, Z_DAMPER_TORQUE = 1, Z_DISSIPATED_ENERGY = 2, OBSERVATIONS = 3 };
#define LAGGED_LOADS 0

#endif
