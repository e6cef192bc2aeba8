"""Exact propagation of independent damped oscillators under a held force, and the energy they dissipate.

Each mode obeys `eta'' + 2 zeta w eta' + w^2 eta = Q`, Q constant over the step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Propagator:
    """Transition over one step size, each field of shape (M,).

    eta1 = a11 eta0 + a12 v0 + b1 Q,   v1 = a21 eta0 + a22 v0 + b2 Q,
    dissipated = w11 z^2 + w12 z v0 + w22 v0^2 with z = eta0 - Q/w^2.
    """

    a11: Vector
    a12: Vector
    a21: Vector
    a22: Vector
    b1: Vector
    b2: Vector
    w11: Vector
    w12: Vector
    w22: Vector
    compliance: Vector

    def dissipated(self, eta: Vector, velocity: Vector, force: Vector) -> float:
        """Energy (J) turned into heat over the step: the integral of 2 zeta w eta'^2, in closed form."""
        z = eta - self.compliance * force
        return float(self.w11 @ (z * z) + self.w12 @ (z * velocity) + self.w22 @ (velocity * velocity))


def propagator(frequency: Vector, damping_ratio: Vector, h: float) -> Propagator:
    """Propagator for step h (s); frequency (M,) in rad/s, positive; damping ratio (M,), not negative.

    The matrix exponential of a 2x2 companion matrix, written with C = (e1 + e2)/2 and
    S = (e1 - e2)/(l1 - l2), which hold for under-, over- and critically damped modes alike.
    """
    w, zeta = frequency, damping_ratio
    root = np.sqrt((zeta * zeta - 1.0).astype(complex))
    l1, l2 = w * (-zeta + root), w * (-zeta - root)
    e1, e2 = np.exp(l1 * h), np.exp(l2 * h)
    gap = l1 - l2
    close = np.abs(gap) * h < 1e-6
    s = np.where(close, h * np.exp(0.5 * (l1 + l2) * h), (e1 - e2) / np.where(close, 1.0, gap)).real
    c = (0.5 * (e1 + e2)).real
    a11, a12, a21, a22 = c + zeta * w * s, s, -w * w * s, c - zeta * w * s
    angle = w * h
    small = angle < 1e-3
    series = h * h * (0.5 - zeta * angle / 3.0 + (4.0 * zeta * zeta - 1.0) * angle * angle / 24.0)
    b1 = np.where(small, series, (1.0 - a11) / (w * w))
    w11, w12, w22 = _dissipation(w, zeta, a11, a12, a21, a22)
    return Propagator(a11, a12, a21, a22, b1, s, w11, w12, w22, 1.0 / (w * w))


def _dissipation(
    w: Vector, zeta: Vector, a11: Vector, a12: Vector, a21: Vector, a22: Vector
) -> tuple[Vector, Vector, Vector]:
    """Quadratic form of the energy 2 zeta w int v^2 dt over a step.

    With the scaled state y = (w z, v) and y' = A y the Gramian G = int E^T e e^T E dt, e = (0, 1), solves
    A^T G + G A = E(h)^T e e^T E(h) - e e^T: three linear equations a mode. Multiplied by 2 zeta w.
    """
    m = w.size
    damped = zeta > 0.0
    zeta_safe = np.where(damped, zeta, 1.0)
    row = np.stack([a21 / w, a22])  # second row of E in scaled coordinates
    right = np.stack([row[0] * row[0], row[0] * row[1], row[1] * row[1] - 1.0], axis=1)
    left = np.zeros((m, 3, 3))
    # A = w [[0, 1], [-1, -2 zeta]]; unknowns (g11, g12, g22)
    left[:, 0, 1] = -2.0 * w
    left[:, 1, 0], left[:, 1, 1], left[:, 1, 2] = w, -2.0 * zeta_safe * w, -w
    left[:, 2, 1], left[:, 2, 2] = 2.0 * w, -4.0 * zeta_safe * w
    gramian = np.linalg.solve(left, right[:, :, None])[:, :, 0] if m else np.zeros((0, 3))
    g11, g12, g22 = np.where(damped, 2.0 * zeta * w, 0.0) * gramian.T
    return g11 * w * w, 2.0 * g12 * w, g22
