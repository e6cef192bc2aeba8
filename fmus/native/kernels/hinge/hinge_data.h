/* Making a hinge from data that are not trusted, and its parameters: part of hinge.c. */

#ifndef FANFOLD_HINGE_DATA_H
#define FANFOLD_HINGE_DATA_H

#include "hinge_model.h"

/* The table of a name where `has_<name>` says so, else a law of no torque. */
static int read_optional_table(const Data *data, Memory *memory, const char *name, Law *law, Reason *why) {
    char switch_name[64];
    int has = 0;
    snprintf(switch_name, sizeof switch_name, "has_%s", name);
    *law = spring_law(0.0, 0.0);
    return read_choice(data, switch_name, 1, &has, why) && (!has || read_table(data, memory, name, law, why));
}

/* The laws that come from the structure. */
static int read_laws(Hinge *hinge, const Data *data, Memory *memory, Reason *why) {
    if (!read_optional_table(data, memory, "motor", &hinge->motor, why)) return 0;
    if (!read_optional_table(data, memory, "harness", &hinge->harness, why)) return 0;
    if (!read_optional_table(data, memory, "hysteresis", &hinge->hysteresis, why)) return 0;
    const double *play = data_array(data, "latch_play", 2, why);
    if (!play) return 0;
    memcpy(hinge->play, play, sizeof hinge->play);
    if (hinge->latch_kind != TABLE_LATCH) return 1;
    return read_table(data, memory, "latch", &hinge->latch, why);
}

static void *hinge_create(const Data *data, const Sizes *sizes, Memory *memory, size_t *states, Reason *why) {
    Hinge *hinge = create_connection(data, sizes, memory, sizeof *hinge, states, why);
    if (!hinge || !read_axis_frame(data, hinge->axis_frame, why) ||
        !read_choice(data, "latch_kind", KINEMATIC_LATCH, &hinge->latch_kind, why) ||
        !read_laws(hinge, data, memory, why))
        return NULL;
    hinge->locks = hinge->latch_kind == KINEMATIC_LATCH && !hinge->base.endpoint;
    return hinge;
}

/* Clearances of coordinates that have stiffness, which then is theirs. */
static int read_clearances(Hinge *hinge, const double *p, Reason *why) {
    static const char *const names[] = {"axial", "radial", "twist", "cross"};
    static const int first[CLEARANCE_COUNT + 1] = {0, 1, HINGE_ANGLE, 4, COORDINATE_COUNT};
    hinge->loose = 0;
    for (int k = 0; k < CLEARANCE_COUNT; k++) {
        const double size = p[P_AXIAL_CLEARANCE + k];
        if (size == 0.0) continue;
        Clearance *one = hinge->clearances + hinge->loose++;
        *one = (Clearance){.size = size};
        for (int i = first[k]; i < first[k + 1]; i++) {
            if (hinge->stiffness[i] == 0.0) continue;
            if (one->count && (one->stiffness != hinge->stiffness[i] || one->damping != hinge->damping[i]))
                return refuse(why, "%s_clearance needs equal stiffness, and equal damping, along both cross axes", names[k]);
            one->stiffness = hinge->stiffness[i];
            one->damping = hinge->damping[i];
            one->members[one->count++] = i;
            hinge->stiffness[i] = hinge->damping[i] = 0.0;
        }
        if (!one->count)
            return refuse(why, "%s_clearance is %g, but the joint has no stiffness there; give it some", names[k], size);
    }
    return 1;
}

/* A kinematic latch is as good as rigid, except where an explicit host cannot solve for a lock. */
static int hinge_prepare(void *self, const double *p, Reason *why) {
    Hinge *hinge = self;
    for (int i = 0; i < 3; i++) {
        hinge->stiffness[i] = p[P_TRANSLATIONAL_STIFFNESS + i];
        hinge->damping[i] = p[P_TRANSLATIONAL_DAMPING + i];
        hinge->stiffness[3 + i] = p[P_ROTATIONAL_STIFFNESS + i];
        hinge->damping[3 + i] = p[P_ROTATIONAL_DAMPING + i];
    }
    if (!read_clearances(hinge, p, why)) return 0;
    if (hinge->motor.kind != TABLE_LAW) {
        hinge->motor = spring_law(p[P_MOTOR_STIFFNESS], p[P_MOTOR_WIND_UP]);
        hinge->motor.constant = p[P_MOTOR_CONSTANT_TORQUE];
    }
    hinge->latch_stiffness = p[hinge->locks ? P_LOCK_STIFFNESS : P_LATCH_STIFFNESS];
    hinge->latch_damping = p[hinge->locks ? P_LOCK_DAMPING : P_LATCH_DAMPING];
    if (hinge->latch_kind != TABLE_LATCH) hinge->latch = spring_law(hinge->latch_stiffness, 0.0);
    return prepare_connection(self, p, p[P_ORDER], why);
}

#endif
