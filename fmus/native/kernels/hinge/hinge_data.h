/* Making a hinge from data that are not trusted, and its parameters: part of hinge.c. */

#ifndef FANFOLD_HINGE_DATA_H
#define FANFOLD_HINGE_DATA_H

#include "hinge_model.h"

static const VariableName PARAMETER_VARIABLES[PARAMETERS] = {
    [TRANSLATIONAL_STIFFNESS] = {"translational_stiffness", 3},
    [TRANSLATIONAL_DAMPING] = {"translational_damping", 3},
    [ROTATIONAL_STIFFNESS] = {"rotational_stiffness", 3},
    [ROTATIONAL_DAMPING] = {"rotational_damping", 3},
    [ALIGNED_ANGLE] = {"aligned_angle", 1},
    [STOWED_ANGLE] = {"stowed_angle", 1},
    [MOTOR_STIFFNESS] = {"motor_stiffness", 1},
    [MOTOR_WIND_UP] = {"motor_wind_up", 1},
    [FRICTION_COEFFICIENT] = {"friction_coefficient", 1},
    [STATIC_FRICTION_RATIO] = {"static_friction_ratio", 1},
    [PIN_RADIUS] = {"pin_radius", 1},
    [FRICTION_BENDING_ARM] = {"friction_bending_arm", 1},
    [FRICTION_PRELOAD] = {"friction_preload", 1},
    [STICTION_VELOCITY] = {"stiction_velocity", 1},
    [LATCH_ANGLE] = {"latch_angle", 1},
    [LATCH_STIFFNESS] = {"latch_stiffness", 1},
    [LATCH_DAMPING] = {"latch_damping", 1},
    [LATCH_AUTOMATIC] = {"latch_automatic", 1},
    [LOCK_MASS] = {"lock_mass", 1},
    [LOCK_INERTIA] = {"lock_inertia", 1},
    [LOCK_STIFFNESS] = {"lock_stiffness", 1},
    [HOLD_STIFFNESS] = {"hold_stiffness", 1},
    [END_WEIGHT] = {"end_weight", 1},
    [ORDER] = {"order", 1},
};

/* The laws that come from the structure. */
static int read_laws(Hinge *hinge, const Data *data, Memory *memory, Reason *why) {
    int has_harness = 0;
    if (!read_choice(data, "has_harness", 1, &has_harness, why)) return 0;
    hinge->harness = spring_law(0.0, 0.0);
    if (has_harness && !read_table(data, memory, "harness", &hinge->harness, why)) return 0;
    if (hinge->latch_kind != TABLE_LATCH) return 1;
    return read_table(data, memory, "latch", &hinge->latch, why);
}

static int find_commands(Hinge *hinge, const Data *data, const Sizes *sizes, Reason *why) {
    return find_place(data, "input", (VariableName){"latch_command", 1}, sizes->inputs, &hinge->latch_command, why) &&
           find_place(data, "input", (VariableName){"impulse", 1}, sizes->inputs, &hinge->impulse, why) &&
           find_place(data, "input", (VariableName){"hold", 1}, sizes->inputs, &hinge->hold, why) &&
           find_moments(data, "inboard.velocity_moment", hinge->endpoint ? 0 : 2, sizes, &hinge->moments, why);
}

static void *hinge_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Hinge *hinge = allocate(memory, sizeof *hinge);
    if (!hinge) {
        refuse(why, "there is no memory for a hinge");
        return NULL;
    }
    *states = STATES;
    if (!read_choice(data, "endpoint", 1, &hinge->endpoint, why)) return NULL;
    size_t pairs = hinge->endpoint ? 0 : PAIR_SIZE;
    size_t observations = OBSERVATIONS + (hinge->endpoint ? 0 : LAGGED_LOADS);
    int usable = check_sizes("hinge", sizes, 2 * MOTION_SIZE + COMMANDS + pairs, OUTPUTS + pairs, observations, why) &&
                 read_axis_frame(data, hinge->axis_frame, why) &&
                 read_choice(data, "latch_kind", KINEMATIC_LATCH, &hinge->latch_kind, why) &&
                 read_laws(hinge, data, memory, why) &&
                 find_parameters(data, PARAMETER_VARIABLES, PARAMETERS, sizes, hinge->places, why) &&
                 find_commands(hinge, data, sizes, why);
    hinge->locks = hinge->latch_kind == KINEMATIC_LATCH && !hinge->endpoint;
    return usable ? hinge : NULL;
}

/* A kinematic latch is as good as rigid, except where an explicit host cannot solve for a lock. */
static void prepare_latch(Hinge *hinge, const double *p) {
    const size_t *place = hinge->places;
    hinge->latch_angle = p[place[LATCH_ANGLE]];
    hinge->latch_automatic = p[place[LATCH_AUTOMATIC]] > 0.5;
    hinge->latch_stiffness = p[place[hinge->locks ? LOCK_STIFFNESS : LATCH_STIFFNESS]];
    hinge->latch_damping = hinge->locks ? 0.0 : p[place[LATCH_DAMPING]];
    if (hinge->latch_kind != TABLE_LATCH) hinge->latch = spring_law(hinge->latch_stiffness, 0.0);
}

static int hinge_prepare(void *self, const double *p, Reason *why) {
    Hinge *hinge = self;
    const size_t *place = hinge->places;
    int fourth = 0;
    if (!read_order(p[place[ORDER]], &fourth, why)) return 0;
    for (size_t i = 0; i < 3; i++) {
        hinge->stiffness[i] = p[place[TRANSLATIONAL_STIFFNESS] + i];
        hinge->damping[i] = p[place[TRANSLATIONAL_DAMPING] + i];
        hinge->stiffness[3 + i] = p[place[ROTATIONAL_STIFFNESS] + i];
        hinge->damping[3 + i] = p[place[ROTATIONAL_DAMPING] + i];
    }
    hinge->aligned_angle = p[place[ALIGNED_ANGLE]];
    hinge->stowed_angle = p[place[STOWED_ANGLE]];
    hinge->motor = spring_law(p[place[MOTOR_STIFFNESS]], p[place[MOTOR_WIND_UP]]);
    hinge->friction = p[place[FRICTION_COEFFICIENT]];
    hinge->static_ratio = p[place[STATIC_FRICTION_RATIO]];
    hinge->pin_radius = p[place[PIN_RADIUS]];
    hinge->bending_arm = p[place[FRICTION_BENDING_ARM]];
    hinge->friction_preload = p[place[FRICTION_PRELOAD]];
    hinge->stiction_velocity = p[place[STICTION_VELOCITY]];
    hinge->lock_mass = p[place[LOCK_MASS]];
    hinge->lock_inertia = p[place[LOCK_INERTIA]];
    hinge->hold_stiffness = p[place[HOLD_STIFFNESS]];
    hinge->end_weight = p[place[END_WEIGHT]];
    hinge->paired = fourth && hinge->end_weight == 0.5 && !hinge->endpoint;
    prepare_latch(hinge, p);
    return 1;
}

#endif
