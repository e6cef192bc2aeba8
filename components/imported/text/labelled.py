"""Matrices as lists of entries: by row and column, or by node and component, whole or one triangle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ...contract.component import ComponentError, Vector
from ...flexible.finite_elements import SparseMatrix
from ..data import Integers

_EMPTY = 100
"""Rows to an entry, beyond which a number of a row is damaged; matrices would not fit into memory."""


@dataclass(frozen=True)
class Entries:
    """Entries by row and column, which count from 0."""

    file: str
    rows: Integers
    """(k,)"""
    columns: Integers
    """(k,)"""
    values: Vector
    """(k,)"""

    @property
    def count(self) -> int:
        """How many rows there are at least."""
        return int(max(self.rows.max(), self.columns.max())) + 1

    def matrix(self, count: int) -> SparseMatrix:
        """(count, count) with both triangles; ComponentError where it has more rows."""
        if self.count > count:
            raise ComponentError(f"{self.file}: an entry is in row or column {self.count} of {count}")
        if count > _EMPTY * len(self.values):
            raise ComponentError(
                f"{self.file}: an entry is in row or column {count}, and there are {len(self.values)}"
            )
        if min(self.rows.min(), self.columns.min()) < 0:
            raise ComponentError(f"{self.file}: rows and columns count from 1")
        return whole(scipy.sparse.csr_array((self.values, (self.rows, self.columns)), shape=(count, count)))


@dataclass(frozen=True)
class LabelledMatrix:
    """A square matrix with the node and the component of every row."""

    file: str
    dofs: Integers
    """(n, 2), see `FiniteElementData`"""
    matrix: SparseMatrix
    """(n, n)"""

    def on(self, dofs: Integers) -> SparseMatrix:
        """The matrix on other degrees of freedom (m, 2), zero where it has none of them."""
        places = {(int(node), int(component)): k for k, (node, component) in enumerate(dofs)}
        try:
            rows = np.array(
                [places[int(node), int(component)] for node, component in self.dofs], dtype=np.int64
            )
        except KeyError as error:
            node, component = error.args[0]
            raise ComponentError(
                f"{self.file}: node {node} component {component} is not in the stiffness matrix; are both of one model?"
            ) from None
        own = scipy.sparse.coo_array(self.matrix)
        return scipy.sparse.csr_array(
            (own.data, (rows[own.row], rows[own.col])), shape=(len(dofs), len(dofs))
        )


def whole(matrix: SparseMatrix) -> SparseMatrix:
    """The matrix itself, or with the other triangle where it has each of its entries once, in whatever order."""
    found = matrix.copy()
    found.eliminate_zeros()
    beside = found - scipy.sparse.diags_array(found.diagonal(), format="csr")
    beside.eliminate_zeros()
    if beside.multiply(beside.T).nnz:
        return found
    return scipy.sparse.csr_array(found + beside.T)


def labelled(file: str, rows: Integers, columns: Integers, values: Vector) -> LabelledMatrix:
    """A matrix of entries whose rows and columns (k, 2) are nodes and components."""
    dofs, places = np.unique(np.vstack([rows, columns]), axis=0, return_inverse=True)
    places = places.ravel()
    entries = Entries(file, places[: len(rows)], places[len(rows) :], values)
    return LabelledMatrix(file, dofs, entries.matrix(len(dofs)))
