"""A shape for pictures of a body that has none: what spans its points and its centre of mass."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..contract.frames import Vector3

_FLAT = 1e-6
"""A direction in which points spread by less than this part of their largest spread is none."""


def span(points: Iterable[Vector3]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Positions (D, 3) and faces (F, 4) of a line, a polygon or a convex hull, as modal data has them.

    Nothing where all points coincide.
    """
    corners = np.unique(np.array(list(points), dtype=float).reshape(-1, 3), axis=0)
    _, spreads, axes = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)
    dimension = int(np.sum(spreads > _FLAT * max(float(spreads[0]), np.finfo(float).tiny)))
    flat = corners @ axes[:dimension].T
    if dimension == 0:
        return np.zeros((0, 3)), np.zeros((0, 4), dtype=np.int64)
    if dimension == 1:
        first, last = int(np.argmin(flat)), int(np.argmax(flat))
        return corners, np.array([[first, last, last, first]])
    return corners, _hull(flat)


def _hull(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Faces (F, 4) of the convex hull of points in the plane or in space, triangles with a corner twice."""
    from scipy.spatial import ConvexHull  # takes its time, which bodies with shapes need not

    hull = ConvexHull(points)
    if points.shape[1] == 3:
        return np.column_stack((hull.simplices, hull.simplices[:, 2])).astype(np.int64)
    first, *others = hull.vertices
    others.append(others[-1])
    return np.array([(first, *others[k : k + 3]) for k in range(0, len(others) - 2, 2)], dtype=np.int64)
