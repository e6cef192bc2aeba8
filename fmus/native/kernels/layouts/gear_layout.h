/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_GEAR_LAYOUT_H
#define FANFOLD_GEAR_LAYOUT_H

#define KIND "gear"
#define LAYOUT_DIGEST "0b80b5bb7f4832a4"
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_RATIO = 0, P_STIFFNESS = 1, P_DAMPING = 2, P_PLAY = 3, P_ORDER = 4, PARAMETERS = 5 };
enum { X_SEATS = 0, X_START = 20, X_MEMORY = 21, X_HEAT = 24, X_SLIDE = 25, X_NUMERICAL = 29, STATES = 30 };
enum { U_IMPULSE = 0, OWN_INPUTS = 1 };
enum { OWN_OUTPUTS = 0 };
enum { Z_FIRST_ANGLE = 0, Z_SECOND_COORDINATE = 1, Z_GEAR_TORQUE = 2, Z_POTENTIAL_ENERGY = 3, Z_DISSIPATED_ENERGY = 4,
       Z_NUMERICAL_DISSIPATION = 5, OBSERVATIONS = 6 };
#define X_WRENCH STATES

#endif
