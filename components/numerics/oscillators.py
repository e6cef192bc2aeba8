"""Exact propagation of independent damped oscillators under a held force, and the energy they dissipate.

Each mode obeys `eta'' + 2 zeta w eta' + w^2 eta = Q`, Q constant over the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

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


class _Decay(NamedTuple):
    """Free motion over a step by a mode's slower root, or by the real part of both where they are complex.

    a11 = first + rate s, a22 = second - rate s, loss = 1 - first; each field of shape (M,), rate in 1/s.
    """

    first: Vector
    second: Vector
    loss: Vector
    rate: Vector
    s: Vector


def propagator(frequency: Vector, damping_ratio: Vector, h: float) -> Propagator:
    """Propagator for step h (s); frequency (M,) in rad/s, positive; damping ratio (M,), not negative.

    The matrix exponential of a 2x2 companion matrix without differences of nearly equal numbers: modes far
    above critical damping, as stiffness-proportional damping makes them, keep the accuracy of the others.
    """
    w, zeta, angle = frequency, damping_ratio, frequency * h
    d = _decay(w, zeta, h)
    a11, a22 = d.first + d.rate * d.s, d.second - d.rate * d.s
    small = np.maximum(zeta, 1.0) * angle < 1e-3
    series = h * h * (0.5 - zeta * angle / 3.0 + (4.0 * zeta * zeta - 1.0) * angle * angle / 24.0)
    b1 = np.where(small, series, (d.loss - d.rate * d.s) / (w * w))
    w11, w12, w22 = _dissipation(w, zeta, d.s, a22)
    return Propagator(a11, d.s, -w * w * d.s, a22, b1, d.s, w11, w12, w22, 1.0 / (w * w))


def _decay(w: Vector, zeta: Vector, h: float) -> _Decay:
    over = zeta >= 1.0
    root = np.sqrt(np.abs((zeta - 1.0) * (zeta + 1.0)))
    rate = np.where(over, w / (zeta + root), zeta * w)
    envelope, gap = np.exp(-rate * h), 2.0 * w * root
    swing = envelope * np.cos(0.5 * gap * h)
    numerator = np.where(over, -np.expm1(-gap * h), 2.0 * np.sin(0.5 * gap * h))
    s = envelope * np.where(gap > 0.0, numerator / np.where(gap > 0.0, gap, 1.0), h)
    return _Decay(
        first=np.where(over, envelope, swing),
        second=np.where(over, envelope * np.exp(-gap * h), swing),
        loss=np.where(over, -np.expm1(-rate * h), 1.0 - swing),
        rate=rate,
        s=s,
    )


def _dissipation(w: Vector, zeta: Vector, s: Vector, a22: Vector) -> tuple[Vector, Vector, Vector]:
    """Quadratic form of the energy 2 zeta w int v^2 dt over a step.

    With the scaled state y = (w z, v) and y' = A y the Gramian G = int E^T e e^T E dt, e = (0, 1), solves
    A^T G + G A = E(h)^T e e^T E(h) - e e^T, with (-w s, a22) the second row of E: solved by elimination.
    """
    r0, r1 = (w * s) ** 2, -w * s * a22
    w22 = np.where(zeta > 0.0, 0.5 * (1.0 - a22 * a22 - r0), 0.0)
    w11 = w * w * (2.0 * zeta * (r1 - zeta * r0) + w22)
    return w11, -2.0 * zeta * w * r0, w22
