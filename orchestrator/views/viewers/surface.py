"""Faces of bodies as triangles and lines, as programs for pictures take them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...assembly import Geometry
from ...results.result import Result, ResultError

Indices = NDArray[np.int64]


class Surface(NamedTuple):
    """Triangles (T, 3) and lines (L, 2) by numbers of nodes; a face has four corners, some of which may be one."""

    triangles: Indices
    lines: Indices


def surface(faces: Indices) -> Surface:
    """Triangles and lines of faces (F, 4): two triangles of four corners, one of three, a line of two."""
    triangles, lines = list[list[int]](), list[list[int]]()
    for face in faces.tolist():
        corners = list(dict.fromkeys(face))
        if len(corners) == 2:
            lines.append(corners)
        triangles += [[corners[0], *corners[k : k + 2]] for k in range(1, len(corners) - 1)]
    return Surface(
        np.array(triangles, dtype=np.int64).reshape(-1, 3), np.array(lines, dtype=np.int64).reshape(-1, 2)
    )


def shown_bodies(result: Result) -> dict[str, Geometry]:
    """Bodies of a result that have a surface; ResultError where none has, or one is damaged."""
    bodies = {name: body for name, body in result.geometry.items() if np.size(body.faces)}
    for name, body in bodies.items():
        faces = np.asarray(body.faces)
        with np.errstate(over="ignore"):
            single = [np.asarray(values, dtype=np.float32) for values in (body.positions, body.shapes)]
        if not all(np.isfinite(values).all() for values in single) or not (
            0 <= faces.min() <= faces.max() < len(body.positions)
        ):
            raise ResultError(f"{result.name}: the geometry of {name} is damaged; run the scene again")
    if not bodies:
        raise ResultError(
            f"{result.name}: no body of this result has a surface and its motion recorded, so there is nothing to show"
        )
    return bodies
