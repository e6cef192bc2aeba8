"""Prediction of wrenches and their curvature over a step, in C, for polynomials."""

import numpy as np
import pytest

from tests.references.coupled_step import Step, bend
from tests.references.coupling_parts import call

COEFFICIENTS = np.random.default_rng(1).normal(size=(6, 5))
SIZES = (0.1, 0.3, 0.2, 0.25)
H = SIZES[-1]


def polynomial(degree, time):
    """Six polynomials at a time, (6,)."""
    return COEFFICIENTS[:, : degree + 1] @ time ** np.arange(degree + 1)


def rate(degree, time):
    """Their derivatives."""
    powers = np.arange(1, degree + 1)
    return COEFFICIENTS[:, 1 : degree + 1] @ (powers * time ** (powers - 1.0))


def steps(degree, sizes=SIZES, order=2):
    """Sizes (s), and at the middle of each the polynomials, at order 4 with half of what they change by a rate."""
    sizes = np.array(sizes)
    middles = np.cumsum(sizes) - 0.5 * sizes
    rows = [polynomial(degree, middle) for middle in middles]
    if order == 4:
        slopes = [0.5 * h * rate(degree, t) for h, t in zip(sizes, middles, strict=True)]
        rows = [np.concatenate(pair) for pair in zip(rows, slopes, strict=True)]
    return sizes, np.array(rows)


def followed(sizes, wrenches):
    """Prediction of the last of some steps, how much it bends, and the growth of independent errors in that."""
    size = wrenches.shape[1]
    predicted, bends = np.zeros(size), np.zeros(size)
    gain = call("followed", size == 12, len(sizes), sizes, wrenches, predicted, bends)
    return predicted, bends, gain


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("points", [1, 2, 3])
def test_as_many_points_as_coefficients_are_exact(points, order):
    """Closed form: a polynomial of degree n - 1 goes through any n points; slopes are of the step's own size."""
    sizes, wrenches = steps(points - 1, SIZES[-points - 1 :], order)
    predicted, _, _ = followed(sizes, wrenches)
    np.testing.assert_allclose(predicted, wrenches[-1], rtol=1e-12, atol=1e-13)


def test_older_points_are_forgotten():
    """A jump before the last three steps leaves no trace."""
    sizes, wrenches = steps(2, (0.1, *SIZES))
    wrenches[0] = 1e9
    predicted, bends, _ = followed(sizes, wrenches)
    np.testing.assert_allclose(predicted, wrenches[-1], rtol=1e-12)
    np.testing.assert_allclose(bends, 2.0 * COEFFICIENTS[:, 2] * H**2, rtol=1e-10)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("points", [3, 4])
def test_bends_are_those_of_the_reference(points, order):
    """Independent path: any wrenches and slopes, by which bends are limited where there are four points.

    Friction has no slope: all of its bend is left.
    """
    rng = np.random.default_rng(2)
    for _ in range(20):
        sizes, wrenches = rng.uniform(0.05, 0.3, points), rng.normal(size=(points, 3 * order))
        wrenches[:, 6:8] = 0.0
        made = [
            Step(end, h, row, {}, {}) for end, h, row in zip(np.cumsum(sizes), sizes, wrenches, strict=True)
        ]
        _, bends, _ = followed(sizes, wrenches)
        np.testing.assert_allclose(bends[:6], bend(made, 1).ravel(), rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(bends[6:], 0.0)


def test_what_changes_sign_with_every_step_does_not_bend():
    """Closed form: u = +-1 has second differences of +-4, whose mean over two steps is zero.

    Of (1, -1, -1, 1) / 2, which that mean is, the length is 1.
    """
    _, bends, gain = followed(np.full(4, 0.1), np.outer((1.0, -1.0, 1.0, -1.0), np.ones(6)))
    np.testing.assert_allclose(bends, 0.0, atol=1e-14)
    assert gain == pytest.approx(1.0, rel=1e-12)


def test_too_few_points_give_nothing():
    """What was accepted last, nothing here, predicts the first step; two steps before tell how a third bends."""
    predicted, _, gain = followed(*steps(2, SIZES[:1]))
    np.testing.assert_array_equal(predicted, 0.0)
    assert np.isnan(gain)
    assert np.isnan(followed(*steps(2, SIZES[:2]))[2])
    assert np.isfinite(followed(*steps(2, SIZES[:3]))[2])
