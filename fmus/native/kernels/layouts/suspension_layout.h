/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_SUSPENSION_LAYOUT_H
#define FANFOLD_SUSPENSION_LAYOUT_H

#define KIND "suspension"
#define LAYOUT_DIGEST "57f735bd4f0d8e01"
#define MOMENTS 12
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_STIFFNESS = 0, P_PRELOAD = 1, P_PRELOAD_LENGTH = 2, P_DAMPING = 3, P_ORDER = 4, PARAMETERS = 5 };
enum { X_SPAN = 0, X_HEAT = 3, X_SLIDE = 4, X_MEMORY = 8, X_NUMERICAL = 11, X_WRENCH = 12, X_SLOPES = 24, STATES = 36 };
enum { U_IMPULSE = 26, INPUTS = 27 };
enum { OUTPUTS = 12 };
enum { Z_LENGTH = 0, Z_TENSION = 1, Z_POTENTIAL_ENERGY = 2, Z_DISSIPATED_ENERGY = 3, Z_NUMERICAL_DISSIPATION = 4,
       OBSERVATIONS = 5 };
#define LAGGED_LOADS 0

#endif
