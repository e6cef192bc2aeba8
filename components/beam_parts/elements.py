"""Elements of a geometrically exact (Simo-Reissner) beam: exact strains of a helix, and loads that keep energy.

An element joins two nodes with rotations Ra, Rb (columns: section axes, the first along the axis) by X = xb - xa. Two
3-vectors are bilinear in these (L: length of the element),

    s = (Ra + Rb)^T X / (2 L)        k = axial vector of Ra^T Rb / L

and with y = L^2 k.k = sin^2 of the angle between the sections, c = asin(sqrt y) / sqrt y and d = (c - 1) / y,

    gamma = c s - L^2 d (k.s) k      kappa = c k

are stretch with shear and curvature of the helix between the nodes (the logarithm of their relative motion). The energy
is L/2 e.C e, e = (gamma, kappa) less their values at rest.

Over a step z = (s, k) changes by the mean B of its derivatives times the travel, exactly, as it is bilinear and Cayley
rotations turn section axes about their mean. Its strain changes by E dz, exactly, where E has divided differences of
c and d in place of their derivatives. So the loads B^T E^T C (e0 + e1)/2 do the work that the energy takes, without a
quotient that could vanish; and as B holds relative motion alone, they change no momentum.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import ComponentError, Vector
from ..contract.frames import skew

SMALLEST_TRACE = 2.0
"""Of a relative rotation by 60 degrees: beyond it, elements are too coarse."""
LARGEST_SQUARE = 0.75
"""Square of the sine of that angle."""
_NEGLIGIBLE = 1e-18
_IDENTITY = np.eye(3)


class Poses(NamedTuple):
    """Directors of the nodes (n, 3, 3), columns the section axes, and vectors (n - 1, 3) from node to node, m."""

    directors: Vector
    spans: Vector

    def mean(self, other: Poses) -> Poses:
        """Means of both, as they are: means of directors are no rotations."""
        return Poses(0.5 * (self.directors + other.directors), 0.5 * (self.spans + other.spans))


class Strains(NamedTuple):
    """Of m elements: s and k, each (m, 3), y, c and d (m,), g = k.s (m,), gamma and kappa (m, 3)."""

    s: Vector
    k: Vector
    y: Vector
    c: Vector
    d: Vector
    g: Vector
    gamma: Vector
    kappa: Vector


class Differences(NamedTuple):
    """Divided differences (m,) of c and d from y0 to y1, their derivatives by y1, and the derivatives of c and d."""

    c: Vector
    d: Vector
    c_by_end: Vector
    d_by_end: Vector
    slope_c: Vector
    slope_d: Vector


class Elements:
    """The m elements of a beam between n = m + 1 nodes.

    lengths: (m,), m. stiffness: (6,), N and N.m2, of axial stretch, shear y, z, torsion, bending about y, z. rest:
    strains (m, 6) without load. Loads on nodes are (m, 12), world axes: force and moment on the first, then on the
    second.
    """

    def __init__(self, poses: Poses, stiffness: Vector) -> None:
        self.stiffness = stiffness
        self.lengths = np.ones(len(poses.spans))
        self.lengths = np.linalg.norm(self.strains(poses).gamma, axis=1)
        self.rest = _joined(self.strains(poses))

    def strains(self, poses: Poses) -> Strains:
        """Strains at these poses; ComponentError where an element turns beyond its range."""
        first, second = poses.directors[:-1], poses.directors[1:]
        relative = first.swapaxes(1, 2) @ second
        length = self.lengths[:, None]
        s = np.einsum("nji,nj->ni", first + second, poses.spans) / (2.0 * length)
        k = 0.5 * _twice_axial(relative) / length
        y = self.lengths**2 * (k * k).sum(1)
        trace = np.trace(relative, axis1=1, axis2=2)
        # written so that what is not a number is beyond the range as well
        beyond = ~((trace >= SMALLEST_TRACE) & (y <= LARGEST_SQUARE))
        if beyond.any():
            raise ComponentError(
                f"element {int(np.argmax(beyond)) + 1} of {len(beyond)} turns by more than 60 deg between its ends;"
                " take more elements, smaller steps or smaller loads"
            )
        d = _divided(y, y)[0]
        c, g = 1.0 + y * d, (k * s).sum(1)
        gamma = c[:, None] * s - (self.lengths**2 * d * g)[:, None] * k
        return Strains(s, k, y, c, d, g, gamma, c[:, None] * k)

    def excess(self, strains: Strains) -> Vector:
        """Strains (m, 6) less those at rest."""
        return _joined(strains) - self.rest

    def resultants(self, strains: Strains) -> Vector:
        """Forces (N) and moments (N.m) of the sections, (m, 6), in their axes."""
        return self.stiffness * self.excess(strains)

    def energy(self, strains: Strains) -> float:
        """Elastic energy, J."""
        excess = self.excess(strains)
        return float(0.5 * (self.lengths[:, None] * self.stiffness * excess * excess).sum())

    def motions(self, poses: Poses) -> Vector:
        """B, (m, 6, 12): rates of (s, k) by the velocities and angular velocities of both nodes."""
        first, second = poses.directors[:-1], poses.directors[1:]
        length = self.lengths[:, None, None]
        b = np.zeros((len(poses.spans), 6, 12))
        axes = 0.5 * (first + second).swapaxes(1, 2) / length
        b[:, :3, :3], b[:, :3, 6:9] = -axes, axes
        for columns, directors in ((slice(3, 6), first), (slice(9, 12), second)):
            b[:, :3, columns] = directors.swapaxes(1, 2) @ skew(poses.spans) / (2.0 * length)
        products = (
            skew(first.swapaxes(1, 2)) @ second[:, None]
        )  # [m, j, :, k]: axis j of the first times k of the second
        for i, j, k in _CYCLIC:
            b[:, 3 + i, 3:6] = (products[:, k, :, j] - products[:, j, :, k]) / (2.0 * length[:, 0])
        b[:, 3:, 9:] = -b[:, 3:, 3:6]
        return b

    def changes_of_strain(self, start: Strains, end: Strains) -> tuple[Vector, Differences]:
        """E of a step, (m, 6, 6), with strains(end) - strains(start) = E (z1 - z0), and what it is made of."""
        _, d, d_by_end = _divided(start.y, end.y)
        slope_d = d + (end.y - start.y) * d_by_end
        differences = Differences(
            start.d + end.y * d, d, d + end.y * d_by_end, d_by_end, end.d + end.y * slope_d, slope_d
        )
        return self._changes(start, end, differences.c, d), differences

    def _changes(self, start: Strains, end: Strains, by_y_of_c: Vector, by_y_of_d: Vector) -> Vector:
        s, k, c, d, g = (
            0.5 * (a + b)
            for a, b in (
                (start.s, end.s),
                (start.k, end.k),
                (start.c, end.c),
                (start.d, end.d),
                (start.g, end.g),
            )
        )
        w = 0.5 * (start.d * start.g + end.d * end.g)
        square = self.lengths**2
        kk = k[:, :, None] * k[:, None, :]
        turned = 2.0 * square * by_y_of_c
        found = np.zeros((len(square), 6, 6))
        found[:, 3:, 3:] = _times(c, _IDENTITY) + _times(turned, kk)
        found[:, :3, :3] = _times(c, _IDENTITY) - _times(square * d, kk)
        found[:, :3, 3:] = (
            _times(turned, s[:, :, None] * k[:, None, :]) - _times(square * w, _IDENTITY)
            - _times(square * d, k[:, :, None] * s[:, None, :]) - _times(2.0 * square**2 * g * by_y_of_d, kk)
        )  # fmt: skip
        return found

    def grown(self, start: Strains, end: Strains, change: Vector) -> Vector:
        """Changes (m, 6) of the strains over a step by those of (s, k), without cancellation."""
        by_change, _ = self.changes_of_strain(start, end)
        found: Vector = np.einsum("nij,nj->ni", by_change, change)
        return found

    def _means(self, start: Strains, end: Strains, viscous: Vector) -> Vector:
        """Mean resultants (m, 6) over a step. viscous: growth of strains that viscosity resists, by stiffness."""
        found: Vector = self.stiffness * (0.5 * (self.excess(start) + self.excess(end)) + viscous)
        return found

    def stresses(self, start: Strains, end: Strains, viscous: Vector) -> Vector:
        """Means (m, 6) over a step of what does the work of elasticity and viscosity on (s, k)."""
        change, _ = self.changes_of_strain(start, end)
        found: Vector = np.einsum("nji,nj->ni", change, self._means(start, end, viscous))
        return found

    def stiffnesses(self, start: Strains, end: Strains, damping: float, viscous: Vector) -> Vector:
        """Derivatives (m, 6, 6) of these by (s, k) at the end. damping: of the stiffness, over the size of the step."""
        change, by_y = self.changes_of_strain(start, end)
        rates = self._changes(end, end, by_y.slope_c, by_y.slope_d)
        found: Vector = (0.5 + damping) * change.swapaxes(1, 2) @ (self.stiffness[:, None] * rates)
        return found + self._curvature(start, end, self._means(start, end, viscous), by_y)

    def _curvature(self, start: Strains, end: Strains, mean: Vector, by_y: Differences) -> Vector:
        """Derivative (m, 6, 6) by (s, k) at the end of E^T times fixed resultants."""
        square = self.lengths**2
        force, moment = mean[:, :3], mean[:, 3:]
        s, k = 0.5 * (start.s + end.s), 0.5 * (start.k + end.k)
        d, g = 0.5 * (start.d + end.d), 0.5 * (start.g + end.g)
        kf, sf, km = (k * force).sum(1), (s * force).sum(1), (k * moment).sum(1)
        # derivatives by (s, k) of: y, mean c and d, divided differences of c and d, mean g, mean d g
        zero = np.zeros_like(k)
        y = np.concatenate((zero, 2.0 * square[:, None] * end.k), axis=1)
        g_end = np.concatenate((end.k, end.s), axis=1)
        w = 0.5 * (end.d[:, None] * g_end + (end.g * by_y.slope_d)[:, None] * y)
        half_s, half_k = 0.5 * np.eye(3, 6), 0.5 * np.eye(3, 6, 3)
        with_k, with_s = force @ half_k, force @ half_s
        found = np.zeros((len(square), 6, 6))
        c_y, d_y = 0.5 * by_y.slope_c[:, None] * y, 0.5 * by_y.slope_d[:, None] * y
        found[:, :3] = (
            _outer(force, c_y) - _outer(k, _by(square * kf, d_y) + _by(square * d, with_k))
            - _times(square * d * kf, half_k)
        )  # fmt: skip
        turned = 2.0 * square * by_y.c
        found[:, 3:] = (
            _outer(moment, c_y) + _times(turned * (sf + km), half_k)
            + _outer(k, _by(turned, with_s + moment @ half_k) + _by(2.0 * square * (sf + km) * by_y.c_by_end, y))
            - _outer(force, _by(square, w))
            - _outer(s, _by(square * kf, d_y) + _by(square * d, with_k)) - _times(square * d * kf, half_s)
            - _times(2.0 * square**2 * g * by_y.d * kf, half_k)
            - _outer(k, _by(2.0 * square**2 * kf * by_y.d, 0.5 * g_end)
                     + _by(2.0 * square**2 * g * kf * by_y.d_by_end, y)
                     + _by(2.0 * square**2 * g * by_y.d, with_k))
        )  # fmt: skip
        return found

    def changes(self, mean: Poses, travel: Vector, turn: Vector) -> Vector:
        """Changes (m, 6) of (s, k) by travel and Cayley rotation vectors (n, 3) of the nodes, without cancellation."""
        nodes = np.concatenate((travel[:-1], turn[:-1], travel[1:], turn[1:]), axis=1)
        found: Vector = np.einsum("nij,nj->ni", self.motions(mean), nodes)
        return found

    def loads(self, mean: Poses, stress: Vector) -> Vector:
        """Loads (m, 12) on the nodes of each element."""
        found: Vector = -self.lengths[:, None] * np.einsum("nij,ni->nj", self.motions(mean), stress)
        return found

    def tangent(self, start: Poses, end: Poses, stress: Vector, stiffness: Vector) -> Vector:
        """Derivatives (m, 12, 12) of the loads of a step by displacements and rotation vectors of the nodes at its end.

        stress, stiffness: what `stresses` and `stiffnesses` give.
        """
        mean = start.mean(end)
        material = self.motions(mean).swapaxes(1, 2) @ stiffness @ self.motions(end)
        return -self.lengths[:, None, None] * material + self._geometric(mean, end, stress)

    def _geometric(self, mean: Poses, end: Poses, stress: Vector) -> Vector:
        """The part of it that fixed stresses have, as their directors and arms turn."""
        found = np.zeros((len(stress), 12, 12))
        force, moment = 0.5 * stress[:, :3, None], stress[:, 3:]
        span, first, second = skew(mean.spans), slice(3, 6), slice(9, 12)
        for own, nodes in ((first, slice(None, -1)), (second, slice(1, None))):
            now, later = (skew((poses.directors[nodes] @ force)[:, :, 0]) for poses in (mean, end))
            found[:, :3, own] = -0.5 * later
            found[:, 6:9, own] = 0.5 * later
            found[:, own, :3], found[:, own, 6:9] = 0.5 * now, -0.5 * now
            found[:, own, own] = -0.5 * span @ later
        by_first, by_second = self._turned_moments(mean.directors, end.directors, moment)
        found[:, first, first] -= by_first
        found[:, first, second] -= by_second
        found[:, second, first] += by_first
        found[:, second, second] += by_second
        return found

    @staticmethod
    def _turned_moments(mean: Vector, end: Vector, moment: Vector) -> tuple[Vector, Vector]:
        """Derivatives (m, 3, 3) of the moment between the nodes by the rotations of its first and its second."""
        turning = skew(moment)
        first = end[:-1] @ turning @ mean[1:].swapaxes(1, 2)
        second = (mean[:-1] @ turning @ end[1:].swapaxes(1, 2)).swapaxes(1, 2)
        by_first, by_second = (
            0.25 * (m - np.trace(m, axis1=1, axis2=2)[:, None, None] * _IDENTITY) for m in (first, second)
        )
        return by_first, -by_second


_CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def _twice_axial(matrix: Vector) -> Vector:
    """Twice the axial vectors (m, 3) of the skew parts of matrices (m, 3, 3)."""
    return np.stack([matrix[:, k, j] - matrix[:, j, k] for _, j, k in _CYCLIC], axis=1)


def _joined(strains: Strains) -> Vector:
    return np.concatenate((strains.gamma, strains.kappa), axis=1)


def _times(weight: Vector, matrix: Vector) -> Vector:
    found: Vector = weight[:, None, None] * matrix
    return found


def _by(weight: Vector, row: Vector) -> Vector:
    found: Vector = weight[:, None] * row
    return found


def _outer(column: Vector, row: Vector) -> Vector:
    found: Vector = column[:, :, None] * row[:, None, :]
    return found


def _divided(start: Vector, end: Vector) -> tuple[Vector, Vector, Vector]:
    """Values (m,) of d(y) at the start, its divided difference to the end, and the derivative of this by the end.

    d(y) = (asin(sqrt y) / sqrt y - 1) / y, by its power series, of numbers up to three quarters.
    """
    coefficient, n = 1.0 / 6.0, 1
    value = np.full_like(start, coefficient)
    difference, by_end = np.zeros_like(start), np.zeros_like(start)
    power, sums, sums_by_end = np.ones_like(start), np.ones_like(start), np.zeros_like(start)
    largest = float(np.maximum(start, end).max(initial=0.0))
    size = 1.0
    while coefficient * n * n * size > _NEGLIGIBLE:
        coefficient *= (2.0 * n + 1.0) ** 2 / ((2.0 * n + 2.0) * (2.0 * n + 3.0))
        difference += coefficient * sums
        by_end += coefficient * sums_by_end
        power = power * start
        value += coefficient * power
        sums_by_end = sums + end * sums_by_end
        sums = end * sums + power
        size, n = size * largest, n + 1
    return value, difference, by_end
