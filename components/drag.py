"""Aerodynamic drag of a flat rectangular plate by strips, on one port.

Every strip across the plate takes 1/2 rho c_d times its area and the square of its own velocity along the
plate's normal, against that velocity (Bagnoli 2007, section 3.4.3.1). The velocity is linear along the plate,
so the sums over strips are integrals of quadratics, exact also where the plate turns about a line within it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, sqrt

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, Port, Quantity, Vector
from .contract.frames import (
    Quaternion,
    Vector3,
    conjugate,
    dot,
    multiply,
    normalized,
    rotate,
    scaled,
    subtract,
)
from .numerics.mid_step import MidStep
from .numerics.relative_motion import as_floats, dissipated_energies, gives_end_point

_POSITION, _ORIENTATION, _HEAT, _WRENCH = slice(0, 3), slice(3, 7), 7, slice(8, 14)
_NORMAL_RATE, _TURN_RATE = slice(14, 18), slice(18, 22)
_NORMAL, _TURN_AXIS = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class _Constants:
    start: float
    end: float
    pressure: float
    """Force per length of the plate and square of the velocity (N.s2/m3)."""

    def loads(self, velocity: float, turn: float) -> tuple[float, float]:
        """Force along the normal and torque about the y axis, both at the port, for the rates of the port.

        velocity: of the port along the normal; turn: rate about the y axis. The strip at x has velocity - x turn.
        """
        length = self.end - self.start
        first, last = velocity - self.start * turn, velocity - self.end * turn
        mean, moment = mean_squares(first, last)
        force = -self.pressure * length * mean
        torque = self.pressure * length * (self.start * mean + length * moment)
        return force, torque

    def centre_velocity(self, velocity: float, turn: float) -> float:
        """Velocity of the plate's centre along the normal."""
        return velocity - 0.5 * (self.start + self.end) * turn


