/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_TAPE_HINGE_LAYOUT_H
#define FANFOLD_TAPE_HINGE_LAYOUT_H

#define KIND "tape_hinge"
#define LAYOUT_DIGEST "09c1232cbe1f5567"
#define REACHED 1e-09
#define MOST_SNAPS 3
#define MOMENTS 12
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_DAMPING = 0, P_STOWED_ANGLE = 1, P_ORDER = 2, PARAMETERS = 3 };
enum { X_ANGLE = 0, X_FRAME = 1, X_SWING = 5, X_WRENCH = 7, X_SLOPES = 19, X_MEMORY = 31, X_HEAT = 34, X_SLIDE = 35, X_FOLD = 39,
       X_SNAP_HEAT = 40, X_NUMERICAL = 41, STATES = 42 };
enum { U_IMPULSE = 26, INPUTS = 27 };
enum { OUTPUTS = 12 };
enum { Z_ANGLE = 0, Z_ANGULAR_RATE = 1, Z_TAPE_TORQUE = 2, Z_STRAIGHT = 3, Z_POTENTIAL_ENERGY = 4, Z_DISSIPATED_ENERGY = 5,
       Z_NUMERICAL_DISSIPATION = 6, OBSERVATIONS = 7 };
#define LAGGED_LOADS 0

#endif
