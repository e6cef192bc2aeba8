r"""Drive about an axis: a commanded angle, by a motion profile or from outside, behind the compliance of a gearbox.

$$ T = k\,(\varphi_c - \varphi) + c\,(\dot{\varphi}{}_c - \dot\varphi),\qquad \varphi_c = \varphi_0 +
(\varphi_1 - \varphi_0)\, s^3 (10 - 15 s + 6 s^2) $$

for the profile `step5`, $s^2 (3 - 2 s)$ for `step`, $s$ the share of the duration $\tau$ that has passed; for
`commanded` $\tau\, \dot{\varphi}{}_c = \varphi_1 - \varphi_c$.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp
from typing import Annotated, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, Inputs
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
)
from .numerics.axial import AxialConnection, Turn
from .numerics.fourth_order_correction import remembered_path, workless_spring
from .numerics.interval_mean import MidStep
from .numerics.laws import cubic_step
from .numerics.stiff_coordinate import Memory, StepMotion, bushing_load, remembered

_PROFILES = ("step", "step5", "commanded")
_GAUSS = 0.6**0.5
_SHORT = 0.02
"""Time constants, below which a series tells how a decay goes on."""


class _Parameters(NamedTuple):
    stiffness: Annotated[float, tunable("N.m/rad", "Stiffness of the gearbox at its output", 1e4, 0.0)]
    damping: Annotated[float, tunable("N.m.s/rad", "Damping of the gearbox at its output", 0.0, 0.0)]
    aligned_angle: Annotated[float, tunable("rad", "Angle where the axes of both ports coincide")]
    start_angle: Annotated[float, tunable("rad", "Commanded angle up to the start time")]
    end_angle: Annotated[float, tunable("rad", "Commanded angle at the end of the motion, or to be followed")]
    start_time: Annotated[float, tunable("s", "Time when the motion starts", 0.0, 0.0)]
    duration: Annotated[
        float, tunable("s", "Duration of the motion, or time constant of following", 1.0, 1e-6)
    ]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    turn: Turn
    memory: Annotated[Memory, kept("rad/s", "Remembered rates of the deflection, and roughness")]
    clock: Annotated[float, integrated("s", "1", "Time since the start, without what was held", False)]
    heat: Annotated[float, HEAT]
    work: Annotated[float, integrated("J", "W", "Work of the motor since the start")]
    slide: Annotated[MidStep, kept("rad/s", "Mean rates of the deflection over two steps")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    load: Annotated[MidStep, kept("N.m", "Mean torques of two steps of order 4")]
    followed: Annotated[
        float, integrated("rad", "rad/s", "Angle that a command from outside has led to", False)
    ]


class _Commands(NamedTuple):
    impulse: Annotated[float, IMPULSE]
    hold: Annotated[float, HOLD.saying("1: the clock stands still, and so does the motor")]


class _Observations(NamedTuple):
    angle: Annotated[float, observed("rad", "Angle of the outboard against the inboard port, unwrapped")]
    angular_rate: Annotated[float, observed("rad/s", "Its rate, of the ports at this instant")]
    commanded_angle: Annotated[float, observed("rad", "Angle that the profile commands")]
    commanded_rate: Annotated[float, observed("rad/s", "Rate that the profile commands")]
    drive_torque: Annotated[float, observed("N.m", "Torque on the outboard side about the axis", LOAD)]
    supplied_energy: Annotated[float, SUPPLIED_ENERGY.saying("Work of the motor since the start")]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy of the gearbox")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


@dataclass(frozen=True, slots=True)
class MotionLaw:
    """Angle (rad) over time (s) from rest to rest, with s the share of the duration that has passed.

    STEP is s^2 (3 - 2 s), with jumps of the acceleration at both ends; STEP5, if `quintic`, is
    s^3 (10 - 15 s + 6 s^2), without.
    """

    quintic: bool
    start: float
    change: float
    start_time: float
    duration: float

    def _share(self, time: float) -> float:
        return min(max((time - self.start_time) / self.duration, 0.0), 1.0)

    def angle(self, time: float) -> float:
        """Angle at a time."""
        s = self._share(time)
        rise = s * s * s * (10.0 + s * (6.0 * s - 15.0)) if self.quintic else cubic_step(s)
        return self.start + self.change * rise

    def rate(self, time: float) -> float:
        """Rate at a time; at most 1.5 (STEP) or 1.875 (STEP5) times change over duration."""
        s = self._share(time)
        rest = s * (1.0 - s)
        return self.change / self.duration * (30.0 * rest * rest if self.quintic else 6.0 * rest)

    def rate_moment(self, start: float, end: float) -> float:
        """First moment (rad) of the rate between two times, by Gauss' rule: exact but where it begins or ends."""
        middle, half = 0.5 * (start + end), 0.5 * (end - start)
        change = self.rate(middle + _GAUSS * half) - self.rate(middle - _GAUSS * half)
        return 5.0 / 9.0 * _GAUSS * half * change


