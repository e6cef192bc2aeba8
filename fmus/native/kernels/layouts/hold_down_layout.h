/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_HOLD_DOWN_LAYOUT_H
#define FANFOLD_HOLD_DOWN_LAYOUT_H

#define KIND "hold_down"
#define LAYOUT_DIGEST "55e3f28b78203532"
#define REACHED 1e-09
#define MOMENTS 12
#define CONTINUOUS 2
#define CONTINUOUS_PLACES {X_CLOCK, X_HEAT}

enum { P_TRANSLATIONAL_STIFFNESS = 0, P_TRANSLATIONAL_DAMPING = 3, P_PRELOAD = 6, P_INITIAL_DISPLACEMENT = 7,
       P_RELEASE_TIME = 10, P_ORDER = 11, PARAMETERS = 12 };
enum { X_FRAME = 0, X_GAP = 4, X_START = 7, X_MEMORIES = 10, X_CLOCK = 19, X_RELEASED = 20, X_HEAT = 21, X_RELEASE_HEAT = 22,
       X_NUMERICAL = 23, X_WRENCH = 24, X_SLOPES = 36, X_LOADS = 48, STATES = 60 };
enum { U_RELEASE_COMMAND = 26, U_IMPULSE = 27, U_HOLD = 28, INPUTS = 29 };
enum { Y_TIME_TO_BREAK = 12, OUTPUTS = 13 };
enum { Z_FORCE = 0, Z_RELEASED = 3, Z_POTENTIAL_ENERGY = 4, Z_DISSIPATED_ENERGY = 5, Z_NUMERICAL_DISSIPATION = 6,
       OBSERVATIONS = 7 };
#define LAGGED_LOADS 0

#endif
