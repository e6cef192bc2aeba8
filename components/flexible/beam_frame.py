"""Frames of straight three-dimensional beams -> finite elements.

Bernoulli beams with cubic bending, linear stretch and linear twist. The mass is sampled at four stations an
element and, there, at four places around the axis, which gives a tube its exact rotary inertia and keeps
the mass matrix regular.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi, sqrt

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from .finite_elements import FiniteElementModel, SparseMatrix
from .membrane_strain import MembraneStrain
from .modal import rigid_motion

_STATIONS, _STATION_WEIGHTS = np.polynomial.legendre.leggauss(4)  # exact for the square of a cubic


@dataclass(frozen=True)
class BeamSection:
    """Stiffnesses of a beam about its own axes; x runs along it, z is as close to world z as it can be."""

    axial: float
    """EA, N"""
    bending_y: float
    """EI of bending about y (deflection along z), N m2"""
    bending_z: float
    """EI of bending about z (deflection along y), N m2"""
    torsion: float
    """GJ, N m2"""
    line_mass: float = 0.0
    """kg/m"""
    gyration_radius: float = 0.0
    """polar radius of gyration of the cross-section, m"""


def tube_section(
    diameter: float, wall: float, youngs_modulus: float, shear_modulus: float, density: float
) -> BeamSection:
    """Round tube of outer diameter and wall thickness (m), moduli (Pa) and density (kg/m3)."""
    inner = diameter - 2.0 * wall
    area = pi / 4.0 * (diameter**2 - inner**2)
    second_moment = pi / 64.0 * (diameter**4 - inner**4)
    return BeamSection(
        axial=youngs_modulus * area,
        bending_y=youngs_modulus * second_moment,
        bending_z=youngs_modulus * second_moment,
        torsion=shear_modulus * 2.0 * second_moment,
        line_mass=density * area,
        gyration_radius=sqrt(2.0 * second_moment / area),
    )


@dataclass(frozen=True)
class Member:
    """A straight beam between two named joints; `extra_line_mass` (kg/m) rides on it without stiffness."""

    start: str
    end: str
    section: BeamSection
    elements: int = 8
    extra_line_mass: float = 0.0


def beam_axes(start: Vector, end: Vector) -> Vector:
    """Rotation (3, 3) whose rows are the beam's x, y, z in construction axes."""
    x = (end - start) / np.linalg.norm(end - start)
    up = np.array([0.0, 0.0, 1.0]) if abs(x[2]) < 0.99 else np.array([0.0, 1.0, 0.0])
    y = np.cross(up, x)
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def beam_stiffness(section: BeamSection, start: Vector, end: Vector) -> Vector:
    """Stiffness (12, 12) for the translation and rotation of both ends, construction axes."""
    length = float(np.linalg.norm(end - start))
    k = np.zeros((12, 12))
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    k[np.ix_((0, 6), (0, 6))] = section.axial * pair
    k[np.ix_((3, 9), (3, 9))] = section.torsion * pair
    a, b = 12.0 / length**3, 6.0 / length**2
    c, d = 4.0 / length, 2.0 / length
    bending = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
    k[np.ix_((1, 5, 7, 11), (1, 5, 7, 11))] = section.bending_z * bending
    turn = np.array([1.0, -1.0, 1.0, -1.0])  # slope of z deflection is minus the rotation about y
    k[np.ix_((2, 4, 8, 10), (2, 4, 8, 10))] = section.bending_y * bending * np.outer(turn, turn)
    axes = np.kron(np.eye(4), beam_axes(start, end))
    result: Vector = axes.T @ k @ axes
    return result


def _section_motion(length: float, fraction: float) -> Vector:
    """Translation and rotation (6, 12) of the section at a fraction of the length, beam axes."""
    s = fraction
    value = (1 - 3 * s**2 + 2 * s**3, length * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3)
    values = np.array([*value, length * (s**3 - s**2)])
    slopes = np.array([(6 * s**2 - 6 * s) / length, 1 - 4 * s + 3 * s**2, (6 * s - 6 * s**2) / length])
    slopes = np.append(slopes, 3 * s**2 - 2 * s)
    turn = np.array([1.0, -1.0, 1.0, -1.0])
    motion = np.zeros((6, 12))
    motion[(0, 3), (0, 3)] = 1.0 - s
    motion[(0, 3), (6, 9)] = s
    motion[1, [1, 5, 7, 11]] = values
    motion[5, [1, 5, 7, 11]] = slopes
    motion[2, [2, 4, 8, 10]] = values * turn
    motion[4, [2, 4, 8, 10]] = -slopes * turn
    return motion


def beam_mass_samples(
    section: BeamSection, extra_line_mass: float, start: Vector, end: Vector
) -> tuple[Vector, Vector, Vector]:
    """Masses (16,), positions (16, 3) and displacements (48, 12) of the samples, construction axes."""
    length = float(np.linalg.norm(end - start))
    axes = beam_axes(start, end)
    ends = np.kron(np.eye(4), axes)
    line_mass = section.line_mass + extra_line_mass
    # four places at the polar radius of gyration have the inertia of the cross-section
    ring = section.gyration_radius * np.array([[0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1]], dtype=float)
    masses, positions, displacements = [], [], []
    for abscissa, weight in zip(_STATIONS, _STATION_WEIGHTS, strict=True):
        fraction = 0.5 * (1.0 + abscissa)
        motion = _section_motion(length, fraction) @ ends
        for offset in ring:
            masses.append(0.125 * weight * length * line_mass)
            positions.append(start + fraction * (end - start) + axes.T @ offset)
            displacements.append(axes.T @ rigid_motion(offset)[:3] @ motion)
    return np.array(masses), np.array(positions), np.concatenate(displacements)


