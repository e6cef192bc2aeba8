"""Rail: a trolley guided in a plane at its orientation, with Coulomb friction against its sliding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, Port, Quantity, Vector
from .contract.frames import conjugate, multiply, nearest_turn, rotate
from .numerics.laws import stiction_factors
from .numerics.mid_step import MidStep
from .numerics.relative_motion import (
    Pose,
    as_floats,
    axis_frame,
    conjugate_torque,
    dissipated_energies,
    gives_end_point,
    numerical_dissipation,
    port_motions,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import Memory, StepMotion, bushing_load, remembered

Four = tuple[float, float, float, float]

_OFFSET, _TWIST, _MEAN_RATES, _END_RATES = 7, 10, 13, 17
_SLIDE, _FRICTION_HEAT, _DAMPING_HEAT, _WRENCH, _NUMERICAL = slice(21, 25), 25, 26, slice(27, 33), 33


@dataclass(frozen=True, slots=True)
class _Constants:
    """Stiffness and damping of the four stiff coordinates in order, and friction."""

    stiffness: Four
    damping: Four
    friction_force: float
    stiction_velocity: float
    end_weight: float

    def friction(self, speed: float) -> float:
        """Friction force at a sliding speed."""
        return self.friction_force * stiction_factors(abs(speed), self.stiction_velocity, 1.0)[1]

    def resistance(self, speed: float) -> float:
        """Friction force over the sliding speed (N.s/m), finite at rest."""
        if speed == 0.0:
            return 1.5 * self.friction_force / self.stiction_velocity
        return self.friction(speed) / speed


class _Instant(NamedTuple):
    """Pose against the start, in axes with x along the normal; stiff coordinates (normal, twist, swing y, z).

    velocity: the sliding velocity in the plane's two axes.
    """

    pose: Pose
    stiff: Four
    rates: Four
    velocity: tuple[float, float]

    @property
    def speed(self) -> float:
        """Sliding speed."""
        return sqrt(self.velocity[0] * self.velocity[0] + self.velocity[1] * self.velocity[1])


class Rail(Component):
    """Guides the trolley port in the plane through its place at the start, at its orientation there.

    normal: direction normal to the plane, world axes; the plane is fixed to the ground, so the rail has one port
    only. Stiffness and damping act along the normal and on all rotations; in the plane there is only friction.
    """

    kind = "rail"

    def __init__(self, normal: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._axes = axis_frame(normal, "the normal to the rail's plane", "normal")
        self._declare(
            {"normal": tuple(normal), "wrench_mode": wrench_mode},
            ports=[Port("trolley", "connection")],
            parameters=_parameters(),
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=_observations(),
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(_FRICTION_HEAT, ("friction_heat", "damping_heat"))

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        one = {q.name: float(p[self.parameter_layout[q.name]][0]) for q in self.parameter_layout.quantities}
        turning, slowing = one["rotational_stiffness"], one["rotational_damping"]
        return _Constants(
            (one["normal_stiffness"], turning, turning, turning),
            (one["normal_damping"], slowing, slowing, slowing),
            one["friction_force"],
            one["stiction_velocity"],
            one["end_weight"],
        )

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """The plane goes through the place of the inputs."""
        inputs = as_floats(u)
        now = self._instant(inputs[:7], inputs, 0.0)
        slide = MidStep.starting(now.speed)
        memories = (*now.rates, *now.rates)
        return np.array((*inputs[:7], *now.pose.offset, *now.stiff[1:], *memories, *slide, *(0.0,) * 9))

    def _instant(self, start: list[float], u: list[float], reference: float) -> _Instant:
        """The instant of the inputs; the twist is the one nearest the reference."""
        axes = multiply(conjugate((start[3], start[4], start[5], start[6])), self._axes)
        motions = [*start, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, *u[:13]]
        pose = relative_pose(port_motions(motions), axes)
        rates = relative_rates(port_motions(motions), pose)
        twist = nearest_turn(pose.twist, reference)
        return _Instant(
            pose,
            (pose.offset[0], twist, *pose.swing),
            (rates.offset[0], rates.twist, *rates.swing),
            (rates.offset[1], rates.offset[2]),
        )

    def _now(self, x: Vector, u: Vector) -> _Instant:
        v = as_floats(x)
        return self._instant(v[:7], as_floats(u), v[_TWIST])

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: mean loads of the stiff coordinates, and friction against the mean sliding velocity."""
        v, inputs = as_floats(x), as_floats(u)
        now = self._instant(v[:7], inputs, v[_TWIST])
        starts = (v[_OFFSET], v[_TWIST], v[_TWIST + 1], v[_TWIST + 2])
        loads, mean_rates, end_rates = [], list(now.rates), list(now.rates)
        for i in range(4):
            mean_rate = (now.stiff[i] - starts[i]) / h
            # inertial terms tame held wrenches, which an end-point wrench is not
            memory = Memory(mean_rate, mean_rate)
            if not self._endpoint:
                memory = Memory(v[_MEAN_RATES + i], v[_END_RATES + i])
            motion = StepMotion(starts[i], now.stiff[i], h, memory)
            loads.append(bushing_load(c.stiffness[i], c.damping[i], motion, c.end_weight))
            if inputs[-1] < 0.5:
                mean_rates[i], end_rates[i], _ = remembered(motion, now.rates[i])
        load, offset = [mean.force for mean in loads], now.pose.offset
        slip_y, slip_z = (offset[1] - v[_OFFSET + 1]) / h, (offset[2] - v[_OFFSET + 2]) / h
        speed = sqrt(slip_y * slip_y + slip_z * slip_z)
        resistance = c.resistance(speed)
        force = (load[0], -resistance * slip_y, -resistance * slip_z)
        swing = (0.5 * (starts[2] + now.stiff[2]), 0.5 * (starts[3] + now.stiff[3]))
        torque = conjugate_torque(load[1], (load[2], load[3]), swing)
        slide = MidStep(*v[_SLIDE]).after(speed, h) if inputs[-1] < 0.5 else MidStep.starting(now.speed)
        heat, lost = sum(mean.heat for mean in loads), sum(mean.numerical for mean in loads)
        energies = (v[_FRICTION_HEAT] + resistance * speed * speed * h, v[_DAMPING_HEAT] + heat)
        wrench = (*rotate(now.pose.frame, force), *rotate(now.pose.frame, torque))
        memories = (*mean_rates, *end_rates)
        moved = (*v[:7], *offset, *now.stiff[1:], *memories, *slide)
        return np.array((*moved, *energies, *wrench, v[_NUMERICAL] + lost))

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrench on the trolley."""
        if not self._endpoint:
            return x[_WRENCH].copy()
        now = self._now(x, u)
        load = [
            -k * q - d * w for k, d, q, w in zip(c.stiffness, c.damping, now.stiff, now.rates, strict=True)
        ]
        resistance = c.resistance(now.speed)
        force = (load[0], -resistance * now.velocity[0], -resistance * now.velocity[1])
        torque = conjugate_torque(load[1], (load[2], load[3]), now.pose.swing)
        return np.array((*rotate(now.pose.frame, force), *rotate(now.pose.frame, torque)))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Forces at the communication point, and energies."""
        now = self._now(x, u)
        rate, speed = now.rates[0], now.speed
        if not self._endpoint:
            rate, speed = float(x[_MEAN_RATES]), MidStep(*as_floats(x[_SLIDE])).now()
        friction_heat, damping_heat = float(x[_FRICTION_HEAT]), float(x[_DAMPING_HEAT])
        return np.array(
            (
                -c.stiffness[0] * now.stiff[0] - c.damping[0] * rate,
                c.friction(speed),
                now.speed,
                friction_heat,
                sum(0.5 * k * q * q for k, q in zip(c.stiffness, now.stiff, strict=True)),
                friction_heat + damping_heat,
                float(x[_NUMERICAL]),
            )
        )

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat (W) of friction and of damping."""
        now = self._now(x, u)
        damping = sum(d * w * w for d, w in zip(c.damping, now.rates, strict=True))
        return np.array((c.resistance(now.speed) * now.speed * now.speed, damping))

    def update(self, c: _Constants, x: Vector, u: Vector, at_event: bool) -> Vector:
        """Follow the trolley's turn."""
        result = x.copy()
        result[_TWIST] = self._now(x, u).stiff[1]
        return result

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axes of the plane, normal first, and mode."""
        return {"axis_frame": self._axes, "endpoint": self._endpoint}

    @classmethod
    def example(cls) -> Rail:
        """A horizontal plane."""
        return cls()


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float = 0.0, minimum: float = 0.0) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("normal_stiffness", "N/m", "Stiffness normal to the plane", 1e6),
        tunable("normal_damping", "N.s/m", "Damping normal to the plane"),
        tunable("rotational_stiffness", "N.m/rad", "Stiffness against rotation about any axis", 1e4),
        tunable("rotational_damping", "N.m.s/rad", "Damping of rotation about any axis"),
        tunable("friction_force", "N", "Coulomb friction against sliding"),
        tunable("stiction_velocity", "m/s", "Speed up to which friction rises to its full force", 2e-2, 1e-9),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
    ]


def _observations() -> list[Quantity]:
    return [
        Quantity("normal_force", "N", "Force on the trolley along the normal"),
        Quantity("friction_force_magnitude", "N", "Friction force on the trolley, against its sliding"),
        Quantity("sliding_speed", "m/s", "Speed of the trolley in the plane"),
        Quantity("friction_energy", "J", "Energy dissipated by friction"),
        Quantity("potential_energy", "J", "Elastic energy of the guidance"),
        Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
        numerical_dissipation(),
    ]
