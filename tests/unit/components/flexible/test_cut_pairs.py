"""A count of modes that parts two of one frequency: the body is the same each time, so that its stresses are found."""

import numpy as np
import pytest

from components.catalogue.reader import read_body
from components.flexible import reduction
from components.flexible.reduction import fixed_interface_frequencies, orthonormal_modes

SQUARE = {
    "length": 1.0,
    "width": 1.0,
    "areal_mass": 3.0,
    "sandwich": {"skin": 2e-4, "core": 0.02, "youngs_modulus": 7e10, "poisson_ratio": 0.3},
    "inserts": [{"name": "hub", "x": 0.5, "y": 0.0, "rectangles": [{"x": [0.4, 0.6], "y": [-0.1, 0.1]}]}],
    "element_size": 0.1,
}
POINTS = ("hub",)


def test_half_of_a_pair_is_always_the_same_half(monkeypatch):
    """Regression: a solver that begins elsewhere gave another half, and stresses were refused as another body's."""
    model = read_body({"panel": SQUARE}, lambda value, unit, sign: value).finite_elements(())
    frequency = fixed_interface_frequencies(model, POINTS, 8)
    count = 1 + int(np.argmin(np.diff(frequency) / frequency[1:]))
    assert frequency[count] == pytest.approx(frequency[count - 1], rel=1e-8)
    _, first = orthonormal_modes(model, POINTS, count)
    started = np.random.default_rng
    monkeypatch.setattr(
        reduction.np.random, "default_rng", lambda seed=None: started(11 if seed == 1 else seed)
    )
    _, second = orthonormal_modes(model, POINTS, count)
    largest = np.abs(first).max()
    assert first.shape[1] == count
    np.testing.assert_allclose(second, first, atol=1e-7 * largest)
