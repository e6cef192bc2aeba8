/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_CONTACT_LAYOUT_H
#define FANFOLD_CONTACT_LAYOUT_H

#define KIND "contact"
#define LAYOUT_DIGEST "68696795f8c7fea5"
#define NARROW 0.001
#define MOMENTS 0
#define CONTINUOUS 1
#define CONTINUOUS_PLACES {X_HEAT}

enum { P_GAP = 0, P_REFERENCE_FORCE = 1, P_REFERENCE_PENETRATION = 2, P_EXPONENT = 3, P_DAMPING = 4,
       P_FULL_DAMPING_PENETRATION = 5, PARAMETERS = 6 };
enum { X_NORMAL = 0, X_ARM = 3, X_RATE = 6, X_HEAT = 10, X_WRENCH = 11, STATES = 23 };
enum { U_IMPULSE = 26, INPUTS = 27 };
enum { OUTPUTS = 12 };
enum { Z_PENETRATION = 0, Z_CONTACT_FORCE = 1, Z_POTENTIAL_ENERGY = 2, Z_DISSIPATED_ENERGY = 3, Z_IN_CONTACT = 4,
       OBSERVATIONS = 5 };
#define LAGGED_LOADS 0

#endif
