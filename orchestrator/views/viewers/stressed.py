"""Plates with their stresses on the mesh that these are recovered at, which is finer than that of pictures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import RBFInterpolator

from components.contract.component import Vector

from ...analysis.stress.model import body_stress
from ...analysis.stress.stretching import stretching
from ...assembly import Geometry
from ...results.result import Result, ResultError
from .motion import Rows

_FLAT = 1e-9
"""m, of a plate's plane."""


class Stressed(NamedTuple):
    """A plate's nodes, shapes and elements, von Mises stress (n, K) in Pa at some rows, and what it does not hold."""

    geometry: Geometry
    von_mises: Vector
    remarks: list[str]


def stressed(result: Result, name: str, rows: Rows) -> Stressed:
    """Stresses of a flexible panel at some rows; ResultError where the result does not allow it."""
    stress = body_stress(result, name, lambda plate: np.arange(len(plate.positions)))
    von_mises = stress.recovery.von_mises(stress.coordinates[rows])
    if not np.all(np.isfinite(von_mises)):
        raise ResultError(f"{result.name}: {name}: the stresses are not finite; the run was unstable")
    remarks = [] if stress.slopes is None else [*stretching(stress, result.time).sentences(name)]
    used, corners = np.unique(stress.plate.faces, return_inverse=True)
    positions = stress.plate.positions[used]
    shapes = _shapes(result, name, positions)
    faces = corners.reshape(stress.plate.faces.shape).astype(np.int64)
    return Stressed(Geometry(positions, shapes, faces), von_mises[:, used], remarks)


def _shapes(result: Result, name: str, positions: Vector) -> Vector:
    """Shapes (K, 3, M) at nodes (K, 3) of a plate's mesh, from those (D, 3, M) of the picture's nodes.

    A thin plate bent to pass through the picture's nodes (Duchon 1977) passes there.
    """
    body = result.geometry[name]
    known, shapes = np.asarray(body.positions), np.asarray(body.shapes)
    if np.any(np.abs(known[:, 2] - positions[0, 2]) > _FLAT) or np.any(np.ptp(positions[:, 2]) > _FLAT):
        raise ResultError(f"{result.name}: {name}: is more than one plane plate")
    try:
        bent = RBFInterpolator(known[:, :2], shapes.reshape(len(known), -1), kernel="thin_plate_spline")
        found: Vector = bent(positions[:, :2]).reshape(len(positions), 3, -1)
    except (ValueError, np.linalg.LinAlgError):
        raise ResultError(f"{result.name}: {name}: its nodes do not span a plate") from None
    return found
