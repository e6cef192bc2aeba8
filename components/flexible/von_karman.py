"""Tension that bending makes: the strain in the mid-plane that no motion of a free plate relieves.

Two modes strain the mid-plane by e_jk = beta_jk + E Psi_jk, the product of their slopes and the response to it
(`second_order`). What is left where nothing holds the border is work of tension on tension, 1/2 sum N_p^2 with

    N_p = 1/2 eta^T S_p eta,    sum_p (S_p)_jk (S_p)_lm = e_jk^T D e_lm = beta_jk^T D beta_lm - f_jk^T K^+ f_lm,

f = E^T D beta (plates of von Karman: Timoshenko and Woinowsky-Krieger, section 101; the static condensation of what
moves in the plane: Muravyov and Rizzi 2003). A border that is held pulls besides, by the forces of its ports on the
displacements of second order.
"""

from __future__ import annotations

import numpy as np

from ..contract.component import ComponentError, Vector
from .finite_elements import FiniteElementModel, PlateNodes
from .membrane_strain import pairs
from .second_order import FreeResponse, symmetric

_MOST_MODES = 80
"""Modes that are of second order unasked; what a step costs grows with the third power of their number."""
_KEPT = 1e-3
"""Of the largest stiffness against two modes of equal strain energy, what the smallest form holds: stresses to 1 %."""
_ROWS = 4000  # strains held at once


def bending_modes(model: FiniteElementModel, modes: Vector) -> int:
    """Number of the lowest modes, of (n, M), up to the last that moves mostly along z, the normal of the plate.

    ComponentError where there are so many that which ones matter should be said.
    """
    motion = np.asarray(model.displacement @ modes).reshape(len(model.masses), 3, -1)
    across = np.flatnonzero(np.einsum("q,qj->j", model.masses, motion[:, 2] ** 2) > 0.5)
    count = int(across.max(initial=-1)) + 1
    if count > _MOST_MODES:
        raise ComponentError(
            f"{count} modes bend the plate, more than {_MOST_MODES}; give second_order_modes, those up to a gap in"
            " frequency above all that the plate does, or fewer fixed_interface_modes"
        )
    return count


def tension_forms(model: FiniteElementModel, shapes: Vector, frequency: Vector, response: Vector) -> Vector:
    """Forms S_p (P, S, S), N^1/2 m^-3/2 kg^-1, of mode shapes (n, S) of frequencies (S,) and their pairs' response.

    The largest first, as seen by modes of equal strain energy; those that would add little are left out.
    """
    scale = _equal_energy(frequency)
    products = np.zeros((scale.size, scale.size))
    for part in model.strain.parts(_ROWS):
        strain = part.of_pairs(shapes) + np.asarray(part.linear @ response)
        products += strain.T @ np.asarray(part.stiffness @ strain)
    values, vectors = np.linalg.eigh(scale[:, None] * (0.5 * (products + products.T)) * scale)
    kept = np.flatnonzero(values > _KEPT * values.max(initial=0.0))[::-1]
    return symmetric((vectors[:, kept] / scale[:, None] * np.sqrt(values[kept])).T, shapes.shape[1])


def _equal_energy(frequency: Vector) -> Vector:
    """Products (S (S + 1) / 2) of the coordinates of two modes of strain energy 1/2 J, other pairs counted twice."""
    first, second = pairs(frequency.size)
    found: Vector = np.where(first == second, 1.0, np.sqrt(2.0)) / (frequency[first] * frequency[second])
    return found


def tension_fields(
    model: FiniteElementModel, plate: PlateNodes, shapes: Vector, frequency: Vector, forms: Vector
) -> Vector:
    """Resultants Nx, Ny, Nxy (3 K, P), N/m per J^1/2, at the nodes of a plate under unit tensions of forms (P, S, S).

    shapes (n, S) and frequency (S,) are those that the forms belong to. The strain of all pairs of modes is
    sum e_jk S_p scale^2 / |S_p scale|^2 for every tension, as forms are orthogonal where modes are of equal energy.
    """
    first, second = pairs(frequency.size)
    entries = forms[:, first, second].T * _equal_energy(frequency)[:, None] ** 2
    weights = entries / np.einsum("kp,kp->p", entries, forms[:, first, second].T)
    load = np.zeros((len(shapes), len(forms)))
    for part in model.strain.parts(_ROWS):
        load -= np.asarray(part.linear.T @ (part.stiffness @ (part.of_pairs(shapes) @ weights)))
    response = FreeResponse(model)(load)
    along, across = (np.asarray(plate.slopes[axis::2] @ shapes) for axis in (0, 1))
    strain = np.stack(
        [
            (along[:, first] * along[:, second]) @ weights,
            (across[:, first] * across[:, second]) @ weights,
            (along[:, first] * across[:, second] + across[:, first] * along[:, second]) @ weights,
        ]
    )
    nodes = len(plate.positions)
    resultants = np.asarray(plate.resultants @ response).reshape(nodes, 6, -1)[:, :3]
    found: Vector = resultants + np.einsum("ab,bkp->kap", plate.membrane, strain)
    return found.reshape(3 * nodes, -1)
