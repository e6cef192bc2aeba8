"""Motions with neither stiffness nor mass, as elements of reduced integration have (hourglass modes): weak springs.

Springs along the lines between nodes that meet cost no energy in rigid motions. Their stiffness of 1e-8 of that of the
nodes changes frequencies by about as little, and makes the matrices regular.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from ..flexible.finite_elements import factorize
from .data import FiniteElementData

_WEAK = 1e-8
"""Of the stiffness of a node."""
_NONE = 1e-12
"""Eigenvalue below which a motion has no energy: matrices have 14 digits, and other motions far more."""
_HALF = 0.5
"""Growth in an inverse iteration, over that without energy."""
_ITERATIONS = 3
"""The first leaves less than 1e-9 of motions with energy."""


def with_stiffness_everywhere(data: FiniteElementData) -> FiniteElementData:
    """The data itself, or with weak springs where some motion has neither stiffness nor mass."""
    if not _has_motion_without_energy(data):
        return data
    nodes = [own for node in data.nodes.tolist() if {1, 2, 3} <= (own := data.dofs_of(node)).keys()]
    rows = np.array([[own[k] for k in (1, 2, 3)] for own in nodes])
    places = np.array([data.position(int(node)) for node in data.dofs[rows[:, 0], 0]])
    touched = scipy.sparse.csr_array(
        (np.ones(rows.size), (np.repeat(np.arange(len(rows)), 3), rows.ravel())), (len(rows), len(data.dofs))
    )
    one, other = scipy.sparse.triu(touched @ abs(data.stiffness) @ touched.T, 1, "coo").coords
    line = places[other] - places[one]
    length = np.linalg.norm(line, axis=1)
    kept = length > 0.0
    one, other, line = one[kept], other[kept], line[kept] / length[kept, None]
    size = np.asarray(data.stiffness.diagonal())[rows].mean(axis=1)
    spring = np.repeat(np.arange(len(one)), 6)
    stretch = scipy.sparse.csr_array(
        (np.hstack([-line, line]).ravel(), (spring, np.hstack([rows[one], rows[other]]).ravel())),
        (len(one), len(data.dofs)),
    )
    weak = scipy.sparse.diags_array(_WEAK * np.minimum(size[one], size[other]))
    return replace(data, stiffness=scipy.sparse.csr_array(data.stiffness + stretch.T @ weak @ stretch))


def _has_motion_without_energy(data: FiniteElementData) -> bool:
    """Whether K + t M is singular, by inverse iteration of that matrix scaled to a diagonal of 1."""
    ratio = data.stiffness.diagonal().sum() / data.mass.diagonal().sum()
    both = data.stiffness + ratio * data.mass
    if both.diagonal().min() <= 0.0:
        return False  # the agreement check says which
    scale = scipy.sparse.diags_array(1.0 / np.sqrt(both.diagonal()))
    shift = _NONE * scipy.sparse.eye_array(len(data.dofs))
    factor = factorize(scipy.sparse.csr_array(scale @ both @ scale + shift))
    motion, growth = np.random.default_rng(0).standard_normal(len(data.dofs)), 0.0
    for _ in range(_ITERATIONS):
        motion = factor.solve(motion / np.linalg.norm(motion))
        growth = float(np.linalg.norm(motion))
    return growth * _NONE > _HALF
