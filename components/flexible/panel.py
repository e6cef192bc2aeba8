"""Honeycomb sandwich panel with hinge fittings -> finite elements.

Kirchhoff bending with the Bogner-Fox-Schmit rectangle and plane stress with the biquadratic rectangle, both
written as tensor products of scikit-fem's one-dimensional elements (cubic Hermite, quadratic): every plate
matrix is a sum of Kronecker products of beam matrices, exact to round-off on any tensor mesh.

Construction frame: x outboard along the wing from the inboard hinge line, y along the hinge lines with its
origin in the middle, z normal to the panel; the mid-plane is z = 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil

import numpy as np
import scipy
import skfem
from numpy.typing import NDArray

from ..contract.component import ComponentError, Vector
from .beam_frame import beam_slopes, beam_stiffness
from .finite_elements import FiniteElementModel, PlateNodes, Rectangle, SparseMatrix
from .membrane_strain import MembraneStrain, combined
from .modal import rigid_motion
from .plate import Panel, Plate
from .plate_resultants import AxisCorners, kron, plate_nodes

_GAUSS_POINTS = 4  # exact for the square of a cubic
_ROUNDING = 1e-9  # of sums over a mesh


class _Axis:
    """One direction of the tensor mesh: Hermite functions for bending, quadratic ones for stretching."""

    def __init__(self, breaks: Sequence[float], element_size: float) -> None:
        corners = np.unique(np.round(np.asarray(breaks, dtype=float), 12))
        parts = [
            np.linspace(a, b, ceil((b - a) / element_size - 1e-9), endpoint=False)
            for a, b in pairwise(corners)
        ]
        self.nodes = np.append(np.concatenate(parts), corners[-1])
        self._mesh = skfem.MeshLine(self.nodes)
        abscissas, weights = np.polynomial.legendre.leggauss(_GAUSS_POINTS)
        rule = (0.5 * (1.0 + abscissas[None]), 0.5 * weights)
        hermite = skfem.CellBasis(self._mesh, skfem.ElementLineHermite(), quadrature=rule)
        quadratic = skfem.CellBasis(self._mesh, skfem.ElementLineP2(), quadrature=rule)
        self.points = np.asarray(hermite.global_coordinates())[0].ravel()
        self.weights = hermite.dx.ravel()
        self.bending = [_values(hermite, order) for order in range(3)]
        self.stretching = [_values(quadratic, order) for order in range(2)]
        self.bending_places = hermite.doflocs[0]
        self.slopes = np.isin(np.arange(hermite.N), hermite.nodal_dofs[1])
        self.stretching_places = quadratic.doflocs[0]

    def at(self, places: Vector) -> tuple[list[SparseMatrix], list[SparseMatrix]]:
        """Bending and stretching functions and their derivatives at places (k,), each (k, n)."""
        cells = np.clip(np.searchsorted(self.nodes, places) - 1, 0, self.nodes.size - 2)
        fractions = (places - self.nodes[cells]) / (self.nodes[cells + 1] - self.nodes[cells])
        rule = (fractions[None, :, None], np.ones(1))  # one point in the element of each place
        hermite = skfem.CellBasis(self._mesh, skfem.ElementLineHermite(), quadrature=rule, elements=cells)
        quadratic = skfem.CellBasis(self._mesh, skfem.ElementLineP2(), quadrature=rule, elements=cells)
        return [_values(hermite, k) for k in range(2)], [_values(quadratic, k) for k in range(2)]

    def corners(self) -> AxisCorners:
        """The functions at both ends of every element."""
        rule = (np.array([[0.0, 1.0]]), np.full(2, 0.5))
        hermite = skfem.CellBasis(self._mesh, skfem.ElementLineHermite(), quadrature=rule)
        quadratic = skfem.CellBasis(self._mesh, skfem.ElementLineP2(), quadrature=rule)
        bending = [_values(hermite, order) for order in range(3)]
        return AxisCorners(self.nodes, bending, [_values(quadratic, order) for order in range(2)])

    def product(self, left: SparseMatrix, right: SparseMatrix) -> SparseMatrix:
        """Integral over the axis of the products of sampled functions."""
        return scipy.sparse.csr_array(left.T @ scipy.sparse.diags_array(self.weights) @ right)


def _values(basis: skfem.CellBasis, order: int) -> SparseMatrix:
    """Derivative of every basis function at every quadrature point, (points, degrees of freedom)."""
    fields = [basis.basis[i][0] for i in range(basis.Nbfun)]
    values = np.array([(f, f.grad[0])[order] if order < 2 else f.hess[0, 0] for f in fields])
    _, cells, points = values.shape
    columns = np.repeat(basis.element_dofs[:, :, None], points, axis=2)
    rows = np.broadcast_to(np.arange(cells * points).reshape(cells, points), columns.shape)
    entries = (values.ravel(), (rows.ravel(), columns.ravel()))
    return scipy.sparse.csr_array(entries, shape=(cells * points, basis.N))


class PlateElements:
    """Plate on a tensor mesh; degrees of freedom are w and its slopes, then u, then v.

    `kind` (n,) says what each is (w, its slope along x, along y, its twist, u, v: 0 to 5), `places` (n, 2)
    where it sits.
    """

    def __init__(
        self, plate: Plate, x_breaks: Sequence[float], y_breaks: Sequence[float], element_size: float
    ) -> None:
        self._plate = plate
        self._x, self._y = _Axis(x_breaks, element_size), _Axis(y_breaks, element_size)
        x, y = self._x, self._y
        bending = _grid(x.bending_places, y.bending_places)
        stretching = _grid(x.stretching_places, y.stretching_places)
        slopes = _grid(x.slopes, y.slopes)
        bending_kind = (slopes[:, 0] + 2 * slopes[:, 1]).astype(np.int64)
        self.kind = np.concatenate([bending_kind, np.repeat([4, 5], len(stretching))])
        self.places = np.concatenate([bending, stretching, stretching])
        self.stiffness = scipy.sparse.block_diag(
            [_bending(x, y, plate), _membrane(x, y, plate)], format="csr"
        )
        self.masses = plate.areal_mass * np.kron(x.weights, y.weights)
        self.positions = np.column_stack([_grid(x.points, y.points), np.zeros(self.masses.size)])
        self.displacement = _interleaved(
            kron(x.stretching[0], y.stretching[0]), kron(x.bending[0], y.bending[0])
        )

    def strain(self) -> MembraneStrain:
        """Strains of the mid-plane along x, along y and in shear at all points of integration, in this order."""
        (hx, gx, _), (hy, gy, _) = self._x.bending, self._y.bending
        (px, qx), (py, qy) = self._x.stretching, self._y.stretching
        along_x, along_y = kron(gx, hy), kron(hx, gy)
        by_x, by_y = kron(qx, py), kron(px, qy)  # of either motion in the plane
        none, still = scipy.sparse.csr_array(along_x.shape), scipy.sparse.csr_array(by_x.shape)
        rows = ((none, by_x, still), (none, still, by_y), (none, by_y, by_x))
        linear = scipy.sparse.csr_array(scipy.sparse.vstack([scipy.sparse.hstack(row) for row in rows]))
        in_plane = [scipy.sparse.csr_array((along_x.shape[0], 2 * by_x.shape[1]))] * 3
        slopes = (
            scipy.sparse.csr_array(
                scipy.sparse.hstack([scipy.sparse.vstack(turned), scipy.sparse.vstack(in_plane)])
            )
            for turned in ((along_x, along_y, 2.0 * along_x), (along_x, along_y, along_y))
        )
        a11, a22, a12, a66 = self._plate.membrane
        elasticity = np.array([[a11, a12, 0.0], [a12, a22, 0.0], [0.0, 0.0, a66]])
        weights = scipy.sparse.diags_array(np.kron(self._x.weights, self._y.weights))
        left, right = slopes
        return MembraneStrain(
            linear, ((left, right),), scipy.sparse.csr_array(scipy.sparse.kron(elasticity, weights))
        )

    def motion(self, x: float, y: float) -> SparseMatrix:
        """Translation and small rotation (6, n) of the plate at a point."""
        (hx, gx), (px, qx) = self._x.at(np.array([x]))
        (hy, gy), (py, qy) = self._y.at(np.array([y]))
        w, w_x, w_y = (kron(*pair) for pair in ((hx, hy), (gx, hy), (hx, gy)))
        u, u_y, v_x = (kron(*pair) for pair in ((px, py), (px, qy), (qx, py)))
        rows = [[None, u, None], [None, None, u], [w, None, None], [w_y, None, None], [-w_x, None, None]]
        return scipy.sparse.csr_array(scipy.sparse.bmat([*rows, [None, -0.5 * u_y, 0.5 * v_x]]))

    def translations(self, x: Vector, y: Vector) -> SparseMatrix:
        """Translations of the plate at all pairs of x (k,) and y (l,): row 3 (l i + j) + axis, (3 k l, n)."""
        ((hx, _), (px, _)), ((hy, _), (py, _)) = self._x.at(x), self._y.at(y)
        return _interleaved(kron(px, py), kron(hx, hy))

    def nodes(self, inserts: Sequence[Rectangle]) -> PlateNodes:
        """Mesh nodes and the force and moment resultants there; nothing deforms inside the inserts."""
        x, y = self._x.corners(), self._y.corners()
        return plate_nodes(x, y, self._plate, inserts, self.translations(x.nodes, y.nodes))

    def rigid_motion(self, origin: Vector) -> Vector:
        """Values (n, 6) of the degrees of freedom when the plate moves with a rigid point at origin (3,)."""
        x, y = (self.places - origin[:2]).T
        zero, one = np.zeros_like(x), np.ones_like(x)
        z = np.full_like(x, -origin[2])
        by_kind = np.array(
            [
                np.column_stack([zero, zero, one, y, -x, zero]),
                np.column_stack([zero, zero, zero, zero, -one, zero]),
                np.column_stack([zero, zero, zero, one, zero, zero]),
                np.zeros((x.size, 6)),
                np.column_stack([one, zero, zero, zero, z, -y]),
                np.column_stack([zero, one, zero, -z, zero, x]),
            ]
        )
        result: Vector = by_kind[self.kind, np.arange(x.size)]
        return result

    def within(self, x_range: tuple[float, float], y_range: tuple[float, float]) -> NDArray[np.bool_]:
        """Which degrees of freedom (n,) sit in a closed rectangle."""
        low, high = np.transpose([x_range, y_range])
        inside: NDArray[np.bool_] = np.all((self.places > low - 1e-9) & (self.places < high + 1e-9), axis=1)
        return inside


def _grid(x: NDArray[np.generic], y: NDArray[np.generic]) -> Vector:
    """All pairs (x_i, y_j) in the order of a Kronecker product, (n, 2)."""
    return np.column_stack([np.repeat(x, y.size), np.tile(y, x.size)]).astype(float)


def _interleaved(u: SparseMatrix, w: SparseMatrix) -> SparseMatrix:
    """Displacements, row 3 q + axis, from in-plane functions u (both directions) and deflections w."""
    axis = np.eye(3)[:, :, None]
    return scipy.sparse.csr_array(
        scipy.sparse.hstack(
            [scipy.sparse.kron(w, axis[2]), scipy.sparse.kron(u, axis[0]), scipy.sparse.kron(u, axis[1])]
        )
    )


def _bending(x: _Axis, y: _Axis, plate: Plate) -> SparseMatrix:
    d11, d22, d12, d66 = plate.bending
    (x0, x1, x2), (y0, y1, y2) = x.bending, y.bending
    mixed = kron(x.product(x2, x0), y.product(y0, y2))
    bent = scipy.sparse.csr_array(
        d11 * kron(x.product(x2, x2), y.product(y0, y0))
        + d22 * kron(x.product(x0, x0), y.product(y2, y2))
        + d12 * (mixed + mixed.T)
        + 4.0 * d66 * kron(x.product(x1, x1), y.product(y1, y1))
    )
    if not plate.prestress:
        return bent
    slopes = kron(x.product(x1, x1), y.product(y0, y0)) + kron(x.product(x0, x0), y.product(y1, y1))
    return scipy.sparse.csr_array(bent + plate.prestress * slopes)


def _membrane(x: _Axis, y: _Axis, plate: Plate) -> SparseMatrix:
    a11, a22, a12, a66 = plate.membrane
    (x0, x1), (y0, y1) = x.stretching, y.stretching
    along_x = kron(x.product(x1, x1), y.product(y0, y0))
    along_y = kron(x.product(x0, x0), y.product(y1, y1))
    poisson = kron(x.product(x1, x0), y.product(y0, y1))
    shear = kron(x.product(x0, x1), y.product(y1, y0))
    uu = scipy.sparse.csr_array(a11 * along_x + a66 * along_y)
    vv = scipy.sparse.csr_array(a22 * along_y + a66 * along_x)
    uv = scipy.sparse.csr_array(a12 * poisson + a66 * shear)
    return scipy.sparse.csr_array(scipy.sparse.bmat([[uu, uv], [scipy.sparse.csr_array(uv.T), vv]]))


def panel_model(panel: Panel) -> FiniteElementModel:
    """Assembled panel; its points are the hinge arms (attachment points) and the panel's nodes."""
    if problems := "; ".join(panel.problems()):
        raise ComponentError(problems)
    end = panel.plate_start + panel.plate.length
    half = 0.5 * panel.plate.width
    patches = {arm.name: panel.patches(arm) for arm in panel.arms}
    rigid = [patch for several in patches.values() for patch in several]
    plate = PlateElements(panel.plate, *panel.mesh_lines(), panel.element_size)
    ties = _Ties(plate, panel, patches)
    shown = np.linspace(panel.plate_start, end, 7), np.linspace(-half, half, 5)
    display = _grid(*shown)
    nodes = {name: np.array([x, y, 0.0]) for name, (x, y) in panel.nodes.items()}
    motions = {name: ties.reduce(plate.motion(p[0], p[1])) for name, p in nodes.items()}
    hubs = ties.attachment_motions()
    heavy = [arm for arm in panel.arms if arm.point_mass > 0.0]
    return FiniteElementModel(
        stiffness=ties.stiffness(),
        masses=np.append(plate.masses, [arm.point_mass for arm in heavy]),
        positions=np.concatenate([plate.positions, *(ties.tips[arm.name][None] for arm in heavy)]),
        displacement=scipy.sparse.csr_array(
            scipy.sparse.vstack([ties.reduce(plate.displacement), *(hubs[arm.name][:3] for arm in heavy)])
        ),
        membrane_strain=ties.strain,
        rigid_motions=ties.rigid_motions(),
        point_positions=ties.tips | nodes,
        point_motions=hubs | motions,
        attachment_dofs=ties.attachment_dofs,
        display_positions=np.column_stack([display, np.zeros(len(display))]),
        display_displacement=ties.reduce(plate.translations(*shown)),
        display_faces=_faces(7, 5),
        plate=plate.nodes(rigid).reduced(ties.reduce),
    )


