"""A beam in small motion about its rest shape, as finite elements: the linear part of what `elements` says.

Its mass matrix is that of the component `beam`, by samples: Simpson's rule over an element gives the consistent
masses of its nodes, and the samples at nodes lie around the axis so as to have the rotary inertia.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np
import scipy

from ..contract.component import Vector
from ..flexible.beam_frame import beam_axes
from ..flexible.finite_elements import FiniteElementModel, SparseMatrix
from ..flexible.membrane_strain import MembraneStrain
from ..flexible.modal import rigid_motion
from .elements import Elements, Poses
from .variables import Section


def linear_model(
    positions: Vector, directors: Vector, section: Section, points: Mapping[str, int]
) -> FiniteElementModel:
    """Finite elements of a beam through nodes at positions (n, 3) with directors (n, 3, 3), points at nodes.

    Six degrees of freedom a node: translation and rotation along the construction axes.
    """
    count = len(positions)
    poses = Poses(directors, np.diff(positions, axis=0))
    elements = Elements(poses, section.stiffness)
    masses, places, displacement = _samples(positions, directors, section, elements.lengths)
    every = scipy.sparse.eye_array(6 * count, format="csr")
    translations = np.add.outer(6 * np.arange(count), np.arange(3)).ravel()
    return FiniteElementModel(
        stiffness=_stiffness(elements, poses),
        masses=masses,
        positions=places,
        displacement=displacement,
        membrane_strain=partial(_strain, positions, section),
        rigid_motions=np.concatenate([rigid_motion(place) for place in positions]),
        point_positions={name: positions[node] for name, node in points.items()},
        point_motions={
            name: scipy.sparse.csr_array(every[6 * node : 6 * node + 6]) for name, node in points.items()
        },
        attachment_dofs={name: 6 * node + np.arange(6) for name, node in points.items()},
        display_positions=positions,
        display_displacement=scipy.sparse.csr_array(every[translations]),
        display_faces=display_faces(count),
    )


def display_faces(count: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    """Lines from node to node as degenerate faces (n - 1, 4)."""
    first = np.arange(count - 1, dtype=np.int64)
    return np.column_stack((first, first + 1, first + 1, first))


def _stiffness(elements: Elements, poses: Poses) -> SparseMatrix:
    """Of the unloaded beam, (6 n, 6 n)."""
    rest = elements.strains(poses)
    nothing = np.zeros((len(elements.lengths), 6))
    pairs = -elements.tangent(poses, poses, nothing, 2.0 * elements.stiffnesses(rest, rest, 0.0, nothing))
    first = 6 * np.arange(len(pairs))[:, None, None]
    row, column = np.indices((12, 12))
    entries = (pairs.ravel(), ((first + row).ravel(), (first + column).ravel()))
    size = 6 * (len(pairs) + 1)
    return scipy.sparse.csr_array(entries, shape=(size, size))


def _strain(positions: Vector, section: Section) -> MembraneStrain:
    """Along the chords of the elements, which a beam that hardly shears keeps in length."""
    chords = np.diff(positions, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    axes = np.array([beam_axes(np.zeros(3), chord) for chord in chords]) / lengths[:, None, None]
    every = scipy.sparse.kron(scipy.sparse.eye_array(len(positions)), np.eye(3, 6), format="csr")
    growth = scipy.sparse.csr_array(every[3:] - every[:-3])
    stretch, along_y, along_z = (
        scipy.sparse.csr_array(scipy.sparse.block_diag(list(axes[:, k : k + 1])) @ growth) for k in range(3)
    )
    stiffness = scipy.sparse.csr_array(scipy.sparse.diags_array(section.stiffness[0] * lengths))
    return MembraneStrain(stretch, ((along_y, along_y), (along_z, along_z)), stiffness)


def _samples(
    positions: Vector, directors: Vector, section: Section, lengths: Vector
) -> tuple[Vector, Vector, SparseMatrix]:
    """Masses (Q,), positions (Q, 3) and displacements (3 Q, 6 n): one in the middle of an element, four at a node."""
    count, mass = len(positions), section.line_mass * lengths
    at_nodes = (np.append(mass, 0.0) + np.append(0.0, mass)) / 6.0
    middle = 0.5 * (positions[:-1] + positions[1:])
    # 4 m/24 arm^2 = (m/2) (inertia / line mass) for the two of a pair, with m/6 a node and element
    arm_y, arm_z = np.sqrt(6.0 * np.array((section.inertia_z, section.inertia_y)) / section.line_mass)
    own = np.array(((0.0, arm_y, 0.0), (0.0, -arm_y, 0.0), (0.0, 0.0, arm_z), (0.0, 0.0, -arm_z)))
    arms = np.einsum("nij,kj->nki", directors, own)
    blocks = np.array([[rigid_motion(arm)[:3] for arm in around] for around in arms])
    every = scipy.sparse.kron(scipy.sparse.eye_array(count), np.eye(3, 6), format="csr")
    halves = scipy.sparse.csr_array(0.5 * (every[: 3 * (count - 1)] + every[3:]))
    around = scipy.sparse.block_diag(list(blocks.reshape(count, 12, 6)))
    return (
        np.concatenate((2.0 / 3.0 * mass, np.repeat(0.25 * at_nodes, 4))),
        np.concatenate((middle, (positions[:, None] + arms).reshape(-1, 3))),
        scipy.sparse.csr_array(scipy.sparse.vstack([halves, around])),
    )
