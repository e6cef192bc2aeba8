"""What two runs differ by around peaks and latch-ups: closed forms of ringing with another phase, later events."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from components.contract.roles import INTERFACE_LOAD
from orchestrator.assembly import HingeLine
from orchestrator.results.error_sources.near_peaks import differences_near
from orchestrator.results.error_sources.step_ends import judged_peaks

STEP, FREQUENCY = 0.01, 20.0


def _run(time, force, events=(), **of_hinge):
    """A made-up result with an interface force along x and the signals of one hinge, from functions of time."""
    line = HingeLine("L", ("hinge",), "hinge", latches=True, kinematic=True, rigid=True)
    signals = {("hinge", name): values for name, values in of_hinge.items()}
    signals["base", "interface_force"] = np.stack([force, 0.0 * time, 0.0 * time], axis=1)
    return SimpleNamespace(
        time=time,
        events=[(at, "L", "L latch-up") for at in events],
        hinge_lines=(line,) if of_hinge else (),
        has=lambda *key: key in signals,
        signal=lambda *key: signals[key],
        unit=lambda *key: "N",
        in_role=lambda role: [("base", "interface_force")] if role == INTERFACE_LOAD else [],
    )


def _differences(one, other):
    return differences_near(one, list(judged_peaks(one)), other, dict(judged_peaks(other)))


def _ringing(time, phase):
    return 100.0 + 3.0 * np.sin(FREQUENCY * time + phase)


def test_ringing_of_another_phase_shows_beside_equal_peaks():
    """Closed form: sines of amplitude a, p apart, still differ by a (1 - cos p) / sqrt(2), shifted where they agree."""
    fine, coarse = STEP * np.arange(401), 2.0 * STEP * np.arange(201)
    one, other = _run(fine, _ringing(fine, 0.0)), _run(coarse, _ringing(coarse, 1.0))
    found = _differences(one, other)
    # 16 rows are 1.02 periods
    expected = 3.0 * (1.0 - np.cos(1.0)) / np.sqrt(2.0)
    assert found["interface force peak", "x"] == pytest.approx(expected, rel=0.03)
    assert found["interface force peak", "y"] == 0.0


def test_rows_belong_together_by_the_time_since_an_event():
    """Rule: what happens later in one run is no difference, and a jump is none but in its own segment."""

    def late(step, event):
        before = np.arange(0.0, event, step)
        time = np.concatenate([before, [event], event + 1e-8 + step * np.arange(100)])
        return _run(time, np.where(time <= event, 1.0, 100.0 - (time - event) ** 2), [event])

    found = _differences(late(STEP, 1.0), late(2.0 * STEP, 1.0037))
    assert found["interface force peak", "x"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.filterwarnings("error")
def test_two_events_at_one_instant_leave_the_difference_of_height():
    """Closed form: a curve 1e-3 s later is as high. Regression: two rows at one time made its slope no number."""

    def curve(time, late):
        return np.where(time < 1.0, 0.0, 5.0 + np.cos(4.0 * (time - 1.06 - late)))

    time = np.concatenate([[0.0, 0.5, 1.0 - 1e-7, 1.0, 1.0], 1.0 + np.arange(1, 40) * 0.02])
    one, other = (_run(time, curve(time, late), [1.0, 1.0]) for late in (0.0, 1e-3))
    assert _differences(one, other)["interface force peak", "x"] < 0.5 * 4e-3


def test_an_impulse_is_off_as_the_rates_before_it():
    """Closed form: J goes with w; opposite ringing by 0.02 of 0.5 rad/s makes 0.08 / sqrt(2) of it."""

    def latching(step, sign):
        before = step * np.arange(int(1.0 / step) + 1)
        time = np.concatenate([before, [1.0 + 1e-7, 1.0 + step]])
        rate = np.where(time <= 1.0, 0.5 + sign * 0.02 * np.sin(FREQUENCY * (time - 1.0)), 0.0)
        taken = np.where(time <= 1.0, 0.0, -8.0)
        return _run(time, 0.0 * time, [1.0], angular_rate=rate, latch_impulse=taken, latch_torque=0.0 * time)

    found = _differences(latching(STEP, 1.0), latching(2.0 * STEP, -1.0))
    assert found["latch impulse", "L"] == pytest.approx(8.0 * 0.08 / np.sqrt(2.0), rel=0.05)


def test_what_only_one_run_comes_to_has_no_difference():
    """Rule: a peak after an event that the other run does not meet is left out."""
    time = STEP * np.arange(401)
    one = _run(time, np.where(time <= 1.0, 0.0, _ringing(time, 0.0)), [1.0])
    found = _differences(one, _run(time, 0.0 * time))
    assert ("interface force peak", "x") not in found
    assert found["interface force peak", "y"] == 0.0
