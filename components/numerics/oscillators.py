"""Exact propagation of independent damped oscillators under a force linear in time, and the energy they dissipate.

Each mode obeys `eta'' + 2 zeta w eta' + w^2 eta = Q + S P1(t)` over a step of size h, P1 = 2 t / h - 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..contract.quantity import Vector

_SERIES_BELOW, _SERIES_TERMS, _ROOTS_ABOVE = 2.0, 32, 2.0


@dataclass(frozen=True, slots=True)
class Propagator:
    """Transition over one step size, each field of shape (M,).

    eta1 = a11 eta0 + a12 v0 + b1 Q + c1 S,   v1 = a21 eta0 + a22 v0 + b2 Q + c2 S,
    integral of P1 v dt = -c1 (Q - w^2 eta0) - c2 v0 + d S,
    dissipated = w11 z^2 + w12 z v0 + w22 v0^2 + S (s1 z + s2 v0 + s3 S) with z = eta0 - Q/w^2.
    """

    a11: Vector
    a12: Vector
    a21: Vector
    a22: Vector
    b1: Vector
    b2: Vector
    c1: Vector
    c2: Vector
    d: Vector
    w11: Vector
    w12: Vector
    w22: Vector
    s1: Vector
    s2: Vector
    s3: Vector
    stiffness: Vector
    compliance: Vector

    def end(self, eta: Vector, velocity: Vector, force: Vector, slope: Vector) -> tuple[Vector, Vector]:
        """Coordinates and velocities (M,) at the end of a step."""
        moved = self.a11 * eta + self.a12 * velocity + self.b1 * force + self.c1 * slope
        return moved, self.a21 * eta + self.a22 * velocity + self.b2 * force + self.c2 * slope

    def dissipated(self, eta: Vector, velocity: Vector, force: Vector, slope: Vector) -> float:
        """Energy (J) turned into heat over the step: the integral of 2 zeta w eta'^2, in closed form."""
        z = eta - self.compliance * force
        heat = float(self.w11 @ (z * z) + self.w12 @ (z * velocity) + self.w22 @ (velocity * velocity))
        return heat + float(slope @ (self.s1 * z + self.s2 * velocity + self.s3 * slope))

    def moment(self, eta: Vector, velocity: Vector, force: Vector, slope: Vector) -> Vector:
        """First moment of the velocity over the step, the integral of P1 eta' dt, shape (M,)."""
        return self.c1 * (self.stiffness * eta - force) - self.c2 * velocity + self.d * slope


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
    c1, c2, moment = _slope_response(zeta, angle, d.s / h, b1 / (h * h)) * np.array([[h * h], [h], [h * h]])
    return Propagator(
        *(a11, d.s, -w * w * d.s, a22),
        *(b1, d.s, c1, c2, moment),
        *_dissipation(w, zeta, d.s, a22),
        *_slope_dissipation(w, zeta, (d.s, a22, b1), (c1, c2, moment)),
        stiffness=w * w,
        compliance=1.0 / (w * w),
    )


def _slope_response(zeta: Vector, angle: Vector, g0: Vector, g1: Vector) -> Vector:
    """c1 / h^2, c2 / h and d / h^2, shape (3, M), from w h and the responses g0 = a12 / h and g1 = b1 / h^2.

    With g(k) the k-fold integral over a step of the response to an impulse, of size one, they are 2 g2 - g1,
    2 g1 - g0 and 4 g2 - 4 g3 - g1: series where these differences are small, the recurrence
    (w h)^2 g(k) = 1 / (k-1)! - 2 zeta w h g(k-1) - g(k-2) where it is stable, and a difference of both roots far
    above critical damping.
    """
    series = np.maximum(zeta, 1.0) * angle < _SERIES_BELOW
    roots = ~series & (zeta >= _ROOTS_ABOVE)
    square = np.where(series | roots, 1.0, angle * angle)
    g2 = (1.0 - 2.0 * zeta * angle * g1 - g0) / square
    g3 = (0.5 - 2.0 * zeta * angle * g2 - g1) / square
    result = np.array((2.0 * g2 - g1, 2.0 * g1 - g0, 4.0 * g2 - 4.0 * g3 - g1))
    result[:, series] = _slope_series(-2.0 * (zeta * angle)[series], -(angle[series] ** 2))
    result[:, roots] = _slope_roots(zeta[roots], angle[roots])
    return result


def _slope_series(first: Vector, second: Vector) -> Vector:
    """The three as series of the derivatives of the response: y(n+2) = first y(n+1) + second y(n)."""
    result = np.zeros((3, first.size))
    before, now, factorial = np.zeros_like(first), np.ones_like(first), 2.0
    for n in range(_SERIES_TERMS):
        term = now / factorial  # factorial = (n + 2)!
        result -= np.array([[(n + 1) / (n + 3)], [n], [n / (n + 4)]]) * term
        before, now, factorial = now, first * now + second * before, factorial * (n + 3)
    return result


def _slope_roots(zeta: Vector, angle: Vector) -> Vector:
    """The three as divided differences of what one exponential gives, between the two real roots."""
    root = np.sqrt((zeta - 1.0) * (zeta + 1.0))
    slow, fast = -angle / (zeta + root), -angle * (zeta + root)
    return (_slope_of_exponential(slow) - _slope_of_exponential(fast)) / (slow - fast)


def _slope_of_exponential(z: Vector) -> Vector:
    """The same of a response exp(z t / h), shape (3, M), z negative."""
    below = z < -1.0
    y = np.where(below, z, -1.0)
    phi1 = np.expm1(y) / y
    phi2 = (phi1 - 1.0) / y
    phi3 = (phi2 - 0.5) / y
    closed = np.array((2.0 * phi2 - phi1, 2.0 * phi1 - np.exp(y), 4.0 * phi2 - 4.0 * phi3 - phi1))
    series, power = np.zeros((3, z.size)), np.ones_like(z)
    for n in range(_SERIES_TERMS):
        # power = z^n / (n + 1)!
        series += np.array([[-n / (n + 2)], [1.0 - n], [-(n * n + n - 2) / ((n + 2) * (n + 3))]]) * power
        power = power * np.maximum(z, -1.0) / (n + 2)
    return np.where(below, closed, series)


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


def _slope_dissipation(
    w: Vector, zeta: Vector, held: tuple[Vector, Vector, Vector], sloped: tuple[Vector, Vector, Vector]
) -> tuple[Vector, Vector, Vector]:
    """What a slope S adds to the energy dissipated, S (s1 z + s2 v0 + s3 S): its work less the energy it brings."""
    (s, a22, b1), (c1, c2, d) = held, sloped
    square, damped = w * w, zeta > 0.0
    s1 = np.where(damped, square * (square * b1 * c1 + s * c2), 0.0)
    s2 = np.where(damped, -(1.0 + a22) * c2 - square * s * c1, 0.0)
    s3 = np.where(damped, d - 0.5 * (c2 * c2 + square * c1 * c1), 0.0)
    return s1, s2, s3
