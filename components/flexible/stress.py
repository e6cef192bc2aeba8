"""Stress recovery from modal coordinates: in-plane stresses of both face sheets at the nodes of a plate.

Equilibrium alone gives the stresses: two sheets of thickness t whose mid-planes are d apart carry the
resultants as N/2 + M/d (upper, +z) and N/2 - M/d (lower) per unit width, so stress = N / (2 t) +- M / (t d)
(Allen 1969, chapter 2; the core carries no in-plane stress). The surfaces of a solid plate of thickness h
have N / h +- 6 M / h². Anisotropic sheets enter through the plate's stiffness only; stresses are means over the
sheet's thickness, and von Mises stress is a measure of intensity for them, not a criterion of failure.

Stresses of the modes times modal coordinates are exact for static loads at attachment points (constraint modes).
Inertia of the plate itself converges with the number of fixed-interface modes, fast in bending (0.2 % with 10 on
the AMOS-3 panel) and slowly in plane (half is missing with 10); `reduction.inertia_relief` has the shapes that
make it exact in static equilibrium. Take them as further modes, with the acceleration field as coordinates.

At the corners of rigid inserts the stress of a Kirchhoff plate is singular: values there depend on the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..contract.component import ComponentError, Vector
from .finite_elements import FiniteElementModel

Indices = NDArray[np.int64]
FACES = ("upper", "lower")
_CHUNK = 4_000_000  # stress values held at once, 32 MB


@dataclass(frozen=True)
class FaceSheets:
    """How the resultants of a plate load its two faces: stress = per_force N +- per_moment M."""

    per_force: float
    """1/m"""
    per_moment: float
    """1/m2"""

    @classmethod
    def sandwich(cls, skin: float, distance: float) -> Self:
        """Two sheets of thickness `skin` (m) with their mid-planes `distance` (m) apart; stresses are those there.

        The sheets' own bending carries its share of the moment, see `plate.sandwich_stiffness`.
        """
        square = _positive(distance, "distance") ** 2 + _positive(skin, "skin") ** 2 / 3.0
        return cls(0.5 / skin, distance / (skin * square))

    @classmethod
    def solid(cls, thickness: float) -> Self:
        """Surfaces of a homogeneous plate (m)."""
        return cls(1.0 / _positive(thickness, "thickness"), 6.0 / thickness**2)


def _positive(value: float, name: str) -> float:
    if not value > 0.0:
        raise ComponentError(f"{name} of a face sheet is {value} m; it must be positive")
    return value


def von_mises(stress: Vector) -> Vector:
    """Von Mises stress (...,) of plane stress (..., 3): sx, sy, txy, all in one unit."""
    sx, sy, txy = np.moveaxis(stress, -1, 0)
    # half the sum of squares, not sx² - sx sy + sy²: it cannot be negative by round-off
    result: Vector = np.sqrt(0.5 * (sx**2 + sy**2 + (sx - sy) ** 2) + 3.0 * txy**2)
    return result


@dataclass(frozen=True)
class StressRecovery:
    """Stresses of the modes at some nodes of a plate."""

    nodes: Indices
    """(K,) numbers of the nodes in the mesh"""
    positions: Vector
    """(K, 3) construction frame, m"""
    modal_stress: Vector
    """(K, 2, 3, M) sx, sy, txy of the upper and the lower face per modal coordinate, Pa / (kg^1/2 m)"""

    def at(self, places: Indices) -> StressRecovery:
        """The recovery at some of its nodes, by their places in `nodes`."""
        return StressRecovery(self.nodes[places], self.positions[places], self.modal_stress[places])

    def with_tension(self, sheets: FaceSheets, fields: Vector) -> StressRecovery:
        """The recovery with stresses of further resultants N (3 nodes of the mesh, P), N/m, as columns behind."""
        tension = sheets.per_force * fields.reshape(-1, 3, fields.shape[1])[self.nodes]
        faces = np.stack([tension, tension], axis=1)
        return StressRecovery(self.nodes, self.positions, np.concatenate((self.modal_stress, faces), axis=3))

    def stress(self, eta: Vector) -> Vector:
        """Stresses (..., K, 2, 3) in Pa at modal coordinates eta (..., M)."""
        shape = self.modal_stress.shape
        if eta.shape[-1] != shape[-1]:
            raise ComponentError(f"{eta.shape[-1]} modal coordinates given; the body has {shape[-1]} modes")
        flat: Vector = eta @ self.modal_stress.reshape(-1, shape[-1]).T
        return flat.reshape(*eta.shape[:-1], *shape[:-1])

    def von_mises(self, eta: Vector) -> Vector:
        """Von Mises stress (..., K) in Pa, of the face where it is larger."""
        larger: Vector = von_mises(self.stress(eta)).max(axis=-1)
        return larger

    def peak(self, eta: Vector) -> PeakStress:
        """Largest von Mises stress of every node over the rows of eta (N, M)."""
        count = len(self.nodes)
        value, row, face = np.full(count, -np.inf), np.zeros(count, np.int64), np.zeros(count, np.int64)
        rows = max(1, _CHUNK // max(6 * count, 1))
        for start in range(0, len(eta), rows):
            found = von_mises(self.stress(eta[start : start + rows])).reshape(-1, count, len(FACES))
            faces = found.argmax(axis=2)
            larger = np.take_along_axis(found, faces[..., None], axis=2)[..., 0]
            best = larger.argmax(axis=0)
            here = larger[best, np.arange(count)]
            better = here > value
            value = np.where(better, here, value)
            row = np.where(better, best + start, row)
            face = np.where(better, faces[best, np.arange(count)], face)
        return PeakStress(value, row, face)


@dataclass(frozen=True)
class PeakStress:
    """Largest von Mises stress over time at the nodes of a recovery."""

    value: Vector
    """(K,) Pa"""
    row: Indices
    """(K,) row of the modal coordinates where it is reached"""
    face: Indices
    """(K,) 0 upper, 1 lower"""


def stress_recovery(
    model: FiniteElementModel, sheets: FaceSheets, modes: Vector, nodes: ArrayLike | None = None
) -> StressRecovery:
    """Recovery at mesh nodes (all of them by default) of a plate with mode shapes `modes` (n, M).

    Inside rigid inserts the stress is zero: the insert carries the load.
    """
    if model.plate is None:
        raise ComponentError("stresses are recovered for plates only, and this body is none")
    positions = model.plate.positions
    chosen = np.arange(len(positions)) if nodes is None else np.asarray(nodes, dtype=np.int64).ravel()
    if chosen.size == 0:
        raise ComponentError("no node is left to recover stresses at; choose a larger part of the plate")
    if chosen.min() < 0 or chosen.max() >= len(positions):
        raise ComponentError(f"a node is not in the mesh, whose nodes are 0 to {len(positions) - 1}")
    rows = (6 * chosen[:, None] + np.arange(6)).ravel()
    resultants = np.asarray(model.plate.resultants[rows] @ modes).reshape(chosen.size, 2, 3, -1)
    tension, bending = sheets.per_force * resultants[:, 0], sheets.per_moment * resultants[:, 1]
    faces = np.stack([tension + bending, tension - bending], axis=1)
    return StressRecovery(chosen, positions[chosen], faces)


def nodes_in_rectangle(
    positions: Vector, x_range: tuple[float, float], y_range: tuple[float, float]
) -> Indices:
    """Nodes, of positions (K, 3), in a closed rectangle (m)."""
    low, high = np.transpose([x_range, y_range])
    inside = np.all((positions[:, :2] >= low - 1e-9) & (positions[:, :2] <= high + 1e-9), axis=1)
    return np.flatnonzero(inside)


def nodes_around(positions: Vector, point: ArrayLike, radius: float) -> Indices:
    """Nodes, of positions (K, 3), at most `radius` (m) from a point (x, y)."""
    return np.flatnonzero(np.linalg.norm(positions[:, :2] - np.asarray(point), axis=1) <= radius + 1e-9)


def hot_spots(values: Vector, positions: Vector, radius: float, count: int) -> Indices:
    """Places (up to `count`) of the largest values (K,), falling; nodes within `radius` of a chosen one are skipped.

    positions (K, 3) and radius in m; a node exactly at the radius is within it.
    """
    left = np.argsort(-values, kind="stable")
    chosen: list[int] = []
    while left.size and len(chosen) < count:
        chosen.append(int(left[0]))
        distance = np.linalg.norm(positions[left] - positions[left[0]], axis=1)
        left = left[1:] if radius <= 0.0 else left[distance > radius + 1e-9]
    return np.array(chosen, dtype=np.int64)
