"""Two finite-element models as one body: attachment points of the same name are welded."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import ComponentError
from .finite_elements import FiniteElementModel, SparseMatrix
from .membrane_strain import combined


def joined(first: FiniteElementModel, second: FiniteElementModel) -> FiniteElementModel:
    """One model of two in the same construction frame; the welded points are no longer points of it."""
    welds = [name for name in first.attachment_dofs if name in second.attachment_dofs]
    _check(first, second, welds)
    count, place = _numbering(first, second, welds)
    other = scipy.sparse.eye_array(count, format="csr")[place]
    here = scipy.sparse.eye_array(count, format="csr")[: first.stiffness.shape[0]]

    def on_first(matrix: SparseMatrix) -> SparseMatrix:
        return scipy.sparse.csr_array(matrix @ here)

    def on_second(matrix: SparseMatrix) -> SparseMatrix:
        return scipy.sparse.csr_array(matrix @ other)

    rigid_motions = np.zeros((count, 6))
    rigid_motions[place] = second.rigid_motions
    rigid_motions[: len(first.rigid_motions)] = first.rigid_motions
    positions = {**first.point_positions, **second.point_positions}
    kept = {name: position for name, position in positions.items() if name not in welds}
    motions = {name: on_first(m) for name, m in first.point_motions.items()}
    motions |= {name: on_second(m) for name, m in second.point_motions.items()}
    dofs = dict(first.attachment_dofs)
    dofs |= {name: place[d] for name, d in second.attachment_dofs.items()}
    return FiniteElementModel(
        stiffness=scipy.sparse.csr_array(
            here.T @ first.stiffness @ here + other.T @ second.stiffness @ other
        ),
        masses=np.concatenate([first.masses, second.masses]),
        positions=np.concatenate([first.positions, second.positions]),
        displacement=_stacked(on_first(first.displacement), on_second(second.displacement)),
        membrane_strain=lambda: combined([first.strain.reduced(on_first), second.strain.reduced(on_second)]),
        rigid_motions=rigid_motions,
        point_positions=kept,
        point_motions={name: motions[name] for name in kept},
        attachment_dofs={name: d for name, d in dofs.items() if name not in welds},
        display_positions=np.concatenate([first.display_positions, second.display_positions]),
        display_displacement=_stacked(
            on_first(first.display_displacement), on_second(second.display_displacement)
        ),
        display_faces=np.concatenate(
            [first.display_faces, second.display_faces + len(first.display_positions)]
        ),
        plate=None if first.plate is None else first.plate.reduced(on_first),
    )


def _check(first: FiniteElementModel, second: FiniteElementModel, welds: list[str]) -> None:
    """Welded points coincide, no other name is used twice, and at most the first model is a plate."""
    if not welds:
        raise ComponentError("two models to be joined have no attachment point in common")
    for name in welds:
        gap = np.linalg.norm(first.point_positions[name] - second.point_positions[name])
        if gap > 1e-9:
            raise ComponentError(f"the models to be joined have {name!r} at places {gap:.3g} m apart")
    twice = (set(first.point_positions) & set(second.point_positions)) - set(welds)
    if twice:
        raise ComponentError(f"the models to be joined both have a node {min(twice)!r}; rename one")
    if second.plate is not None:
        raise ComponentError("only the first of two models to be joined can be a plate")


def _numbering(
    first: FiniteElementModel, second: FiniteElementModel, welds: list[str]
) -> tuple[int, NDArray[np.int64]]:
    """Degrees of freedom of the whole, and where those of the second model are among them."""
    place = np.full(second.stiffness.shape[0], -1, dtype=np.int64)
    for name in welds:
        place[second.attachment_dofs[name]] = first.attachment_dofs[name]
    own = np.flatnonzero(place < 0)
    place[own] = first.stiffness.shape[0] + np.arange(own.size)
    return first.stiffness.shape[0] + own.size, place


def _stacked(upper: SparseMatrix, lower: SparseMatrix) -> SparseMatrix:
    return scipy.sparse.csr_array(scipy.sparse.vstack([upper, lower]))