class PlateDrag(Component):
    """Drag of a plate in the x-y plane of its port, from `start` to `end` along x and `width` across.

    The air is at rest in world axes. The mean wrench follows from the mean velocities of a step, so its work is
    never positive, and is what is dissipated.
    """

    kind = "drag"

    def __init__(self, wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._declare(
            {"wrench_mode": wrench_mode},
            ports=[Port("body", "connection")],
            parameters=_parameters(),
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=[
                Quantity(
                    "drag_force", "N", "Force on the body along the plate's normal, the z axis of the port"
                ),
                Quantity("drag_torque", "N.m", "Torque on the body about the y axis of the port"),
                Quantity("normal_velocity", "m/s", "Velocity of the plate's centre along the normal"),
                Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
            ],
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(_HEAT)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        start, end, width, density, coefficient = as_floats(p)
        if end <= start:
            raise ComponentError(f"the plate ends at {end:g} m; it must end beyond its start at {start:g} m")
        return _Constants(start, end, 0.5 * density * coefficient * width)

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the pose of the inputs."""
        v = as_floats(u)
        velocity, turn = _rates(v)
        slides = (*MidStep.starting(velocity), *MidStep.starting(turn))
        return np.array((*v[:7], 0.0, *(0.0,) * 6, *slides))

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the wrench of the mean velocities in the orientation halfway, and the heat it makes."""
        v, w = as_floats(x), as_floats(u)
        before, after = (v[3], v[4], v[5], v[6]), (w[3], w[4], w[5], w[6])
        halfway, change = _halfway(before, after), _turned(before, after)
        moved = subtract((w[0], w[1], w[2]), (v[0], v[1], v[2]))
        # the axis of the change is the same in all three frames
        velocity, turn = dot(rotate(halfway, _NORMAL), moved) / h, dot(_TURN_AXIS, change) / h
        force, torque = c.loads(velocity, turn)
        heat = v[_HEAT] - (force * velocity + torque * turn) * h
        if u[-1] < 0.5:
            slides = (
                MidStep(*v[_NORMAL_RATE]).after(velocity, h),
                MidStep(*v[_TURN_RATE]).after(turn, h),
            )
        else:
            slides = MidStep.starting(_rates(w)[0]), MidStep.starting(_rates(w)[1])
        return np.array((*w[:7], heat, *_wrench(halfway, force, torque), *slides[0], *slides[1]))

    def _felt(self, x: Vector, u: Vector) -> tuple[float, float]:
        """Velocity and turn rate of the port at the communication point."""
        if self._endpoint:
            return _rates(as_floats(u))
        v = as_floats(x)
        return MidStep(*v[_NORMAL_RATE]).now(), MidStep(*v[_TURN_RATE]).now()

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrench on the port."""
        if not self._endpoint:
            return x[_WRENCH].copy()
        v = as_floats(u)
        return np.array(_wrench((v[3], v[4], v[5], v[6]), *c.loads(*_rates(v))))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Force, torque and velocity at the communication point, energy dissipated."""
        velocity, turn = self._felt(x, u)
        return np.array((*c.loads(velocity, turn), c.centre_velocity(velocity, turn), x[_HEAT]))

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat of the end-point wrench (W)."""
        velocity, turn = _rates(as_floats(u))
        force, torque = c.loads(velocity, turn)
        return np.array((-(force * velocity + torque * turn),))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Mode."""
        return {"endpoint": self._endpoint}

    @classmethod
    def example(cls) -> PlateDrag:
        """A plate."""
        return cls()


def mean_squares(first: float, last: float) -> tuple[float, float]:
    """Means over t from 0 to 1 of v |v| and of t v |v|, with v linear from first to last."""
    if first * last >= 0.0:
        sign = 1.0 if first + last >= 0.0 else -1.0
        cross = first * last
        return (
            sign * (first * first + cross + last * last) / 3.0,
            sign * (first * first + 2.0 * cross + 3.0 * last * last) / 12.0,
        )
    still = first / (first - last)
    left, right = first * abs(first) * still, last * abs(last) * (1.0 - still)
    return (left + right) / 3.0, left * still / 12.0 + right * (still / 3.0 + (1.0 - still) / 4.0)


def _rates(u: list[float]) -> tuple[float, float]:
    """Velocity of the port along the plate's normal, and its rate about the plate's y axis."""
    orientation = (u[3], u[4], u[5], u[6])
    normal, axis = rotate(orientation, _NORMAL), rotate(orientation, _TURN_AXIS)
    return dot(normal, (u[7], u[8], u[9])), dot(axis, (u[10], u[11], u[12]))


def _wrench(orientation: Quaternion, force: float, torque: float) -> tuple[float, ...]:
    """Six numbers in world axes."""
    return (*scaled(force, rotate(orientation, _NORMAL)), *scaled(torque, rotate(orientation, _TURN_AXIS)))


def _halfway(before: Quaternion, after: Quaternion) -> Quaternion:
    """Orientation after half of the shortest rotation between two."""
    sign = 1.0 if sum(a * b for a, b in zip(before, after, strict=True)) >= 0.0 else -1.0
    w, x, y, z = (a + sign * b for a, b in zip(before, after, strict=True))
    return normalized((w, x, y, z))


def _turned(before: Quaternion, after: Quaternion) -> Vector3:
    """Vector of the shortest rotation between two orientations, in the axes of either."""
    w, x, y, z = multiply(conjugate(before), after)
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    half = sqrt(x * x + y * y + z * z)
    return scaled(2.0 if half < 1e-8 else 2.0 * atan2(half, w) / half, (x, y, z))


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float, minimum: float | None) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("start", "m", "Where the plate begins on the x axis of the port", 0.0, None),
        tunable("end", "m", "Where the plate ends on the x axis of the port", 1.0, None),
        tunable("width", "m", "Width of the plate along the y axis of the port", 1.0, 0.0),
        tunable("air_density", "kg/m3", "Density of the air", 1.204, 0.0),
        tunable("drag_coefficient", "1", "Drag coefficient of the plate, flow along its normal", 1.28, 0.0),
    ]
