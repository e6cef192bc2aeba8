"""Unilateral contact without friction between a point and a plane: a penalty force with a potential, and damping.

The law is that of the IMPACT function of multibody programs, with an exponent of 1.5 that of Hertz: a power of
the penetration, and damping that rises from nothing at touch to its full value by a cubic step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pow

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, Port, Quantity, Vector
from .contract.frames import Vector3, cross, dot, mean, rotate, scaled, subtract
from .numerics.mid_step import MidStep
from .numerics.relative_motion import as_floats, dissipated_energies, gives_end_point, pair, unit_direction

_NORMAL, _ARM, _HEAT, _WRENCH, _RATE = slice(0, 3), slice(3, 6), 6, slice(7, 19), slice(19, 23)
_NARROW = 1e-3


@dataclass(frozen=True, slots=True)
class _Constants:
    gap: float
    reference_force: float
    reference_penetration: float
    exponent: float
    damping: float
    full_damping_penetration: float
    end_weight: float

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

        Damping, end weight and the limit at zero all change the force in the direction of the penetration's
        change, so they only dissipate.
        """
        reference, full = self.reference_penetration, self.full_damping_penetration
        elastic = self.reference_force * mean_power(before / reference, after / reference, self.exponent)
        force = elastic + self.damping * mean_rise(before / full, after / full) * ((after - before) / h)
        if self.end_weight != 0.5:
            force += (self.end_weight - 0.5) * (self.elastic(after) - self.elastic(before))
        return elastic, _pushing(force)


class Contact(Component):
    """A point of the outboard body, its port, against a plane fixed to the inboard port.

    normal: direction in the axes of the inboard port along which the outboard body is pushed away. The
    plane is `gap` along the normal from the inboard port; the penetration is gap - normal . (p_out - p_in).
    The force acts at the outboard port.
    """

    kind = "contact"

    def __init__(self, normal: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._direction = unit_direction(normal, "normal", "the plane's normal")
        self._declare(
            {"normal": tuple(normal), "wrench_mode": wrench_mode},
            ports=[Port("inboard", "connection"), Port("outboard", "connection")],
            parameters=_parameters(),
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=[
                Quantity("penetration", "m", "Penetration of the outboard port; negative: its clearance"),
                Quantity("contact_force", "N", "Force on the outboard body along the normal"),
                Quantity("potential_energy", "J", "Elastic energy of the penetration"),
                Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
                Quantity("in_contact", "1", "1: the outboard port is in the plane or behind it"),
            ],
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(_HEAT)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        return _Constants(*as_floats(p))

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the pose of the inputs."""
        normal, arm, rate = self._place(as_floats(u))
        return np.array((*normal, *arm, 0.0, *(0.0,) * 12, *MidStep.starting(rate)))

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the mean force from the penetrations at both ends, and the heat it makes."""
        v = as_floats(x)
        old_normal, old_arm = (v[0], v[1], v[2]), (v[3], v[4], v[5])
        normal, arm, end_rate = self._place(as_floats(u))
        before, after = c.gap - dot(old_normal, old_arm), c.gap - dot(normal, arm)
        elastic, force = c.mean_forces(before, after, h)
        heat = v[_HEAT] + (force - elastic) * (after - before)
        # with both means the work on the ports is the force times the change of penetration
        wrench = pair(scaled(force, mean(old_normal, normal)), (0.0, 0.0, 0.0), mean(old_arm, arm))
        rate = (after - before) / h
        felt = MidStep(*v[_RATE]).after(rate, h) if u[-1] < 0.5 else MidStep.starting(end_rate)
        return np.array((*normal, *arm, heat, *wrench, *felt))

    def _place(self, u: list[float]) -> tuple[Vector3, Vector3, float]:
        """Normal and vector from the inboard to the outboard port, world axes, and rate of the penetration."""
        normal = rotate((u[3], u[4], u[5], u[6]), self._direction)
        arm = (u[13] - u[0], u[14] - u[1], u[15] - u[2])
        velocity = subtract((u[20] - u[7], u[21] - u[8], u[22] - u[9]), cross((u[10], u[11], u[12]), arm))
        return normal, arm, -dot(normal, velocity)

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports."""
        if not self._endpoint:
            return x[_WRENCH].copy()
        normal, arm, rate = self._place(as_floats(u))
        force = c.force(c.gap - dot(normal, arm), rate)
        return np.array(pair(scaled(force, normal), (0.0, 0.0, 0.0), arm))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Penetration and force at the communication point, energies."""
        normal, arm, rate = self._place(as_floats(u))
        penetration = c.gap - dot(normal, arm)
        felt = rate if self._endpoint else MidStep(*as_floats(x[_RATE])).now()
        return np.array(
            (
                penetration,
                c.force(penetration, felt),
                c.potential(penetration),
                x[_HEAT],
                float(penetration >= 0.0),
            )
        )

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat of the end-point force (W)."""
        normal, arm, rate = self._place(as_floats(u))
        penetration = c.gap - dot(normal, arm)
        return np.array(((c.force(penetration, rate) - c.elastic(penetration)) * rate,))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Normal and mode."""
        return {"normal": self._direction, "endpoint": self._endpoint}

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


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float, minimum: float | None) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("gap", "m", "Distance of the plane from the inboard port along the normal", 0.0, None),
        tunable("reference_force", "N", "Elastic force at the reference penetration", 1000.0, 0.0),
        tunable("reference_penetration", "m", "Penetration of the reference force", 1e-3, 1e-9),
        tunable("exponent", "1", "Power of the penetration that the elastic force grows with", 1.5, 1.0),
        tunable("damping", "N.s/m", "Force per rate of penetration at full damping", 0.0, 0.0),
        tunable("full_damping_penetration", "m", "Penetration from which damping is full", 1e-4, 1e-9),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
    ]
