"""Friction that sticks: an elastic deflection before sliding, whose force never exceeds the friction.

A spring and a damper in series with a Coulomb slider: the contact deflects by z with the motion s of its body until
the force reaches the friction F, and then slides (an elasto-plastic model without its blend, Dupont, Hayward,
Armstrong and Altpeter 2002; Prandtl's element). Unlike in the models of Dahl and LuGre, nothing slides below the
friction, so that a load that swings causes no drift:

    force = -(k z + c s'), at most F in size;   z' = s', but k z never exceeds F.

Over a step the rate s' is linear in time (order 4), and so is F. The step then consists of at most five
stretches on which the contact sticks or slides, and of parts on which the force is a quadratic of time. Mean, slope
and heat of the force are their exact integrals: sticking is as accurate as a spring of order 4, sliding as friction of
order 4, and breaking away and turning around within a step cost no accuracy. The work is that of the force along the
path, and the heat k z (s' - z') + (force - k z) s' is nowhere negative, so the law cannot generate energy. The mean
force is continuous in the motion. A damper, or friction that falls, lets the spring go down to the friction, which is
heat too.

Without motion the derivative is that of a spring, but near the friction that of sliding: a line that just latches has
slid up to there.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

_NEVER = 2.0
_GAUSS = sqrt(1.0 / 3.0)
_MOST_STRETCHES = 6
_STILL, _NEAR = 1e-9, 0.9
"""Of the largest deflection: a motion that is none, and that from which on the derivative is of sliding."""


class Presliding(NamedTuple):
    """Force on the body (N, N.m), heat (J over a step, W of an instant), deflection (m, rad), slope of the force."""

    force: float
    heat: float
    deflection: float
    slope: float = 0.0


def within(value: float, limit: float) -> float:
    """The value, at most the limit in size."""
    return max(-limit, min(limit, value))


class _Rubbing(NamedTuple):
    """Motion and friction over a step, by the time t from 0 to 1.

    start, bend: the rate of the motion per step is start + bend t. limit, growth: the largest deflection is
    limit + growth t. damping: of the contact, over its stiffness and the step size.
    """

    start: float
    bend: float
    limit: float
    growth: float
    damping: float

    def rate(self, t: float) -> float:
        """Rate of the motion per step."""
        return self.start + self.bend * t

    def largest(self, t: float) -> float:
        """Largest deflection."""
        return self.limit + self.growth * t

    def slides_on(self, t: float, side: int) -> bool:
        """Whether a contact at its largest deflection slides on towards a side."""
        faster = side * self.rate(t) - self.growth
        return faster > 0.0 or (faster == 0.0 and side * self.bend >= 0.0)


class _Stretch(NamedTuple):
    """From a time on and for a length of it, the deflection is z0 + z1 x + z2 x^2 / 2."""

    start: float
    length: float
    z0: float
    z1: float
    z2: float

    def deflection(self, x: float) -> float:
        """After a time x."""
        return self.z0 + (self.z1 + 0.5 * self.z2 * x) * x


def step_force(
    stiffness: float,
    damping: float,
    friction: float,
    deflection: float,
    change: float,
    h: float,
    *,
    moment: float = 0.0,
    friction_slope: float = 0.0,
) -> Presliding:
    """Mean force over a step of size h with its slope, and the deflection at the end.

    stiffness: above 0. friction: mean, not negative. change: of the coordinate. moment: of its rate, zero at order 2.
    """
    slope = within(friction_slope, friction)
    r = _Rubbing(
        start=change - 3.0 * moment,
        bend=6.0 * moment,
        limit=(friction - slope) / stiffness,
        growth=2.0 * slope / stiffness,
        damping=damping / (stiffness * h),
    )
    z = within(deflection, r.limit)
    holds = abs(z) <= r.limit + min(r.growth, 0.0)
    if abs(change) + abs(moment) <= _STILL * r.limit and abs(z) >= _NEAR * r.limit and holds:
        r = r._replace(limit=abs(z), growth=0.0)
    force = force_slope = 0.0
    heat = 0.5 * (deflection * deflection - z * z)
    for stretch in _stretches(r, z):
        for added in _integrals(r, stretch):
            force, force_slope, heat = force - added[0], force_slope - added[1], heat + added[2]
        z = stretch.deflection(stretch.length)
    return Presliding(stiffness * force, stiffness * heat, z, stiffness * force_slope)


def _stretches(r: _Rubbing, z: float) -> Iterator[_Stretch]:
    """Stretches of a step on which the contact sticks or slides, from a deflection on.

    Against the largest deflection the motion is a parabola in time: it does not return to a side that it has left.
    """
    t, left = 0.0, 0
    side = next((side for side in (1, -1) if side * z >= r.limit and r.slides_on(0.0, side)), 0)
    for _ in range(_MOST_STRETCHES):
        rate, limit, length = r.rate(t), r.largest(t), 1.0 - t
        if side:
            if side * r.bend < 0.0:
                length = min(length, (side * r.growth - rate) / r.bend)
            stretch = _Stretch(t, length, side * limit, side * r.growth, 0.0)
            left, side = side, 0
        else:
            for barrier in (-1, 1):
                if barrier != left:
                    hit = _rising_through_zero(
                        barrier * z - limit, barrier * rate - r.growth, barrier * r.bend
                    )
                    if hit < length:
                        length, side = hit, barrier
            stretch = _Stretch(t, length, z, rate, r.bend)
        yield stretch
        t, z = t + length, stretch.deflection(length)
        if t >= 1.0:
            return


def _rising_through_zero(c: float, b: float, a: float) -> float:
    """Where c + b x + a x^2 / 2, not positive at first, becomes positive; beyond a step where it does not."""
    square = b * b - 2.0 * a * c
    if b > 0.0 and square >= 0.0:
        return -2.0 * c / (b + sqrt(square))
    if b <= 0.0 and a > 0.0:
        return (sqrt(max(square, 0.0)) - b) / a
    return _NEVER


def _zeros(c: float, b: float, a: float, length: float) -> Iterator[float]:
    """Zeros of c + b x + a x^2 / 2 within a length."""
    square = b * b - 2.0 * a * c
    if square < 0.0:
        return
    q = -(b + sqrt(square)) if b >= 0.0 else sqrt(square) - b
    for zero in (2.0 * c / q if q else length, q / a if a else length):
        if 0.0 < zero < length:
            yield zero


def _integrals(r: _Rubbing, s: _Stretch) -> Iterator[tuple[float, float, float]]:
    """Parts of the integrals of force and of 3 P1 times the force, and of the heat, over the stiffness.

    By Gauss' rule with two points, exact for cubics, between the times at which the force reaches the friction.
    """
    rate, limit = r.rate(s.start), r.largest(s.start)
    c, b = s.z0 + r.damping * rate, s.z1 + r.damping * r.bend
    reached = [
        zero for sign in (1, -1) for zero in _zeros(c - sign * limit, b - sign * r.growth, s.z2, s.length)
    ]
    cuts = [0.0, *sorted(reached), s.length]
    for begin, end in pairwise(cuts):
        half, middle = 0.5 * (end - begin), 0.5 * (end + begin)
        for x in (middle - _GAUSS * half, middle + _GAUSS * half):
            t, slipping, deflection = s.start + x, rate + r.bend * x, s.deflection(x)
            force = within(deflection + r.damping * slipping, limit + r.growth * x)
            heat = force * slipping - deflection * (s.z1 + s.z2 * x)
            yield half * force, 3.0 * half * (2.0 * t - 1.0) * force, half * heat


def instant_force(
    stiffness: float, damping: float, friction: float, deflection: float, rate: float
) -> Presliding:
    """Force of one instant; heat as power (W)."""
    held = within(deflection, friction / stiffness)
    force = -within(stiffness * held + damping * rate, friction)
    slides = held * rate > 0.0 and stiffness * abs(held) >= friction
    stored = 0.0 if slides else stiffness * held * rate
    return Presliding(force, -force * rate - stored, held)
