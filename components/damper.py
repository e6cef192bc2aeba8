"""Eddy-current damper between two ports, about their common axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, Port, Quantity, Vector
from .contract.frames import nearest_turn, rotate
from .numerics.mid_step import MidStep
from .numerics.relative_motion import (
    Passage,
    Pose,
    as_floats,
    axis_frame,
    conjugate_torque,
    dissipated_energies,
    gives_end_point,
    is_of_order_four,
    order_parameter,
    pair,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import MeanLoad
from .numerics.workless_pair import viscous_load

_ANGLE, _HEAT, _WRENCH, _RATE, _SLOPES = 0, 8, slice(9, 21), slice(21, 25), slice(27, 39)
_IMPULSE, _MOMENTS = 26, slice(27, 39)
_NOWHERE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class _Constants:
    coefficient: float
    peak_rate: float
    paired: bool

    def torque(self, rate: float) -> float:
        """Torque against the rate: c w / (1 + (w / w_peak)^2), linear where no peak rate is given."""
        if self.peak_rate == 0.0:
            return -self.coefficient * rate
        return -self.coefficient * rate / (1.0 + (rate / self.peak_rate) ** 2)


class EddyCurrentDamper(Component):
    """Torque against the relative rate of the outboard port about the axis.

    axis: direction in the axes of both ports. The torque of a magnetic brake grows with the rate up to a
    peak and falls beyond it; without a peak rate it is linear.
    """

    kind = "eddy_current_damper"

    def __init__(self, axis: Sequence[float] = (0.0, 1.0, 0.0), wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._axis_frame = axis_frame(axis, "the damper's axis")
        self._declare(
            {"axis": tuple(axis), "wrench_mode": wrench_mode},
            ports=[
                Port(name, "connection", 2 if self._endpoint else 4) for name in ("inboard", "outboard")
            ],
            parameters=[
                Quantity(
                    "damping_coefficient", "N.m.s/rad", "Torque per rate at low rate", 1, 1.0, 0.0, None, "tunable"
                ),
                Quantity(
                    "peak_rate", "rad/s", "Rate of the largest torque; 0 for a linear damper", 1, 0.0, 0.0,
                    variability="tunable",
                ),
                order_parameter(),
            ],
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=[
                Quantity("angular_rate", "rad/s", "Rate of the outboard against the inboard port"),
                Quantity("damper_torque", "N.m", "Torque on the outboard side about the axis"),
                Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
            ],
            feedthrough=self._endpoint,
        )  # fmt: skip
        if self._endpoint:
            self.continuous = dissipated_energies(_HEAT)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        return _Constants(float(p[0]), float(p[1]), is_of_order_four(float(p[2])) and not self._endpoint)

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the pose of the inputs."""
        pose, rate = self._rate(as_floats(u))
        slide = MidStep.starting(rate)
        return np.array((pose.twist, *pose.frame, *pose.gap, *(0.0,) * 13, *slide, *pose.swing, *(0.0,) * 12))

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the torque of the mean rate, at order 4 that along the path, and the heat it makes."""
        v, inputs = as_floats(x), as_floats(u)
        pose, end_rate = self._rate(inputs)
        angle = nearest_turn(pose.twist, v[_ANGLE])
        change = angle - v[_ANGLE]
        swing = (0.5 * (v[25] + pose.swing[0]), 0.5 * (v[26] + pose.swing[1]))
        passage = Passage((v[1], v[2], v[3], v[4]), pose.frame, (v[5], v[6], v[7]), pose.gap)
        rate = MidStep.starting(end_rate)
        if c.paired and inputs[_IMPULSE] < 0.5:
            moment = passage.rate_moments(inputs[_MOMENTS], swing).twist
            load = viscous_load(c.torque, change, moment, h)
            rate = MidStep.starting((change + 3.0 * moment) / h)
        else:
            torque = c.torque(change / h)
            load = MeanLoad(torque, -torque * change, 0.0)
            if inputs[_IMPULSE] < 0.5:
                rate = MidStep(*v[_RATE]).after(change / h, h)
        wrench, slopes = (passage.twist_wrench(torque, swing) for torque in (load.force, load.slope))
        heat = v[_HEAT] + load.heat
        return np.array((angle, *pose.frame, *pose.gap, heat, *wrench, *rate, *pose.swing, *slopes))

    def _rate(self, u: list[float]) -> tuple[Pose, float]:
        pose = relative_pose(u, self._axis_frame)
        return pose, relative_rates(u, pose).twist

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[_WRENCH], x[_SLOPES]))
        pose, rate = self._rate(as_floats(u))
        torque = conjugate_torque(c.torque(rate), (0.0, 0.0), pose.swing)
        return np.array(pair(_NOWHERE, rotate(pose.frame, torque), pose.gap))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Rate and torque at the communication point, energy dissipated."""
        rate = self._rate(as_floats(u))[1]
        felt = rate if self._endpoint else MidStep(*as_floats(x[_RATE])).now()
        return np.array((rate, c.torque(felt), x[_HEAT]))

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat of the end-point torque (W)."""
        rate = self._rate(as_floats(u))[1]
        return np.array((-c.torque(rate) * rate,))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axis and mode."""
        return {"axis_frame": self._axis_frame, "endpoint": self._endpoint}

    @classmethod
    def example(cls) -> EddyCurrentDamper:
        """A damper about the y axis."""
        return cls()
