/* Friction that sticks: an elastic deflection before sliding, whose force never exceeds the friction: the twin of
   components/numerics/presliding.py, which says why. */

#ifndef FANFOLD_PRESLIDING_H
#define FANFOLD_PRESLIDING_H

#include "real.h"

/* Force on the body, its heat (over a step, or as power of an instant), deflection, and slope of the force over a step. */
typedef struct Presliding {
    real force, heat, deflection, slope;
} Presliding;

/* The motion over a step and the friction along it, at the time t from 0 to 1: rate start + bend t (per step), largest
   deflection limit + growth t. damping: of the contact, over its stiffness and the step size. */
typedef struct Rubbing {
    real start, bend, limit, growth, damping;
} Rubbing;

/* Of the largest deflection: a motion that is none, and a deflection from which on a contact without motion has the
   derivative of one that slides. */
#define NO_MOTION 1e-9
#define NEAR_FRICTION 0.9

/* The value, at most the limit in size. */
static inline real within(real value, real limit) {
    if (value_of(value) > value_of(limit)) return limit;
    if (value_of(value) < -value_of(limit)) return -limit;
    return value;
}

/* Where c + b x + a x^2 / 2, not positive at first, becomes positive; beyond a step where it does not. */
static inline real rising_through_zero(real c, real b, real a) {
    const real square = b * b - 2.0 * a * c;
    if (value_of(b) > 0.0 && value_of(square) >= 0.0) return -2.0 * c / (b + real_sqrt(square));
    if (value_of(b) <= 0.0 && value_of(a) > 0.0) return (real_sqrt(square) - b) / a;
    return 2.0;
}

/* Adds the zeros of c + b x + a x^2 / 2 within a length to those found, in order. */
static inline int with_zeros(real c, real b, real a, real length, real *zeros, int count) {
    const real square = b * b - 2.0 * a * c;
    if (value_of(square) < 0.0) return count;
    const real root = real_sqrt(square), q = value_of(b) >= 0.0 ? -(b + root) : root - b;
    const real found[2] = {value_of(q) != 0.0 ? 2.0 * c / q : length, value_of(a) != 0.0 ? q / a : length};
    for (int k = 0; k < 2; k++) {
        if (!(value_of(found[k]) > 0.0 && value_of(found[k]) < value_of(length))) continue;
        int place = count++;
        for (; place > 0 && value_of(zeros[place - 1]) > value_of(found[k]); place--) zeros[place] = zeros[place - 1];
        zeros[place] = found[k];
    }
    return count;
}

/* Adds a stretch on which the deflection is z[0] + z[1] x + z[2] x^2 / 2: by Gauss' rule with two points on every part
   where the force is a polynomial. */
static inline void add_stretch(const Rubbing *r, real from, real length, const real z[3], Presliding *sum) {
    const real rate = r->start + r->bend * from, limit = r->limit + r->growth * from;
    const real c = z[0] + r->damping * rate, b = z[1] + r->damping * r->bend;
    real cuts[6] = {0.0};
    int count = with_zeros(c - limit, b - r->growth, z[2], length, cuts + 1, 0);
    count = with_zeros(c + limit, b + r->growth, z[2], length, cuts + 1, count);
    cuts[count + 1] = length;
    for (int i = 0; i <= count; i++) {
        const real half = 0.5 * (cuts[i + 1] - cuts[i]), middle = 0.5 * (cuts[i + 1] + cuts[i]);
        for (int side = -1; side <= 1; side += 2) {
            const real x = middle + side * sqrt(1.0 / 3.0) * half, slipping = rate + r->bend * x;
            const real deflection = z[0] + (z[1] + 0.5 * z[2] * x) * x;
            const real force = within(deflection + r->damping * slipping, limit + r->growth * x);
            sum->force -= half * force;
            sum->slope -= 3.0 * half * (2.0 * (from + x) - 1.0) * force;
            sum->heat += half * (force * slipping - deflection * (z[1] + z[2] * x));
        }
    }
}

/* Whether the contact slides towards a side, where its deflection is the largest. */
static inline int slides_on(const Rubbing *r, real from, int side) {
    const double faster = side * value_of(r->start + r->bend * from) - value_of(r->growth);
    return faster > 0.0 || (faster == 0.0 && side * value_of(r->bend) >= 0.0);
}

/* Mean force over a step of size h with its slope, and the deflection at its end; the friction has a slope too. */
static inline Presliding step_force(double stiffness, double damping, real friction, real friction_slope,
                                    real deflection, real change, real moment, double h) {
    if (fabs(value_of(friction_slope)) > value_of(friction))
        friction_slope = value_of(friction_slope) > 0.0 ? friction : -friction;
    Rubbing r = {change - 3.0 * moment, 6.0 * moment, (friction - friction_slope) / stiffness,
                 2.0 * friction_slope / stiffness, damping / (stiffness * h)};
    real from = 0.0, z = within(deflection, r.limit);
    const double most = value_of(r.limit);
    const int holds = fabs(value_of(z)) <= most + fmin(value_of(r.growth), 0.0);
    if (fabs(value_of(change)) + fabs(value_of(moment)) <= NO_MOTION * most && fabs(value_of(z)) >= NEAR_FRICTION * most && holds) {
        r.limit = value_of(z) < 0.0 ? -z : z;
        r.growth = 0.0;
    }
    Presliding sum = {0.0, 0.5 * (deflection * deflection - z * z), 0.0, 0.0};
    int side = 0, left = 0;
    if (value_of(z) >= value_of(r.limit) && slides_on(&r, from, 1)) side = 1;
    else if (value_of(z) <= -value_of(r.limit) && slides_on(&r, from, -1)) side = -1;
    for (int stretch = 0; stretch < 6 && value_of(from) < 1.0; stretch++) {
        const real rate = r.start + r.bend * from, limit = r.limit + r.growth * from;
        real length = 1.0 - from;
        if (side != 0) {
            const real turn = side * value_of(r.bend) < 0.0 ? (side * r.growth - rate) / r.bend : length;
            if (value_of(turn) < value_of(length)) length = turn;
            add_stretch(&r, from, length, (real[3]){side * limit, side * r.growth, 0.0}, &sum);
            z = side * (limit + r.growth * length);
            left = side;
            side = 0;
        } else {
            for (int barrier = -1; barrier <= 1; barrier += 2) {
                if (barrier == left) continue;
                const real hit = rising_through_zero(barrier * z - limit, barrier * rate - r.growth, barrier * r.bend);
                if (value_of(hit) < value_of(length)) length = hit, side = barrier;
            }
            add_stretch(&r, from, length, (real[3]){z, rate, r.bend}, &sum);
            z += (rate + 0.5 * r.bend * length) * length;
        }
        from += length;
    }
    return (Presliding){stiffness * sum.force, stiffness * sum.heat, z, stiffness * sum.slope};
}

/* Force of one instant. */
static inline Presliding instant_force(double stiffness, double damping, real friction, real deflection, real rate) {
    const real held = within(deflection, friction / stiffness);
    const real force = -within(stiffness * held + damping * rate, friction);
    const int slides = value_of(held) * value_of(rate) > 0.0 && stiffness * fabs(value_of(held)) >= value_of(friction);
    real heat = -force * rate;
    if (!slides) heat -= stiffness * held * rate;
    return (Presliding){force, heat, held, 0.0};
}

#endif
