"""Linear equations of a chain of nodes with six unknowns each, of which only neighbours know each other."""

from __future__ import annotations

import numpy as np
import scipy

from ..contract.component import Vector

_BAND = 11
_ROWS = 3 * _BAND + 1


class Factors:
    """A matrix of blocks of nodes (n, 6, 6) and of pairs of neighbours (n - 1, 12, 12), added up and factorised.

    Where it is singular or not finite, solutions are not finite.
    """

    def __init__(self, nodes: Vector, pairs: Vector) -> None:
        band = np.zeros((_ROWS, 6 * len(nodes)))
        for blocks in (nodes, pairs):
            size = blocks.shape[1]
            first = 6 * np.arange(len(blocks))[:, None, None]
            row, column = np.indices((size, size))
            np.add.at(band, (2 * _BAND + row - column + 0 * first, first + column), blocks)
        self._factors, self._pivots, self._flaw = scipy.linalg.lapack.dgbtrf(band, _BAND, _BAND)

    def solve(self, right: Vector) -> Vector:
        """The solution (n, 6) for a right side (n, 6)."""
        if self._flaw:
            return np.full(right.shape, np.nan)
        found, _ = scipy.linalg.lapack.dgbtrs(self._factors, _BAND, _BAND, right.ravel(), self._pivots)
        result: Vector = found.reshape(right.shape)
        return result
