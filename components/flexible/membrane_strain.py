"""Strain along the axes of beams and in the mid-planes of plates, to second order in the displacement.

A slope shortens what it turns: beams stretch by u' + (v'^2 + w'^2) / 2, plates by (u,x + w,x^2 / 2,
v,y + w,y^2 / 2, u,y + v,x + w,x w,y) (Timoshenko and Woinowsky-Krieger, section 95).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import Vector

SparseMatrix: TypeAlias = "scipy.sparse.csr_array[np.float64, tuple[int, int]]"

_ALL = slice(None)


@dataclass(frozen=True)
class MembraneStrain:
    """Strains e = E q + 1/2 sum (L q) (R q) of displacements q (n,); P rows, of integration points and components."""

    linear: SparseMatrix
    """(P, n) E"""
    slopes: tuple[tuple[SparseMatrix, SparseMatrix], ...]
    """pairs L, R (P, n) of slopes, whose products are summed"""
    stiffness: SparseMatrix
    """(P, P) stiffness in tension times the weight of integration: e^T D e / 2 is the energy, J"""

    def reduced(self, reduce: Callable[[SparseMatrix], SparseMatrix]) -> MembraneStrain:
        """The same of other degrees of freedom."""
        slopes = tuple((reduce(left), reduce(right)) for left, right in self.slopes)
        return MembraneStrain(reduce(self.linear), slopes, self.stiffness)

    def parts(self, most: int) -> Iterator[MembraneStrain]:
        """The same in parts of about so many rows, whose strains do no work on one another's stress."""
        count, label = scipy.sparse.csgraph.connected_components(self.stiffness, directed=False)
        rows = np.argsort(label, kind="stable")
        ends = np.cumsum(np.bincount(label, minlength=count))
        first = 0
        while first < rows.size:
            last = int(ends[min(int(np.searchsorted(ends, first + most)), count - 1)])
            chosen = rows[first:last]
            slopes = tuple((left[chosen], right[chosen]) for left, right in self.slopes)
            yield MembraneStrain(self.linear[chosen], slopes, self.stiffness[chosen][:, chosen])
            first = last

    def of_pairs(self, shapes: Vector, some: slice = _ALL) -> Vector:
        """Strains (P, S (S + 1) / 2) that every two of shapes (n, S) make, in the order of `pairs`, or some of them."""
        first, second = (index[some] for index in pairs(shapes.shape[1]))
        total = np.zeros((first.size, self.linear.shape[0]))
        for left, right in self.slopes:
            # a shape's slopes together, as rows of memory are much faster to gather than columns
            one, other = (np.ascontiguousarray((side @ shapes).T) for side in (left, right))
            total += 0.5 * (one[first] * other[second] + one[second] * other[first])
        return total.T


def pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices j <= k of all pairs of so many shapes."""
    return np.triu_indices(count)


def combined(strains: Sequence[MembraneStrain]) -> MembraneStrain:
    """The strains of several structures on the same degrees of freedom, one behind the other."""
    most = max(len(one.slopes) for one in strains)
    columns = []
    for term in range(most):
        sides = [one.slopes[term] if term < len(one.slopes) else _none(one) for one in strains]
        columns.append((_stacked([left for left, _ in sides]), _stacked([right for _, right in sides])))
    stiffness = scipy.sparse.csr_array(scipy.sparse.block_diag([one.stiffness for one in strains]))
    return MembraneStrain(_stacked([one.linear for one in strains]), tuple(columns), stiffness)


def _none(strain: MembraneStrain) -> tuple[SparseMatrix, SparseMatrix]:
    empty = scipy.sparse.csr_array(strain.linear.shape)
    return empty, empty


def _stacked(parts: Sequence[SparseMatrix]) -> SparseMatrix:
    return scipy.sparse.csr_array(scipy.sparse.vstack(list(parts)))
