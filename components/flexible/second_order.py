"""Displacements of a flexible body to second order in its modal coordinates, u = Phi eta + 1/2 eta^T Psi eta.

Psi_jk is the response of the free body to the membrane strain that the slopes of two modes make, so that bending
shortens and does not stretch; the rigid motions are removed mass-orthogonally as from the modes, and the frame stays
the mean-axis frame to second order (modal derivatives: Wu and Tiso 2016).
"""

from __future__ import annotations

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from .finite_elements import FiniteElementModel, factorize
from .membrane_strain import pairs

_AT_ONCE = 64  # pairs of modes, whose strains take much memory


def second_order_shapes(model: FiniteElementModel, shapes: Vector) -> Vector:
    """Psi (n, S (S + 1) / 2) of shapes (n, S): of every two, those of `membrane_strain.pairs` in order."""
    strain, free = model.strain, FreeResponse(model)
    load_of = scipy.sparse.csr_array(strain.linear.T @ strain.stiffness)
    response = np.empty((len(shapes), pairs(shapes.shape[1])[0].size))
    for start in range(0, response.shape[1], _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        response[:, some] = free(-np.asarray(load_of @ strain.of_pairs(shapes, some)))
    return response


class FreeResponse:
    """Static response (n, k) of a free body to loads (n, k) in equilibrium, without rigid motions."""

    def __init__(self, model: FiniteElementModel) -> None:
        self._model = model
        # in equilibrium, so that six held degrees of freedom carry nothing
        held = next(iter(model.attachment_dofs.values()))
        self._interior = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
        self._factor = factorize(model.stiffness[self._interior][:, self._interior])

    def __call__(self, load: Vector) -> Vector:
        """The response to loads."""
        response = np.zeros_like(load)
        response[self._interior] = self._factor.solve(load[self._interior])
        return self._model.without_rigid_motions(response)


def symmetric(values: Vector, count: int) -> Vector:
    """Values (..., S (S + 1) / 2) of all pairs as (..., S, S)."""
    first, second = pairs(count)
    result = np.zeros((*values.shape[:-1], count, count))
    result[..., first, second] = result[..., second, first] = values
    return result


def second_order_inertia(model: FiniteElementModel, response: Vector, count: int) -> Vector:
    """What invariant 9 gains, (S, S, 3, 3) kg m2: the symmetric part of sum m skew(s) skew(Psi_jk)."""
    arms = model.masses[:, None] * (model.positions - model.center_of_mass)
    sums = scipy.sparse.csr_array(scipy.sparse.kron(arms.T, np.eye(3))) @ model.displacement  # row 3 a + b
    moment = symmetric(np.asarray(sums @ response).reshape(3, 3, -1), count)
    both = 0.5 * (moment + moment.transpose(1, 0, 2, 3)) - np.einsum("ccjk,ab->abjk", moment, np.eye(3))
    gained: Vector = both.transpose(2, 3, 0, 1)
    return gained


def check_second_order(count: int, modes: int) -> None:
    """Refuse more second-order modes than there are, or fewer than none."""
    if not 0 <= count <= modes:
        raise ComponentError(f"{count} second-order modes asked for; the body has {modes} modes")
