"""Extrapolation over the last steps: exact for polynomials, and only as far back as it may look."""

import numpy as np
import pytest

from orchestrator.cosim.implicit.history import History

SLOPES = np.array([[1.0, -2.0, 0.5], [0.3, 4.0, -7.0]])
TIMES = (0.1, 0.25, 0.3)


def polynomial(degree, time):
    """Two polynomials at a time, (2,)."""
    return SLOPES[:, : degree + 1] @ time ** np.arange(degree + 1)


def filled(degree, times=TIMES):
    history = History(2)
    for time in times:
        history.add(time, polynomial(degree, time))
    return history


@pytest.mark.parametrize("points", [1, 2, 3])
def test_as_many_points_as_coefficients_are_exact(points):
    """Closed form: a polynomial of degree n - 1 goes through any n points."""
    history = filled(points - 1, TIMES[-points:])
    np.testing.assert_allclose(history.extrapolated(0.42), polynomial(points - 1, 0.42), rtol=1e-13)


def test_older_points_are_forgotten():
    """A jump before the last three steps leaves no trace."""
    history = History(2)
    history.add(0.0, np.full(2, 1e9))
    for time in TIMES:
        history.add(time, polynomial(2, time))
    np.testing.assert_allclose(history.extrapolated(0.42), polynomial(2, 0.42), rtol=1e-13)


def test_curvature_of_a_parabola():
    """Closed form: h^2 u'' of u = a + b t + c t^2 is 2 c h^2, whatever the spacing."""
    bend = filled(2).curvature(0.42, polynomial(2, 0.42), 0.2)
    np.testing.assert_allclose(bend.change, 2.0 * SLOPES[:, 2] * 0.2**2, rtol=1e-12)


def test_what_changes_sign_with_every_step_does_not_bend():
    """Closed form: u = +-1 has second differences of +-4, whose mean over two steps is zero."""
    history = History(1)
    for k in range(3):
        history.add(0.1 * k, np.array([(-1.0) ** k]))
    bend = history.curvature(0.3, np.array([-1.0]), 0.1)
    np.testing.assert_allclose(bend.change, 0.0, atol=1e-14)


def test_gain_is_that_of_independent_errors():
    """Closed form: at even steps the mean of (1, -2, 1, 0) and (0, 1, -2, 1) is (1, -1, -1, 1) / 2, of length 1."""
    history = History(1)
    for k in range(3):
        history.add(0.1 * k, np.zeros(1))
    assert history.curvature(0.3, np.zeros(1), 0.1).gain == pytest.approx(1.0, rel=1e-12)


def test_too_few_points_give_nothing():
    history = History(2)
    assert history.extrapolated(0.1) is None
    history.add(0.1, np.ones(2))
    assert history.curvature(0.2, np.ones(2), 0.1) is None
    history.add(0.2, np.ones(2))
    history.clear()
    assert history.extrapolated(0.3) is None
