"""Masses of a component, from which the mass properties of a whole structure follow."""

from __future__ import annotations

from typing import NamedTuple

from .quantity import Vector


class RigidMass(NamedTuple):
    """A rigid mass that moves with observations of its component.

    mass: kg. center_of_mass: (3,) m, from the mean of two positions. inertia: (3, 3) about it, kg.m2. Both are in the
    axes of a quaternion. ends, orientation: first places of the positions and of the quaternion among the observations.
    """

    mass: float
    center_of_mass: Vector
    inertia: Vector
    ends: tuple[int, int]
    orientation: int
