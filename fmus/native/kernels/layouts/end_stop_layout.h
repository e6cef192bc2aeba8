/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_END_STOP_LAYOUT_H
#define FANFOLD_END_STOP_LAYOUT_H

#define KIND "end_stop"
#define LAYOUT_DIGEST "c7a9a8c6f248542e"
#define MOMENTS 12
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_STOP_ANGLE = 0, P_STIFFNESS = 1, P_DAMPING = 2, P_FULL_DAMPING_PENETRATION = 3, P_ALIGNED_ANGLE = 4,
       P_STOWED_ANGLE = 5, P_ORDER = 6, PARAMETERS = 7 };
enum { X_ANGLE = 0, X_FRAME = 1, X_SWING = 5, X_WRENCH = 7, X_SLOPES = 19, X_MEMORY = 31, X_HEAT = 34, X_SLIDE = 35, X_LOAD = 39,
       X_NUMERICAL = 43, X_FAILED = 44, X_FAILURE_HEAT = 45, STATES = 46 };
enum { U_FAILURE_COMMAND = 26, U_IMPULSE = 27, INPUTS = 28 };
enum { OUTPUTS = 12 };
enum { Z_PENETRATION = 0, Z_ANGULAR_RATE = 1, Z_STOP_TORQUE = 2, Z_POTENTIAL_ENERGY = 3, Z_DISSIPATED_ENERGY = 4,
       Z_NUMERICAL_DISSIPATION = 5, Z_IN_CONTACT = 6, OBSERVATIONS = 7 };
#define LAGGED_LOADS 0

#endif
