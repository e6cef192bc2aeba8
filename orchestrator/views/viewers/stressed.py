"""Plates with their stresses on the mesh that these are recovered at, which is finer than that of pictures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from components.contract.component import Vector

from ...analysis.stress.model import body_stress
from ...analysis.stress.stretching import stretching
from ...assembly import Geometry
from ...results.result import Result, ResultError
from .motion import Rows


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
    faces = corners.reshape(stress.plate.faces.shape).astype(np.int64)
    return Stressed(Geometry(positions, stress.shapes[used], faces), von_mises[:, used], remarks)
