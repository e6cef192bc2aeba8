"""Finite elements -> Craig-Bampton reduction -> modal data.

The reduction keeps fixed-interface normal modes and six constraint modes per attachment point (Craig and
Bampton 1968; Bagnoli 2007, chapter 1). The six rigid motions are then taken out by a mass-orthogonal
projection onto their exact geometry, and a second eigensolution makes the remaining modes orthonormal.
Mass matrix and invariants come from one sampling of the mass: I3 and I4 vanish to round-off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import ComponentError, Vector
from .finite_elements import FiniteElementModel, SparseMatrix, factorize
from .modal import ModalData, default_damping, inertia_invariants
from .plate import Geometry
from .second_order import check_second_order, second_order_inertia, second_order_shapes, symmetric
from .von_karman import bending_modes, tension_forms

_ALIKE, _EQUAL = 2, 1e-6
"""Modes beyond those asked for that are compared with the last, and the difference of eigenvalues that are one."""


def _times(matrix: SparseMatrix, vectors: Vector) -> Vector:
    """Sparse matrix times dense vectors."""
    return np.asarray(matrix @ vectors)


def _boundary(model: FiniteElementModel, attachment_points: Sequence[str]) -> NDArray[np.int64]:
    """Degrees of freedom of the attachment points, in their order."""
    if not attachment_points:
        raise ComponentError("a reduced body needs at least one attachment point")
    for name in attachment_points:
        if name not in model.attachment_dofs:
            known = ", ".join(model.attachment_dofs)
            raise ComponentError(f"{name!r} cannot be an attachment point; possible ones are {known}")
    return np.concatenate([model.attachment_dofs[name] for name in attachment_points])


def _lowest_modes(
    stiffness: SparseMatrix,
    mass: SparseMatrix,
    count: int,
    factor: scipy.sparse.linalg.SuperLU,
    shift: float = 0.0,
) -> tuple[Vector, Vector]:
    """Lowest eigenvalues (count,) and mass-normalised vectors (n, count), given the LU of K - shift M."""
    if count < 0:
        raise ComponentError(f"{count} modes asked for; the number must not be negative")
    if count == 0:
        return np.zeros(0), np.zeros((stiffness.shape[0], 0))
    if count == stiffness.shape[0]:
        found = scipy.linalg.eigh(stiffness.toarray(), mass.toarray())
        return found[0], found[1]
    if count > stiffness.shape[0]:
        raise ComponentError(
            f"{count} modes asked for, but only {stiffness.shape[0]} degrees of freedom between its attachment points; "
            "ask for fewer (fixed_interface_modes), or give more elements"
        )
    inverse = scipy.sparse.linalg.LinearOperator(stiffness.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    values, vectors = scipy.sparse.linalg.eigsh(
        stiffness, k=count, M=mass, sigma=shift, OPinv=inverse, v0=start
    )
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _lowest_whole(
    stiffness: SparseMatrix, mass: SparseMatrix, count: int, factor: scipy.sparse.linalg.SuperLU
) -> Vector:
    """The same vectors, and with them all those of the frequency of the last one.

    With half of a pair a round boom would swing out of the plane that it is moved in.
    """
    size = stiffness.shape[0]
    asked = min(count + _ALIKE, size) if 0 < count < size else count
    values, vectors = _lowest_modes(stiffness, mass, asked, factor)
    if asked == count:
        return vectors
    return vectors[:, np.flatnonzero(values <= (1.0 + _EQUAL) * values[count - 1])]


def _told_apart(values: Vector, vectors: Vector, mass: SparseMatrix) -> Vector:
    """Mass-normalised vectors (n, k) of rising eigenvalues (k,), those of one value turned in a way of their own.

    A solver returns any vectors of a pair, others each time, and bodies would not be the same.
    """
    found, k = vectors.copy(), 0
    while k < values.size:
        last = int(np.searchsorted(values, (1.0 + _EQUAL) * values[k], side="right"))
        if last - k > 1:
            marks = np.random.default_rng(2).standard_normal((len(vectors), last - k))
            turn, sizes = np.linalg.qr(vectors[:, k:last].T @ _times(mass, marks))
            found[:, k:last] = vectors[:, k:last] @ (turn * np.sign(np.diag(sizes)))
        k = last
    return found


def fixed_interface_frequencies(
    model: FiniteElementModel, attachment_points: Sequence[str], count: int
) -> Vector:
    """Lowest frequencies (count,) in rad/s with the attachment points clamped."""
    interior = np.setdiff1d(np.arange(model.stiffness.shape[0]), _boundary(model, attachment_points))
    stiffness = model.stiffness[interior][:, interior]
    mass = model.mass_matrix[interior][:, interior]
    return np.sqrt(_lowest_modes(stiffness, mass, count, factorize(stiffness))[0])


def free_frequencies(model: FiniteElementModel, count: int) -> Vector:
    """Lowest elastic frequencies (count,) in rad/s of the free body."""
    shift = -(float(2.0 * np.pi) ** 2)  # a rigid body on 1 Hz springs is regular and spoils no mode
    factor = factorize(scipy.sparse.csr_array(model.stiffness - shift * model.mass_matrix))
    values, _ = _lowest_modes(model.stiffness, model.mass_matrix, count + 6, factor, shift)
    return np.sqrt(values[6:])


def craig_bampton_basis(
    model: FiniteElementModel, attachment_points: Sequence[str], number_of_fixed_interface_modes: int
) -> Vector:
    """Craig-Bampton vectors (n, fixed-interface normal modes + 6 constraint modes per attachment point)."""
    boundary = _boundary(model, attachment_points)
    interior = np.setdiff1d(np.arange(model.stiffness.shape[0]), boundary)
    stiffness = model.stiffness[interior][:, interior]
    mass = model.mass_matrix[interior][:, interior]
    if not interior.size and not number_of_fixed_interface_modes:
        return np.eye(boundary.size)[np.argsort(boundary)]
    factor = factorize(stiffness)
    normal = _lowest_whole(stiffness, mass, number_of_fixed_interface_modes, factor)
    constraint = -factor.solve(model.stiffness[interior][:, boundary].toarray())
    basis = np.zeros((model.stiffness.shape[0], normal.shape[1] + boundary.size))
    basis[interior] = np.hstack([normal, constraint])
    basis[boundary, normal.shape[1] :] = np.eye(boundary.size)
    return basis


def orthonormal_modes(
    model: FiniteElementModel, attachment_points: Sequence[str], number_of_fixed_interface_modes: int
) -> tuple[Vector, Vector]:
    """Frequencies (M,) in rad/s and orthonormal modes (n, M), M = fixed-interface modes + 6 AP - 6."""
    basis = craig_bampton_basis(model, attachment_points, number_of_fixed_interface_modes)
    boundary = _boundary(model, attachment_points)
    rigid_coordinates = np.zeros((basis.shape[1], 6))
    rigid_coordinates[-boundary.size :] = model.rigid_motions[boundary]
    complement = np.linalg.qr(rigid_coordinates, mode="complete")[0][:, 6:]
    elastic = model.without_rigid_motions(basis @ complement)
    stiffness = elastic.T @ _times(model.stiffness, elastic)
    mass = elastic.T @ _times(model.mass_matrix, elastic)
    try:
        values, vectors = scipy.linalg.eigh(0.5 * (stiffness + stiffness.T), 0.5 * (mass + mass.T))
    except scipy.linalg.LinAlgError:
        raise ComponentError(
            "some motions have no kinetic energy, or a negative one, by the mass matrix; it is not that of a body"
        ) from None
    modes = _told_apart(values, model.without_rigid_motions(elastic @ vectors), model.mass_matrix)
    return np.sqrt(values), modes * _signs(modes)


def _signs(modes: Vector) -> Vector:
    """Signs (M,) that make the first large entry of every mode positive, whatever the solver returned."""
    size = np.abs(modes)
    first = np.argmax(size > 0.99 * size.max(axis=0, initial=0.0), axis=0)
    signs: Vector = np.sign(modes[first, np.arange(modes.shape[1])])
    return signs


def inertia_relief(
    model: FiniteElementModel, attachment_points: Sequence[str], frequency: Vector, modes: Vector
) -> Vector:
    """What modes (n, M) of `orthonormal_modes` lack of the static deformation under inertia loads, (n, 12).

    The loads are -m (a + G s), s from the centre of mass: columns are unit a along the axes (m/s2), then the
    entries of G (1/s2) column by column. The shapes are the response with attachment points clamped, less its
    projection on the modes: orthogonal to them in stiffness, so they add to a static solution and leave it alone
    (Dickens, Nakagawa and Wittbrodt 1997). Right up to rigid motions, which carry no stress.
    """
    boundary = _boundary(model, attachment_points)
    interior = np.setdiff1d(np.arange(model.stiffness.shape[0]), boundary)
    arms = model.positions - model.center_of_mass
    factors = np.column_stack([np.ones(len(arms)), arms])
    fields = np.einsum("q,qj,ik->qijk", model.masses, factors, np.eye(3))  # row 3 q + i, column 3 j + k
    loads = -_times(scipy.sparse.csr_array(model.displacement.T), fields.reshape(-1, 12))
    shapes = np.zeros((model.stiffness.shape[0], 12))
    shapes[interior] = factorize(model.stiffness[interior][:, interior]).solve(loads[interior])
    amplitudes = modes.T @ _times(model.stiffness, shapes) / frequency[:, None] ** 2
    return shapes - modes @ amplitudes


def craig_bampton(
    model: FiniteElementModel,
    attachment_points: Sequence[str],
    number_of_fixed_interface_modes: int,
    nodes: Sequence[str] = (),
    second_order_modes: int = 0,
    geometry: Geometry = "linear",
) -> ModalData:
    """Reduced body with default damping; `nodes` are further points a scene may load, without modes.

    second_order_modes: so many of the lowest modes displace the body to second order too, which stiffens it under
    tension and spin. geometry: with "von_karman" what bends stretches; then 0 modes are those that bend a plate.
    """
    frequency, modes = orthonormal_modes(model, attachment_points, number_of_fixed_interface_modes)
    check_second_order(second_order_modes, frequency.size)
    stretches = geometry == "von_karman"
    if stretches and not second_order_modes:
        second_order_modes = bending_modes(model, modes)
    names = (*attachment_points, *nodes)
    motion = np.array([_times(model.point_motions[name], modes) for name in names])
    arms = model.positions - model.center_of_mass
    invariants = inertia_invariants(model.masses, arms, _times(model.displacement, modes))
    inertia, invariant8 = invariants.i7, invariants.i8
    if (
        model.further_mass is not None
    ):  # exact, and without the moment of momentum that samples alone would have
        inertia, invariant8 = model.inertia, 0.5 * (invariant8 + invariant8.transpose(0, 2, 1))
    data = ModalData(
        mass=model.mass,
        center_of_mass=model.center_of_mass,
        inertia=inertia,
        frequency=frequency,
        damping_ratio=default_damping(frequency),
        point_names=names,
        point_positions=np.array([model.point_positions[name] for name in names]),
        translation=motion[:, :3],
        rotation=motion[:, 3:],
        invariant5=invariants.i5,
        invariant8=invariant8,
        invariant9=invariants.i9,
        display_positions=model.display_positions,
        display_shapes=_times(model.display_displacement, modes).reshape(
            len(model.display_positions), 3, frequency.size
        ),
        display_faces=model.display_faces,
    )
    if not second_order_modes:
        return data
    return _to_second_order(data, model, modes[:, :second_order_modes], stretches)


def _to_second_order(data: ModalData, model: FiniteElementModel, modes: Vector, stretches: bool) -> ModalData:
    """The body with what pairs of its lowest modes (n, S) do: at the points, to inertia, and by stretching it."""
    count, response = modes.shape[1], second_order_shapes(model, modes)
    points = [_times(model.point_motions[name], response) for name in data.point_names]
    invariant9 = data.invariant9.copy()
    invariant9[:count, :count] += second_order_inertia(model, response, count)
    data = replace(data, invariant9=invariant9, second_order_points=symmetric(np.array(points), count))
    if not stretches:
        return data
    return replace(data, tension_forms=tension_forms(model, modes, data.frequency[:count], response))
