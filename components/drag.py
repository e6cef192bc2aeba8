r"""Aerodynamic drag of a flat rectangular plate by strips, on one port.

$$ F = -\frac{1}{2}\, \rho\, c_d\, b \int_{x_0}^{x_1} v(x)\, |v(x)|\, \mathrm d x,\qquad v(x) = v_0 - \omega
x $$

with the velocity $v$ along the normal of the plate of width $b$, which turns at the rate $\omega$ about y.

Every strip across the plate takes 1/2 rho c_d times its area and the square of its own velocity along the
plate's normal, against that velocity (Bagnoli 2007, section 3.4.3.1). The velocity is linear along the plate,
so the sums over strips are integrals of quadratics, exact also where the plate turns about a line within it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, WRENCH, Connection, Impulse, Inputs
from .contract.frames import (
    Quaternion,
    Vector3,
    conjugate,
    dot,
    multiply,
    normalized,
    rotate,
    rotation_vector,
    scaled,
    subtract,
)
from .contract.ports import WRENCH_SIZE, PortMotion
from .contract.record import Record, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD
from .numerics.interval_mean import MidStep

_NORMAL, _TURN_AXIS = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


class _Parameters(NamedTuple):
    start: Annotated[float, tunable("m", "Where the plate begins on the x axis of the port")]
    end: Annotated[float, tunable("m", "Where the plate ends on the x axis of the port", 1.0)]
    width: Annotated[float, tunable("m", "Width of the plate along the y axis of the port", 1.0, 0.0)]
    air_density: Annotated[float, tunable("kg/m3", "Density of the air", 1.204, 0.0)]
    drag_coefficient: Annotated[float, tunable("1", "Drag coefficient, flow along the normal", 1.28, 0.0)]

    @property
    def pressure(self) -> float:
        """Force per length of the plate and square of the velocity (N.s2/m3)."""
        return 0.5 * self.air_density * self.drag_coefficient * self.width

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


class _State(NamedTuple):
    position: Annotated[Vector3, kept("m", "Position of the port, world axes")]
    orientation: Annotated[Quaternion, kept("1", "Its orientation")]
    normal_rate: Annotated[MidStep, kept("m/s", "Mean velocities along the normal over two steps")]
    turn_rate: Annotated[MidStep, kept("rad/s", "Mean rates about the y axis over two steps")]
    heat: Annotated[float, HEAT]
    wrench: Annotated[tuple[float, ...], WRENCH.sized(WRENCH_SIZE)] = (0.0,) * WRENCH_SIZE


class _Observations(NamedTuple):
    drag_force: Annotated[
        float, observed("N", "Force on the body along the z axis of the port, the normal", LOAD)
    ]
    drag_torque: Annotated[float, observed("N.m", "Torque on the body about the y axis of the port")]
    normal_velocity: Annotated[float, observed("m/s", "Velocity of the plate's centre along the normal")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]


class PlateDrag(Connection[_Parameters, _State, Impulse]):
    """Drag of a plate in the x-y plane of its port, from `start` to `end` along x and `width` across.

    The air is at rest in world axes. The mean wrench follows from the mean velocities of a step, so its work is
    never positive; it is the dissipated energy.
    """

    kind, noun, port_names, order = "drag", "air drag", ("body",), 2
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)

    def __init__(self, wrench_mode: str = "mean") -> None:
        super().__init__({}, wrench_mode)

    def prepare(self, p: Vector) -> _Parameters:
        """The checked parameters by name."""
        one = self._checked(p)
        if one.end <= one.start:
            raise ComponentError(
                f"the plate ends at {one.end:g} m; it must end beyond its start at {one.start:g} m"
            )
        return one

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """At the pose of the inputs."""
        (port,) = u.motions
        velocity, turn = _rates(port)
        return _State(
            port.position, port.orientation, MidStep.starting(velocity), MidStep.starting(turn), 0.0
        )

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The wrench of the mean velocities in the orientation halfway, and the heat it makes."""
        (port,) = u.motions
        halfway, change = _halfway(s.orientation, port.orientation), _turned(s.orientation, port.orientation)
        moved = subtract(port.position, s.position)
        # the axis of the change is the same in all three frames
        velocity, turn = dot(rotate(halfway, _NORMAL), moved) / h, dot(_TURN_AXIS, change) / h
        force, torque = c.loads(velocity, turn)
        felt = s.normal_rate.after(velocity, h), s.turn_rate.after(turn, h)
        if u.commands.impulse > 0.5:
            at_end = _rates(port)
            felt = MidStep.starting(at_end[0]), MidStep.starting(at_end[1])
        heat = s.heat - (force * velocity + torque * turn) * h
        return _State(port.position, port.orientation, *felt, heat, _wrench(halfway, force, torque))

    def wrenches(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Of the present velocities."""
        (port,) = u.motions
        return _wrench(port.orientation, *c.loads(*_rates(port)))

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Force, torque and velocity at the communication point, energy dissipated."""
        velocity, turn = _rates(u.motions[0])
        if not self.endpoint:
            velocity, turn = s.normal_rate.now(), s.turn_rate.now()
        return _Observations(*c.loads(velocity, turn), c.centre_velocity(velocity, turn), s.heat)

    def powers(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat of the end-point wrench (W)."""
        velocity, turn = _rates(u.motions[0])
        force, torque = c.loads(velocity, turn)
        return (-(force * velocity + torque * turn),)


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


def _rates(port: PortMotion) -> tuple[float, float]:
    """Velocity of the port along the plate's normal, and its rate about the plate's y axis."""
    normal, axis = rotate(port.orientation, _NORMAL), rotate(port.orientation, _TURN_AXIS)
    return dot(normal, port.velocity), dot(axis, port.angular_velocity)


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
    return rotation_vector(multiply(conjugate(before), after))
