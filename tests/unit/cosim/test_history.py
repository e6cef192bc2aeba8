"""Extrapolation over the last steps: exact for polynomials, and only as far back as it may look."""

import numpy as np
import pytest
from orchestrator.cosim.implicit.history import History

from orchestrator.cosim.ports import WIDTHS

COEFFICIENTS = np.random.default_rng(1).normal(size=(6, 5))
TIMES = (0.1, 0.25, 0.3)
EVEN = (0.0, 0.1, 0.2)


def polynomial(degree, time):
    """Six polynomials at a time, (6,)."""
    return COEFFICIENTS[:, : degree + 1] @ time ** np.arange(degree + 1)


def rate(degree, time):
    """Their derivatives."""
    powers = np.arange(1, degree + 1)
    return COEFFICIENTS[:, 1 : degree + 1] @ (powers * time ** (powers - 1.0))


def with_slope(degree, time, h):
    """The polynomials and half of what they would change over a step h at their present rates, (12,)."""
    return np.concatenate((polynomial(degree, time), 0.5 * h * rate(degree, time)))


def filled(degree, times=TIMES):
    history = History(1, WIDTHS[2])
    for time in times:
        history.add(time, polynomial(degree, time), 0.1)
    return history


def filled_with_slopes(degree, times=TIMES):
    """Steps of three sizes."""
    history = History(1, WIDTHS[4])
    for time, h in zip(times, (0.1, 0.3, 0.2), strict=True):
        history.add(time, with_slope(degree, time, h), h)
    return history


@pytest.mark.parametrize("points", [1, 2, 3])
def test_as_many_points_as_coefficients_are_exact(points):
    """Closed form: a polynomial of degree n - 1 goes through any n points."""
    history = filled(points - 1, TIMES[-points:])
    np.testing.assert_allclose(history.extrapolated(0.42, 0.1), polynomial(points - 1, 0.42), rtol=1e-13)


def test_slopes_follow_the_size_of_the_step():
    """Closed form: slopes are half the change over a step, whatever its size was."""
    history = filled_with_slopes(2)
    np.testing.assert_allclose(history.extrapolated(0.42, 0.05), with_slope(2, 0.42, 0.05), rtol=1e-12)


def test_older_points_are_forgotten():
    """A jump before the last three steps leaves no trace."""
    history = History(1, WIDTHS[2])
    history.add(0.0, np.full(6, 1e9), 0.1)
    for time in TIMES:
        history.add(time, polynomial(2, time), 0.1)
    np.testing.assert_allclose(history.extrapolated(0.42, 0.1), polynomial(2, 0.42), rtol=1e-13)


def test_curvature_of_a_parabola():
    """Closed form: h^2 u'' of u = a + b t + c t^2 is 2 c h^2, whatever the spacing."""
    bend = filled(2).curvature(0.42, polynomial(2, 0.42), 0.2)
    np.testing.assert_allclose(bend.change, 2.0 * COEFFICIENTS[:, 2] * 0.2**2, rtol=1e-12)


def test_what_changes_sign_with_every_step_does_not_bend():
    """Closed form: u = +-1 has second differences of +-4, whose mean over two steps is zero."""
    history = History(1, WIDTHS[2])
    for k in range(3):
        history.add(0.1 * k, np.full(6, (-1.0) ** k), 0.1)
    bend = history.curvature(0.3, np.full(6, -1.0), 0.1)
    np.testing.assert_allclose(bend.change, 0.0, atol=1e-14)


def test_gain_is_that_of_independent_errors():
    """Closed form: at even steps the mean of (1, -2, 1, 0) and (0, 1, -2, 1) is (1, -1, -1, 1) / 2, of length 1."""
    history = History(1, WIDTHS[2])
    for k in range(3):
        history.add(0.1 * k, np.zeros(6), 0.1)
    assert history.curvature(0.3, np.zeros(6), 0.1).gain == pytest.approx(1.0, rel=1e-12)


def test_right_slopes_leave_nothing_of_a_cubic():
    """Closed form: a fourth divided difference of a cubic vanishes, whatever the spacing."""
    bend = filled_with_slopes(3).curvature(0.42, with_slope(3, 0.42, 0.2), 0.2)
    np.testing.assert_allclose(bend.change, 0.0, atol=1e-11)


def test_right_slopes_leave_the_fourth_derivative():
    """Closed form: -h^4 u/12, u = 24 c, at even steps; or a twelfth of the third difference where that is less."""
    history = History(1, WIDTHS[4])
    for time in EVEN:
        history.add(time, with_slope(4, time, 0.1), 0.1)
    bend = history.curvature(0.3, with_slope(4, 0.3, 0.1), 0.1)
    fourth = -2.0 * COEFFICIENTS[:, 4] * 0.1**4
    third = np.diff([polynomial(4, time) for time in (*EVEN, 0.3)], 3, axis=0)[0] / 12.0
    less = np.where(np.abs(third) < np.abs(fourth), third, fourth)
    np.testing.assert_allclose(bend.change[:6], less, rtol=1e-9)
    assert np.count_nonzero(less == fourth) == 5
    np.testing.assert_array_equal(bend.change[6:], 0.0)


def test_slopes_of_unresolved_joints_do_not_bend():
    """Closed form: of a cubic with slopes of any size a twelfth of its third difference is left, h^3 c / 2."""
    history = History(1, WIDTHS[4])
    for k, time in enumerate(EVEN):
        history.add(time, np.concatenate((polynomial(3, time), np.full(6, 50.0 * k * k))), 0.1)
    bend = history.curvature(0.3, np.concatenate((polynomial(3, 0.3), np.full(6, 450.0))), 0.1)
    np.testing.assert_allclose(bend.change[:6], 0.5 * COEFFICIENTS[:, 3] * 0.1**3, rtol=1e-9)


def test_without_slopes_all_of_the_bend_is_left():
    """Friction has no slope: at even steps what is left is h^2 u'', as at order 2."""
    history = History(1, WIDTHS[4])
    for time in EVEN:
        history.add(time, np.concatenate((polynomial(2, time), np.zeros(6))), 0.1)
    bend = history.curvature(0.3, np.concatenate((polynomial(2, 0.3), np.zeros(6))), 0.1)
    np.testing.assert_allclose(bend.change[:6], 2.0 * COEFFICIENTS[:, 2] * 0.1**2, rtol=1e-9)


def test_too_few_points_give_nothing():
    history = History(1, WIDTHS[2])
    assert history.extrapolated(0.1, 0.1) is None
    history.add(0.1, np.ones(6), 0.1)
    assert history.curvature(0.2, np.ones(6), 0.1) is None
    history.add(0.2, np.ones(6), 0.1)
    history.clear()
    assert history.extrapolated(0.3, 0.1) is None
