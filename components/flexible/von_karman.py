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

from ..contract.component import Vector
from .finite_elements import FiniteElementModel
from .membrane_strain import pairs
from .second_order import symmetric

MOST_MODES = 48
"""Modes that may be of second order unasked; forms grow with the third power of their number."""
_KEPT = 3e-3
"""Of the largest stiffness against two modes of equal strain energy, what the smallest form holds."""
_ROWS = 4000  # strains held at once


def bending_modes(model: FiniteElementModel, modes: Vector) -> int:
    """Number of the lowest modes, of (n, M), up to the last that moves mostly along z, the normal of the plate."""
    motion = np.asarray(model.displacement @ modes).reshape(len(model.masses), 3, -1)
    across = np.flatnonzero(np.einsum("q,qj->j", model.masses, motion[:, 2] ** 2) > 0.5)
    return min(int(across.max(initial=-1)) + 1, MOST_MODES)


def tension_forms(model: FiniteElementModel, shapes: Vector, frequency: Vector, response: Vector) -> Vector:
    """Forms S_p (P, S, S), N^1/2 m^-3/2 kg^-1, of mode shapes (n, S) of frequencies (S,) and their pairs' response.

    The largest first, as seen by modes of equal strain energy; those that would add little are left out.
    """
    first, second = pairs(shapes.shape[1])
    products = np.zeros((first.size, first.size))
    for part in model.strain.parts(_ROWS):
        strain = part.of_pairs(shapes) + np.asarray(part.linear @ response)
        products += strain.T @ np.asarray(part.stiffness @ strain)
    scale = np.where(first == second, 1.0, np.sqrt(2.0)) / (frequency[first] * frequency[second])
    values, vectors = np.linalg.eigh(scale[:, None] * (0.5 * (products + products.T)) * scale)
    kept = np.flatnonzero(values > _KEPT * values.max(initial=0.0))[::-1]
    return symmetric((vectors[:, kept] / scale[:, None] * np.sqrt(values[kept])).T, shapes.shape[1])
