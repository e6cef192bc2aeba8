"""Axes of beams without load: an arc, straight where it has no curvature, or a smooth curve through points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import hypot

import numpy as np

from ..contract.component import ComponentError, Vector
from ..contract.frames import (
    Quaternion,
    Vector3,
    cross,
    dot,
    multiply,
    norm,
    normalized,
    quaternion_of_axes,
    scaled,
)

_SAMPLES = 400
"""Of a curve between two of its points, by which its length is measured."""
_STRAIGHT = 1e-9
"""Sine of an angle below which two directions are one."""


@dataclass(frozen=True)
class Arc:
    """From the origin along x, in the plane of x and z; curvature (1/m) bends it towards z."""

    length: float
    curvature: float = 0.0

    def at(self, distances: Vector) -> tuple[Vector, Vector]:
        """Positions and unit tangents (n, 3) at distances (n,) along it."""
        turn, zero = self.curvature * distances, np.zeros_like(distances)
        half = np.sinc(0.5 * turn / np.pi)
        along, across = distances * np.sinc(turn / np.pi), 0.5 * distances * turn * half**2
        return np.column_stack((along, zero, across)), np.column_stack((np.cos(turn), zero, np.sin(turn)))


@dataclass(frozen=True)
class Curve:
    """A cubic spline through points (m), a straight line through two."""

    points: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        spans = np.linalg.norm(np.diff(np.array(self.points), axis=0), axis=1)
        if len(self.points) < 2 or not spans.min() > 0.0:
            raise ComponentError("an axis goes through two points or more, neighbours at different places")

    @property
    def length(self) -> float:
        """Along the curve, m."""
        return float(self._lengths[-1])

    def at(self, distances: Vector) -> tuple[Vector, Vector]:
        """Positions and unit tangents (n, 3) at distances (n,) along it."""
        parameter = np.interp(distances, self._lengths, self._parameters)
        position, tangent = self._evaluated(parameter, 0), self._evaluated(parameter, 1)
        return position, tangent / np.linalg.norm(tangent, axis=1)[:, None]

    def _evaluated(self, parameter: Vector, derivative: int) -> Vector:
        points = np.array(self.points, dtype=float)
        if len(points) == 2:
            span = points[1] - points[0]
            along = parameter[:, None] / np.linalg.norm(span) * span
            straight: Vector = (
                points[0] + along if derivative == 0 else np.repeat(span[None], len(parameter), 0)
            )
            return straight
        from scipy.interpolate import CubicSpline  # takes a fifth of the start of all that has no such curve

        found: Vector = CubicSpline(self._knots, points)(parameter, derivative)
        return found

    @cached_property
    def _knots(self) -> Vector:
        chords = np.linalg.norm(np.diff(np.array(self.points, dtype=float), axis=0), axis=1)
        return np.concatenate(([0.0], np.cumsum(chords)))

    @cached_property
    def _parameters(self) -> Vector:
        shares = np.linspace(0.0, 1.0, _SAMPLES, endpoint=False)
        own = self._knots[:-1, None] + shares * np.diff(self._knots)[:, None]
        return np.append(own.ravel(), self._knots[-1])

    @cached_property
    def _lengths(self) -> Vector:
        """Lengths at the parameters: the chords of ten times finer steps would differ by 1e-8 of it."""
        chords = np.linalg.norm(np.diff(self._evaluated(self._parameters, 0), axis=0), axis=1)
        return np.concatenate(([0.0], np.cumsum(chords)))


def section_orientations(tangents: Vector, z: Sequence[float]) -> list[Quaternion]:
    """Quaternions of sections along a curve: x along it, the first z as near a direction as x allows.

    From one to the next they turn as little as x does. ComponentError where z has the direction of the first x.
    """
    first: Vector3 = tuple(tangents[0].tolist())
    up: Vector3 = (z[0], z[1], z[2])
    across = cross(up, first)
    if norm(across) <= _STRAIGHT * norm(up):
        raise ComponentError("section_z has the direction of the axis at its start; give one across it")
    y = scaled(1.0 / norm(across), across)
    found = [quaternion_of_axes(first, y, cross(first, y))]
    for before, after in zip(tangents[:-1].tolist(), tangents[1:].tolist(), strict=True):
        found.append(normalized(multiply(_shortest_turn(tuple(before), tuple(after)), found[-1])))
    return found


def _shortest_turn(before: Vector3, after: Vector3) -> Quaternion:
    """From one unit vector to another that is not opposite to it."""
    x, y, z = cross(before, after)
    w = 1.0 + dot(before, after)
    if hypot(w, x, y, z) < _STRAIGHT:
        raise ComponentError("the axis turns back from one node to the next; take more elements")
    return normalized((w, x, y, z))
