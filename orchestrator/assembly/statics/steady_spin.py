"""Steady spin: what bodies feel in axes that turn at a constant rate, and how that changes with small motion.

With w the rate, p = m w x r and l = J w the momenta in these axes, centrifugal forces are -w x p on the centre of mass,
-w x l about it, and w^T dJ/deta w / 2 on the modes. Gyroscopic forces are linear in the rates, of inertia as it is
undeformed: together they are the linear part of the body's own equations of motion (`components/body.py`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.contract.frames import skew

from ...scene import PlacedScene
from .placed_body import PlacedBody

_STILL = 1e-9
"""Rate (rad/s) of what does not turn: smooth laws begin at rest but for rounding."""


class Spin(NamedTuple):
    """Rate (3,), rad/s, of axes that turn about a point (3,), m, of their line; world axes."""

    rate: Vector
    point: Vector

    def forces(self, placed: PlacedBody) -> Vector:
        """Centrifugal forces (size,) on a body at rest in these axes."""
        result = np.zeros(placed.size)
        if placed.body is None:
            return result
        own, coupling = placed.axes.T @ self.rate, placed.body.inertia
        momentum = placed.body.data.mass * np.cross(self.rate, placed.position - self.point)
        result[:3] = -np.cross(self.rate, momentum)
        result[3:6] = -np.cross(self.rate, placed.axes @ coupling.matrix(placed.eta) @ own)
        result[6:] = 0.5 * np.einsum("a,abm,b->m", own, coupling.slopes(placed.eta), own)
        return result

    def stiffness(self, placed: PlacedBody) -> Vector:
        """Minus their derivatives (size, size); symmetric."""
        result = np.zeros((placed.size, placed.size))
        if placed.body is None:
            return result
        own, turn, coupling = placed.axes.T @ self.rate, skew(self.rate), placed.body.inertia
        inertia = placed.axes @ coupling.matrix(placed.eta) @ placed.axes.T
        changes = placed.axes @ np.einsum("abm,b->am", coupling.slopes(placed.eta), own)
        result[:3, :3] = placed.body.data.mass * turn @ turn
        result[3:6, 3:6] = turn @ (inertia @ turn - skew(inertia @ self.rate))
        result[3:6, 6:] = turn @ changes
        result[6:, 3:6] = result[3:6, 6:].T
        result[6:, 6:] = coupling.curvature(own)
        return result

    def gyroscopic(self, placed: PlacedBody) -> Vector:
        """Minus the derivatives (size, size) of the forces on a body by its rates in these axes; antisymmetric."""
        result = np.zeros((placed.size, placed.size))
        if placed.body is None:
            return result
        own, turn, coupling = placed.axes.T @ self.rate, skew(self.rate), placed.body.inertia
        inertia = placed.axes @ placed.body.data.inertia @ placed.axes.T
        changes = placed.axes @ np.einsum("abm,b->am", coupling.slopes(0.0 * placed.eta), own)
        result[:3, :3] = 2.0 * placed.body.data.mass * turn
        result[3:6, 3:6] = inertia @ turn + turn @ inertia - skew(inertia @ self.rate)
        result[3:6, 6:], result[6:, 3:6] = changes, -changes.T
        result[6:, 6:] = 2.0 * coupling.drag_rates(own)
        return result


def spin_at_start(scene: PlacedScene) -> Spin | None:
    """That of a base that turns by a law, where the law begins; None where it does not turn."""
    motion = scene.base.motion
    rate = 0.0 if motion is None else motion.laws[1].rate(0.0)
    if motion is None or abs(rate) <= _STILL:
        return None
    axis, along = (np.array(a) / np.linalg.norm(a) for a in (motion.rotation_axis, motion.translation_axis))
    return Spin(rate * axis, np.array(motion.pivot) + motion.laws[0].value(0.0) * along)


def turning_at(scene: PlacedScene, time: float) -> list[str]:
    """Names of what turns by a law at a time (s), the base among them."""
    return [name for name, motion in scene.motions.items() if abs(motion.laws[1].rate(time)) > _STILL]
