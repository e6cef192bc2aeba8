"""Monotone cubics against those of SciPy, and a table of forces against its integral."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from components.numerics.laws import Table
from components.numerics.monotone_cubic import monotone_cubics


@pytest.mark.parametrize("count", [2, 3, 4, 40])
@pytest.mark.parametrize("seed", range(5))
def test_coefficients_are_those_of_scipy(count, seed):
    """Values of both signs, some of which repeat."""
    random = np.random.default_rng(seed)
    x = np.cumsum(random.uniform(0.1, 2.0, count))
    y = np.round(random.normal(size=count), seed)
    assert monotone_cubics(x, y) == pytest.approx(PchipInterpolator(x, y).c, rel=1e-12, abs=1e-13)


def test_the_potential_of_a_table_is_the_integral_of_its_force():
    table = Table([-1.0, 0.0, 0.5, 2.0], [0.4, 0.1, 0.3, -0.2])
    for end in (-3.0, -0.3, 1.2, 5.0):
        work = quad(table.value, -3.5, end, points=[-1.0, 0.0, 0.5, 2.0], epsabs=1e-12)[0]
        assert table.potential(-3.5) - table.potential(end) == pytest.approx(work, abs=1e-10)
