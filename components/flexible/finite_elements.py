"""What finite elements give: a model with a sampling of its mass, plates, and what is known at their nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..contract.component import Vector
from .modal import inertia_invariants

Rectangle = tuple[tuple[float, float], tuple[float, float]]
SparseMatrix: TypeAlias = "sparse.csr_array[np.float64, tuple[int, int]]"


@dataclass(frozen=True)
class FiniteElementModel:
    """Assembled finite elements with n free degrees of freedom and a sampling of their mass.

    The mass matrix is S^T diag(m) S by construction, S being `displacement`.
    """

    stiffness: SparseMatrix
    """(n, n)"""
    masses: Vector
    """(Q,) mass samples, kg"""
    positions: Vector
    """(Q, 3) of the samples, construction frame, m"""
    displacement: SparseMatrix
    """(3 Q, n) displacement of the samples, row 3 q + axis"""
    rigid_motions: Vector
    """(n, 6) exact translations along and rotations about the construction axes"""
    point_positions: Mapping[str, Vector]
    """(3,) of every attachment point and node, m"""
    point_motions: Mapping[str, SparseMatrix]
    """(6, n) translation and small rotation of every attachment point and node"""
    attachment_dofs: Mapping[str, NDArray[np.int64]]
    """(6,) degrees of freedom of the points that can be attachment points"""
    display_positions: Vector
    """(D, 3) coarse grid for pictures, m"""
    display_displacement: SparseMatrix
    """(3 D, n)"""
    display_faces: NDArray[np.int64]
    """(F, 4)"""
    plate: PlateNodes | None = None
    """where stresses can be recovered, if the body is a plate"""

    @cached_property
    def mass_matrix(self) -> SparseMatrix:
        """Consistent mass matrix (n, n)."""
        weights = sparse.diags_array(np.repeat(self.masses, 3))
        return sparse.csr_array(self.displacement.T @ weights @ self.displacement)

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        return float(self.masses.sum())

    @property
    def center_of_mass(self) -> Vector:
        """(3,) in the construction frame, m."""
        center: Vector = self.masses @ self.positions / self.masses.sum()
        return center

    @property
    def inertia(self) -> Vector:
        """(3, 3) about the centre of mass, kg m2."""
        arms = self.positions - self.center_of_mass
        return inertia_invariants(self.masses, arms, np.zeros((3 * len(arms), 0))).i7


@dataclass(frozen=True)
class PlateNodes:
    """Mesh nodes of a plate and the resultants (Nx, Ny, Nxy in N/m, Mx, My, Mxy in N) at each of them."""

    positions: Vector
    """(K, 3) construction frame, m"""
    faces: NDArray[np.int64]
    """(F, 4) corners of the elements that deform"""
    resultants: SparseMatrix
    """(6 K, n) row 6 k + component; zero at nodes that no deforming element touches"""
    inserts: Mapping[str, Rectangle]
    """ranges of x and y of the rigid inserts, m"""

    def reduced(self, reduce: Callable[[SparseMatrix], SparseMatrix]) -> PlateNodes:
        """The same on other degrees of freedom."""
        return replace(self, resultants=reduce(self.resultants))

    def insert_distance(self) -> Vector:
        """Distance (K,) in the plane from every node to the nearest rigid insert, m; inf without inserts."""
        x, y = self.positions[:, 0], self.positions[:, 1]
        distances = [np.full(len(self.positions), np.inf)]
        for (x0, x1), (y0, y1) in self.inserts.values():
            along = np.maximum(np.maximum(x0 - x, x - x1), 0.0)
            distances.append(np.hypot(along, np.maximum(np.maximum(y0 - y, y - y1), 0.0)))
        nearest: Vector = np.min(distances, axis=0)
        return nearest
