/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_POINT_MOTION_LAYOUT_H
#define FANFOLD_POINT_MOTION_LAYOUT_H

#define KIND "point_motion"
#define LAYOUT_DIGEST "689f1d908612b18a"
#define MOMENTS 12
#define CONTINUOUS 3
#define CONTINUOUS_PLACES {X_CLOCK, X_HEAT, X_WORK}

enum { P_STIFFNESS = 0, P_DAMPING = 1, P_OFFSET = 2, P_ORDER = 3, PARAMETERS = 4 };
enum { X_FRAME = 0, X_GAP = 4, X_MEMORY = 7, X_CLOCK = 10, X_HEAT = 11, X_WORK = 12, X_NUMERICAL = 13, X_LOAD = 14, X_WRENCH = 18,
       X_SLOPES = 30, STATES = 42 };
enum { U_IMPULSE = 26, U_HOLD = 27, INPUTS = 28 };
enum { Y_TIME_TO_BREAK = 12, OUTPUTS = 13 };
enum { Z_DISTANCE = 0, Z_COMMANDED_DISTANCE = 1, Z_COMMANDED_RATE = 2, Z_COMMANDED_ACCELERATION = 3, Z_MOTION_FORCE = 4,
       Z_SUPPLIED_ENERGY = 5, Z_POTENTIAL_ENERGY = 6, Z_DISSIPATED_ENERGY = 7, Z_NUMERICAL_DISSIPATION = 8, OBSERVATIONS = 9
       };
#define LAGGED_LOADS 0

#endif
