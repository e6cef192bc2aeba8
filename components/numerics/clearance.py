"""Spring and damper of a joint that act beyond a clearance: along one coordinate, or in the plane of a round hole.

With the distance r of the coordinates q from their middle and the clearance c the deflection is d = (r - c) q / r where
r exceeds c, else none. The spring has the potential k d^2 / 2, the damper the force of the rate of d,

    -b (n n^T + f^2 (1 - n n^T)) q',    n = q / r,    f = 1 - c / r:

all of it along q, and across what the deflection turns with q. Without clearance both are those of a bushing. Along one
coordinate this is the impact pair of Dubowsky and Freudenstein (1971).

Over a step the discrete gradient of the potential is that of a law of r, along q0 + q1: its moment about the middle is
none. Of order 4 the load is linear in time, as `fourth_order_correction` has it, with the tangent as a matrix. The
discrete gradient then errs across the step by V3 / 3 ((qm . D) D - D^2 qm) for the step D = q1 - q0, its middle qm and
V = W(r^2), V3 = W''; that term does no work, and is added. The damper acts for the share of the step beyond the
clearance.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from .laws import share_beyond
from .scheme import NUMERICAL_DAMPING
from .stiff_coordinate import MeanLoad, StepMotion, inertial_force

_Numbers = Sequence[float]


class Clearance(NamedTuple):
    """Clearance (m, rad) of the coordinates `members`, one or two, with stiffness and damping beyond it."""

    members: tuple[int, ...]
    size: float
    stiffness: float
    damping: float

    def potential(self, coordinates: _Numbers) -> float:
        """Energy at the coordinates of a joint."""
        deep = self._beyond(_size(self._own(coordinates)))
        return 0.5 * self.stiffness * deep * deep

    def force(self, coordinates: _Numbers, rates: _Numbers) -> list[float]:
        """Force at an instant along every member."""
        q, w = self._own(coordinates), self._own(rates)
        distance = _size(q)
        deep = self._beyond(distance)
        if deep == 0.0:
            return [0.0] * len(q)
        viscous = self._braking(q, deep / distance, 1.0, w)
        around = self.stiffness * deep / distance
        return [-around * a - b for a, b in zip(q, viscous, strict=True)]

    def heat(self, coordinates: _Numbers, rates: _Numbers) -> float:
        """Power (W) of the damper at an instant."""
        q, w = self._own(coordinates), self._own(rates)
        distance = _size(q)
        deep = self._beyond(distance)
        return _dot(self._braking(q, deep / distance, 1.0, w), w) if deep > 0.0 else 0.0

    def loads(self, motions: Sequence[StepMotion], *, is_paired: bool) -> list[MeanLoad]:
        """Loads over a step along every member, of either order."""
        own = [motions[i] for i in self.members]
        start, end = [m.start for m in own], [m.end for m in own]
        change = [b - a for a, b in zip(start, end, strict=True)]
        middle = [a + b for a, b in zip(start, end, strict=True)]
        r0, r1 = _size(start), _size(end)
        total, deep = r0 + r1, self._beyond(r0) + self._beyond(r1)
        around = along = 0.0
        viscous = lasting = [0.0] * len(own)
        h, moment = own[0].h, [m.moment for m in own]
        if deep > 0.0:
            play, began = (-self.size, self.size), -r0 if _dot(start, end) < 0.0 else r0
            along = self.stiffness * share_beyond(play, r0, r1)
            around = along * deep / total
            share = share_beyond(play, began, r1)
            viscous = self._braking(middle, deep / total, share / h, change)
            lasting = self._braking(middle, deep / total, 3.0 * share / h, moment)
        elastic = [-0.5 * around * a for a in middle]
        if not is_paired:
            numerical = [inertial_force(self.stiffness, m) for m in own]
            each = zip(elastic, viscous, numerical, change, strict=True)
            return [MeanLoad(e - v + n, v * d, -n * d) for e, v, n, d in each]
        bent, turned = (_resisted(middle, around, along, v) for v in (moment, change))
        if deep > 0.0:
            across = (along - around) / (6.0 * total * total)
            inward, square = _dot(middle, change), _dot(change, change)
            elastic = [
                e - across * (inward * d - square * a)
                for e, d, a in zip(elastic, change, middle, strict=True)
            ]
        rough = 3.0 * NUMERICAL_DAMPING * max(m.memory.roughness for m in own)
        return [
            MeanLoad(
                elastic[i] + 0.5 * bent[i] - viscous[i],
                viscous[i] * change[i] + lasting[i] * moment[i],
                rough * bent[i] * moment[i],
                -0.5 * turned[i] - lasting[i] - rough * bent[i],
            )
            for i in range(len(own))
        ]

    def _own(self, values: _Numbers) -> list[float]:
        return [values[i] for i in self.members]

    def _beyond(self, distance: float) -> float:
        return max(distance - self.size, 0.0)

    def _braking(self, q: _Numbers, turning: float, factor: float, rates: _Numbers) -> list[float]:
        """Force against the damper's rates, at the direction of q; turning: the share of q that the deflection is."""
        damping = factor * self.damping
        return _resisted(q, damping * turning * turning, damping, rates)


def _resisted(q: _Numbers, around: float, along: float, v: _Numbers) -> list[float]:
    """A symmetric matrix with one value along q and one around the middle, times v."""
    square = _dot(q, q)
    radial = (along - around) * _dot(q, v) / square if square > 0.0 else 0.0
    return [around * a + radial * b for a, b in zip(v, q, strict=True)]


def _dot(a: _Numbers, b: _Numbers) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _size(a: _Numbers) -> float:
    return sqrt(_dot(a, a))
