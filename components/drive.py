"""Drive about an axis: a commanded angle that follows a motion profile, behind the compliance of a gearbox."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, ContinuousStates, Port, Quantity, Vector
from .contract.frames import nearest_turn, rotate
from .numerics.mid_step import MidStep
from .numerics.relative_motion import (
    Passage,
    Pose,
    as_floats,
    axis_frame,
    conjugate_torque,
    gives_end_point,
    is_of_order_four,
    numerical_dissipation,
    order_parameter,
    pair,
    port_moments,
    port_motions,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import Memory, StepMotion, bushing_load, remembered
from .numerics.workless_pair import remembered_path, workless_spring

_PROFILES = ("step", "step5")
_ANGLE, _SWING, _MEAN_RATE, _CLOCK, _HEAT, _WORK = 0, 5, 7, 9, 10, 11
_SLIDE, _WRENCH, _NUMERICAL = slice(12, 16), slice(16, 28), 28
_ROUGHNESS, _SLOPES, _LOAD = 29, slice(30, 42), slice(42, 46)
_IMPULSE, _HOLD, _MOMENTS = 26, 27, slice(28, 40)
_GAUSS = 0.6**0.5
_NOWHERE = (0.0, 0.0, 0.0)


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
        rise = s * s * s * (10.0 + s * (6.0 * s - 15.0)) if self.quintic else s * s * (3.0 - 2.0 * s)
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
class _Constants:
    stiffness: float
    damping: float
    aligned_angle: float
    motion: MotionLaw
    end_weight: float
    paired: bool

    def torque(self, deflection: float, rate: float) -> float:
        """Torque of an instant."""
        return -self.stiffness * deflection - self.damping * rate


class _Instant(NamedTuple):
    """Pose, angle and its rate, and what is commanded."""

    pose: Pose
    angle: float
    rate: float
    commanded: float
    commanded_rate: float

    @property
    def deflection(self) -> float:
        """Deflection of the gearbox."""
        return self.angle - self.commanded

    @property
    def deflection_rate(self) -> float:
        """Its rate."""
        return self.rate - self.commanded_rate


class Drive(Component):
    """Turns the outboard against the inboard port about the axis as commanded, through a gearbox.

    axis: direction in the axes of both ports. profile: "step" or "step5", see `MotionLaw`. The other five
    directions belong to a hinge beside the drive, whose stiffness about the axis is zero. The clock starts at
    zero, when the scene does, and stands still while `hold` is 1. The motor's work is its torque times the
    change of the commanded angle.
    """

    kind = "drive"

    def __init__(
        self, axis: Sequence[float] = (0.0, 1.0, 0.0), profile: str = "step5", wrench_mode: str = "mean"
    ) -> None:
        if profile not in _PROFILES:
            raise ComponentError(f"profile is {profile!r}; it must be step or step5")
        self._endpoint = gives_end_point(wrench_mode)
        self._axis_frame = axis_frame(axis, "the drive's axis")
        self._quintic = profile == "step5"
        self._declare(
            {"axis": tuple(axis), "profile": profile, "wrench_mode": wrench_mode},
            ports=[Port(name, "connection", 2 if self._endpoint else 4) for name in ("inboard", "outboard")],
            parameters=_parameters(),
            inputs=[
                Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete"),
                Quantity(
                    "hold", "1", "1: the clock stands still, and so does the motor", variability="discrete"
                ),
            ],
            observations=_observations(),
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = ContinuousStates(
                (
                    Quantity("clock", "s", "Time since the start, without what was held"),
                    Quantity("heat", "J", "Energy dissipated since the start"),
                    Quantity("work", "J", "Work of the motor since the start"),
                ),
                ("1", "W", "W"),
                (1.0, 1.0, 1.0),
                (_CLOCK, _HEAT, _WORK),
                ("heat", "work"),
            )

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        one = {q.name: float(p[self.parameter_layout[q.name]][0]) for q in self.parameter_layout.quantities}
        start = one["start_angle"]
        motion = MotionLaw(self._quintic, start, one["end_angle"] - start, one["start_time"], one["duration"])
        return _Constants(
            one["stiffness"],
            one["damping"],
            one["aligned_angle"],
            motion,
            one["end_weight"],
            is_of_order_four(one["order"]) and one["end_weight"] == 0.5 and not self._endpoint,
        )

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the pose of the inputs; the angle is the one nearest the start angle."""
        now = self._instant(c, as_floats(u), 0.0, c.motion.start)
        rate = now.deflection_rate
        slide = MidStep.starting(rate)
        return np.array(
            (now.angle, *now.pose.frame, *now.pose.swing, rate, rate, 0.0, 0.0, 0.0, *slide, *(0.0,) * 30)
        )

    def _instant(self, c: _Constants, u: list[float], clock: float, reference: float) -> _Instant:
        """The instant of the inputs; the angle is the one nearest the reference."""
        pose = relative_pose(port_motions(u), self._axis_frame)
        angle = nearest_turn(c.aligned_angle + pose.twist, reference)
        commanded_rate = 0.0 if u[_HOLD] > 0.5 else c.motion.rate(clock)
        return _Instant(
            pose, angle, relative_rates(port_motions(u), pose).twist, c.motion.angle(clock), commanded_rate
        )

    def _now(self, c: _Constants, x: Vector, u: Vector) -> _Instant:
        return self._instant(c, as_floats(u), float(x[_CLOCK]), float(x[_ANGLE]))

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the mean torque of the deflections at both ends, and the motor's work."""
        v, inputs = as_floats(x), as_floats(u)
        impulse = inputs[_IMPULSE] > 0.5
        clock = v[_CLOCK] if inputs[_HOLD] > 0.5 else v[_CLOCK] + h
        now = self._instant(c, inputs, clock, v[_ANGLE])
        commanded = c.motion.angle(v[_CLOCK])
        start, pose, fourth = v[_ANGLE] - commanded, now.pose, c.paired and not impulse
        mean_rate, rate = (now.deflection - start) / h, now.deflection_rate
        swing = (0.5 * (v[_SWING] + pose.swing[0]), 0.5 * (v[_SWING + 1] + pose.swing[1]))
        passage = Passage((v[1], v[2], v[3], v[4]), pose.frame, _NOWHERE, _NOWHERE)
        turned = driven = 0.0
        if fourth:
            turned = passage.rate_moments(port_moments(inputs[_MOMENTS]), swing).twist
            driven = c.motion.rate_moment(v[_CLOCK], clock)
        # inertial terms tame held torques, which an end-point torque is not
        memory = Memory(mean_rate, mean_rate)
        if not self._endpoint:
            memory = Memory(v[_MEAN_RATE], v[_MEAN_RATE + 1], v[_ROUGHNESS])
        motion = StepMotion(start, now.deflection, h, memory, turned - driven)
        slide, last = MidStep.starting(rate), MidStep.starting(0.0)
        if fourth:
            load, memory = workless_spring(c.stiffness, c.damping, motion), remembered_path(motion)
            slide, last = MidStep.starting(memory.end_rate), MidStep(*v[_LOAD]).after(load.force, h)
        else:
            load = bushing_load(c.stiffness, c.damping, motion, c.end_weight)
            memory = Memory(rate, rate) if impulse else remembered(motion, rate)
            slide = slide if impulse else MidStep(*v[_SLIDE]).after(mean_rate, h)
        wrench, slopes = (passage.twist_wrench(torque, swing) for torque in (load.force, load.slope))
        work = load.force * (now.commanded - commanded) + load.slope * driven
        energies = (v[_HEAT] + load.heat, v[_WORK] + work)
        motions = (now.angle, *pose.frame, *pose.swing, memory.mean_rate, memory.end_rate, clock)
        losses = (v[_NUMERICAL] + load.numerical, memory.roughness)
        return np.array((*motions, *energies, *slide, *wrench, *losses, *slopes, *last))

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[_WRENCH], x[_SLOPES]))
        now = self._now(c, x, u)
        torque = c.torque(now.deflection, now.deflection_rate)
        conjugate = conjugate_torque(torque, (0.0, 0.0), now.pose.swing)
        return np.array(pair(_NOWHERE, rotate(now.pose.frame, conjugate), _NOWHERE))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Angles, rates and torque at the communication point, and energies.

        Of order 4 the torque comes from what the last steps' loads were.
        """
        now = self._now(c, x, u)
        felt = now.deflection_rate if self._endpoint else MidStep(*as_floats(x[_SLIDE])).now()
        torque = c.torque(now.deflection, felt)
        if c.paired:
            torque = MidStep(*as_floats(x[_LOAD])).load_now(torque, float(x[_ROUGHNESS]))
        return np.array(
            (
                now.angle,
                now.rate,
                now.commanded,
                now.commanded_rate,
                torque,
                x[_WORK],
                0.5 * c.stiffness * now.deflection * now.deflection,
                x[_HEAT],
                x[_NUMERICAL],
            )
        )

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Rate of the clock, heat (W) of the end-point torque and power (W) of the motor."""
        now = self._now(c, x, u)
        rate = now.deflection_rate
        clock = 0.0 if u[_HOLD] > 0.5 else 1.0
        return np.array((clock, c.damping * rate * rate, c.torque(now.deflection, rate) * now.commanded_rate))

    def update(self, c: _Constants, x: Vector, u: Vector, at_event: bool) -> Vector:
        """Follow the angle."""
        result = x.copy()
        result[_ANGLE] = self._now(c, x, u).angle
        return result

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axis, profile and mode."""
        return {"axis_frame": self._axis_frame, "quintic": self._quintic, "endpoint": self._endpoint}

    @classmethod
    def example(cls) -> Drive:
        """A drive about the y axis."""
        return cls()


def _parameters() -> list[Quantity]:
    def tunable(
        name: str, unit: str, text: str, start: float = 0.0, minimum: float | None = None
    ) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("stiffness", "N.m/rad", "Stiffness of the gearbox at its output", 1e4, 0.0),
        tunable("damping", "N.m.s/rad", "Damping of the gearbox at its output", 0.0, 0.0),
        tunable("aligned_angle", "rad", "Angle where the axes of both ports coincide"),
        tunable("start_angle", "rad", "Commanded angle up to the start time"),
        tunable("end_angle", "rad", "Commanded angle from the end of the motion on"),
        tunable("start_time", "s", "Time when the motion starts", 0.0, 0.0),
        tunable("duration", "s", "Duration of the motion", 1.0, 1e-6),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
        order_parameter(),
    ]


def _observations() -> list[Quantity]:
    return [
        Quantity("angle", "rad", "Angle of the outboard against the inboard port, unwrapped"),
        Quantity("angular_rate", "rad/s", "Its rate, of the ports at this instant"),
        Quantity("commanded_angle", "rad", "Angle that the profile commands"),
        Quantity("commanded_rate", "rad/s", "Rate that the profile commands"),
        Quantity("drive_torque", "N.m", "Torque on the outboard side about the axis"),
        Quantity("supplied_energy", "J", "Work of the motor since the start"),
        Quantity("potential_energy", "J", "Elastic energy of the gearbox"),
        Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
        numerical_dissipation(),
    ]
