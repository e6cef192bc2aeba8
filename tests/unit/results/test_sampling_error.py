"""What peaks owe to where steps ended: closed forms of sampling and ringing, and a random wing that rings."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from fmus import native_library
from orchestrator.assembly import HingeLine
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.error_sources.sampling_error import (
    hidden_excess,
    latching_rate_error,
    sampling_error,
)
from orchestrator.results.estimated_errors import estimated_errors
from orchestrator.run.error_estimate import with_estimates
from orchestrator.run.run import run
from tests.references.random_wings import load_wing

STEP, LATCH_UP = 0.01, 1.0
TIME = np.concatenate([np.arange(101) * STEP, LATCH_UP + 1e-3 * np.arange(1, 400)])


def test_a_peak_that_rows_resolve_owes_them_little():
    """Closed form: a cubic errs by 3/128 (w h)^4 of an amplitude, here with every other row."""
    time = np.linspace(0.0, 10.0, 401)
    bound = 3.0 / 128.0 * (2.0 * time[1]) ** 4
    assert 0.0 < sampling_error(time, 7.0 * np.sin(time), []) <= 7.0 * bound


def test_a_peak_of_ringing_owes_them_what_its_row_stands_out_by():
    """Closed form: rows of alternating sign, of which one is higher by 0.3; without it all are alike."""
    rows = np.arange(41)
    values = (-1.0) ** rows * (2.0 + 0.3 * (rows == 20))
    assert sampling_error(0.1 * rows, values, []) == pytest.approx(0.3)


def test_rows_of_events_stay():
    """Rule: a jump belongs to its event and is no matter of sampling."""
    time = np.array([0.0, 1.0, 2.0, 3.0, 3.0 + 1e-7, 4.0, 5.0, 6.0, 7.0])
    values = np.array([0.0, 0.0, 0.0, 0.0, 5.0, 1.0, 1.0, 1.0, 1.0])
    assert sampling_error(time, values, [0.0, 3.0]) == 0.0


def test_a_top_between_two_rows_after_an_event_may_be_higher_than_the_peak():
    """Rule: 9 beside a peak of 10, of which 5 are one row's alone, may be 14; at 4, or without that row, it is none."""
    time = np.concatenate([np.linspace(0.0, 10.0, 401), 10.0 + 1e-7 + 0.025 * np.arange(40)])
    slow = np.where(time <= 10.0, 10.0 * np.sin(0.5 * np.pi * time / 5.0), 0.0)
    resolved = 10.0 * 3.0 / 128.0 * (0.1 * np.pi * 0.05) ** 4
    for top, hidden in ((9.0, 4.0), (4.0, 0.0)):
        values = slow.copy()
        values[401:407] = [0.0, -top, -4.0, -4.0, -4.0, -4.0]
        assert hidden_excess(time, values, [0.0, 10.0]) == pytest.approx(hidden, abs=resolved)


def test_tops_that_rows_resolve_hide_nothing():
    """Closed form: a cubic errs by 3/128 (w h)^4 of an amplitude, here with every other row; tops are alike."""
    time = np.linspace(0.0, 50.0, 2001)
    bound = 3.0 / 128.0 * (2.0 * time[1]) ** 4
    assert hidden_excess(time, 7.0 * np.sin(time) * (1.0 - 1e-9 * time), []) <= 7.0 * bound


def _latching(angle, rate, torque):
    """A made-up result of one line that latches at LATCH_UP, from functions of time."""
    line = HingeLine("L", ("hinge",), "hinge", True, None)
    values = {"angle": angle(TIME), "angular_rate": rate(TIME), "latch_torque": torque(TIME - LATCH_UP)}
    values["latch_torque"][TIME <= LATCH_UP] = 0.0
    result = SimpleNamespace(
        time=TIME,
        events=[(LATCH_UP, "L", "L latch-up")],
        hinge_lines=(line,),
        has=lambda component, variable: variable in values,
        signal=lambda component, variable: values[variable],
    )
    return result, line


def test_a_damper_torque_is_off_by_the_ringing_of_its_rate():
    """Closed form: 0.5 rad/s and ringing of 0.1 rad/s that every step ends at the top of; the torque follows it."""
    ringing = 2.0 * np.pi / STEP
    result, line = _latching(
        lambda t: 0.5 * t + 0.1 / ringing * np.sin(ringing * t),
        lambda t: 0.6 * np.exp(-np.maximum(0.0, t - LATCH_UP) / 1e-3),
        lambda t: 300.0 * np.exp(-np.maximum(0.0, t) / 1e-3),
    )
    peak, still = 300.0 * np.exp(-1.0), np.exp(-1.0)
    assert latching_rate_error(result, line) == pytest.approx(peak * still * 0.1 / 0.6, rel=1e-6)


@pytest.mark.parametrize("swing", [False, True])
def test_a_rate_that_angles_arrive_at_is_believed(swing):
    """Closed form: constant acceleration, which a parabola follows; and ringing before a swing that ends at rest."""
    ringing = 2.0 * np.pi / STEP
    result, line = _latching(
        lambda t: 0.25 * t**2 + swing * 0.1 / ringing * np.sin(ringing * t),
        lambda t: np.where(t <= LATCH_UP, 0.5 * t + swing * 0.1, 0.5 * np.cos(5.0 * np.pi * (t - LATCH_UP))),
        lambda t: 300.0 * np.sin(5.0 * np.pi * t),
    )
    assert latching_rate_error(result, line) == pytest.approx(0.0, abs=1e-6 if swing else 1e-9)


def test_a_swing_is_over_between_rows():
    """Closed form: the top of a swing lies a third of a step behind the nearest row, where the hinge still turns."""
    ringing, late = 2.0 * np.pi / STEP, 0.1 + STEP / 3.0
    result, line = _latching(
        lambda t: 0.25 * t**2 + 0.1 / ringing * np.sin(ringing * t),
        lambda t: np.where(t <= LATCH_UP, 0.5 * t + 0.1, np.cos(0.5 * np.pi * (t - LATCH_UP) / late)),
        lambda t: 300.0 * np.sin(0.5 * np.pi * t / late),
    )
    assert latching_rate_error(result, line) == 0.0


@pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
@pytest.mark.thorough
def test_a_latch_that_meets_a_wing_that_rings_is_told_of():
    """Regression: random wing 57 latches with a rate that rings; its peak is 1530.0 N.m (at 8e-6, 66,521 steps)."""
    scene = load_wing(57)
    assembly, settings = assemble(scene), Settings(scene.header.tolerance)
    found = with_estimates(assembly, run(assembly, None, settings), settings).headline
    off = abs(found.latch_torque_peaks["L0"] - 1530.0)
    told = any("latch torque peak of L0" in sentence for sentence in found.messages)
    assert told or off <= 10.0 * settings.tolerance * 1530.0


@pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
def test_a_stop_that_steps_lead_over_is_doubted():
    """Random wing 1905: 15,647 N.m of a damped stop in the one row that its blow has, 14,968 N.m in finer steps.

    Its companion strikes at the same instant, and tells the same.
    """
    scene = load_wing(1905, stops=True)
    assembly = assemble(scene)
    settings = Settings(1e-3, assembly.largest_step)
    outcome = with_estimates(assembly, run(assembly, None, settings, until=1.4), settings, 1.4)
    told = estimated_errors(outcome.result)["stop torque peak", "h3_0_stop"]
    assert told.most > 15647.0 - 14968.0
