"""A coupler between lines that share no body, in a wing of three panels: against equations of motion of its own."""

from dataclasses import replace

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.analysis.torque_margin.undriven import margin_groups, uncounted, without_margin
from orchestrator.messages import code_of
from orchestrator.validity.before_run import scene_warnings
from tests.references.coupled_wing import RATIO, coupled_wing, motion

STIFFNESS = 2e5
pytestmark = pytest.mark.filterwarnings("ignore:.*(W-no-end|W-not-opened)")


def test_rigid_panels_move_as_lagrange_says():
    """Own equations, whose coupler is ideal: angles to twice its wind-up, and its torque once it has settled."""
    scene = coupled_wing(2.0, stiffness=STIFFNESS, damping=20.0)
    run = fanfold.simulate(scene, rigid="all", estimate=False)
    expected, torque = motion(scene, run.time)
    angles = np.array([run[f"hinge{number}", "angle"][:] for number in (1, 2, 3)]).T
    assert np.ptp(expected, axis=0).min() > 0.25
    assert angles == pytest.approx(expected, abs=2.0 * np.abs(torque).max() / STIFFNESS / RATIO)
    settled = run.time > 0.5
    assert run["coupler", "gear_torque"][:][settled] == pytest.approx(torque[settled], rel=5e-3)
    assert run.headline.energy_residual < 1e-4


def test_flexible_panels_keep_the_ratio():
    """Definition: without damping the torque is the stiffness times the difference of both turns at the ports."""
    run = fanfold.simulate(coupled_wing(0.2, stiffness=STIFFNESS, damping=0.0), estimate=False)
    wound = run["coupler", "first_angle"][:] - RATIO * run["coupler", "second_coordinate"][:]
    torque = run["coupler", "gear_torque"][:]
    assert torque == pytest.approx(-STIFFNESS * (wound - wound[0]), abs=1e-6 * np.abs(torque).max())
    assert np.abs(torque).max() > 1.0
    assert run.headline.energy_residual < 1e-4


def test_lines_that_share_no_body_are_coupled():
    """Definition: HL1 turns at half the rate of HL3, and they have one margin; HL2 between them is as it was.

    Without stiffness nothing is coupled.
    """
    scene, loose = coupled_wing().check(), coupled_wing(stiffness=0.0).check()
    bare, bare_loose = (
        replace(one, hinge_lines=[k.model_copy(update={"motor": None}) for k in one.hinge_lines])
        for one in (scene, loose)
    )
    (group,) = scene.coupled_lines
    assert group == ({"HL1": 1.0, "HL3": 1.0 / RATIO}, ("coupler",), ())
    assert margin_groups(scene) == [group]
    assert uncounted(scene) == {}
    reasons = without_margin(bare)
    assert ["coupler" in reasons[name] for name in ("HL1", "HL2", "HL3")] == [True, False, True]
    assert loose.coupled_lines == ()
    assert not any("coupler" in reason for reason in without_margin(bare_loose).values())


def test_a_coupler_that_does_not_fit_its_lines_is_told():
    """Definition: 90 and 180 deg need a ratio of 0.5; with another gear of the contrary sense no line can move."""
    scene = coupled_wing()
    assert [one for one in scene_warnings(scene.check()) if "coupler" in one] == []
    ports = {"carrier": ("base", "tip_right"), "first": ("panel1", "root_right")}
    more = {"second": ("panel3", "root_right"), "second_carrier": ("panel2", "tip_right")}
    scene.connection(
        "contrary",
        "gear",
        ports=ports | more,
        structure={"second_carrier": True},
        parameters={"ratio": -RATIO},
    )
    unlike, jam = (one for one in scene_warnings(scene.check()) if code_of(one) == "W-loop-data")
    assert "connection.contrary" in unlike
    assert "ratio of 0.5" in unlike
    assert all(word in jam for word in ("connection.coupler", "connection.contrary", "HL1 and HL3"))
