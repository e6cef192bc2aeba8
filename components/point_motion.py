r"""Prescribed motion of a point: the distance of two ports along a direction follows a motion law, through a spring.

$$ F = k\,(d_c - d) + c\,(\dot d{}_c - \dot d),\qquad d_c = d_0 + \mathrm{law}(t) $$

with the distance $d$ of the ports along the axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import Vector
from .contract.connection import HEAT, NO_PAIR, SLOPES, WRENCH, Connection, Inputs
from .contract.frames import Quaternion, Vector3, cross, multiply, rotate, rotate_back, subtract
from .contract.record import Record, integrated, kept, observed, tunable
from .contract.roles import (
    DISSIPATED_ENERGY,
    HOLD,
    IMPULSE,
    LOAD,
    NUMERICAL_DISSIPATION,
    ORDER,
    POTENTIAL_ENERGY,
    SUPPLIED_ENERGY,
    TIME_TO_BREAK,
)
from .numerics.fourth_order_correction import remembered_path, workless_spring
from .numerics.interval_mean import MidStep
from .numerics.motion_law import MotionLaw
from .numerics.relative_motion import Passage, axis_frame, pair
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion, bushing_load, remembered

_NOWHERE: Vector3 = (0.0, 0.0, 0.0)


class _Parameters(NamedTuple):
    stiffness: Annotated[float, tunable("N/m", "Stiffness that enforces the distance", 5e7, 0.0)]
    damping: Annotated[float, tunable("N.s/m", "Damping in parallel with it", 0.0, 0.0)]
    offset: Annotated[float, tunable("m", "Distance where the law is zero")]
    order: Annotated[float, ORDER]

    def force(self, deflection: float, rate: float) -> float:
        """Force of an instant on the outboard port."""
        return -self.stiffness * deflection - self.damping * rate


class _State(NamedTuple):
    frame: Annotated[Quaternion, kept("1", "Frame of the direction on the inboard port")]
    gap: Annotated[Vector3, kept("m", "From the inboard to the outboard port, world axes")]
    memory: Annotated[Memory, kept("m/s", "Remembered rates of the deflection, and roughness")]
    clock: Annotated[float, integrated("s", "1", "Time since the start, without what was held", False)]
    heat: Annotated[float, HEAT]
    work: Annotated[float, integrated("J", "W", "Work of the motion since the start")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    load: Annotated[MidStep, kept("N", "Mean forces of two steps")]
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR


class _Commands(NamedTuple):
    impulse: Annotated[float, IMPULSE]
    hold: Annotated[float, HOLD.saying("1: the clock stands still, and so does the motion")]


class _Observations(NamedTuple):
    distance: Annotated[float, observed("m", "Distance of the ports along the direction")]
    commanded_distance: Annotated[float, observed("m", "Distance that the law commands")]
    commanded_rate: Annotated[float, observed("m/s", "Rate that the law commands")]
    commanded_acceleration: Annotated[float, observed("m/s2", "Acceleration that the law commands")]
    motion_force: Annotated[float, observed("N", "Force on the outboard port along the direction", LOAD)]
    supplied_energy: Annotated[float, SUPPLIED_ENERGY.saying("Work of the motion since the start")]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class _Constants(NamedTuple):
    p: _Parameters
    is_paired: bool


class _Instant(NamedTuple):
    """Frame and gap, distance and its rate, and those that are commanded."""

    frame: Quaternion
    gap: Vector3
    distance: float
    rate: float
    commanded: float
    commanded_rate: float

    @property
    def deflection(self) -> float:
        """Distance beyond the commanded one."""
        return self.distance - self.commanded

    @property
    def deflection_rate(self) -> float:
        """Its rate."""
        return self.rate - self.commanded_rate


class PointMotion(Connection[_Parameters, _State, _Commands]):
    """Prescribed motion of the outboard relative to the inboard port along `axis`, in axes of the inboard port.

    The distance axis . (p_out - p_in) follows `offset` plus the law, see `MotionLaw`, in one direction only, and in
    no rotation. The force acts at the outboard port; its torque on the inboard port is that of the gap. The clock
    starts at zero, when the scene does, and stands still while `hold` is 1. The work of the motion is its force times
    the change of the commanded distance.
    """

    kind, own_outputs = "point_motion", (TIME_TO_BREAK,)
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(_Commands), Record(_Observations)

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 0.0, 1.0),
        law: Sequence[Mapping[str, Any]] = (),
        wrench_mode: str = "mean",
    ) -> None:
        self._axis_frame = axis_frame(axis, "the motion's direction")
        self._law = MotionLaw(law)
        super().__init__({"axis": tuple(axis), "law": [dict(term) for term in law]}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        return _Constants(one, self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """At the places of the inputs."""
        now, none = self._instant(c, u, 0.0), MidStep(0.0, 0.0, 0.0, 0.0)
        rate = now.deflection_rate
        return _State(now.frame, now.gap, Memory(rate, rate), 0.0, 0.0, 0.0, 0.0, none)

    def _instant(self, c: _Constants, u: Inputs[_Commands], clock: float) -> _Instant:
        inboard, outboard = u.motions
        frame = multiply(inboard.orientation, self._axis_frame)
        gap = subtract(outboard.position, inboard.position)
        apart = subtract(subtract(outboard.velocity, inboard.velocity), cross(inboard.angular_velocity, gap))
        rate = 0.0 if u.commands.hold > 0.5 else self._law.rate(clock)
        commanded = c.p.offset + self._law.value(clock)
        return _Instant(frame, gap, rotate_back(frame, gap)[0], rotate_back(frame, apart)[0], commanded, rate)

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """The mean force of the deflections at both ends, and the work of the motion."""
        is_impulse = u.commands.impulse > 0.5
        clock = s.clock if u.commands.hold > 0.5 else s.clock + h
        now, commanded = self._instant(c, u, clock), c.p.offset + self._law.value(s.clock)
        passage, is_paired = Passage(s.frame, now.frame, s.gap, now.gap), c.is_paired and not is_impulse
        start = rotate_back(s.frame, s.gap)[0] - commanded
        driven = self._law.rate_moment(s.clock, clock) if is_paired else 0.0
        moment = passage.moments(u.moments)[0][0] - driven if is_paired else 0.0
        mean_rate = (now.deflection - start) / h
        # inertial terms tame held forces, which an end-point force is not
        memory = Memory(mean_rate, mean_rate) if self.endpoint else s.memory
        motion = StepMotion(start, now.deflection, h, memory, moment)
        if is_paired:
            load, memory = workless_spring(c.p.stiffness, c.p.damping, motion), remembered_path(motion)
        else:
            load = bushing_load(c.p.stiffness, c.p.damping, motion)
            rate = now.deflection_rate
            memory = Memory(rate, rate) if is_impulse else remembered(motion, rate)
        wrench, slopes = _wrenches(passage, load)
        return _State(
            now.frame,
            now.gap,
            memory,
            clock,
            s.heat + load.heat,
            s.work + load.force * (now.commanded - commanded) + load.slope * driven,
            s.numerical + load.numerical,
            s.load.after(load.force, h) if is_paired else MidStep.starting(0.0),
            wrench,
            slopes,
        )

    def own(self, c: _Constants, s: _State) -> Sequence[float]:
        """Time to the next break."""
        return (self._law.time_to_break(s.clock),)

    def wrenches(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Of the present deflection and its rate."""
        now = self._instant(c, u, s.clock)
        force = c.p.force(now.deflection, now.deflection_rate)
        return pair(rotate(now.frame, (force, 0.0, 0.0)), _NOWHERE, now.gap)

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """At the communication point; the force from what the last steps' loads were."""
        now = self._instant(c, u, s.clock)
        rate = now.deflection_rate
        if not self.endpoint:
            rate = s.memory.end_rate if c.is_paired else s.memory.mean_rate
        force = c.p.force(now.deflection, rate)
        return _Observations(
            distance=now.distance,
            commanded_distance=now.commanded,
            commanded_rate=now.commanded_rate,
            commanded_acceleration=0.0 if u.commands.hold > 0.5 else self._law.acceleration(s.clock),
            motion_force=s.load.load_now(force, s.memory.roughness) if c.is_paired else force,
            supplied_energy=s.work,
            potential_energy=0.5 * c.p.stiffness * now.deflection * now.deflection,
            dissipated_energy=s.heat,
            numerical_dissipation=s.numerical,
        )

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Rate of the clock, heat (W) of the end-point force and power (W) of the motion."""
        now = self._instant(c, u, s.clock)
        rate = now.deflection_rate
        clock = 0.0 if u.commands.hold > 0.5 else 1.0
        return clock, c.p.damping * rate * rate, c.p.force(now.deflection, rate) * now.commanded_rate

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Direction, law and mode."""
        return {**super().native_data(), "axis_frame": self._axis_frame, **self._law.native_data()}

    @classmethod
    def example(cls) -> PointMotion:
        """A smooth step along z."""
        return cls(law=[{"profile": "step5", "duration": 1.0, "change": 0.1}])


def _wrenches(passage: Passage, load: MeanLoad) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Mean wrenches on both ports, and their slopes."""
    return passage.wrenches((load.force, 0.0, 0.0), _NOWHERE, (load.slope, 0.0, 0.0), _NOWHERE)
