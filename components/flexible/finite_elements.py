"""What finite elements give: a model with a sampling of its mass, plates, and what is known at their nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import Vector
from ..contract.frames import skew
from .membrane_strain import MembraneStrain
from .membrane_strain import SparseMatrix as SparseMatrix
from .modal import inertia_invariants

Rectangle = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class OutputRows:
    """Outputs linear in the degrees of freedom, such as stresses and forces of elements of imported models."""

    labels: tuple[str, ...]
    """(S,) whose they are, and which"""
    units: tuple[str, ...]
    """(S,) Pa, N, N.m or N/m"""
    rows: Vector
    """(S, n)"""


@dataclass(frozen=True)
class FiniteElementModel:
    """Assembled finite elements with n free degrees of freedom and a sampling of their mass.

    The mass matrix is S^T diag(m) S, S being `displacement`, and what the samples do not stand for.
    """

    stiffness: SparseMatrix
    """(n, n)"""
    masses: Vector
    """(Q,) mass samples, kg"""
    positions: Vector
    """(Q, 3) of the samples, construction frame, m"""
    displacement: SparseMatrix
    """(3 Q, n) displacement of the samples, row 3 q + axis"""
    membrane_strain: Callable[[], MembraneStrain]
    """makes `strain`, which only bodies of second order need"""
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
    further_mass: SparseMatrix | None = None
    """(n, n) of imported models, whose mass matrix no samples need to make"""
    outputs: OutputRows | None = None
    """of imported models that bring rows for them"""

    @cached_property
    def strain(self) -> MembraneStrain:
        """Strains along beams and in the planes of plates."""
        return self.membrane_strain()

    @cached_property
    def mass_matrix(self) -> SparseMatrix:
        """Consistent mass matrix (n, n)."""
        weights = scipy.sparse.diags_array(np.repeat(self.masses, 3))
        sampled = self.displacement.T @ weights @ self.displacement
        return scipy.sparse.csr_array(sampled if self.further_mass is None else sampled + self.further_mass)

    @cached_property
    def _rigid_mass(self) -> Vector:
        """Mass matrix (6, 6) of the rigid motions."""
        found: Vector = self.rigid_motions.T @ np.asarray(self.mass_matrix @ self.rigid_motions)
        return found

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        if self.further_mass is not None:
            return float(np.trace(self._rigid_mass[:3, :3])) / 3.0
        return float(self.masses.sum())

    @property
    def center_of_mass(self) -> Vector:
        """(3,) in the construction frame, m."""
        if self.further_mass is not None:
            return _axial(self._rigid_mass[3:, :3]) / self.mass
        center: Vector = self.masses @ self.positions / self.masses.sum()
        return center

    @property
    def inertia(self) -> Vector:
        """(3, 3) about the centre of mass, kg m2."""
        if self.further_mass is not None:
            cross = skew(self.center_of_mass)
            return self._rigid_mass[3:, 3:] - self.mass * (cross.T @ cross)
        arms = self.positions - self.center_of_mass
        return inertia_invariants(self.masses, arms, np.zeros((3 * len(arms), 0))).i7

    def without_rigid_motions(self, vectors: Vector) -> Vector:
        """Vectors (n, k) made mass-orthogonal to the rigid motions, which are known exactly."""
        rigid = self.rigid_motions.copy()
        rigid[:, 3:] -= rigid[:, :3] @ skew(self.center_of_mass).T  # rotations about the centre of mass
        weighted = np.asarray(self.mass_matrix @ rigid)
        gram = rigid.T @ weighted
        for _ in range(2):  # the second pass removes what round-off left of the first
            vectors = vectors - rigid @ np.linalg.solve(gram, weighted.T @ vectors)
        return vectors


def factorize(matrix: SparseMatrix) -> scipy.sparse.linalg.SuperLU:
    """LU of a symmetric positive definite matrix, whose pivots are its diagonal; others would spoil the ordering."""
    return scipy.sparse.linalg.splu(
        scipy.sparse.csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _axial(matrix: Vector) -> Vector:
    """Vector (3,) whose `skew` is the skew part of a matrix (3, 3)."""
    parts = matrix - matrix.T
    return 0.5 * np.array([parts[2, 1], parts[0, 2], parts[1, 0]])


@dataclass(frozen=True)
class PlateNodes:
    """Mesh nodes of a plate and the resultants (Nx, Ny, Nxy in N/m, Mx, My, Mxy in N) at each of them."""

    positions: Vector
    """(K, 3) construction frame, m"""
    faces: NDArray[np.int64]
    """(F, 4) corners of the elements that deform"""
    resultants: SparseMatrix
    """(6 K, n) row 6 k + component; zero at nodes that no deforming element touches"""
    slopes: SparseMatrix
    """(2 K, n) w,x and w,y, row 2 k + axis; zero there as well"""
    translations: SparseMatrix
    """(3 K, n), row 3 k + axis"""
    membrane: Vector
    """(3, 3) forces in tension by the strains of the mid-plane, N/m"""
    inserts: tuple[Rectangle, ...]
    """ranges of x and y of the rigid inserts, m"""

    def reduced(self, reduce: Callable[[SparseMatrix], SparseMatrix]) -> PlateNodes:
        """The same on other degrees of freedom."""
        return replace(
            self,
            resultants=reduce(self.resultants),
            slopes=reduce(self.slopes),
            translations=reduce(self.translations),
        )

    def insert_distance(self) -> Vector:
        """Distance (K,) in the plane from every node to the nearest rigid insert, m; inf without inserts."""
        x, y = self.positions[:, 0], self.positions[:, 1]
        distances = [np.full(len(self.positions), np.inf)]
        for (x0, x1), (y0, y1) in self.inserts:
            along = np.maximum(np.maximum(x0 - x, x - x1), 0.0)
            distances.append(np.hypot(along, np.maximum(np.maximum(y0 - y, y - y1), 0.0)))
        nearest: Vector = np.min(distances, axis=0)
        return nearest
