r"""Unilateral contact without friction between a point and a plane: a penalty force with a potential, and damping.

$$ F = F_\mathrm{ref} \left(\frac{p}{p_\mathrm{ref}}\right)^n + c\,
\mathrm{STEP}\!\left(\frac{p}{p_\mathrm{full}}\right) \dot p \;\ge\; 0,\qquad p > 0 $$

with the penetration $p$ and $\mathrm{STEP}(s) = s^2 (3 - 2 s)$, 1 from $s = 1$ on.

The law is that of the IMPACT function of multibody programs, with an exponent of 1.5 that of Hertz: a power of
the penetration, and damping that rises from nothing at touch to its full value by a cubic step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pow
from typing import Annotated, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from .contract.connection import HEAT, NO_PAIR, WRENCH, Connection, Impulse, Inputs
from .contract.frames import Vector3, cross, dot, mean, rotate, scaled, subtract
from .contract.record import Record, flagged, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD, PENETRATION, POTENTIAL_ENERGY
from .numerics.interval_mean import MidStep
from .numerics.relative_motion import pair, unit_direction

_NARROW = 1e-3


class _Parameters(NamedTuple):
    gap: Annotated[float, tunable("m", "Distance of the plane from the inboard port along the normal")]
    reference_force: Annotated[float, tunable("N", "Elastic force at the reference penetration", 1000.0, 0.0)]
    reference_penetration: Annotated[float, tunable("m", "Penetration of the reference force", 1e-3, 1e-9)]
    exponent: Annotated[float, tunable("1", "Power of the penetration in the elastic force", 1.5, 1.0)]
    damping: Annotated[float, tunable("N.s/m", "Force per rate of penetration at full damping", 0.0, 0.0)]
    full_damping_penetration: Annotated[float, tunable("m", "Penetration of full damping", 1e-4, 1e-9)]

    def elastic(self, penetration: float) -> float:
        """Force of the potential."""
        if penetration <= 0.0:
            return 0.0
        return self.reference_force * pow(penetration / self.reference_penetration, self.exponent)

    def potential(self, penetration: float) -> float:
        """Energy of the penetration."""
        return self.elastic(penetration) * max(penetration, 0.0) / (self.exponent + 1.0)

    def force(self, penetration: float, rate: float) -> float:
        """Force of an instant, never pulling."""
        damping = self.damping * mean_rise(*(penetration / self.full_damping_penetration,) * 2)
        return _pushing(self.elastic(penetration) + damping * rate)

    def mean_forces(self, before: float, after: float, h: float) -> tuple[float, float]:
        """Mean over a step of the force of the potential, and of the whole force, which never pulls.

        Damping and the limit at zero change the force in the direction of the penetration's change, so they only
        dissipate.
        """
        reference, full = self.reference_penetration, self.full_damping_penetration
        elastic = self.reference_force * mean_power(before / reference, after / reference, self.exponent)
        force = elastic + self.damping * mean_rise(before / full, after / full) * ((after - before) / h)
        return elastic, _pushing(force)


class _State(NamedTuple):
    normal: Annotated[Vector3, kept("1", "Normal of the plane, world axes")]
    arm: Annotated[Vector3, kept("m", "Vector from the inboard to the outboard port, world axes")]
    rate: Annotated[MidStep, kept("m/s", "Mean rates of the penetration over two steps")]
    heat: Annotated[float, HEAT]
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR


class _Observations(NamedTuple):
    penetration: Annotated[
        float,
        observed("m", "Penetration of the outboard port; negative: its clearance", PENETRATION),
    ]
    contact_force: Annotated[float, observed("N", "Force on the outboard body along the normal", LOAD)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy of the penetration")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    in_contact: Annotated[float, flagged("1: the outboard port is in the plane or behind it")]


class Contact(Connection[_Parameters, _State, Impulse]):
    """Contact between the outboard port, a point, and a plane fixed to the inboard port.

    normal: direction in the axes of the inboard port along which the outboard body is pushed away. The
    plane is `gap` along the normal from the inboard port; the penetration is gap - normal . (p_out - p_in).
    The force acts at the outboard port.
    """

    kind, order = "contact", 2
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)
    scheme: ClassVar = {"NARROW": _NARROW}

    def __init__(self, normal: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._direction = unit_direction(normal, "normal", "the plane's normal")
        super().__init__({"normal": tuple(normal)}, wrench_mode)

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """At the pose of the inputs."""
        normal, arm, rate = self._place(u)
        return _State(normal, arm, MidStep.starting(rate), 0.0)

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The mean force from the penetrations at both ends, and the heat it makes."""
        normal, arm, end_rate = self._place(u)
        before, after = c.gap - dot(s.normal, s.arm), c.gap - dot(normal, arm)
        elastic, force = c.mean_forces(before, after, h)
        heat = s.heat + (force - elastic) * (after - before)
        # with both means the work on the ports is the force times the change of penetration
        wrench = pair(scaled(force, mean(s.normal, normal)), (0.0, 0.0, 0.0), mean(s.arm, arm))
        is_impulse = u.commands.impulse > 0.5
        felt = MidStep.starting(end_rate) if is_impulse else s.rate.after((after - before) / h, h)
        return _State(normal, arm, felt, heat, wrench)

    def _place(self, u: Inputs[Impulse]) -> tuple[Vector3, Vector3, float]:
        """Normal and vector from the inboard to the outboard port, world axes, and rate of the penetration."""
        inboard, outboard = u.motions
        normal = rotate(inboard.orientation, self._direction)
        arm = subtract(outboard.position, inboard.position)
        apart = subtract(outboard.velocity, inboard.velocity)
        return normal, arm, -dot(normal, subtract(apart, cross(inboard.angular_velocity, arm)))

    def wrenches(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Of the present penetration and its rate."""
        normal, arm, rate = self._place(u)
        return pair(scaled(c.force(c.gap - dot(normal, arm), rate), normal), (0.0, 0.0, 0.0), arm)

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Penetration and force at the communication point, energies."""
        normal, arm, rate = self._place(u)
        penetration = c.gap - dot(normal, arm)
        force = c.force(penetration, rate if self.endpoint else s.rate.now())
        return _Observations(penetration, force, c.potential(penetration), s.heat, float(penetration >= 0.0))

    def powers(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat of the end-point force (W)."""
        normal, arm, rate = self._place(u)
        penetration = c.gap - dot(normal, arm)
        return ((c.force(penetration, rate) - c.elastic(penetration)) * rate,)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Normal and mode."""
        return {**super().native_data(), "normal": self._direction}

    @classmethod
    def example(cls) -> Contact:
        """A tilted plane."""
        return cls(normal=(0.0, 0.3, 1.0))


def mean_power(start: float, end: float, exponent: float) -> float:
    """Mean of max(s, 0)^exponent over s from start to end, exact also where they are close."""
    low, high = (start, end) if start < end else (end, start)
    if high <= 0.0:
        return 0.0
    width = (high - low) / (high + low) if low > 0.0 else 1.0
    if width > _NARROW:
        power = exponent + 1.0
        below = pow(low, power) if low > 0.0 else 0.0
        return (pow(high, power) - below) / (power * (high - low))
    # binomial series of the mean about the middle; the next term is of the order of width^6
    square = width * width
    fourth = 1.0 + (exponent - 2.0) * (exponent - 3.0) / 20.0 * square
    series = 1.0 + exponent * (exponent - 1.0) / 6.0 * square * fourth
    return pow(0.5 * (low + high), exponent) * series


def mean_rise(start: float, end: float) -> float:
    """Mean over s from start to end of the cubic step 3 s^2 - 2 s^3, which is 0 below 0 and 1 above 1."""
    low, high = (start, end) if start < end else (end, start)
    if high <= 0.0:
        return 0.0
    if low >= 1.0:
        return 1.0
    a, b = max(low, 0.0), min(high, 1.0)
    rise = a * a + a * b + b * b - 0.5 * (a + b) * (a * a + b * b)
    if a == low and b == high:
        return rise
    return ((b - a) * rise + (high - b)) / (high - low)


def _pushing(force: float) -> float:
    return 0.0 if force < 0.0 else force