def beam_slopes(start: Vector, end: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Strain along the axis and slopes along y and z, each (4, 12), at stations of weights (4,) in m."""
    length = float(np.linalg.norm(end - start))
    ends = np.kron(np.eye(4), beam_axes(start, end))
    turns = np.array([_section_motion(length, 0.5 * (1.0 + a))[4:] @ ends for a in _STATIONS])
    stretch = np.tile((ends[6] - ends[0]) / length, (_STATIONS.size, 1))
    return stretch, turns[:, 1], -turns[:, 0], 0.5 * length * _STATION_WEIGHTS


class _Assembly:
    """Nodes of six degrees of freedom, filled member by member."""

    def __init__(self, joints: Mapping[str, Sequence[float]]) -> None:
        self.nodes = [np.asarray(p, dtype=float) for p in joints.values()]
        self.index = {name: i for i, name in enumerate(joints)}
        self.lines: list[tuple[int, int]] = []
        self.axial: list[float] = []
        self.elements: list[tuple[int, int, Vector, Vector, Vector, Vector]] = []

    def add(self, member: Member) -> None:
        """Divide a member into elements of equal length."""
        if not {member.start, member.end} <= set(self.index):
            raise ComponentError(f"a member runs from {member.start!r} to {member.end!r}; one is no joint")
        first, last = self.index[member.start], self.index[member.end]
        inner = range(len(self.nodes), len(self.nodes) + member.elements - 1)
        path = [first, *inner, last]
        for step in range(1, member.elements):
            fraction = step / member.elements
            self.nodes.append((1.0 - fraction) * self.nodes[first] + fraction * self.nodes[last])
        for i, j in pairwise(path):
            a, b = self.nodes[i], self.nodes[j]
            stiffness = beam_stiffness(member.section, a, b)
            samples = beam_mass_samples(member.section, member.extra_line_mass, a, b)
            self.lines.append((i, j))
            self.axial.append(member.section.axial)
            self.elements.append((i, j, stiffness, *samples))

    def scattered(self, blocks: Sequence[Vector]) -> SparseMatrix:
        """Blocks (rows, 12) of the elements below each other, in the columns of their nodes."""
        rows, columns = [], []
        offset = 0
        for (i, j), block in zip(self.lines, blocks, strict=True):
            dofs = np.concatenate([6 * i + np.arange(6), 6 * j + np.arange(6)])
            rows.append(np.repeat(offset + np.arange(len(block)), 12))
            columns.append(np.tile(dofs, len(block)))
            offset += len(block)
        values = np.concatenate([block.ravel() for block in blocks])
        indices = (np.concatenate(rows), np.concatenate(columns))
        return scipy.sparse.csr_array((values, indices), shape=(offset, 6 * len(self.nodes)))

    def strain(self) -> MembraneStrain:
        """Along the axes of all members."""
        parts = [beam_slopes(self.nodes[i], self.nodes[j]) for i, j in self.lines]
        stretch, along_y, along_z = (self.scattered([part[k] for part in parts]) for k in range(3))
        weights = [axial * part[3] for axial, part in zip(self.axial, parts, strict=True)]
        stiffness = scipy.sparse.csr_array(scipy.sparse.diags_array(np.concatenate(weights)))
        return MembraneStrain(stretch, ((along_y, along_y), (along_z, along_z)), stiffness)

    def node_motion(self, node: int, rows: int = 6) -> SparseMatrix:
        """Translation (and rotation) of a node, (rows, n)."""
        return scipy.sparse.csr_array(
            (np.ones(rows), (np.arange(rows), 6 * node + np.arange(rows))), shape=(rows, 6 * len(self.nodes))
        )


def beam_frame(
    joints: Mapping[str, Sequence[float]],
    members: Sequence[Member],
    point_masses: Mapping[str, float] | None = None,
    points: Sequence[str] | None = None,
) -> FiniteElementModel:
    """Model of a frame: joints (name -> position, m), members, masses (kg) lumped at joints.

    `points` are the joints a scene may connect to, by default all.
    """
    assembly = _Assembly(joints)
    for member in members:
        assembly.add(member)
    lumped = dict(point_masses or {})
    names = tuple(joints) if points is None else tuple(points)
    ends = assembly.scattered([np.eye(12)] * len(assembly.elements))
    blocks = scipy.sparse.csr_array(scipy.sparse.block_diag([element[2] for element in assembly.elements]))
    nodes = np.array(assembly.nodes)
    masses = [element[3] for element in assembly.elements]
    positions = [element[4] for element in assembly.elements]
    displacement = [assembly.scattered([element[5] for element in assembly.elements])]
    for name, mass in lumped.items():
        masses.append(np.array([mass]))
        positions.append(nodes[assembly.index[name]][None])
        displacement.append(assembly.node_motion(assembly.index[name], 3))
    motions = [assembly.node_motion(i, 3) for i in range(len(nodes))]
    return FiniteElementModel(
        stiffness=scipy.sparse.csr_array(ends.T @ blocks @ ends),
        masses=np.concatenate(masses),
        positions=np.concatenate(positions),
        displacement=scipy.sparse.csr_array(scipy.sparse.vstack(displacement)),
        membrane_strain=assembly.strain,
        rigid_motions=np.concatenate([rigid_motion(p) for p in nodes]),
        point_positions={name: nodes[assembly.index[name]] for name in names},
        point_motions={name: assembly.node_motion(assembly.index[name]) for name in names},
        attachment_dofs={name: 6 * assembly.index[name] + np.arange(6) for name in names},
        display_positions=nodes,
        display_displacement=scipy.sparse.csr_array(scipy.sparse.vstack(motions)),
        display_faces=np.array([(i, j, j, i) for i, j in assembly.lines], dtype=np.int64),
    )
