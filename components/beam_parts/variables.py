"""The variables of a beam beside its ports, and the records that its structure is given as."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from ..contract.component import ComponentError, Quantity, Vector
from ..contract.roles import DISSIPATED_ENERGY, KINETIC_ENERGY, POTENTIAL_ENERGY

_UNTURNED = (1.0, 0.0, 0.0, 0.0)


class Section(NamedTuple):
    """Stiffness and inertia of a section, in its axes: x along the beam."""

    axial: float
    """EA, N"""
    shear_y: float
    """GA of shear along y, N"""
    shear_z: float
    """GA of shear along z, N"""
    torsion: float
    """GJ, N m2"""
    bending_y: float
    """EI of bending about y (deflection along z), N m2"""
    bending_z: float
    """EI of bending about z (deflection along y), N m2"""
    line_mass: float
    """kg/m"""
    inertia_x: float
    """rotary inertia about x per length, kg m"""
    inertia_y: float
    """rotary inertia about y per length, kg m"""
    inertia_z: float
    """rotary inertia about z per length, kg m"""

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Section:
        """From its fields by name; ComponentError where one is missing, unknown, or not positive."""
        odd = set(values) ^ set(cls._fields)
        if odd:
            raise ComponentError(
                f"the section needs {', '.join(cls._fields)}; what is missing or unknown: {', '.join(sorted(odd))}"
            )
        section = cls(**{name: float(value) for name, value in values.items()})
        for name, value in section._asdict().items():
            if not (isfinite(value) and value > 0.0):
                raise ComponentError(f"section: {name} is {value:g}; it must be positive")
        return section

    @property
    def stiffness(self) -> Vector:
        """(6,), in the order of the strains."""
        return np.array(self[:6])

    @property
    def line_inertia(self) -> Vector:
        """(3,), kg m."""
        return np.array(self[7:])


def parameters(nodes: int) -> list[Quantity]:
    """Start of a beam with this number of nodes, fixed; gravity and damping, tunable."""
    vectors = (
        ("initial_position", "m", "Start position of the construction frame, world axes"),
        ("initial_velocity", "m/s", "Start velocity of the centre of mass"),
        ("initial_angular_velocity", "rad/s", "Start angular velocity, world axes"),
    )
    position, velocity, rate = (Quantity(*one, 3, variability="fixed") for one in vectors)
    return [
        position,
        Quantity("initial_orientation", "1", "Start quaternion of the construction frame", 4, _UNTURNED,
                 variability="fixed"),
        velocity,
        rate,
        Quantity("gravity", "m/s2", "Gravitational acceleration, world axes", 3, variability="tunable"),
        Quantity("stiffness_damping", "s", "Damping as a multiple of the stiffness", minimum=0.0,
                 variability="tunable"),
        *(replace(_resized(name, unit, f"Start {text} of the nodes from there, its axes, one after the other",
                           3 * nodes), variability="fixed")
          for name, unit, text in (("initial_displacement", "m", "displacements"),
                                   ("initial_rotation", "rad", "rotation vectors"))),
    ]  # fmt: skip


def observations(nodes: int) -> list[Quantity]:
    """What is recorded of a beam with this number of nodes."""
    elements = nodes - 1
    return [
        Quantity("linear_momentum", "N.s", "Linear momentum, world axes", 3),
        Quantity("angular_momentum", "N.m.s", "Angular momentum about the world origin, world axes", 3),
        KINETIC_ENERGY,
        POTENTIAL_ENERGY.saying("Strain energy and energy in gravity"),
        DISSIPATED_ENERGY.saying("Energy dissipated by damping in proportion to the stiffness since the start"),
        _resized("node_position", "m", "Positions of the nodes, one after the other, world axes", 3 * nodes),
        _resized("section_force", "N", "Force of every element's section, in its axes: axial, shear y and z",
                 3 * elements),
        _resized("section_moment", "N.m", "Moment of every element's section: torsion, bending about y and z",
                 3 * elements),
        _resized("node_orientation", "1", "Quaternions of the sections at the nodes, one after the other, scalar first",
                 4 * nodes),
    ]  # fmt: skip


def states(nodes: int) -> list[Quantity]:
    """The state of a beam with this number of nodes."""
    return [
        Quantity("heat", "J", "Energy dissipated since the start"),
        _resized("position", "m", "Positions of the nodes, world axes", 3 * nodes),
        _resized("orientation", "1", "Quaternions of the sections at the nodes", 4 * nodes),
        _resized("velocity", "m/s", "Velocities of the nodes, world axes", 3 * nodes),
        _resized("angular_velocity", "rad/s", "Angular velocities of the sections, their axes", 3 * nodes),
    ]


def _resized(name: str, unit: str, text: str, size: int) -> Quantity:
    return replace(Quantity(name, unit, text, size), resized=True)
