/* Friction of a hinge: pin and constant friction and the hysteresis of its laws, sticking or smooth at rest: part of
   hinge.c, of either number type. */

#ifndef FANFOLD_HINGE_FRICTION_H
#define FANFOLD_HINGE_FRICTION_H

#include "hinge_model.h"

/* Friction that is static or dynamic, and friction that is the same at any rate. */
typedef struct Magnitudes {
    real of_pin, constant;
} Magnitudes;

/* Coulomb torque mu r_p F_r, and T_pre (Bagnoli 2007, eq 2.2) with half the width of the hysteresis. */
static inline Magnitudes friction_magnitudes(const Hinge *hinge, const Grip *grip, const real *load, real angle) {
    const double *p = hinge->base.p;
    Magnitudes found = {0.0, grip->latched > 0.5 ? 0.0 : p[P_FRICTION_PRELOAD]};
    if (hinge->hysteresis.kind == TABLE_LAW) found.constant += above(law_value(&hinge->hysteresis, angle), 0.0);
    if (p[P_FRICTION_COEFFICIENT] == 0.0) return found;
    real square = load[1] * load[1] + load[2] * load[2];
    real normal = square / real_sqrt(square + FORCE_SMOOTHING * FORCE_SMOOTHING);
    if (p[P_FRICTION_BENDING_ARM] > 0.0)
        normal += root_of_squares(load[4] * load[4] + load[5] * load[5]) / p[P_FRICTION_BENDING_ARM];
    found.of_pin = p[P_FRICTION_COEFFICIENT] * p[P_PIN_RADIUS] * normal;
    return found;
}

/* Torque against a sliding rate, with its heat over a motion or as power of a rate. */
static inline Presliding smooth_friction(const Hinge *hinge, Magnitudes found, real rate, real motion) {
    const double *p = hinge->base.p;
    if (value_of(found.of_pin) == 0.0 && value_of(found.constant) == 0.0) return (Presliding){0.0, 0.0, 0.0, 0.0};
    StictionFactors factors = stiction_factors(rate, p[P_STICTION_VELOCITY], p[P_STATIC_FRICTION_RATIO]);
    real torque = -(found.of_pin * factors.dynamic + found.constant * factors.constant);
    return (Presliding){torque, -torque * motion, 0.0, 0.0};
}

/* Torque that friction does not exceed at a rate. */
static inline real largest_friction(const Hinge *hinge, Magnitudes found, real rate) {
    const double *p = hinge->base.p;
    return found.of_pin * static_factor(rate, p[P_STICTION_VELOCITY], p[P_STATIC_FRICTION_RATIO]) + found.constant;
}

/* No torque while the angle is held, but the deflection with which friction then takes over what it can. */
static inline Presliding taking_over(const Hinge *hinge, Magnitudes found, real held) {
    const double *p = hinge->base.p;
    real torque = within(p[P_HOLD_STIFFNESS] * held, largest_friction(hinge, found, 0.0));
    return (Presliding){0.0, 0.0, torque / p[P_PRESLIDING_STIFFNESS], 0.0};
}

/* Torque over a step, positive opening, with its slope: friction at both points of Gauss' rule, along lines of the
   bushing's loads and of the rate. */
static inline Presliding step_friction(const Hinge *hinge, const Grip *grip, const StiffLoads *stiff,
                                       const StepMotion *turn) {
    const double *p = hinge->base.p;
    const real angle = 0.5 * (turn->start + turn->end), change = turn->end - turn->start;
    const real moment = hinge->base.paired ? turn->moment : 0.0;
    const int sticks = p[P_PRESLIDING_STIFFNESS] != 0.0;
    real rates[2], torques[2];
    gauss_rates(change, moment, turn->h, rates);
    Magnitudes found;
    for (int k = 0; k < 2; k++) {
        const double place = k ? sqrt(1.0 / 3.0) : -sqrt(1.0 / 3.0);
        real load[COORDINATE_COUNT];
        for (int i = 0; i < COORDINATE_COUNT; i++)
            load[i] = stiff->bushing[i].force + place * stiff->bushing[i].slope;
        found = friction_magnitudes(hinge, grip, load, angle);
        torques[k] = sticks ? largest_friction(hinge, found, rates[k]) : smooth_friction(hinge, found, rates[k], 0.0).force;
    }
    if (!sticks) {
        const MeanLoad smooth = viscous_load(rates, torques, turn->h);
        return (Presliding){smooth.force, smooth.heat, 0.0, smooth.slope};
    }
    if (grip->holding != 0.0) return taking_over(hinge, found, turn->end - grip->hold_angle);
    const real mean = 0.5 * (torques[0] + torques[1]), slope = 0.5 * sqrt(3.0) * (torques[1] - torques[0]);
    return step_force(p[P_PRESLIDING_STIFFNESS], p[P_PRESLIDING_DAMPING], mean, slope, grip->presliding, change, moment,
                      turn->h);
}

/* Torque of one instant; heat as power. */
static inline Presliding instant_friction(const Hinge *hinge, const Grip *grip, const real *load, real angle, real rate) {
    const double *p = hinge->base.p;
    Magnitudes found = friction_magnitudes(hinge, grip, load, angle);
    if (p[P_PRESLIDING_STIFFNESS] == 0.0) return smooth_friction(hinge, found, rate, rate);
    if (grip->holding != 0.0) return taking_over(hinge, found, angle - grip->hold_angle);
    return instant_force(p[P_PRESLIDING_STIFFNESS], p[P_PRESLIDING_DAMPING], largest_friction(hinge, found, rate),
                         grip->presliding, rate);
}

/* Deflection with which friction that sticks holds what motor, harness and joint do at an angle, as far as it can: of the
   friction, what is there without loads on the pin. */
static inline real starting_deflection(const Hinge *hinge, real angle) {
    const double *p = hinge->base.p;
    const Grip free = {0.0, 0.0, 0.0, 0.0, 0.0, 0};
    const real none[COORDINATE_COUNT] = {0.0};
    if (p[P_PRESLIDING_STIFFNESS] == 0.0) return 0.0;
    real driving = law_value(&hinge->motor, angle) + law_value(&hinge->harness, angle) -
                   hinge->stiffness[HINGE_ANGLE] * (angle - p[P_ALIGNED_ANGLE]);
    real turn[COORDINATE_COUNT] = {0.0}, held[COORDINATE_COUNT] = {0.0};
    turn[HINGE_ANGLE] = angle - p[P_ALIGNED_ANGLE];
    for (int k = 0; k < hinge->loose; k++) add_clearance_force(hinge->clearances + k, turn, none, held);
    driving += held[HINGE_ANGLE];
    real most = largest_friction(hinge, friction_magnitudes(hinge, &free, none, angle), 0.0);
    return within(driving, most) / p[P_PRESLIDING_STIFFNESS];
}

#endif