@dataclass(frozen=True, slots=True)
class Following:
    """Angle (rad) that goes to a commanded one with a time constant (s), from where it is at a time."""

    angle_before: float
    time_before: float
    command: float
    time_constant: float

    def _left(self, time: float) -> float:
        return (self.angle_before - self.command) * exp((self.time_before - time) / self.time_constant)

    def angle(self, time: float) -> float:
        """Angle at a time."""
        return self.command + self._left(time)

    def rate(self, time: float) -> float:
        """Rate at a time."""
        return -self._left(time) / self.time_constant

    def rate_moment(self, start: float, end: float) -> float:
        """First moment (rad) of the rate between two times; by its series where steps are short."""
        x = (end - start) / self.time_constant
        return -self._left(start) * x * decay_moment(x)


def decay_moment(x: float) -> float:
    """Integral of (2 s - 1) exp(-x s) over s from 0 to 1; a series below 0.02, where the rest would be round-off."""
    if x < _SHORT:
        return -x * (1.0 / 6.0 - x * (1.0 / 12.0 - x * (1.0 / 40.0 - x / 180.0)))
    left = exp(-x)
    return 2.0 * (1.0 - left * (1.0 + x)) / (x * x) - (1.0 - left) / x


Law = MotionLaw | Following


class _Constants(NamedTuple):
    p: _Parameters
    motion: MotionLaw
    is_followed: bool
    is_paired: bool

    def law(self, s: _State) -> Law:
        """What is commanded from the state on."""
        if self.is_followed:
            return Following(s.followed, s.clock, self.p.end_angle, self.p.duration)
        return self.motion

    def torque(self, deflection: float, rate: float) -> float:
        """Torque of an instant."""
        return -self.p.stiffness * deflection - self.p.damping * rate


class _Instant(NamedTuple):
    """Turn and its rate, what is commanded, and the deflection of the gearbox."""

    turn: Turn
    rate: float
    commanded: float
    commanded_rate: float

    @property
    def deflection(self) -> float:
        """Deflection of the gearbox."""
        return self.turn.angle - self.commanded

    @property
    def deflection_rate(self) -> float:
        """Its rate."""
        return self.rate - self.commanded_rate


