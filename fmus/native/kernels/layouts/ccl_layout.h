/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_CCL_LAYOUT_H
#define FANFOLD_CCL_LAYOUT_H

#define KIND "ccl"
#define LAYOUT_DIGEST "80fd4d2946c26a0c"
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_RADIUS_1 = 0, P_RADIUS_2 = 1, P_PRELOAD = 2, P_STRAND_STIFFNESS = 3, P_STRAND_DAMPING = 4, P_CUT = 5, P_ORDER = 6,
       PARAMETERS = 7 };
enum { X_ANGLES = 0, X_WORKS_1 = 2, X_WORKS_2 = 5, X_SPAN = 8, X_PRELOAD_ANGLES = 11, X_PRELOAD_LENGTH = 13, X_HEAT = 14,
       X_FRAMES = 15, STATES = 23 };
enum { U_HOLD = 0, OWN_INPUTS = 1 };
enum { OWN_OUTPUTS = 0 };
enum { Z_TENSION_A = 0, Z_TENSION_B = 1, Z_TORQUE_1 = 2, Z_TORQUE_2 = 3, Z_AXIAL_FORCE = 4, Z_LATERAL_FORCE = 5,
       Z_SYNCHRONIZATION_ERROR = 6, Z_POTENTIAL_ENERGY = 7, Z_DISSIPATED_ENERGY = 8, OBSERVATIONS = 9 };
#define X_WRENCH STATES

#endif
