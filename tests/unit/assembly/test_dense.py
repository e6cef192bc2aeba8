"""Dense linear algebra against SciPy's."""

import numpy as np
import pytest
import scipy

from orchestrator.assembly.dense import generalized_modes, null_space


@pytest.mark.parametrize("shape", [(1, 4), (3, 5), (5, 3), (4, 4), (0, 3)])
def test_null_space(shape):
    matrix = np.random.default_rng(1).normal(size=shape)
    if min(shape) > 2:
        matrix[0] = matrix[1] + matrix[2]
    found, expected = null_space(matrix), scipy.linalg.null_space(matrix)
    assert found.shape == expected.shape
    assert found @ found.T == pytest.approx(expected @ expected.T, abs=1e-12)


def test_generalized_modes():
    """Eigenvalues over twelve decades, as stiff joints give them."""
    random = np.random.default_rng(2)
    a, b = (one @ one.T for one in random.normal(size=(2, 8, 8)) * np.logspace(0, 3, 8)[:, None])
    values, vectors = generalized_modes(a, b)
    expected = scipy.linalg.eigh(a, b, eigvals_only=True)
    assert values == pytest.approx(expected, rel=1e-7, abs=1e-13 * expected[-1])
    assert vectors.T @ b @ vectors == pytest.approx(np.eye(8), abs=1e-9)
    with pytest.raises(np.linalg.LinAlgError):
        generalized_modes(a, -b)
