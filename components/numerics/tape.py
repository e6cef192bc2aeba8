r"""Moments of a tape spring, a thin strip that is straight along its length and curved across it.

Uniform bending (Wuest 1954): with the curvature $\kappa$, positive in the opposite sense to the transverse one,

$$ M = s D \left( \kappa + \frac{\nu}{R} - \nu \left(\frac 1R + \nu\kappa\right) F_1 + \frac 1\kappa
\left(\frac 1R + \nu\kappa\right)^2 F_2 \right),\qquad D = \frac{E t^3}{12 (1 - \nu^2)} $$

with the transverse radius $R$ and width $s = R\alpha$. A fold has the radius $R$ and the steady moments $(1 + \nu) D
\alpha$ and $-(1 - \nu) D \alpha$ (Seffen and Pellegrino 1999, Proc. R. Soc. A 455).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from math import cos, cosh, inf, isfinite, pi, sin, sinh, sqrt
from typing import Any, NamedTuple

from ..contract.component import ComponentError
from ..contract.errors import unknown

_POINTS = 48
"""Of the law of one side: its cubics are within 1e-5 of the curve."""
_SEARCHED = 2000
_HALVINGS = 60


class Tape(NamedTuple):
    """Geometry and material of one strip (m, rad, Pa), and how many there are, in SI units.

    length: of the part that bends uniformly before it folds. opposite, equal: numbers of strips that a positive angle
    bends in the opposite and in the equal sense.
    """

    radius: float
    subtended_angle: float
    thickness: float
    length: float
    youngs_modulus: float
    poisson_ratio: float
    opposite: float = 1.0
    equal: float = 0.0

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> Tape:
        """From a table; ComponentError where a key is unknown or missing, or a number is out of its range."""
        for name in given:
            if name not in cls._fields:
                raise ComponentError(f"tape.{name}: {unknown(name, list(cls._fields))}")
        for name in cls._fields:
            least, most = (0.0, 0.5) if name == "poisson_ratio" else (0.0, inf)
            if name not in given and name not in cls._field_defaults:
                raise ComponentError(f"tape.{name} is missing")
            value = given.get(name, 1.0)
            if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
                raise ComponentError(f"tape.{name} is {value!r}; it must be a number in SI units")
            if not least <= value <= most or (
                value == 0.0 and name not in ("opposite", "equal", "poisson_ratio")
            ):
                raise ComponentError(
                    f"tape.{name} is {value:g}; it must be above 0"
                    + (" and at most 0.5" if name == "poisson_ratio" else "")
                )
        tape = cls(**{name: float(value) for name, value in given.items()})
        if tape.opposite + tape.equal == 0.0:
            raise ComponentError("tape.opposite and tape.equal are 0; give the number of strips")
        return tape

    @property
    def plate_stiffness(self) -> float:
        """D, N.m."""
        return self.youngs_modulus * self.thickness**3 / (12.0 * (1.0 - self.poisson_ratio**2))

    @property
    def steady_moments(self) -> tuple[float, float]:
        """Of a fold in the opposite and in the equal sense (N.m), both positive."""
        moment = self.plate_stiffness * self.subtended_angle
        return (1.0 + self.poisson_ratio) * moment, (1.0 - self.poisson_ratio) * moment

    def uniform_moment(self, curvature: float) -> float:
        """Moment (N.m) of uniform bending by a curvature (1/m), positive in the opposite sense."""
        if curvature == 0.0:
            return 0.0
        nu, across = self.poisson_ratio, 1.0 / self.radius
        width = self.radius * self.subtended_angle
        edge = (3.0 * (1.0 - nu * nu)) ** 0.25 * width * sqrt(abs(curvature) / self.thickness)
        first, second = _edge_factors(edge)
        bent = across + nu * curvature
        moment = curvature + nu * across - nu * bent * first + bent * bent * second / curvature
        return width * self.plate_stiffness * moment


class Laws(NamedTuple):
    """Torques (N.m) on the outboard side over the angle (rad): of the straight tape up to where it snaps, and folded.

    The points of `folded` nearest to zero are where a fold snaps back.
    """

    straight_angle: tuple[float, ...]
    straight_torque: tuple[float, ...]
    folded_angle: tuple[float, ...]
    folded_torque: tuple[float, ...]


class _Side(NamedTuple):
    """Of one sign of the angle: points up to the snap, and where a fold of a torque snaps back; all positive."""

    angles: list[float]
    torques: list[float]
    back: float
    folded: float


def laws_of(tape: Tape) -> Laws:
    """Laws of strips side by side, each in uniform bending up to the peak of its moment.

    In the equal sense a strip twists before its peak, and its moment does not exceed the steady one. A fold snaps back
    at the angle where uniform bending has its moment.
    """
    positive, negative = _side(tape, tape.opposite, tape.equal), _side(tape, tape.equal, tape.opposite)
    fold = tape.length / tape.radius + pi  # constant from there on as well
    return Laws(
        straight_angle=(*(-a for a in reversed(negative.angles)), 0.0, *positive.angles),
        straight_torque=(*reversed(negative.torques), 0.0, *(-t for t in positive.torques)),
        folded_angle=(-negative.back - fold, -negative.back, positive.back, positive.back + fold),
        folded_torque=(negative.folded, negative.folded, -positive.folded, -positive.folded),
    )


def _side(tape: Tape, opposite: float, equal: float) -> _Side:
    """Of an angle that bends these numbers of strips in the opposite and in the equal sense."""
    steady, twisted = tape.steady_moments
    folded, most = opposite * steady + equal * twisted, 1.0 / tape.radius

    def torque(curvature: float) -> float:
        return opposite * tape.uniform_moment(curvature) + equal * min(
            -tape.uniform_moment(-curvature), twisted
        )

    grid = [most * (k / _SEARCHED) ** 2 for k in range(1, _SEARCHED + 1)]
    triples = zip(grid, grid[1:], grid[2:], strict=False)
    limit = next((b for _, b in pairwise(grid) if -tape.uniform_moment(-b) >= twisted), None)
    around = next(((a, c) for a, b, c in triples if tape.uniform_moment(c) < tape.uniform_moment(b)), None)
    peak = _peak(tape.uniform_moment, *around) if around else None
    if limit is None or peak is None or tape.uniform_moment(peak) <= steady:
        raise ComponentError(
            "the tape is too shallow or too thick to snap: its moment in uniform bending has no peak above the moment "
            "of a fold; check radius, subtended_angle and thickness"
        )
    end = peak if opposite else _root(lambda k: -tape.uniform_moment(-k) - twisted, 0.0, limit)
    back = _root(lambda k: torque(k) - folded, 0.0, end) if opposite else end
    curvatures = sorted(
        {*(end * (k / _POINTS) for k in range(1, _POINTS + 1)), back, *([limit] if limit < end else [])}
    )
    return _Side(
        [k * tape.length for k in curvatures], [torque(k) for k in curvatures], back * tape.length, folded
    )


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that is negative at `low` and not at `high` becomes zero, by bisection."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return high


def _peak(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function with one peak between two numbers is largest, by thirds."""
    for _ in range(_HALVINGS):
        third = (high - low) / 3.0
        low, high = (
            (low, high - third) if function(low + third) > function(high - third) else (low + third, high)
        )
    return 0.5 * (low + high)


def _edge_factors(edge: float) -> tuple[float, float]:
    """F1 and F2 of Wuest by the ratio of the width to that of the boundary layer at the edges."""
    if edge > 50.0:  # cosh overflows beyond 700, and nothing is left of the other terms here
        return 2.0 / edge, 0.5 / edge
    hyperbolic, circular = sinh(edge), sin(edge)
    first = 2.0 / edge * (cosh(edge) - cos(edge)) / (hyperbolic + circular)
    if edge < 0.3:  # the difference loses digits
        return first, edge**4 / 180.0
    return first, 0.25 * first - hyperbolic * circular / (hyperbolic + circular) ** 2
