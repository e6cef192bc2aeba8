"""Points of an imported model: nodes, and points that rigid elements or means join to many nodes.

A rigid element (RBE2) moves its nodes with its point. A mean (RBE3) moves its point by the rigid motion that fits the
translations of its nodes best, in least squares, and stiffens nothing. Either becomes a node of six degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from ..flexible.modal import rigid_motion
from .data import FiniteElementData, transformed

_COLLINEAR = 1e-8
"""Least over largest eigenvalue of what a mean tells of its point: sums over nodes are right to 1e-15 of their size."""


@dataclass(frozen=True)
class JoinedPoint:
    """A point that moves with nodes; without a position it is in their middle (m)."""

    name: str
    nodes: tuple[int, ...]
    position: tuple[float, ...] | None = None


def with_rigid_elements(
    data: FiniteElementData, elements: Sequence[JoinedPoint]
) -> tuple[FiniteElementData, dict[str, int]]:
    """The data with the nodes of each element moved by a new node, and the numbers of these by name."""
    added: dict[str, int] = {}
    for element in elements:
        data, added[element.name] = _rigid(data, element)
    return data, added


def with_means(
    data: FiniteElementData, means: Sequence[JoinedPoint]
) -> tuple[FiniteElementData, dict[str, int]]:
    """The data with a new node at each mean, and the numbers of these by name."""
    added: dict[str, int] = {}
    for mean in means:
        data, added[mean.name] = _mean(data, mean)
    return data, added


def _reference(data: FiniteElementData, point: JoinedPoint) -> Vector:
    """Position of the point, m."""
    if point.position is not None:
        return np.array(point.position)
    middle: Vector = np.mean([data.position(node) for node in point.nodes], axis=0)
    return middle


def _with_node(
    data: FiniteElementData, position: Vector, gone: Sequence[int], change: scipy.sparse.csr_array
) -> tuple[FiniteElementData, int]:
    """The data with degrees of freedom replaced by the six of a new node, which come last."""
    number = int(data.nodes.max()) + 1
    own = np.column_stack([np.full(6, number), np.arange(1, 7)])
    dofs = np.vstack([np.delete(data.dofs, gone, axis=0), own])
    found = transformed(data, change, dofs)
    return replace(
        found, nodes=np.append(data.nodes, number), coordinates=np.vstack([data.coordinates, position])
    ), number


def _rigid(data: FiniteElementData, element: JoinedPoint) -> tuple[FiniteElementData, int]:
    position = _reference(data, element)
    gone: list[int] = []
    rows: list[Vector] = []
    for node in (part for named in element.nodes for part in data.parts(named)):
        motion = rigid_motion(data.coordinates[data.place(node)] - position)
        own = data.dofs_of(node)
        if not own:
            raise ComponentError(
                f"{element.name}: node {node} has no degree of freedom left that could move with it; it has none, or "
                "another rigid element has it already"
            )
        gone += own.values()
        rows += [motion[component - 1] for component in own]
    return _with_node(data, position, gone, _replacing(len(data.dofs), gone, np.array(rows)))


def _replacing(count: int, gone: Sequence[int], rows: Vector) -> scipy.sparse.csr_array:
    """Old degrees of freedom (count,) from those that stay, then the six that the rows (len(gone), 6) are of."""
    stay = np.setdiff1d(np.arange(count), gone)
    change = scipy.sparse.lil_array((count, stay.size + 6))
    change[stay, np.arange(stay.size)] = 1.0
    change[np.asarray(gone), stay.size :] = rows
    return scipy.sparse.csr_array(change)


def _mean(data: FiniteElementData, mean: JoinedPoint) -> tuple[FiniteElementData, int]:
    position = _reference(data, mean)
    columns: list[int] = []
    motions: list[Vector] = []
    for node in (part for named in mean.nodes for part in data.parts(named)):
        own = data.dofs_of(node)
        if not {1, 2, 3} <= own.keys():
            raise ComponentError(
                f"{mean.name}: node {node} has no three translations left, so no mean can be taken of it; it lacks "
                "one, or a rigid element or another mean has it already"
            )
        columns += [own[k] for k in (1, 2, 3)]
        motions.append(rigid_motion(data.coordinates[data.place(node)] - position)[:3])
    fit = np.concatenate(motions)
    size = np.abs(fit).max(axis=0) + np.finfo(float).tiny
    spread = np.linalg.eigvalsh((fit / size).T @ (fit / size))
    if spread[0] < _COLLINEAR * spread[-1]:
        raise ComponentError(
            f"{mean.name}: its nodes {', '.join(map(str, mean.nodes))} lie on one line or place, so their mean does "
            "not turn; give three that span a plane"
        )
    weights = np.linalg.pinv(fit)  # (6, 3 k): motion of the point from the translations
    pivots = scipy.linalg.qr(weights, pivoting=True)[2][:6]
    rest = np.setdiff1d(np.arange(len(columns)), pivots)
    inverse = np.linalg.inv(weights[:, pivots])
    gone = [columns[k] for k in pivots]
    change = scipy.sparse.lil_array(_replacing(len(data.dofs), gone, inverse))
    stay = np.setdiff1d(np.arange(len(data.dofs)), gone)
    places = np.searchsorted(stay, [columns[k] for k in rest])
    change[np.array(gone)[:, None], places] = -inverse @ weights[:, rest]
    return _with_node(data, position, gone, scipy.sparse.csr_array(change))
