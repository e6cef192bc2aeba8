"""Shells and beams of CalculiX, which it expands into solids: places of the nodes that this makes.

The .dof names the rows of all nodes of an expansion by the node that the deck has. Rows of other nodes are rotations of
a knot, where expansions that differ meet in a rigid node, and amplitudes inside of elements. What belongs to which row
follows from the stiffness: rigid motions cost no energy, and the mean place of an expansion is that of its node.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import SparseMatrix
from ..flexible.modal import rigid_motion
from .data import INTERNAL, FiniteElementData, Integers

_CLEAR = 1e-3
"""Between a share of 0 and of 1 in rigid motions; stiffness in 14 digits leaves at most 1e-5."""
_HELD = 1e-9
"""Of the largest force, that rigid motions leave at a node; matrices have 14 digits."""
_LARGE = 0.3
"""Of the largest, forces at nodes that are let go at once; neighbours of such a node have smaller ones."""
_TRIALS = 10
_THREE = 3
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class _Rows:
    """Rows of a model by what the deck says of their nodes."""

    data: FiniteElementData

    @cached_property
    def listed(self) -> Integers:
        """Rows whose node has a place in the deck."""
        return np.flatnonzero(np.isin(self.data.dofs[:, 0], self.data.nodes))

    @cached_property
    def others(self) -> Integers:
        """Rows of nodes that CalculiX adds."""
        return np.setdiff1d(np.arange(len(self.data.dofs)), self.listed)

    @cached_property
    def parts(self) -> tuple[Integers, Integers]:
        """Of each listed row: which part of an expansion it belongs to (from 0), and how many its node has."""
        dofs = self.data.dofs[self.listed]
        _, inverse, count = np.unique(dofs, axis=0, return_inverse=True, return_counts=True)
        inverse = inverse.ravel()
        order = np.argsort(inverse, kind="stable")
        part = np.empty(len(dofs), dtype=np.int64)
        part[order] = np.arange(len(dofs)) - np.repeat(np.cumsum(count) - count, count)
        return part, count[inverse]


def with_expanded_nodes(data: FiniteElementData) -> FiniteElementData:
    """The data with a node for each part of an expansion, six components of knots, and `INTERNAL` rows.

    ComponentError where the deck holds some of these rows, or rigid motions do not say what a row is.
    """
    rows = _Rows(data)
    part, count = rows.parts
    if not rows.others.size and (not part.size or count.max() == 1):
        return data
    owner, component = data.dofs[rows.listed].T
    expanded = count > 1
    keys, member = np.unique(np.column_stack([owner, part]), axis=0, return_inverse=True)
    member = member.ravel()
    if np.any(np.bincount(member[expanded]) % _THREE) or np.any(component > _THREE):
        raise ComponentError(
            "some directions of expanded shells or beams are held; leave *BOUNDARY out of the deck"
        )
    places, moved = _rigid_motions(rows, keys, member)
    several = np.isin(keys[:, 0], np.unique(owner[expanded]))
    numbers = keys[:, 0].copy()
    numbers[several] = data.nodes.max() + 1 + np.arange(np.sum(several))
    dofs = data.dofs.copy()
    dofs[rows.listed, 0] = numbers[member]
    dofs[rows.others] = _other_dofs(rows, moved)
    members = {int(node): tuple(numbers[keys[:, 0] == node].tolist()) for node in np.unique(keys[several, 0])}
    return replace(data, nodes=numbers, coordinates=places, dofs=dofs, members=members)


def _rigid_motions(rows: _Rows, keys: Integers, member: Integers) -> tuple[Vector, Vector]:
    """Places (P, 3) of all parts, and rigid motions (k, 6) of the other rows.

    The energy of three rotations is least over deviations of places from their nodes, whose sum is zero at each node,
    and over rotations of the other rows. A node with a mass or a constraint is a part itself in place of another, so
    that their mean is elsewhere: nodes that forces hold are let go, and found from the others.
    """
    data = rows.data
    centres = data.coordinates[[data.place(int(node)) for node in keys[:, 0]]]
    turns = [_turned(axis, data.dofs[rows.listed, 1] - 1, member, len(keys)) for axis in range(3)]
    listed, others = (
        scipy.sparse.eye_array(len(data.dofs), format="csc")[:, own] for own in (rows.listed, rows.others)
    )
    three = scipy.sparse.eye_array(3)
    # rows of the three rotations, one after the other
    moves = scipy.sparse.vstack([listed @ turn for turn in turns], "csr")
    inner = scipy.sparse.kron(three, others)
    stiffness = scipy.sparse.kron(three, data.stiffness, "csc")
    start = np.concatenate([listed @ (turn @ centres.ravel()) for turn in turns])
    node, count = np.unique(keys[:, 0], return_inverse=True, return_counts=True)[1:]
    largest = float((abs(moves).T @ (abs(stiffness) @ np.abs(start))).max())
    loose = np.zeros(len(keys), dtype=bool)
    for _ in range(_TRIALS):
        free = _deviations(keys, loose)
        change = scipy.sparse.hstack([moves @ free, inner], "csc")
        found = _solved(change.T @ stiffness @ change, change.T @ (stiffness @ start)[:, None])[:, 0]
        force = np.zeros((len(count), 3))
        np.add.at(force, node.ravel(), (moves.T @ (stiffness @ (start + change @ found))).reshape(-1, 3))
        held = np.where(count > 1, np.linalg.norm(force, axis=1), 0.0)
        if held.max() <= _HELD * largest:
            break
        loose |= (held > _LARGE * held.max())[node.ravel()]
    places = centres + np.asarray(free @ found[: free.shape[1]]).reshape(-1, 3)
    shifted = (data.dofs[rows.listed, 1] - 1)[:, None] == np.arange(3)
    moved = _solved(others.T @ data.stiffness @ others, others.T @ (data.stiffness @ (listed @ shifted)))
    return places, np.hstack([moved, found[free.shape[1] :].reshape(3, -1).T])


def _solved(matrix: SparseMatrix, force: Vector) -> Vector:
    """Solution (n, k) of matrix x = -force (n, k)."""
    if not len(force):
        return np.zeros(force.shape)
    try:
        solved: Vector = scipy.sparse.linalg.splu(scipy.sparse.csc_array(matrix)).solve(-np.asarray(force))
    except RuntimeError:
        raise ComponentError("parts of expanded shells or beams move without stiffness") from None
    return solved


def _deviations(keys: Integers, loose: Flags) -> SparseMatrix:
    """Places (3 P) from those of all parts but the last of each node, which balances them; nodes of one part stay.

    loose: parts (P,) that nothing balances.
    """
    last = np.r_[keys[1:, 0] != keys[:-1, 0], True]
    free = np.flatnonzero(~last | loose)
    own = np.flatnonzero(~loose[free])
    balance = np.flatnonzero(last)[np.cumsum(last)[free[own]]]
    parts = scipy.sparse.coo_array(
        (
            np.r_[np.ones(free.size), -np.ones(own.size)],
            (np.r_[free, balance], np.r_[np.arange(free.size), own]),
        ),
        (len(keys), free.size),
    )
    return scipy.sparse.csr_array(scipy.sparse.kron(parts, scipy.sparse.eye_array(3)))


def _turned(axis: int, component: Integers, member: Integers, parts: int) -> SparseMatrix:
    """Displacements of rows from places (3 P), under a unit rotation about an axis through the origin."""
    cross = np.array([rigid_motion(unit)[:3, 3 + axis] for unit in np.eye(3)]).T
    row, place = np.nonzero(cross[component])
    value = cross[component[row], place]
    shape = (len(component), 3 * parts)
    return scipy.sparse.csr_array((value, (row, 3 * member[row] + place)), shape=shape)


def _other_dofs(rows: _Rows, moved: Vector) -> Integers:
    """Node and component of the other rows: rotations of knots, or amplitudes with no share in rigid motions."""
    dofs = rows.data.dofs[rows.others].copy()
    turning = np.abs(moved[:, 3:] - np.eye(3)[np.maximum(dofs[:, 1] - 1, 0) % 3]).max(axis=1) < _CLEAR
    still = np.abs(moved).max(axis=1) < _CLEAR
    lost = np.flatnonzero((np.abs(moved[:, :3]).max(axis=1) > _CLEAR) | ~(turning | still))
    if lost.size:
        raise ComponentError(
            f"node {dofs[lost[0], 0]} has no coordinates in the deck, and is no part of a shell or beam"
        )
    knots = _knots(rows, np.unique(dofs[turning, 0]))
    dofs[turning, 0] = [knots[node] for node in dofs[turning, 0].tolist()]
    dofs[turning, 1] += _THREE
    dofs[still, 1] = INTERNAL
    return dofs


def _knots(rows: _Rows, turning: Integers) -> dict[int, int]:
    """The node of the deck that each node of rotations turns: both meet the same nodes; of several the next."""
    labels, own = np.unique(rows.data.dofs[:, 0], return_inverse=True)
    to_label = scipy.sparse.csr_array(
        (np.ones(len(own)), (own.ravel(), np.arange(len(own)))), shape=(len(labels), len(own))
    )
    met = scipy.sparse.csr_array(to_label @ abs(rows.data.stiffness) @ to_label.T)
    known = np.isin(labels, rows.data.nodes)
    single = known & (np.asarray(to_label.sum(axis=1)).ravel() == _THREE)
    found: dict[int, int] = {}
    for node in turning.tolist():
        around = _neighbours(met, int(np.searchsorted(labels, node)), known)
        knot = next(
            (
                int(labels[k])
                for k in sorted(around)
                if single[k] and int(labels[k]) not in found.values() and _neighbours(met, k, known) == around
            ),
            None,
        )
        if knot is None:
            raise ComponentError(f"node {node} turns with no node of the deck")
        found[node] = knot
    return found


def _neighbours(met: SparseMatrix, label: int, known: Flags) -> frozenset[int]:
    indices = met.indices[met.indptr[label] : met.indptr[label + 1]]
    return frozenset(indices[known[indices]].tolist())
