"""Wrenches on the ports of a body over a step, linear in time, and the moments they have on arms that move."""

from __future__ import annotations

from typing import NamedTuple

from ..contract.component import Vector
from ..contract.frames import sum_of_moments


class Load(NamedTuple):
    """Wrenches of all ports, world axes: their means and slopes, each (ports, 3), and the sums of torques."""

    force: Vector
    torque: Vector
    torque_sum: Vector
    force_slope: Vector
    torque_slope: Vector
    torque_slope_sum: Vector

    @classmethod
    def of(cls, u: Vector) -> Load:
        """From a body's inputs."""
        wrench, slope = u.reshape(2, -1, 6)
        force, torque, force_slope, torque_slope = wrench[:, :3], wrench[:, 3:], slope[:, :3], slope[:, 3:]
        return cls(force, torque, torque.sum(0), force_slope, torque_slope, torque_slope.sum(0))

    def moments(self, start: Vector, end: Vector) -> tuple[Vector, Vector]:
        """Mean moment and slope of the moment (3,) on arms (ports, 3) at both ends of a step, world axes.

        A changing force on an arm that moves on has a mean moment as well.
        """
        arms, moved = 0.5 * (start + end), (end - start) / 6.0
        mean = sum_of_moments(arms, self.force) + self.torque_sum + sum_of_moments(moved, self.force_slope)
        return mean, sum_of_moments(arms, self.force_slope) + self.torque_slope_sum