def _faces(nx: int, ny: int) -> NDArray[np.int64]:
    """Quadrilaterals (F, 4) of a display grid."""
    corner = (np.arange(nx - 1)[:, None] * ny + np.arange(ny - 1)).ravel()
    return np.column_stack([corner, corner + ny, corner + ny + 1, corner + 1])


class _Ties:
    """Free degrees of freedom: those of the plate outside the patches, six per patch, six per arm's tip.

    With a rigid link the patch moves with the tip, so the two sets are one.
    """

    def __init__(
        self,
        plate: PlateElements,
        panel: Panel,
        patches: Mapping[str, Sequence[Rectangle]],
    ) -> None:
        self.plate, self.arms = plate, panel.arms
        self.has_tension = panel.plate.prestress > 0.0
        inside = {
            name: np.any([plate.within(*patch) for patch in several], axis=0)
            for name, several in patches.items()
        }
        self.free = ~np.any([np.zeros(plate.kind.size, dtype=bool), *inside.values()], axis=0)
        self.roots, self.tips = {}, {}
        for arm in panel.arms:
            root, tip = panel.ends(arm)
            self.tips[arm.name] = np.array([tip, arm.y, arm.z])
            self.roots[arm.name] = np.array([root, arm.y, arm.z]) if arm.section else self.tips[arm.name]
        count = int(self.free.sum())
        self.root_dofs, self.attachment_dofs = {}, {}
        for arm in panel.arms:
            self.root_dofs[arm.name] = count + np.arange(6)
            count += 6 if arm.section else 0
            self.attachment_dofs[arm.name] = count + np.arange(6)
            count += 6
        self.count = count
        self._transformation = self._build(inside)

    def _build(self, inside: Mapping[str, NDArray[np.bool_]]) -> SparseMatrix:
        """Plate degrees of freedom from the free ones."""
        full = np.zeros((self.plate.kind.size, self.count - int(self.free.sum())))
        first = int(self.free.sum())
        for name, mask in inside.items():
            full[np.ix_(mask, self.root_dofs[name] - first)] = self.plate.rigid_motion(self.roots[name])[mask]
        selection = scipy.sparse.eye_array(self.plate.kind.size, format="csr")[:, np.flatnonzero(self.free)]
        return scipy.sparse.csr_array(scipy.sparse.hstack([selection, scipy.sparse.csr_array(full)]))

    def reduce(self, matrix: SparseMatrix) -> SparseMatrix:
        """A matrix on plate degrees of freedom (k, n) turned into one on the free ones."""
        return scipy.sparse.csr_array(matrix @ self._transformation)

    def stiffness(self) -> SparseMatrix:
        """Plate and arms; tension gives none to the tilting of the whole."""
        total = scipy.sparse.csr_array(self._transformation.T @ self.plate.stiffness @ self._transformation)
        for arm in self.arms:
            if arm.section is not None:
                dofs = np.concatenate([self.root_dofs[arm.name], self.attachment_dofs[arm.name]])
                block = beam_stiffness(arm.section, self.roots[arm.name], self.tips[arm.name])
                indices = (np.repeat(dofs, 12), np.tile(dofs, 12))
                total = total + scipy.sparse.csr_array((block.ravel(), indices), shape=total.shape)
        return (
            _without_tilting(total, self.rigid_motions())
            if self.has_tension
            else scipy.sparse.csr_array(total)
        )

    def strain(self) -> MembraneStrain:
        """Of the plate and along the arms that bend."""
        identity = scipy.sparse.eye_array(self.count, format="csr")
        parts = [self.plate.strain().reduced(self.reduce)]
        for arm in self.arms:
            if arm.section is not None:
                dofs = np.concatenate([self.root_dofs[arm.name], self.attachment_dofs[arm.name]])
                *rows, weights = beam_slopes(self.roots[arm.name], self.tips[arm.name])
                own: SparseMatrix = scipy.sparse.csr_array(identity[dofs])
                stretch, along_y, along_z = (scipy.sparse.csr_array(row @ own) for row in rows)
                stiffness = scipy.sparse.csr_array(scipy.sparse.diags_array(arm.section.axial * weights))
                parts.append(MembraneStrain(stretch, ((along_y, along_y), (along_z, along_z)), stiffness))
        return combined(parts)

    def rigid_motions(self) -> Vector:
        """Rigid motions (n, 6) about the construction frame."""
        motions = np.zeros((self.count, 6))
        motions[: self.free.sum()] = self.plate.rigid_motion(np.zeros(3))[self.free]
        for name in self.tips:
            motions[self.root_dofs[name]] = rigid_motion(self.roots[name])
            motions[self.attachment_dofs[name]] = rigid_motion(self.tips[name])
        return motions

    def attachment_motions(self) -> dict[str, SparseMatrix]:
        """Motion (6, n) of every attachment point."""
        identity = scipy.sparse.eye_array(self.count, format="csr")
        return {name: scipy.sparse.csr_array(identity[dofs]) for name, dofs in self.attachment_dofs.items()}


def _without_tilting(stiffness: SparseMatrix, rigid_motions: Vector) -> SparseMatrix:
    """Stiffness of a plate in tension less that against tilting, for what pulls at its border turns along.

    Inside, where the tension is in equilibrium, nothing changes: what is taken away acts on the border alone.
    """
    tilts = rigid_motions[:, 3:5]
    forces = np.asarray(stiffness @ tilts)
    forces[np.abs(forces) < _ROUNDING * np.abs(forces).max()] = 0.0
    border = scipy.sparse.csr_array(forces)
    whole: SparseMatrix = border @ scipy.sparse.csr_array(np.linalg.inv(tilts.T @ forces)) @ border.T
    return scipy.sparse.csr_array(stiffness - whole)
