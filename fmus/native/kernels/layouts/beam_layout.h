/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_BEAM_LAYOUT_H
#define FANFOLD_BEAM_LAYOUT_H

#define KIND "beam"
#define LAYOUT_DIGEST "021896e41b07f93f"
#define CONTINUOUS 0
#define CONTINUOUS_PLACES {0}

enum { P_INITIAL_POSITION = 0, P_INITIAL_ORIENTATION = 3, P_INITIAL_VELOCITY = 7, P_INITIAL_ANGULAR_VELOCITY = 10,
       P_GRAVITY = 13, P_STIFFNESS_DAMPING = 16, PARAMETERS = 17 };
enum { X_HEAT = 0, STATES = 1 };
enum { OWN_INPUTS = 0 };
enum { OWN_OUTPUTS = 0 };
enum { Z_LINEAR_MOMENTUM = 0, Z_ANGULAR_MOMENTUM = 3, Z_KINETIC_ENERGY = 6, Z_POTENTIAL_ENERGY = 7, Z_DISSIPATED_ENERGY = 8,
       OBSERVATIONS = 9 };
#define P_INITIAL_DISPLACEMENT PARAMETERS
#define X_POSITION STATES
#define Z_NODE_POSITION OBSERVATIONS

#endif
