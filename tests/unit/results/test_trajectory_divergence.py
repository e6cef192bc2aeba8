"""Runs that come apart long after their peaks: what either may have missed there is told beside the peaks."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from components.contract.roles import INTERFACE_LOAD
from orchestrator.results.error_sources.sampling_error import judged_peaks
from orchestrator.results.error_sources.trajectory_divergence import beyond_peaks

SWING, PEAK, LATE = 0.02, 10.0, 3.0
"""Period of a ringing (s), the load on which it is (N), and when (s) runs have come apart."""


def _result(step, late, shift=0.0, event=None):
    """A made-up load that rings with 10 N at first, with 4 N later, and from 3 s on with another amplitude (N)."""
    time = np.arange(0.0, 4.0, step)
    amplitude = np.select([time < 1.0, time < LATE], [PEAK, 0.4 * PEAK], late)
    force = np.stack(
        [amplitude * np.sin(2.0 * np.pi * (time - shift) / SWING), 0.0 * time, 0.0 * time], axis=1
    )
    return SimpleNamespace(
        time=time,
        events=[] if event is None else [(event, "hinge", "latch-up")],
        hinge_lines=(),
        signal=lambda *key: force,
        unit=lambda *key: "N",
        in_role=lambda role: [("base", "interface_force")] if role == INTERFACE_LOAD else [],
    )


def _beyond(one, other):
    return beyond_peaks(one, list(judged_peaks(one)), other, dict(judged_peaks(other)))[
        "interface force peak", "x"
    ]


def test_what_runs_differ_by_may_be_missed_by_both():
    """Definition: 8 N in one and 2 N in the other may be 14 N in truth, 4 N above the peak."""
    for ours, theirs in ((8.0, 2.0), (2.0, 8.0)):
        assert _beyond(_result(1e-4, ours), _result(2e-4, theirs)) == pytest.approx(4.0, abs=0.01)


def test_phases_and_small_differences_are_no_such_thing():
    """Rule: what comes a little later is as high, and what steps resolve differs by little."""
    for theirs, shift in ((8.0, SWING / 3.0), (7.0, 0.0)):
        assert _beyond(_result(1e-4, 8.0), _result(2e-4, theirs, shift)) <= 0.0


def test_short_runs_have_nothing_to_compare():
    """Rows that are too few for a stretch of time."""
    assert _beyond(_result(0.5, 8.0), _result(1.0, 2.0)) <= 0.0
