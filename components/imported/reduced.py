"""The way back: finite elements -> Craig-Bampton data for other programs, attachment components first.

Samples of the mass come along, few of them: inertia follows the deformation by sums of second order over the mass,
which as many samples as there are sums in one row have exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from ..contract.component import Vector
from ..flexible.finite_elements import FiniteElementModel
from ..flexible.reduction import craig_bampton_basis
from .data import AMPLITUDE, FiniteElementData, MassSamples, Recovery


def reduced_data(
    model: FiniteElementModel, attachment_points: Sequence[str], nodes: Sequence[str], modes: int
) -> FiniteElementData:
    """Reduced to the attachment points, nodes 1, 2, ... in their order, and amplitudes of fixed-interface modes.

    nodes: recovered, numbered on; so are, last, the places of a coarse grid for pictures, without their rotations.
    """
    ends = len(attachment_points)
    basis = np.roll(craig_bampton_basis(model, attachment_points, modes), 6 * ends, axis=1)
    numbers = np.arange(1, ends + 1)
    attached = np.column_stack([np.repeat(numbers, 6), np.tile(np.arange(1, 7), ends)])
    amplitudes = np.column_stack([np.arange(modes) + 1, np.full(modes, AMPLITUDE)])
    return FiniteElementData(
        stiffness=_projected(model.stiffness, basis),
        mass=_projected(model.mass_matrix, basis),
        nodes=numbers,
        coordinates=np.array([model.point_positions[name] for name in attachment_points]),
        dofs=np.concatenate([attached, amplitudes]),
        samples=few_samples(model.masses, model.positions, np.asarray(model.displacement @ basis)),
        recovery=_recovered(model, nodes, basis, ends + 1),
        outputs=model.outputs and replace(model.outputs, rows=model.outputs.rows @ basis),
    )


def _projected(matrix: scipy.sparse.csr_array, basis: Vector) -> scipy.sparse.csr_array:
    found = basis.T @ np.asarray(matrix @ basis)
    return scipy.sparse.csr_array(0.5 * (found + found.T))


def _recovered(model: FiniteElementModel, nodes: Sequence[str], basis: Vector, first: int) -> Recovery:
    """Motion of the nodes and of the grid for pictures, numbered from `first` on."""
    moved = [np.asarray(model.point_motions[name] @ basis) for name in nodes]
    shown = np.zeros((len(model.display_positions), 6, basis.shape[1]))
    shown[:, :3] = np.asarray(model.display_displacement @ basis).reshape(-1, 3, basis.shape[1])
    places = np.array([*(model.point_positions[name] for name in nodes), *model.display_positions])
    motion = scipy.sparse.csr_array(np.concatenate([*moved, shown.reshape(-1, basis.shape[1])]))
    return Recovery(np.arange(first, first + len(places)), places.reshape(-1, 3), motion)


def few_samples(masses: Vector, positions: Vector, displacement: Vector) -> MassSamples:
    """Few samples with all sums up to second order of masses (Q,) at positions (Q, 3), displacements (3 Q, n).

    Rows sqrt(m) (1, position, displacement) have these sums as their products with themselves. The triangular factor
    has the same products in few rows; turned so that its first column is constant, it is rows of equal masses.
    """
    count, coordinates = masses.size, displacement.shape[1]
    if count <= 4 + 3 * coordinates:
        return MassSamples(masses, positions, scipy.sparse.csr_array(displacement))
    fields = np.column_stack([np.ones(count), positions, displacement.reshape(count, 3 * coordinates)])
    factor = np.linalg.qr(np.sqrt(masses)[:, None] * fields).R
    mass = masses.sum() / len(factor)
    rows = _reflected(factor, np.full(len(factor), 1.0 / np.sqrt(len(factor)))) / np.sqrt(mass)
    return MassSamples(
        np.full(len(rows), mass), rows[:, 1:4], scipy.sparse.csr_array(rows[:, 4:].reshape(-1, coordinates))
    )


def _reflected(rows: Vector, direction: Vector) -> Vector:
    """Rows mirrored so that their first column lies along a unit vector."""
    first = rows[:, 0] / np.linalg.norm(rows[:, 0])
    if first @ direction < 0.0:
        rows, first = -rows, -first
    normal = first - direction
    size = normal @ normal
    result: Vector = rows if size == 0.0 else rows - np.outer(2.0 / size * normal, normal @ rows)
    return result
