"""Scalar laws against their potentials, and friction factors against their definition."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.contract.component import ComponentError
from components.numerics.laws import Linear, SlackSpring, Table, mean_force, stiction_factors

DEGREE = np.pi / 180
SPLINE = (
    np.array([-8, -4, -2, -1, -0.5, -0.2, -0.05, 0, 0.05, 0.2, 0.5, 1, 2, 4, 8]) * DEGREE,
    [408.6, 203.4, 100.8, 49.5, 24, 7, 1, 0, -1, -7, -24, -49.5, -100.8, -203.4, -408.6],
)
LAWS = {
    "linear": Linear(3.0, 0.4),
    "strand": SlackSpring(5000.0, 40.0),
    "soft": Table((-1.0, 0.2, 0.5, 2.0), (4.0, 1.0, 0.9, -3.0)),
    "latch": Table(*SPLINE),
}
SPAN = {"linear": 5.0, "strand": 0.05, "soft": 5.0, "latch": 12 * DEGREE}
STEEPEST = {"linear": 3.0, "strand": 5000.0, "soft": 6.0, "latch": 100 / DEGREE}
NAMES = st.sampled_from(sorted(LAWS))
PLACE = st.floats(-1.0, 1.0)


@given(NAMES, PLACE)
def test_value_is_minus_the_slope_of_the_potential(name, place):
    """Definition of a potential, by central differences: second order where the law is smooth, first at a kink.

    The force differs over the interval by at most stiffness x interval; round-off of V adds eps V / interval.
    """
    law, s = LAWS[name], place * SPAN[name]
    d = 1e-6 * SPAN[name]
    slope = (law.potential(s + d) - law.potential(s - d)) / (2 * d)
    size = abs(law.potential(s)) + abs(law.value(s)) * d + 1e-3 * STEEPEST[name] * SPAN[name] ** 2
    assert law.value(s) == pytest.approx(-slope, abs=STEEPEST[name] * d + 4e-16 * size / d)


@given(NAMES, PLACE, PLACE)
def test_mean_force_does_the_work_of_the_potential(name, start, end):
    """Discrete gradient: force times change is the change of potential, whatever the step.

    Below 1e-5 the mid-point value takes over, whose work errs by at most a quarter of the steepest slope
    times the square of the change.
    """
    law, s0, s1 = LAWS[name], start * SPAN[name], end * SPAN[name]
    work = mean_force(law, s0, s1) * (s1 - s0)
    drop = law.potential(s0) - law.potential(s1)
    scale = abs(law.potential(s0)) + abs(law.potential(s1))
    small = 0.25 * STEEPEST[name] * (s1 - s0) ** 2 if abs(s1 - s0) <= 1e-5 else 0.0
    assert work == pytest.approx(drop, abs=1e-15 + 4e-16 * scale + small)


@given(NAMES, PLACE)
def test_mean_force_tends_to_the_value(name, place):
    """Limit of the discrete gradient on both sides of its switch at 1e-5: within the steepest slope times the step."""
    law, s = LAWS[name], place * SPAN[name]
    for change in (0.0, 0.9e-5, 1.1e-5):
        size = abs(law.potential(s)) + abs(law.value(s)) * change
        assert mean_force(law, s, s + change) == pytest.approx(
            law.value(s), abs=STEEPEST[name] * change + 4e-16 * size / 1.1e-5 + 1e-12
        )


def test_mean_of_a_spring_is_the_spring_of_the_middle():
    """Closed form -k (s0 + s1)/2 of a linear spring."""
    assert mean_force(LAWS["linear"], 1.0, 2.0) == pytest.approx(-3.0 * (1.5 - 0.4), rel=1e-14)


@given(st.floats(-0.1, 0.1))
def test_strand_never_pushes(elongation):
    """Law of a cable: preload plus k s while taut, exactly nothing while slack."""
    strand = SlackSpring(5000.0, 40.0)
    tension = -strand.value(elongation)
    assert tension == (pytest.approx(max(0.0, 40.0 + 5000.0 * elongation), abs=1e-12))
    assert tension >= 0.0
    assert strand.potential(elongation) >= 0.0


def test_strand_going_slack_within_a_step():
    """Closed form: all energy of the preload, F^2 / 2k = 0.16 J, over the way."""
    strand = SlackSpring(5000.0, 40.0)
    assert mean_force(strand, 0.0, -0.1) * -0.1 == pytest.approx(0.16, rel=1e-12)


def test_table_meets_its_points_and_does_not_overshoot():
    """Definition: interpolating, monotone between points, straight with the end slope beyond."""
    table = LAWS["soft"]
    for s, f in zip((-1.0, 0.2, 0.5, 2.0), (4.0, 1.0, 0.9, -3.0), strict=True):
        assert table.value(s) == pytest.approx(f, abs=1e-14)
    inside = [table.value(s) for s in np.linspace(-1.0, 2.0, 301)]
    assert np.all(np.diff(inside) <= 1e-14)
    for edge, sign in ((-1.0, -1.0), (2.0, 1.0)):
        slope = (table.value(edge + sign) - table.value(edge)) / sign
        assert table.value(edge + 3.7 * sign) == pytest.approx(table.value(edge) + 3.7 * sign * slope)
        assert (table.value(edge + sign * 1e-6) - table.value(edge - sign * 1e-6)) / (
            2e-6 * sign
        ) == pytest.approx(slope, abs=1e-4)


def test_table_of_two_points_is_a_line_everywhere():
    """Closed form: straight line of slope -2 through (0, 3), and its potential."""
    line = Table((0.0, 1.0), (3.0, 1.0))
    for s in (-7.0, -1e-9, 0.4, 1.0, 9.0):
        assert line.value(s) == pytest.approx(3.0 - 2.0 * s, abs=1e-13)
        assert line.potential(s) - line.potential(0.0) == pytest.approx(s * s - 3.0 * s, abs=1e-12)


@pytest.mark.parametrize(
    ("places", "forces", "words"),
    [
        ((0.0,), (1.0,), "two points"),
        ((0.0, 1.0), (1.0,), "two points"),
        ((1.0, 0.0), (1.0, 2.0), "increase"),
    ],
)
def test_impossible_tables_are_refused(places, forces, words):
    """A sentence says what is wrong."""
    with pytest.raises(ComponentError, match=words):
        Table(places, forces)


@given(st.floats(-5.0, 5.0), st.floats(1.0, 2.0), st.floats(1e-4, 1.0))
def test_friction_is_odd_continuous_and_dissipative(ratio, static, transition):
    """Law: odd in the rate, never along it, at most static, and Lipschitz (3 per transition while rising)."""
    rate = ratio * transition
    both = stiction_factors(rate, transition, static)
    opposite = stiction_factors(-rate, transition, static)
    assert [a + b for a, b in zip(both, opposite, strict=True)] == [0.0, 0.0] or rate == 0.0
    assert all(f * rate >= 0.0 for f in both)
    assert abs(both[0]) <= static * (1 + 1e-15)
    assert abs(both[1]) <= 1.0
    step = 1e-7 * transition
    near = stiction_factors(rate + step, transition, static)
    assert all(abs(b - a) <= 3.2e-7 * static + 1e-15 for a, b in zip(both, near, strict=True))


def test_friction_factors_at_their_knots():
    """Published law: static at the transition, dynamic from 1.5 times it, nothing at rest."""
    assert stiction_factors(0.0, 0.1, 1.2) == (0.0, 0.0)
    assert stiction_factors(0.1, 0.1, 1.2) == pytest.approx((1.2, 1.0))
    assert stiction_factors(0.15, 0.1, 1.2) == pytest.approx((1.0, 1.0))
    assert stiction_factors(-3.0, 0.1, 1.2) == (-1.0, -1.0)
