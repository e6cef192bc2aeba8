"""Motions without mass, such as rotations of lumped masses: they get mass in proportion to stiffness.

M + K / w^2 has the modes of M, their frequencies f lower by the share (f / w)^2 / 2, and the same mass of rigid
motions, as K x = 0 there. At w of 1 MHz that is 5e-11 at 10 Hz and 5e-7 at 1 kHz.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import scipy

from .data import FiniteElementData

_FREQUENCY = 2.0 * pi * 1e6
"""rad/s"""
_MASSLESS = 1e-10
"""Of the largest, in a mass matrix whose diagonal is scaled to 1."""
_DENSE = 600
"""Degrees of freedom up to which eigenvalues are looked at."""


def with_mass_everywhere(data: FiniteElementData) -> FiniteElementData:
    """The data itself, or with mass for motions that had none."""
    diagonal = data.mass.diagonal()
    if diagonal.min() > 0.0 and _is_regular(data):
        return data
    added = data.stiffness * (1.0 / _FREQUENCY**2)
    return replace(data, mass=scipy.sparse.csr_array(data.mass + added))


def _is_regular(data: FiniteElementData) -> bool:
    """Whether all motions of a small model have mass; of large ones the reduced basis decides, which has."""
    if len(data.dofs) > _DENSE:
        return True
    scale = scipy.sparse.diags_array(1.0 / np.sqrt(data.mass.diagonal()))
    values = np.linalg.eigvalsh((scale @ data.mass @ scale).toarray())
    return bool(values[0] > _MASSLESS * values[-1])
