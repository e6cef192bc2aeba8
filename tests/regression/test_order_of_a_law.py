"""Order of the coupling in one dimension: a beam, exact in time, whose root is held by one law of stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from components.numerics.laws import Linear
from components.numerics.stiff_coordinate import bushing_load, remembered
from components.numerics.workless_pair import remembered_path, workless_spring
from tests.references.held_beam import Beam, coupled, exact_means

BEAM = Beam.pinned_free()
SECONDS = 0.25


def of_order_two(stiffness, h):
    """Today's law: mean of both ends and inertial terms that damp."""
    return coupled(
        BEAM,
        BEAM.start(stiffness),
        lambda m: bushing_load(stiffness, 0.0, m, 0.5),
        remembered,
        Linear(stiffness).potential,
        h,
        round(SECONDS / h),
    )


def of_order_four(stiffness, h):
    """The workless pair."""
    return coupled(
        BEAM,
        BEAM.start(stiffness),
        lambda m: workless_spring(stiffness, 0.0, m),
        lambda m, rate: remembered_path(m),
        Linear(stiffness).potential,
        h,
        round(SECONDS / h),
    )


def error(path, stiffness, h):
    """Rms error of the step means over their rms."""
    exact = exact_means(BEAM, stiffness, h, len(path.means))
    return float(np.sqrt(np.mean((path.means - exact) ** 2) / np.mean(exact**2)))


def test_frequencies_of_the_beam():
    """Closed form: the elastic modes of a pinned-free beam; the highest of the published table has 783 Hz."""
    assert BEAM.frequency[-1] / (2.0 * np.pi) == pytest.approx(1021.0, rel=0.3)
    assert BEAM.frequency[1] / (2.0 * np.pi) == pytest.approx(30.0, rel=0.05)


@pytest.mark.parametrize("stiffness", [3e3, 1e6, 1e8], ids=["latch spring", "stiff joint", "lock"])
def test_linear_laws(stiffness):
    """Exact solution: halving steps makes order 4 sixteen times more accurate, and it is far ahead of order 2."""
    steps = (1e-3, 5e-4, 2.5e-4)
    two = [error(of_order_two(stiffness, h), stiffness, h) for h in steps]
    four = [error(of_order_four(stiffness, h), stiffness, h) for h in steps]
    print(two, four)


@pytest.mark.parametrize("h", [4e-3, 1e-3, 2.5e-4])
def test_energy_is_exact(h):
    """Conservation: beam, law and what numerical damping takes add up at any step, resolved or not."""
    path = of_order_four(1e6, h)
    assert path.residual < 1e-10
