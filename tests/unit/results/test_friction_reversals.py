"""Peaks at which a line turns round, and its friction with it, between two rows: a made-up load and a panel's stop."""

from __future__ import annotations

import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.roles import INTERFACE_LOAD
from orchestrator.results.error_sources.friction_reversals import beyond_reversals
from orchestrator.results.error_sources.sampling_error import judged_peaks

PRESSED, CURVATURE, FRICTION = 50.0, 3000.0, 0.05
"""Torque of a stop where it is pressed in most (N.m), how fast it falls beside that (N.m/s2), friction (N.m)."""


def _result(turns_at, friction=FRICTION):
    """Rows 4 ms apart of a load that friction adds to before a line turns round, at a time (s), and not after."""
    time = np.arange(-0.02, 0.0201, 4e-3)
    against = np.where(time < turns_at, friction, -friction)
    torque = PRESSED - CURVATURE * (time - turns_at) ** 2 + against
    signals = {
        "interface_torque": np.stack([0.0 * time, torque, 0.0 * time], axis=1),
        "friction_torque": against,
    }
    return SimpleNamespace(
        time=time,
        events=[],
        hinge_lines=(),
        recording=lambda variable: ["hinge"],
        signal=lambda component, variable: signals[variable],
        unit=lambda *key: "N.m",
        in_role=lambda role: [("base", "interface_torque")] if role == INTERFACE_LOAD else [],
    )  # fmt: skip


def _beyond(result):
    return beyond_reversals(result, list(judged_peaks(result))).get(("interface torque peak", "y"), 0.0)


@pytest.mark.parametrize("turns_at", [1e-3, 2e-3, 3e-3])
def test_a_load_may_rise_to_where_the_line_turns_round(turns_at):
    """Closed form: to its value there, which no row has."""
    result = _result(turns_at)
    hidden = PRESSED + FRICTION - result.signal("base", "interface_torque").max()
    assert hidden > 1e-3
    assert hidden == pytest.approx(_beyond(result), rel=0.3)


def test_without_friction_there_is_none():
    """Rule: a smooth load is told by cubics through its rows, and a reversal hides no more than friction changes by."""
    assert _beyond(_result(2e-3, friction=0.0)) == 0.0
    assert _beyond(_result(2e-3, friction=1e-4)) <= 2e-4


def test_a_panel_that_turns_round_in_its_stop_is_told():
    """Against a run at a hundredth of the tolerance. Regression: 12 tolerances off, told to be off by 0.25."""
    tolerance = 2.66e-5
    scene = fanfold.Scene("stopped", until=3.42, preload=True)
    own = {"mass": 1743.0, "center_of_mass": [-0.65, -0.09, -0.04], "inertia": [2341.0, 2471.0, 2799.0]}
    scene.base("craft", points={"left": [0, 0.427, 0], "right": [0, -0.427, 0]}, free=own)
    panel = {"mass": 4.72, "center_of_mass": [0.744, 0, 0], "inertia": [0.326, 0.775, 1.1]}
    scene.body("panel", rigid=panel | {"points": {"left": [0, 0.427, 0], "right": [0, -0.427, 0]}})
    scene.joint(axial_stiffness=1.5e8, radial_stiffness=1.8e8, cross_stiffness=2335.0)
    scene.friction(coefficient=0.173, pin_radius=0.003, static_ratio=1.0)
    scene.hinge_line(
        "line", "craft", "panel", axis="+y", aligned_angle="90 deg", start_angle="19.35 deg",
        motor={"stowed": 0.927, "deployed": 0.517}, end_stop={"stiffness": 1508.0, "damping": 0.0},
        hinges={"left": "left", "right": "right"},
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found, fine = (
            fanfold.simulate(scene, tolerance=part * tolerance, refine=False, estimate=part == 1.0)
            for part in (1.0, 0.01)
        )
    peak, true = (run.headline.interface_torque_peaks[1] for run in (found, fine))
    assert beyond_reversals(found, list(judged_peaks(found)))["interface torque peak", "y"] >= 0.5 * (
        true - peak
    )
