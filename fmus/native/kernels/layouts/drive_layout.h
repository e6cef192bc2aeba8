/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_DRIVE_LAYOUT_H
#define FANFOLD_DRIVE_LAYOUT_H

#define KIND "drive"
#define LAYOUT_DIGEST "00cd32ec27679e1c"
#define SHORT 0.02
#define STEP_PROFILE 0
#define STEP5_PROFILE 1
#define COMMANDED_PROFILE 2
#define MOMENTS 12
#define CONTINUOUS 4
#define CONTINUOUS_PLACES {X_CLOCK, X_HEAT, X_WORK, X_FOLLOWED}

enum { P_STIFFNESS = 0, P_DAMPING = 1, P_ALIGNED_ANGLE = 2, P_START_ANGLE = 3, P_END_ANGLE = 4, P_START_TIME = 5, P_DURATION = 6,
       P_ORDER = 7, PARAMETERS = 8 };
enum { X_ANGLE = 0, X_FRAME = 1, X_SWING = 5, X_WRENCH = 7, X_SLOPES = 19, X_MEMORY = 31, X_CLOCK = 34, X_HEAT = 35, X_WORK = 36,
       X_SLIDE = 37, X_NUMERICAL = 41, X_LOAD = 42, X_FOLLOWED = 46, STATES = 47 };
enum { U_IMPULSE = 26, U_HOLD = 27, INPUTS = 28 };
enum { OUTPUTS = 12 };
enum { Z_ANGLE = 0, Z_ANGULAR_RATE = 1, Z_COMMANDED_ANGLE = 2, Z_COMMANDED_RATE = 3, Z_DRIVE_TORQUE = 4, Z_SUPPLIED_ENERGY = 5,
       Z_POTENTIAL_ENERGY = 6, Z_DISSIPATED_ENERGY = 7, Z_NUMERICAL_DISSIPATION = 8, OBSERVATIONS = 9 };
#define LAGGED_LOADS 0

#endif
