"""Eddy-current damper between two ports, about their common axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, Port, Quantity, Vector
from .contract.frames import mean, nearest_turn, rotate
from .numerics.mid_step import MidStepRate
from .numerics.relative_motion import (
    Pose,
    as_floats,
    axis_frame,
    conjugate_torque,
    dissipated_energies,
    gives_end_point,
    mean_direction,
    pair,
    relative_pose,
    relative_rates,
)

_ANGLE, _HEAT, _WRENCH, _RATE = 0, 8, slice(9, 21), slice(21, 25)


@dataclass(frozen=True, slots=True)
class _Constants:
    coefficient: float
    peak_rate: float

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
            ports=[Port("inboard", "connection"), Port("outboard", "connection")],
            parameters=[
                Quantity(
                    "damping_coefficient", "N.m.s/rad", "Torque per rate at low rate", 1, 1.0, 0.0, None, "tunable"
                ),
                Quantity(
                    "peak_rate", "rad/s", "Rate of the largest torque; 0 for a linear damper", 1, 0.0, 0.0,
                    variability="tunable",
                ),
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
        return _Constants(float(p[0]), float(p[1]))

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the pose of the inputs."""
        pose, rate = self._rate(as_floats(u))
        return np.array(
            (pose.twist, *pose.frame, *pose.gap, 0.0, *(0.0,) * 12, *MidStepRate.starting(rate), *pose.swing)
        )

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the torque of the mean rate, and the heat it makes."""
        v = as_floats(x)
        pose, end_rate = self._rate(as_floats(u))
        angle = nearest_turn(pose.twist, v[_ANGLE])
        change = angle - v[_ANGLE]
        torque = c.torque(change / h)
        swing = (0.5 * (v[25] + pose.swing[0]), 0.5 * (v[26] + pose.swing[1]))
        conjugate = conjugate_torque(torque, (0.0, 0.0), swing)
        world = mean_direction((v[1], v[2], v[3], v[4]), pose.frame, conjugate)
        gap = mean((v[5], v[6], v[7]), pose.gap)
        wrench = pair((0.0, 0.0, 0.0), world, gap)
        rate = MidStepRate(*v[_RATE]).after(change / h, h) if u[-1] < 0.5 else MidStepRate.starting(end_rate)
        heat = v[_HEAT] - torque * change
        return np.array((angle, *pose.frame, *pose.gap, heat, *wrench, *rate, *pose.swing))

    def _rate(self, u: list[float]) -> tuple[Pose, float]:
        pose = relative_pose(u, self._axis_frame)
        return pose, relative_rates(u, pose).twist

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports."""
        if not self._endpoint:
            return x[_WRENCH].copy()
        pose, rate = self._rate(as_floats(u))
        torque = conjugate_torque(c.torque(rate), (0.0, 0.0), pose.swing)
        return np.array(pair((0.0, 0.0, 0.0), rotate(pose.frame, torque), pose.gap))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Rate and torque at the communication point, energy dissipated."""
        rate = self._rate(as_floats(u))[1]
        felt = rate if self._endpoint else MidStepRate(*as_floats(x[_RATE])).now()
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
