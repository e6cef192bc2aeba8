"""Imported data -> the finite-element model that reductions take, with a sampling of its mass.

The mass matrix is kept as it is. Inertia that changes with the deformation needs a field of mass besides: samples that
come along, or the mass of every node (its row sums, for translations); a reduced model without samples has none, and
its inertia stays that of the undeformed body. Matrices tell nothing of strains to second order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import FiniteElementModel, SparseMatrix
from ..flexible.membrane_strain import MembraneStrain
from ..flexible.point_shapes import span
from .data import FiniteElementData, Integers, MassSamples, told_nodes

_ALL = (1, 2, 3, 4, 5, 6)
_ROUNDING = 1e-12
"""Of the largest entry of the mass matrix: what samples leave of it by round-off."""


def finite_element_model(
    data: FiniteElementData, attachment_points: Mapping[str, int], nodes: Mapping[str, int]
) -> FiniteElementModel:
    """The model with named points at nodes; ComponentError where a node is not there or lacks components."""
    ends = {name: _six(data, name, node) for name, node in attachment_points.items()}
    motions = {name: _selection(own, len(data.dofs)) for name, own in ends.items()}
    positions = {name: data.coordinates[data.place(node)] for name, node in attachment_points.items()}
    for name, node in nodes.items():
        positions[name], motions[name] = _moving(data, name, node)
    samples = data.samples or _nodal_samples(data)
    sampled = (
        samples.displacement.T @ scipy.sparse.diags_array(np.repeat(samples.masses, 3)) @ samples.displacement
    )
    further = scipy.sparse.csr_array(data.mass - sampled)
    small = _ROUNDING * float(abs(data.mass).max())
    display, motion, faces = _display(data)
    return FiniteElementModel(
        stiffness=data.stiffness,
        masses=samples.masses,
        positions=samples.positions,
        displacement=samples.displacement,
        membrane_strain=partial(
            MembraneStrain, scipy.sparse.csr_array((0, len(data.dofs))), (), scipy.sparse.csr_array((0, 0))
        ),
        rigid_motions=data.rigid_motions(),
        point_positions=positions,
        point_motions=motions,
        attachment_dofs=ends,
        display_positions=display,
        display_displacement=motion,
        display_faces=faces,
        further_mass=None if abs(further).max() <= small else further,
        outputs=data.outputs,
    )


def _six(data: FiniteElementData, name: str, node: int) -> Integers:
    """The degrees of freedom of a node, in order."""
    data.place(node)
    own = data.dofs_of(node)
    if not own:
        raise ComponentError(
            f"attachment point {name}: node {node} has no degree of freedom left; it has none, or a rigid element or a "
            "mean has it already: attach to the point of that instead"
        )
    missing = [k for k in _ALL if k not in own]
    if missing:
        raise ComponentError(
            f"attachment point {name}: node {node} has no component {', '.join(map(str, missing))}; an attachment "
            "point needs all six: join a point to several nodes by rigid_elements or means"
        )
    return np.array([own[k] for k in _ALL])


def _selection(rows: Integers, count: int) -> SparseMatrix:
    return scipy.sparse.csr_array(
        (np.ones(len(rows)), (np.arange(len(rows)), rows)), shape=(len(rows), count)
    )


def _moving(data: FiniteElementData, name: str, node: int) -> tuple[Vector, SparseMatrix]:
    """Position and motion (6, n) of a node; rotations that it lacks are zero."""
    recovery = data.recovery
    if recovery is not None and node in recovery.nodes:
        place = int(np.flatnonzero(recovery.nodes == node)[0])
        return recovery.coordinates[place], scipy.sparse.csr_array(recovery.motion[6 * place : 6 * place + 6])
    if node in data.members:
        parts = [_moving(data, name, part)[1].tocsr() for part in data.members[node]]
        mean = scipy.sparse.kron(np.full((1, len(parts)), 1.0 / len(parts)), scipy.sparse.eye_array(6))
        return data.position(node), scipy.sparse.csr_array(mean @ scipy.sparse.vstack(parts))
    if node not in data.nodes:
        known = data.nodes if recovery is None else np.union1d(data.nodes, recovery.nodes)
        raise ComponentError(f"node {name}: there is no node {node}; {told_nodes(known)}")
    own = data.dofs_of(node)
    if not {1, 2, 3} <= own.keys():
        raise ComponentError(
            f"node {name}: node {node} does not move by itself in all three directions; where a rigid element or a "
            "mean determines it, use its point, or a node next to it"
        )
    rows = scipy.sparse.lil_array((6, len(data.dofs)))
    for component, dof in own.items():
        rows[component - 1, dof] = 1.0
    return data.coordinates[data.place(node)], scipy.sparse.csr_array(rows)


def _nodal_samples(data: FiniteElementData) -> MassSamples:
    """The mass of every node as a point mass; none for reduced models, whose mass is not at their nodes."""
    count = len(data.dofs)
    if data.ready:
        return MassSamples(np.zeros(0), np.zeros((0, 3)), scipy.sparse.csr_array((0, count)))
    owners = {int(node): data.dofs_of(int(node)) for node in data.nodes}
    moving = [node for node, own in owners.items() if {1, 2, 3} <= own.keys()]
    rows = np.array([[owners[node][k] for k in (1, 2, 3)] for node in moving], dtype=np.int64).reshape(-1, 3)
    masses = _lumped(data, rows)
    kept = masses != 0.0
    places = [data.place(node) for node, keep in zip(moving, kept, strict=True) if keep]
    return MassSamples(masses[kept], data.coordinates[places], _selection(rows[kept].ravel(), count))


def _lumped(data: FiniteElementData, rows: Integers) -> Vector:
    """Mass of each node: mean over the axes of its row sums, or where one is negative, of diagonals, to the total."""
    translations = data.rigid_motions()[:, :3]
    sums = np.asarray(data.mass @ translations)
    masses: Vector = np.mean([sums[rows[:, k], k] for k in range(3)], axis=0)
    if masses.size and masses.min() < 0.0:
        diagonal = np.asarray(data.mass.diagonal())[rows].sum(axis=1)
        masses = diagonal * masses.sum() / diagonal.sum()
    return masses


def _display(data: FiniteElementData) -> tuple[Vector, SparseMatrix, Integers]:
    """A shape for pictures: what spans the nodes, with their motion."""
    nodes: Sequence[int] = data.nodes.tolist()
    moving = [node for node in nodes if {1, 2, 3} <= data.dofs_of(node).keys()]
    found = [_moving(data, "display", node) for node in moving]
    if data.recovery is not None:
        found += [_moving(data, "display", int(node)) for node in data.recovery.nodes]
    places = np.array([position for position, _ in found]).reshape(-1, 3)
    _, first = np.unique(places, axis=0, return_index=True)
    corners, faces = span([tuple(place) for place in places.tolist()])
    if not len(corners):
        return np.zeros((0, 3)), scipy.sparse.csr_array((0, len(data.dofs))), faces
    used = np.unique(faces)
    motion = scipy.sparse.vstack([found[first[k]][1][:3] for k in used])
    return corners[used], scipy.sparse.csr_array(motion), np.searchsorted(used, faces).astype(np.int64)
