"""Ringing that steps damp is told beside the peaks that it would pass; what fades by itself is not."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.roles import INTERFACE_LOAD
from orchestrator.assembly import HingeLine
from orchestrator.results.error_sources.numerical_damping import lost_ringing
from orchestrator.results.error_sources.sampling_error import judged_peaks

SWING, STEP, LONG_STEP, LOST = 2e-3, 1e-4, 0.02, 0.2
"""Period of a ringing, steps that resolve it, steps after it was lost, and when that was (s)."""


def _result(step, damping):
    """A made-up load along x and z that grows from 1 to 2 N in a second, and of x a ringing of 0.8 N that fades."""
    time = np.concatenate([np.arange(0.0, LOST, step), np.arange(LOST, 1.0, LONG_STEP * step / STEP)])
    ringing = np.where(time < LOST, 0.8 * np.exp(-damping * time) * np.cos(2.0 * np.pi * time / SWING), 0.0)
    force = np.stack([1.0 + time + ringing, 1e-3 * time, -1.0 - time], axis=1)
    return SimpleNamespace(
        time=time,
        events=[],
        hinge_lines=(HingeLine("L", (), "", latches=False, kinematic=False, axis=(0.0, 1.0, 0.0)),),
        signal=lambda *key: force,
        unit=lambda *key: "N",
        in_role=lambda role: [("base", "interface_force")] if role == INTERFACE_LOAD else [],
    )


def _lost(of_companion):
    one, other = _result(STEP, 30.0), _result(2.0 * STEP, of_companion)
    return lost_ringing(one, list(judged_peaks(one)), other, dict(judged_peaks(other)))


def test_what_steps_damp_would_pass_the_peak():
    """Closed form: 0.8 N, less what fades in half a swing and what is left at 0.2 s, on the highest load of long steps.

    The line turns x into z, and nothing into what is along it.
    """
    found = _lost(30.0 * 2**4)
    # the strongest swing ends a period after the start, the first of the last eight five periods before the end
    first, left = (
        0.4 * (np.exp(-30.0 * at) + np.exp(-30.0 * (at - SWING / 2.0))) for at in (SWING, LOST - 4.0 * SWING)
    )
    assert found["interface force peak", "x"] == pytest.approx(first - left, rel=1e-2)
    assert found["interface force peak", "z"] == pytest.approx(first - left, rel=1e-2)
    assert found["interface force peak", "y"] == 0.0


def test_what_fades_in_both_runs_is_not_lost_by_steps():
    """Rule: dampers and friction take the same from a ringing whatever the steps."""
    assert _lost(30.0) == {}


@pytest.mark.filterwarnings("ignore:line.*W-not-opened")  # it is on its way
@pytest.mark.parametrize("damping_ratio", [0.0, 0.05])
def test_joints_without_damping_are_told(damping_ratio):
    """Regression: random wing 3006, whose steps let go of what its motor had stirred, told 0.59 N along z for 0.86.

    Of joints with damping nothing is left by then, and nothing is told.
    """
    scene = fanfold.Scene("one_panel", until="3.2 s", tolerance=1e-3)
    points = {"left": (0, 0.4, 0), "right": (0, -0.4, 0)}
    base = scene.base(points=points)
    scene.joint(axial_stiffness=6e8, radial_stiffness=9e7, cross_stiffness=2e6, damping_ratio=damping_ratio)
    panel = scene.body(
        "panel",
        rigid={"mass": 1.8, "center_of_mass": (0.7, 0, 0), "inertia": (0.15, 0.16, 0.3), "points": points},
    )  # fmt: skip
    scene.hinge_line(
        "line", base, panel, axis="+y", aligned_angle="90 deg", hinges={"one": "left", "two": "right"},
        motor={"stowed": 0.26, "deployed": 0.23}, latch={"kind": "kinematic", "stiffness": 2e4},
    )  # fmt: skip
    result = fanfold.simulate(scene)
    messages = " ".join(m for m in (*result.warnings, *result.notes) if "interface force peak" in m)
    assert ("z" in re.findall(r"\b[xyz]\b", messages)) is (damping_ratio == 0.0)
