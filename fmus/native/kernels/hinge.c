/* Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch: the twin of
   components/hinge.py. */

#include "hinge_step.h"
#include "hinge_exchange.h"

#ifndef FANFOLD_COMPLEX

#include "hinge_data.h"

int hinge_step_complex(void *self, const double *x, const double complex *u, double h, double complex *x_next,
                       Reason *why);
void hinge_outputs_complex(void *self, const double complex *x, const double complex *u, double complex *y);

/* Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle. */
static int hinge_initial(void *self, const double *u, double *x, Reason *why) {
    const Hinge *hinge = self;
    (void)why;
    Motion motion = hinge_motion(hinge, u, hinge->stowed_angle);
    for (int i = 0; i < STATES; i++) x[i] = 0.0;
    store_motion(&motion, x);
    store_rates_after_impulse(&motion, x);
    store_mid_step_slope_start(motion.rates[HINGE_ANGLE], x + SLIDING);
    x[HOLD_ANGLE] = motion.coordinates[HINGE_ANGLE];
    return 1;
}

/* Energy in bushing, motor, harness, latch and hold. */
static double stored_energy(const Hinge *hinge, const Grip *grip, const double *coordinates) {
    double angle = coordinates[HINGE_ANGLE], energy = 0.0;
    for (int i = 0; i < COORDINATE_COUNT; i++) {
        double deflection = i == HINGE_ANGLE ? coordinates[i] - hinge->aligned_angle : coordinates[i];
        energy += 0.5 * hinge->stiffness[i] * deflection * deflection;
    }
    energy += law_potential(&hinge->motor, angle) + law_potential(&hinge->harness, angle);
    if (latch_acts(hinge, grip))
        energy += law_potential(&hinge->latch, angle - grip->latched_angle) - law_potential(&hinge->latch, 0.0);
    if (grip->holding != 0.0) {
        double held = angle - grip->hold_angle;
        energy += 0.5 * hinge->hold_stiffness * held * held;
    }
    return energy;
}

/* At order 4, from what bushing and latch did over the last steps. */
static void correct(const double *x, Held *held) {
    for (int i = 0; i < COORDINATE_COUNT; i++)
        held->bushing[i] = load_with_slopes_now(x + load_place(i), held->bushing[i], x[ROUGHNESS + i]);
    held->latch = load_with_slopes_now(x + load_place(LATCH_LOAD), held->latch, x[ROUGHNESS + HINGE_ANGLE]);
}

/* Latch torque, axial and radial force at the communication point before the last step. */
static void store_lagged_loads(const double *x, double *z) {
    double y = mid_step_slope_before(x + load_place(1)), across = mid_step_slope_before(x + load_place(2));
    z[0] = mid_step_slope_before(x + load_place(LATCH_LOAD));
    z[1] = mid_step_slope_before(x + load_place(0));
    z[2] = sqrt(y * y + across * across);
}

/* Angles, torques and forces at the communication point, and energies. Loads follow from the end-point law, at order 4
   corrected by what the last steps' loads were. */
static void hinge_observe(void *self, const double *x, const double *u, double *z) {
    const Hinge *hinge = self;
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    /* in a mean wrench a command acts from the next step's start, which is this instant */
    Grip grip = hinge->endpoint ? present_grip(hinge, x, u) : commanded_grip(hinge, x, u);
    double angle = now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (!hinge->endpoint) {
        memcpy(now.rates, x + (hinge->paired ? END_RATES : MEAN_RATES), sizeof now.rates);
        now.rates[HINGE_ANGLE] = hinge->paired ? mid_step_slope_now(x + SLIDING) : mid_step_now(x + SLIDE);
    }
    Held held = held_at(hinge, &grip, now.coordinates, now.rates);
    if (hinge->paired) correct(x, &held);
    Loads loads = instant_loads(hinge, &grip, now.coordinates, now.rates, &held);
    z[0] = angle;
    z[1] = rate;
    z[2] = law_value(&hinge->motor, angle);
    z[3] = law_value(&hinge->harness, angle);
    z[4] = loads.friction_torque;
    z[5] = loads.latch_torque;
    z[6] = loads.force.x;
    z[7] = sqrt(loads.force.y * loads.force.y + loads.force.z * loads.force.z);
    z[8] = sqrt(loads.torque.y * loads.torque.y + loads.torque.z * loads.torque.z);
    z[9] = law_potential(&hinge->motor, hinge->stowed_angle) - law_potential(&hinge->motor, angle);
    for (int i = 0; i < HEAT_CAUSES; i++) z[10 + i] = x[HEAT + i];
    z[13] = stored_energy(hinge, &grip, now.coordinates);
    z[14] = x[HEAT] + x[HEAT + 1] + x[HEAT + 2];
    z[15] = x[NUMERICAL];
    if (!hinge->endpoint) store_lagged_loads(x, z + OBSERVATIONS);
}

/* Time until the latch angle is reached at the present rate; in end-point mode only does a latch engage by itself. */
static double hinge_next_event(void *self, const double *x, const double *u) {
    const Hinge *hinge = self;
    Grip grip = commanded_grip(hinge, x, u);
    if (!hinge->endpoint || !awaits_latch(hinge, &grip)) return INFINITY;
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    double ahead = hinge->latch_angle - now.coordinates[HINGE_ANGLE], rate = now.rates[HINGE_ANGLE];
    if (ahead <= 0.0) return 0.0;
    return rate > 0.0 ? ahead / rate : INFINITY;
}

/* Commands act, and a latch that is due engages at its angle; from here on it gives off its own heat. */
static void hinge_event(void *self, const double *x, const double *u, int due, double *x_next) {
    const Hinge *hinge = self;
    memcpy(x_next, x, STATES * sizeof(double));
    if (!hinge->endpoint) return;
    Grip grip = commanded_grip(hinge, x, u);
    Motion now = hinge_motion(hinge, u, x[COORDINATES + HINGE_ANGLE]);
    latch_if_reached(hinge, &grip, due || now.coordinates[HINGE_ANGLE] >= hinge->latch_angle);
    store_grip(&grip, x_next);
    Loads loads = endpoint_loads(hinge, &grip, now.coordinates, now.rates);
    for (int i = 0; i < HEAT_CAUSES; i++) x_next[POWER + i] = loads.heat[i];
}

const Kernel hinge_kernel = {
    "hinge",       hinge_create,       hinge_prepare,         hinge_initial,    hinge_step_real, hinge_outputs_real,
    hinge_observe, hinge_step_complex, hinge_outputs_complex, hinge_next_event, hinge_event,
    .continuous = hinge_continuous,
    .rates = hinge_rates_real,
    .rates_complex = hinge_rates_complex,
    .indicators = hinge_indicators,
    .update = hinge_update,
};

#endif
