"""Dense linear algebra on small matrices by NumPy alone, as SciPy takes its time to import."""

from __future__ import annotations

import numpy as np

from components.contract.component import Vector


def null_space(matrix: Vector) -> Vector:
    """Orthonormal basis (n, k) of the null space of a matrix (m, n), to round-off of its largest singular value."""
    _, sizes, rows = np.linalg.svd(matrix, full_matrices=True)
    tolerance = np.finfo(float).eps * max(matrix.shape) * sizes.max(initial=0.0)
    basis: Vector = rows[int((sizes > tolerance).sum()) :].T
    return basis


def generalized_modes(a: Vector, b: Vector) -> tuple[Vector, Vector]:
    """Eigenvalues (n,), rising, and vectors (n, n) of a v = lambda b v with v^T b v = 1, both symmetric.

    LinAlgError where b is not positive definite.
    """
    factor = np.linalg.cholesky(b)
    reduced = np.linalg.solve(factor, np.linalg.solve(factor, a).T)
    values, vectors = np.linalg.eigh(reduced)
    return values, np.linalg.solve(factor.T, vectors)
