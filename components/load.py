r"""Load from outside on one port: a force and a torque along a direction of the world or of the body, over time.

$$ \mathbf F = \left(f(t) + f_+\right) \mathbf d,\qquad \mathbf T = \left(\tau(t) + \tau_+\right) \mathbf d
$$

along the direction $\mathbf d$ with the laws $f$ and $\tau$ and what is added in mid-run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import SLOPES, WRENCH, Connection, Inputs
from .contract.frames import (
    Quaternion,
    Vector3,
    dot,
    exponential,
    multiply,
    rotate,
    rotation_between,
    scaled,
    subtract,
)
from .contract.ports import WRENCH_SIZE
from .contract.record import Record, integrated, kept, observed, tunable
from .contract.roles import HOLD, IMPULSE, LOAD, ORDER, SUPPLIED_ENERGY, TIME_TO_BREAK
from .numerics.motion_law import NOTHING, MotionLaw, gauss_moments, interpolated
from .numerics.relative_motion import unit_direction

_NONE = (0.0,) * WRENCH_SIZE
_FRAMES = ("world", "body")


class _Parameters(NamedTuple):
    added_force: Annotated[
        float, tunable("N", "Force in addition to the law, for example of a controller", 0.0)
    ]
    added_torque: Annotated[
        float, tunable("N.m", "Torque in addition to the law, for example of a controller", 0.0)
    ]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    position: Annotated[Vector3, kept("m", "Position of the port, world axes")]
    orientation: Annotated[Quaternion, kept("1", "Its orientation")]
    clock: Annotated[float, integrated("s", "1", "Time since the start, without what was held", False)]
    work: Annotated[float, integrated("J", "W", "Work of the load since the start")]
    wrench: Annotated[tuple[float, ...], WRENCH.sized(WRENCH_SIZE)] = _NONE
    slopes: Annotated[tuple[float, ...], SLOPES.sized(WRENCH_SIZE)] = _NONE


class _Commands(NamedTuple):
    impulse: Annotated[float, IMPULSE]
    hold: Annotated[float, HOLD.saying("1: the clock stands still; the load acts on")]


class _Observations(NamedTuple):
    applied_force: Annotated[float, observed("N", "Force on the body along the direction", LOAD)]
    applied_torque: Annotated[float, observed("N.m", "Torque on the body about the direction", LOAD)]
    supplied_energy: Annotated[float, SUPPLIED_ENERGY.saying("Work of the load since the start")]


class _Constants(NamedTuple):
    added: tuple[float, float]
    is_paired: bool


class Load(Connection[_Parameters, _State, _Commands]):
    """Force along `direction` and torque about it at a port, each by a law over time (N, N.m).

    frame: "world" for a direction that stays, "body" for one in the axes of the port that turns with it. force,
    torque: terms, see `MotionLaw`; they may be left out. What is added to them may be set in mid-run. The clock starts
    at zero, when the scene does, and stands still while `hold` is 1. Over a step the load is its mean and its slope,
    whose work on the port is what is supplied.
    """

    kind, port_names, own_outputs = "load", ("body",), (TIME_TO_BREAK,)
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(_Commands), Record(_Observations)

    def __init__(
        self,
        direction: Sequence[float] = (0.0, 0.0, 1.0),
        frame: str = "world",
        force: Sequence[Mapping[str, Any]] = (),
        torque: Sequence[Mapping[str, Any]] = (),
        wrench_mode: str = "mean",
    ) -> None:
        if frame not in _FRAMES:
            raise ComponentError(f"frame is {frame!r}; it must be world or body")
        self._direction = unit_direction(direction, "direction", "the load")
        self._turns = frame == "body"
        self._laws = MotionLaw(force or NOTHING), MotionLaw(torque or NOTHING)
        structure = {"direction": tuple(direction), "frame": frame}
        structure |= {name: [dict(t) for t in law] for name, law in (("force", force), ("torque", torque))}
        super().__init__(structure, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        return _Constants((one.added_force, one.added_torque), self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """At the place of the inputs."""
        (port,) = u.motions
        return _State(port.position, port.orientation, 0.0, 0.0)

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """Mean and slope of the load along the way, and its work."""
        (port,), (moment,) = u.motions, u.moments or (None,)
        clock = s.clock if u.commands.hold > 0.5 else s.clock + h
        is_paired = c.is_paired and moment is not None and u.commands.impulse < 0.5
        turned = rotation_between(s.orientation, port.orientation)
        bend = moment.angular_velocity if is_paired and moment is not None else (0.0, 0.0, 0.0)
        directions = self._directions(s.orientation, port.orientation, turned, bend)
        wrench, slopes = self._means(c, s.clock, clock, directions)
        moved = (*subtract(port.position, s.position), *turned)
        work = sum(w * m for w, m in zip(wrench, moved, strict=True))
        if not is_paired or moment is None:
            return _State(port.position, port.orientation, clock, s.work + work, wrench)
        bent = (*moment.velocity, *moment.angular_velocity)
        work += sum(w * m for w, m in zip(slopes, bent, strict=True))
        return _State(port.position, port.orientation, clock, s.work + work, wrench, slopes)

    def _directions(
        self, before: Quaternion, after: Quaternion, turned: Vector3, bend: Vector3
    ) -> tuple[Vector3, Vector3, Vector3]:
        """The direction at the points of Gauss' rule: of a turning one the parabola through three places.

        turned: rotation vector of the step; bend: first moment of the angular velocity, of which a rate that is linear
        in time leaves the orientation by three quarters behind in the middle.
        """
        if not self._turns:
            return (self._direction,) * 3
        lag = subtract(scaled(0.5, turned), scaled(0.75, bend))
        middle = multiply(exponential(lag), before)
        three = (rotate(q, self._direction) for q in (before, middle, after))
        x, y, z = (interpolated(*values) for values in zip(*three, strict=True))
        return (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])

    def _means(
        self, c: _Constants, start: float, end: float, directions: tuple[Vector3, Vector3, Vector3]
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Mean wrench and its slope over a step."""
        found: list[tuple[float, float]] = []
        for law, added in zip(self._laws, c.added, strict=True):
            samples = [value + added for value in law.samples(start, end)]
            found += [
                gauss_moments([f * d[axis] for f, d in zip(samples, directions, strict=True)])
                for axis in range(3)
            ]
        means, slopes = zip(*found, strict=True)
        return means, slopes

    def own(self, c: _Constants, s: _State) -> Sequence[float]:
        """Time to the next break."""
        return (min(law.time_to_break(s.clock) for law in self._laws),)

    def wrenches(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Of the present time and orientation."""
        (port,) = u.motions
        along = rotate(port.orientation, self._direction) if self._turns else self._direction
        force, torque = (scaled(value, along) for value in self._present(c, s))
        return (*force, *torque)

    def _present(self, c: _Constants, s: _State) -> tuple[float, float]:
        """Force (N) and torque (N.m) at the present time."""
        force, torque = self._laws
        return force.value(s.clock) + c.added[0], torque.value(s.clock) + c.added[1]

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """The load at the communication point, and its work."""
        return _Observations(*self._present(c, s), s.work)

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Rate of the clock, and power (W) of the load."""
        (port,), w = u.motions, self.wrenches(c, s, u)
        power = dot((w[0], w[1], w[2]), port.velocity) + dot((w[3], w[4], w[5]), port.angular_velocity)
        return 0.0 if u.commands.hold > 0.5 else 1.0, power

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Direction, laws and mode."""
        force, torque = self._laws
        return {
            **super().native_data(),
            "direction": self._direction,
            "turns": self._turns,
            **force.native_data("force"),
            **torque.native_data("torque"),
        }

    @classmethod
    def example(cls) -> Load:
        """A force that turns with the body, and a torque."""
        wave = {"profile": "harmonic", "amplitude": 2.0, "frequency": 1.5}
        ramp = {"profile": "ramp", "duration": 1.0, "change": 10.0}
        return cls((0.3, 0.0, 1.0), "body", force=[ramp], torque=[wave])
