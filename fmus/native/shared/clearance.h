/* Spring and damper of a joint that act beyond a clearance, along one coordinate or in the plane of a round hole: the twin
   of components/numerics/clearance.py, which says why. */

#ifndef FANFOLD_CLEARANCE_H
#define FANFOLD_CLEARANCE_H

#include "frames.h"
#include "workless.h"

/* Clearance (m, rad) of `count` coordinates, none to two, with stiffness and damping beyond it. */
typedef struct Clearance {
    int count, members[2];
    double size, stiffness, damping;
} Clearance;

/* Two coordinates; the second one is 0 where there is but one. */
typedef struct Planar {
    real v[2];
} Planar;

static inline real planar_dot(Planar a, Planar b) { return a.v[0] * b.v[0] + a.v[1] * b.v[1]; }
static inline real planar_size(Planar a) { return root_of_squares(planar_dot(a, a)); }

static inline Planar own_values(const Clearance *c, const real *values) {
    Planar own = {{values[c->members[0]], 0.0}};
    if (c->count > 1) own.v[1] = values[c->members[1]];
    return own;
}

static inline real beyond_clearance(const Clearance *c, real distance) { return above(distance - c->size, 0.0); }

/* A symmetric matrix with one value along q and one around the middle, times v. */
static inline Planar resisted(Planar q, real around, real along, Planar v) {
    const real square = planar_dot(q, q);
    real radial = 0.0;
    if (value_of(square) > 0.0) radial = (along - around) * planar_dot(q, v) / square;
    return (Planar){{around * v.v[0] + radial * q.v[0], around * v.v[1] + radial * q.v[1]}};
}

/* Force against the damper's rates, at the direction of q; turning: the share of q that the deflection is. */
static inline Planar braking(const Clearance *c, Planar q, real turning, real factor, Planar rates) {
    const real damping = factor * c->damping;
    return resisted(q, damping * turning * turning, damping, rates);
}

/* Energy at the coordinates of a joint. */
static inline real clearance_potential(const Clearance *c, const real *coordinates) {
    const real deep = beyond_clearance(c, planar_size(own_values(c, coordinates)));
    return 0.5 * c->stiffness * deep * deep;
}

/* Adds the force of an instant along every member; the power (W) of the damper. */
static inline real add_clearance_force(const Clearance *c, const real *coordinates, const real *rates, real *force) {
    const Planar q = own_values(c, coordinates), w = own_values(c, rates);
    const real distance = planar_size(q), deep = beyond_clearance(c, distance);
    if (!(value_of(deep) > 0.0)) return 0.0;
    const Planar viscous = braking(c, q, deep / distance, 1.0, w);
    for (int i = 0; i < c->count; i++)
        force[c->members[i]] += -(c->stiffness * deep / distance) * q.v[i] - viscous.v[i];
    return planar_dot(viscous, w);
}

/* Loads over a step along every member, of either order. */
static inline void clearance_loads(const Clearance *c, const StepMotion *motions, int paired, MeanLoad *loads) {
    Planar start = {{0.0}}, end = {{0.0}}, change, middle, moment = {{0.0}};
    const double h = motions[c->members[0]].h, play[2] = {-c->size, c->size};
    double roughness = 0.0;
    for (int i = 0; i < c->count; i++) {
        const StepMotion *own = motions + c->members[i];
        start.v[i] = own->start, end.v[i] = own->end, moment.v[i] = own->moment;
        if (own->roughness > roughness) roughness = own->roughness;
    }
    for (int i = 0; i < 2; i++) {
        change.v[i] = end.v[i] - start.v[i];
        middle.v[i] = start.v[i] + end.v[i];
    }
    const real r0 = planar_size(start), r1 = planar_size(end), total = r0 + r1;
    const real deep = beyond_clearance(c, r0) + beyond_clearance(c, r1);
    const int touches = value_of(deep) > 0.0;
    real around = 0.0, along = 0.0, across = 0.0;
    Planar viscous = {{0.0}}, lasting = {{0.0}};
    if (touches) {
        along = c->stiffness * share_beyond(play, r0, r1);
        around = along * deep / total;
        across = (along - around) / (6.0 * total * total);
        const real share = share_beyond(play, value_of(planar_dot(start, end)) < 0.0 ? -r0 : r0, r1);
        viscous = braking(c, middle, deep / total, share / h, change);
        lasting = braking(c, middle, deep / total, 3.0 * share / h, moment);
    }
    const Planar bent = resisted(middle, around, along, moment), turned = resisted(middle, around, along, change);
    const real inward = planar_dot(middle, change), square = planar_dot(change, change);
    const double rough = 3.0 * NUMERICAL_DAMPING * roughness;
    for (int i = 0; i < c->count; i++) {
        const real elastic = -0.5 * around * middle.v[i], moved = change.v[i];
        MeanLoad *load = loads + c->members[i];
        if (paired) {
            load->force = elastic - across * (inward * moved - square * middle.v[i]) + 0.5 * bent.v[i] - viscous.v[i];
            load->heat = viscous.v[i] * moved + lasting.v[i] * moment.v[i];
            load->numerical = rough * bent.v[i] * moment.v[i];
            load->slope = -0.5 * turned.v[i] - lasting.v[i] - rough * bent.v[i];
        } else {
            const real numerical = inertial_force(c->stiffness, motions + c->members[i]);
            *load = (MeanLoad){elastic - viscous.v[i] + numerical, viscous.v[i] * moved, -numerical * moved, 0.0};
        }
    }
}

#endif