class Drive(AxialConnection[_Parameters, _State, _Commands]):
    """Rotary drive with a gearbox: rotates the outboard relative to the inboard port about `axis`, as commanded.

    axis: direction in the axes of both ports. profile: "step" or "step5", see `MotionLaw`; or "commanded", where the
    angle follows `end_angle`, which is set in mid-run, with the time constant `duration`. The other five
    directions belong to a parallel hinge, whose stiffness about the axis is zero. The clock starts at
    zero, when the scene does, and stands still while `hold` is 1. The motor's work is its torque times the
    change of the commanded angle.
    """

    kind, axis_of = "drive", "the drive's axis"
    scheme: ClassVar = {"SHORT": _SHORT} | {f"{p.upper()}_PROFILE": n for n, p in enumerate(_PROFILES)}
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(_Commands), Record(_Observations)

    def __init__(
        self, axis: Sequence[float] = (0.0, 1.0, 0.0), profile: str = "step5", wrench_mode: str = "mean"
    ) -> None:
        if profile not in _PROFILES:
            raise ComponentError(f"profile is {profile!r}; it must be step, step5 or commanded")
        self._profile = profile
        self._turn_about(axis, {"profile": profile}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        change, is_followed = one.end_angle - one.start_angle, self._profile == "commanded"
        if is_followed and one.start_time:
            raise ComponentError(
                f"start_time is {one.start_time:g}; a commanded drive follows from the start on"
            )
        motion = MotionLaw(self._profile == "step5", one.start_angle, change, one.start_time, one.duration)
        return _Constants(one, motion, is_followed, self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """At the pose of the inputs; the angle is the one nearest the start angle."""
        start = c.motion.start
        law = Following(start, 0.0, c.p.end_angle, c.p.duration) if c.is_followed else c.motion
        now = self._instant(c, law, u, 0.0, start)
        rate, none = now.deflection_rate, MidStep(0.0, 0.0, 0.0, 0.0)
        slide = MidStep.starting(rate)
        return _State(now.turn, Memory(rate, rate), 0.0, 0.0, 0.0, slide, 0.0, none, start)

    def _instant(
        self, c: _Constants, law: Law, u: Inputs[_Commands], clock: float, reference: float
    ) -> _Instant:
        """The instant of the inputs; the angle is the one nearest the reference."""
        turn, rate = self._turn(u, reference, c.p.aligned_angle)
        commanded_rate = 0.0 if u.commands.hold > 0.5 else law.rate(clock)
        return _Instant(turn, rate, law.angle(clock), commanded_rate)

    def _now(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Instant:
        return self._instant(c, c.law(s), u, s.clock, s.turn.angle)

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """The mean torque of the deflections at both ends, and the motor's work."""
        is_impulse = u.commands.impulse > 0.5
        clock = s.clock if u.commands.hold > 0.5 else s.clock + h
        law = c.law(s)
        now, commanded = self._instant(c, law, u, clock, s.turn.angle), law.angle(s.clock)
        start, is_paired = s.turn.angle - commanded, c.is_paired and not is_impulse
        mean_rate, rate = (now.deflection - start) / h, now.deflection_rate
        arc = self._arc(s.turn, now.turn, u, is_paired)
        driven = law.rate_moment(s.clock, clock) if is_paired else 0.0
        motion = StepMotion(start, now.deflection, h, s.memory, arc.moment - driven)
        if self.endpoint:
            motion = motion.without_inertia()
        slide, last = MidStep.starting(rate), MidStep.starting(0.0)
        if is_paired:
            load, memory = workless_spring(c.p.stiffness, c.p.damping, motion), remembered_path(motion)
            slide, last = MidStep.starting(memory.end_rate), s.load.after(load.force, h)
        else:
            load = bushing_load(c.p.stiffness, c.p.damping, motion)
            memory = Memory(rate, rate) if is_impulse else remembered(motion, rate)
            slide = slide if is_impulse else s.slide.after(mean_rate, h)
        work = load.force * (now.commanded - commanded) + load.slope * driven
        return _State(
            arc.under(load),
            memory,
            clock,
            s.heat + load.heat,
            s.work + work,
            slide,
            s.numerical + load.numerical,
            last,
            now.commanded if c.is_followed else s.followed,
        )

    def torque(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> tuple[Turn, float, float]:
        """Of the present deflection and its rate."""
        now = self._now(c, s, u)
        return now.turn, now.deflection_rate, c.torque(now.deflection, now.deflection_rate)

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """At the communication point; of order 4 the torque comes from what the last steps' loads were."""
        now = self._now(c, s, u)
        torque = c.torque(now.deflection, now.deflection_rate if self.endpoint else s.slide.now())
        if c.is_paired:
            torque = s.load.load_now(torque, s.memory.roughness)
        return _Observations(
            angle=now.turn.angle,
            angular_rate=now.rate,
            commanded_angle=now.commanded,
            commanded_rate=now.commanded_rate,
            drive_torque=torque,
            supplied_energy=s.work,
            potential_energy=0.5 * c.p.stiffness * now.deflection * now.deflection,
            dissipated_energy=s.heat,
            numerical_dissipation=s.numerical,
        )

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Rate of the clock, heat (W) of the end-point torque, power (W) of the motor, rate of what is followed."""
        now = self._now(c, s, u)
        rate = now.deflection_rate
        clock = 0.0 if u.commands.hold > 0.5 else 1.0
        power = c.torque(now.deflection, rate) * now.commanded_rate
        return clock, c.p.damping * rate * rate, power, now.commanded_rate if c.is_followed else 0.0

    def follow(self, c: _Constants, s: _State, u: Inputs[_Commands], at_event: bool) -> _State:
        """Follow the angle."""
        return s._replace(turn=s.turn._replace(angle=self._now(c, s, u).turn.angle))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axis, profile and mode."""
        return {**super().native_data(), "profile": _PROFILES.index(self._profile)}
