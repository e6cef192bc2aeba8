"""Force and moment resultants at the mesh nodes of a plate, as sparse matrices on its degrees of freedom.

Per unit width: forces N = A e of the mid-plane strains e = (u,x, v,y, u,y + v,x), positive in tension, and
moments M = integral of stress times z = -D k of the curvatures k = (w,xx, w,yy, 2 w,xy) (Timoshenko and
Woinowsky-Krieger, chapters 2 and 11). Elements are evaluated at their corners and averaged over the elements
that meet in a node; those inside rigid inserts are no part of the average.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import Vector
from .finite_elements import PlateNodes, Rectangle, SparseMatrix
from .plate import Plate


@dataclass(frozen=True)
class AxisCorners:
    """One direction of a tensor mesh: its nodes (k + 1,) and the functions at both ends of its k elements."""

    nodes: Vector
    bending: Sequence[SparseMatrix]
    """(2 k, degrees of freedom) functions, first and second derivatives; row 2 element + end"""
    stretching: Sequence[SparseMatrix]
    """the same of the in-plane functions, up to first derivatives"""


def plate_nodes(
    x: AxisCorners, y: AxisCorners, plate: Plate, inserts: Sequence[Rectangle], translations: SparseMatrix
) -> PlateNodes:
    """Nodes of a plate on a tensor mesh; degrees of freedom are those of w, then of u, then of v.

    translations: (3 K, n) of the nodes, y fastest.
    """
    nx, ny = x.nodes.size - 1, y.nodes.size - 1
    faces = _corner_nodes(nx, ny)[:, [0, 2, 3, 1]]
    places = np.column_stack([np.repeat(x.nodes, y.nodes.size), np.tile(y.nodes, x.nodes.size)])
    deforming = ~_inside(places[faces].mean(axis=1), inserts)
    average = _average(nx, ny, deforming)
    a11, a22, a12, a66 = plate.membrane
    return PlateNodes(
        positions=np.column_stack([places, np.zeros(len(places))]),
        faces=faces[deforming],
        resultants=_by_node(
            [scipy.sparse.csr_array(average @ r) for r in _at_corners(x, y, plate)], len(places)
        ),
        slopes=_by_node([scipy.sparse.csr_array(average @ r) for r in _slopes_at_corners(x, y)], len(places)),
        translations=translations,
        membrane=np.array([[a11, a12, 0.0], [a12, a22, 0.0], [0.0, 0.0, a66]]),
        inserts=tuple(inserts),
    )


def _corner_nodes(nx: int, ny: int) -> NDArray[np.int64]:
    """Nodes (nx ny, 4) at the corners of the elements, y fastest, corner 2 (end in x) + (end in y)."""
    i, j = np.divmod(np.arange(nx * ny), ny)
    return np.column_stack([(i + p) * (ny + 1) + j + q for p in (0, 1) for q in (0, 1)])


def _inside(points: Vector, rectangles: Sequence[Rectangle]) -> NDArray[np.bool_]:
    """Which points (k, 2) lie in one of the rectangles."""
    found = np.zeros(len(points), dtype=bool)
    for ranges in rectangles:
        low, high = np.transpose(ranges)
        found |= np.all((points > low) & (points < high), axis=1)
    return found


def _average(nx: int, ny: int, deforming: NDArray[np.bool_]) -> SparseMatrix:
    """Mean at the nodes (nodes, 4 elements) of what deforming elements have there.

    Columns are corners in the order of a Kronecker product of two `AxisCorners`.
    """
    corner, count = _corner_nodes(nx, ny), (nx + 1) * (ny + 1)
    i, j = np.divmod(np.arange(nx * ny), ny)
    column = np.column_stack([(2 * i + p) * 2 * ny + 2 * j + q for p in (0, 1) for q in (0, 1)])
    rows, columns = corner[deforming].ravel(), column[deforming].ravel()
    meeting = np.bincount(rows, minlength=count)
    return scipy.sparse.csr_array((1.0 / meeting[rows], (rows, columns)), shape=(count, 4 * nx * ny))


def _at_corners(x: AxisCorners, y: AxisCorners, plate: Plate) -> list[SparseMatrix]:
    """Nx, Ny, Nxy, Mx, My, Mxy at the corners of every element, each (4 elements, n)."""
    (px, qx), (py, qy) = x.stretching, y.stretching
    (x0, x1, x2), (y0, y1, y2) = x.bending, y.bending
    along_x, along_y = kron(qx, py), kron(px, qy)
    curvature_x, curvature_y, twist = kron(x2, y0), kron(x0, y2), kron(x1, y1)
    a11, a22, a12, a66 = plate.membrane
    d11, d22, d12, d66 = plate.bending
    rows = [
        [None, a11 * along_x, a12 * along_y],
        [None, a12 * along_x, a22 * along_y],
        [None, a66 * along_y, a66 * along_x],
        [-d11 * curvature_x - d12 * curvature_y, None, None],
        [-d12 * curvature_x - d22 * curvature_y, None, None],
        [-2.0 * d66 * twist, None, None],
    ]
    widths = (curvature_x.shape[1], along_x.shape[1], along_x.shape[1])
    empty = [scipy.sparse.csr_array((along_x.shape[0], width)) for width in widths]
    return [
        scipy.sparse.csr_array(
            scipy.sparse.hstack([e if b is None else b for b, e in zip(row, empty, strict=True)])
        )
        for row in rows
    ]


def _slopes_at_corners(x: AxisCorners, y: AxisCorners) -> list[SparseMatrix]:
    """w,x and w,y at the corners of every element, each (4 elements, n)."""
    (x0, x1, _), (y0, y1, _) = x.bending, y.bending
    in_plane = 2 * x.stretching[0].shape[1] * y.stretching[0].shape[1]
    still = scipy.sparse.csr_array((x0.shape[0] * y0.shape[0], in_plane))
    return [
        scipy.sparse.csr_array(scipy.sparse.hstack([turned, still]))
        for turned in (kron(x1, y0), kron(x0, y1))
    ]


def kron(left: SparseMatrix, right: SparseMatrix) -> SparseMatrix:
    """Tensor product of what two directions give."""
    return scipy.sparse.csr_array(scipy.sparse.kron(left, right))


def _by_node(components: Sequence[SparseMatrix], count: int) -> SparseMatrix:
    """Matrices (count, n), one a component, with their rows interleaved."""
    stacked = scipy.sparse.csr_array(scipy.sparse.vstack(components))
    order = np.arange(len(components) * count).reshape(len(components), count).T.ravel()
    return scipy.sparse.csr_array(stacked[order])
