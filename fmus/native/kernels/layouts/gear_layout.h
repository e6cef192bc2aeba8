/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_GEAR_LAYOUT_H
#define FANFOLD_GEAR_LAYOUT_H

#define KIND "gear"
#define LAYOUT_DIGEST "8313d4d25050c006"
#define MOMENTS 18
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_RATIO = 0, P_STIFFNESS = 1, P_DAMPING = 2, P_ORDER = 3, PARAMETERS = 4 };
enum { X_SEATS = 0, X_START = 20, X_MEMORY = 21, X_HEAT = 24, X_SLIDE = 25, X_WRENCH = 29, X_SLOPES = 47, X_NUMERICAL = 65,
       STATES = 66 };
enum { U_IMPULSE = 39, INPUTS = 40 };
enum { OUTPUTS = 18 };
enum { Z_FIRST_ANGLE = 0, Z_SECOND_COORDINATE = 1, Z_GEAR_TORQUE = 2, Z_POTENTIAL_ENERGY = 3, Z_DISSIPATED_ENERGY = 4,
       Z_NUMERICAL_DISSIPATION = 5, OBSERVATIONS = 6 };
#define LAGGED_LOADS 0

#endif
