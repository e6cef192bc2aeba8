"""Plates with their stresses on the mesh that these are recovered at, which is finer than that of pictures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.flexible.stress import StressRecovery

from ...analysis.stress.model import body_stress
from ...analysis.stress.stretching import left_out, stretching
from ...assembly import Geometry
from ...results.result import Result, ResultError
from .motion import Rows


class Plate(NamedTuple):
    """A plate's nodes, shapes and elements; recovery at these nodes, with its coordinates (N, C) at all rows.

    remarks: sentences on what the stresses leave out.
    """

    geometry: Geometry
    recovery: StressRecovery
    coordinates: Vector
    remarks: list[str]


class Stressed(NamedTuple):
    """A plate's nodes, shapes and elements, von Mises stress (n, K) in Pa at some rows, and what it does not hold."""

    geometry: Geometry
    von_mises: Vector
    remarks: list[str]


def plate(result: Result, name: str) -> Plate:
    """The plate of a flexible panel; ResultError where the result does not allow stresses."""
    stress = body_stress(result, name, lambda plate: np.arange(len(plate.positions)))
    if not np.all(np.isfinite(stress.coordinates)):
        raise ResultError(f"{result.name}: {name}: the stresses are not finite; the run was unstable")
    remarks = list(left_out(name, stress, stretching(stress, result.time)))
    used, corners = np.unique(stress.plate.faces, return_inverse=True)
    faces = corners.reshape(stress.plate.faces.shape).astype(np.int64)
    geometry = Geometry(stress.plate.positions[used], stress.shapes[used], faces)
    return Plate(geometry, stress.recovery.at(used), stress.coordinates, remarks)


def stressed(result: Result, name: str, rows: Rows) -> Stressed:
    """Stresses of a flexible panel at some rows; ResultError where the result does not allow it."""
    found = plate(result, name)
    return Stressed(found.geometry, found.recovery.von_mises(found.coordinates[rows]), found.remarks)
