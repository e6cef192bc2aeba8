"""Where the nodes of bodies are at rows of a result, and the rows nearest to some times."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from components.contract.component import Vector
from components.contract.frames import rotated

from ..assembly import Geometry
from ..results.result import Result


def rows_near(time: Vector, wanted: ArrayLike) -> NDArray[np.int64]:
    """Communication points nearest to some times (s), in order, each once."""
    times = np.asarray(wanted, dtype=float)
    after = np.clip(np.searchsorted(time, times), 0, time.size - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(times - time[before] < time[after] - times, before, after)
    return np.unique(nearest).astype(np.int64)


def placed(result: Result, name: str, body: Geometry, rows: NDArray[np.int64]) -> Vector:
    """Nodes of a body in world axes at the given rows, shape (rows, nodes, 3)."""
    if result.has(name, "node_position"):
        moved: Vector = result.signal(name, "node_position")[rows].reshape(rows.size, -1, 3)
        return moved
    nodes = np.repeat(np.asarray(body.positions)[None], rows.size, axis=0)
    if not result.has(name, "frame_position"):
        return nodes
    if result.has(name, "modal_coordinate"):
        coordinates = result.signal(name, "modal_coordinate").reshape(result.time.size, -1)[rows]
        nodes = nodes + np.einsum("dam,rm->rda", np.asarray(body.shapes), coordinates)
    turned = rotated(result.signal(name, "frame_orientation")[rows][:, None, :], nodes)
    return turned + result.signal(name, "frame_position")[rows][:, None, :]
