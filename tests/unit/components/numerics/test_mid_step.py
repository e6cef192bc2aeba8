"""Means over steps brought to the communication point: exact for what they can know."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from components.numerics.interval_mean import MidStep, MidStepSlope, StepMean, between, extrapolated
from components.numerics.scheme import INSTANT

SIZES = [(0.1, 0.1), (0.05, 0.2), (0.3, 0.01)]


def of_step(u, end, h, *, sloped=True):
    """Mean of a polynomial over a step and its slope, three times the mean of u P1."""
    first = Polynomial([-1.0 - 2.0 * (end - h) / h, 2.0 / h])
    mean, moment = ((f.integ()(end) - f.integ()(end - h)) / h for f in (u, u * first))
    return StepMean(mean, 3.0 * moment if sloped else 0.0, h)


@pytest.mark.parametrize(("h", "previous_h"), SIZES)
def test_parabola_with_slopes_is_exact(h, previous_h):
    """Closed form: mean and slope of two steps know a parabola, whatever their sizes."""
    u = Polynomial([1.0, -2.0, 3.0])
    found = extrapolated(of_step(u, 0.7, h), of_step(u, 0.7 - h, previous_h))
    assert found == pytest.approx(u(0.7), rel=1e-10)


@pytest.mark.parametrize(("h", "previous_h"), SIZES)
def test_line_without_slopes_is_exact(h, previous_h):
    """Closed form: the means of two steps know a line, and so do those of which slopes know one part only."""
    known, unknown = Polynomial([1.0, -2.0, 3.0]), Polynomial([0.5, 4.0])
    ends = ((0.7, h), (0.7 - h, previous_h))
    sums = [
        StepMean(a.mean + b.mean, a.slope, size)
        for (end, size), a, b in (
            (step, of_step(known, *step), of_step(unknown, *step, sloped=False)) for step in ends
        )
    ]
    assert extrapolated(*sums) == pytest.approx(known(0.7) + unknown(0.7), rel=1e-12)


def test_a_jump_before_a_short_step_leaves_no_more_than_its_share():
    """Property: behind a jump, and however fast a load fades, its own step tells it but for the share of its size."""
    h, previous_h, start, end = 2.7e-6, 4e-3, 1500.0, 1365.0
    last = StepMean(0.5 * (start + end), 0.5 * (end - start), h)
    found = extrapolated(last, StepMean(0.0, 0.0, previous_h))
    assert found == pytest.approx(end, abs=1.1 * start * h / previous_h)


@pytest.mark.parametrize("previous_h", [4e-12, 1e-9, 1e-3])
def test_a_jump_before_an_instant_is_all_that_its_load_shows(previous_h):
    """Rule: nothing moves in an instant, and a step before it, however short, belongs to what was before the jump."""
    assert extrapolated(StepMean(70.0, 0.0, INSTANT), StepMean(0.0, 0.0, previous_h)) == 70.0


@pytest.mark.parametrize(("h", "previous_h"), SIZES)
def test_cubic_between_two_steps_is_exact(h, previous_h):
    """Closed form: means and slopes on both sides of a point know a cubic, whatever the sizes of the steps."""
    u = Polynomial([1.0, -2.0, 3.0, -4.0])
    steps = of_step(u, 0.7, previous_h), of_step(u, 0.7 + h, h)
    assert between(*steps) == pytest.approx(u(0.7), rel=1e-10)
    last = MidStepSlope.starting(0.0).after(*steps[0]).after(*steps[1])
    assert last.before() == between(*steps)


def test_error_between_equal_steps_is_of_order_four():
    """Closed form: u = t^4 is missed by h^4 / 360 times its fourth derivative, 24."""
    u, h = Polynomial([0.0, 0.0, 0.0, 0.0, 1.0]), 0.1
    assert between(of_step(u, 0.0, h), of_step(u, h, h)) == pytest.approx(-24.0 * h**4 / 360.0, rel=1e-10)


def test_nothing_lies_between_fewer_than_two_steps():
    """Rule: zero until there are two."""
    one = MidStepSlope.starting(4.0).after(1.0, 0.5, 0.1)
    assert MidStepSlope.starting(4.0).before() == one.before() == 0.0


def test_a_first_step_has_its_own_slope_only():
    """After the start or an impulse the line of the one step is all there is."""
    before = StepMean(np.zeros(2), np.zeros(2), 0.0)
    found = extrapolated(StepMean(np.array((1.0, 2.0)), np.array((0.5, -0.5)), 0.1), before)
    np.testing.assert_array_equal(found, (1.5, 1.5))


def test_rate_of_a_line():
    """Closed form: mean rates of a motion that speeds up evenly."""
    rate = MidStep.starting(0.0).after(1.0, 0.2).after(1.75, 0.1)
    assert rate.now() == pytest.approx(2.0)


def test_load_of_a_resolved_motion_is_that_of_its_law():
    """Property: a smooth motion is recorded by its law, a rough one by the means of its load, a mixed one between."""
    load = MidStep.starting(0.0).after(1.0, 0.2).after(1.75, 0.1)
    assert load.load_now(3.0, 0.0) == 3.0
    assert load.load_now(3.0, 1e-4) == pytest.approx(3.0, rel=1e-4)
    assert load.load_now(3.0, 1e-2) == pytest.approx(2.5)
    assert load.load_now(3.0, 1.0) == pytest.approx(2.0, rel=1e-4)


def test_load_without_a_step_is_that_of_its_law():
    """Rule: before the first step, and where a load has just begun, there is no mean to go by."""
    assert MidStep.starting(0.0).load_now(3.0, 1.0) == 3.0
    assert MidStep.starting(0.0).after(2.0, 0.1).load_now(3.0, 1e6) == pytest.approx(2.0)


@pytest.mark.parametrize(("h", "previous_h"), SIZES)
def test_rate_with_slopes_at_communication_point(h, previous_h):
    """Closed form: two steps with slopes know a parabola; one knows a line; none the rate at the start."""
    u, line = Polynomial([1.0, -2.0, 3.0]), Polynomial([1.0, -2.0])
    start = MidStepSlope.starting(4.0)
    one = of_step(line, 0.7, h)
    assert start.now() == 4.0
    assert start.after(*one).now() == pytest.approx(line(0.7))
    both = start.after(*of_step(u, 0.7 - h, previous_h)).after(*of_step(u, 0.7, h))
    assert both.now() == pytest.approx(u(0.7), rel=1e-10)
