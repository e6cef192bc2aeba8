"""Impacts found in a run, against the closed form of a bar that swings against a linear stop."""

from math import pi, sqrt

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator.analysis.impact import closing_speed, impacts
from orchestrator.assembly.assemble import assemble
from orchestrator.cli.analyse.impact import command
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result, ResultError
from orchestrator.run.run import run
from orchestrator.scene import load_scene

MASS, LENGTH, ABOUT_HINGE = 3.0, 2.0, 4.0
TORQUE, STIFFNESS, OPENING = 0.02, 4e4, 0.1
SCENE = f"""
[scene]
name = "bar"
until = 20.0
[base]
points = {{ hinge = [0.0, 0.0, 0.0], stop = [{LENGTH * np.cos(OPENING)}, 0.0, {-LENGTH * np.sin(OPENING)}] }}
[joint]
damping_ratio = 0.0
[[body]]
name = "bar"
[body.rigid]
mass = {MASS}
center_of_mass = [1.0, 0.0, 0.0]
inertia = [0.01, {ABOUT_HINGE - MASS}, {ABOUT_HINGE - MASS}]
points = {{ hinge = [0.0, 0.0, 0.0], tip = [{LENGTH}, 0.0, 0.0] }}
[[hinge_line]]
name = "HL"
inboard = "base"
outboard = "bar"
axis = "+y"
aligned_angle = 0.0
latch_angle = "3 rad"
motor = {{ stowed = {TORQUE}, deployed = {TORQUE - 1e-9} }}
hinges = [{{ name = "hinge", inboard = "hinge", outboard = "hinge" }}]
[[connection]]
name = "stop"
kind = "contact"
structure = {{ normal = [{np.sin(OPENING)}, 0.0, {np.cos(OPENING)}] }}
ports.inboard = {{ body = "base", point = "stop" }}
ports.outboard = {{ body = "bar", point = "tip" }}
[connection.parameters]
gap = 0.0
reference_force = {STIFFNESS}
reference_penetration = "1 m"
exponent = 1.0
damping = 0.0
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    path = tmp_path_factory.mktemp("impact") / "bar.toml"
    path.write_text(SCENE, encoding="utf-8")
    outcome = run(assemble(load_scene(path)), path.with_suffix(".h5"), Settings(), 20.0)
    return Result.open(outcome.path)


def test_first_impact_is_that_of_the_closed_form(found):
    """Half a sine of the bar's J / L^2 on the stop; the constant torque adds a part in T / (k v L) ~ 2e-4."""
    reduced = ABOUT_HINGE / LENGTH**2
    speed = LENGTH * sqrt(2.0 * TORQUE * OPENING / ABOUT_HINGE)
    start = sqrt(2.0 * OPENING * ABOUT_HINGE / TORQUE)
    first = impacts(found)[0]
    assert first.start == pytest.approx(start, rel=1e-4)
    assert first.closing_speed == pytest.approx(speed, rel=1e-3)
    assert first.peak_force == pytest.approx(speed * sqrt(STIFFNESS * reduced), rel=2e-3)
    assert first.deepest == pytest.approx(speed * sqrt(reduced / STIFFNESS), rel=2e-3)
    assert first.duration == pytest.approx(
        pi * sqrt(reduced / STIFFNESS), rel=1e-2
    )  # ends lie between samples
    assert first.impulse == pytest.approx(2.0 * reduced * speed, rel=1e-2)
    assert first.dissipated == pytest.approx(0.0, abs=1e-9)


def test_a_bar_that_lost_nothing_comes_back_as_hard(found):
    """It swings back to where it started, and falls again: the second impact is the first, a period later."""
    first, second = impacts(found)
    period = 2.0 * sqrt(2.0 * OPENING * ABOUT_HINGE / TORQUE)
    assert second.start - first.start == pytest.approx(period, rel=2e-3)
    assert second.peak_force == pytest.approx(first.peak_force, rel=1e-3)


def test_a_latch_up_before_a_touch_leaves_the_closing_speed():
    """Two samples at the event, before which the point moved away; free flight at 2 m/s from there on."""
    time = np.array([0.0, 0.1, 0.1, 0.2, 0.3, 0.4])
    depth = np.array([-0.4, -0.6, -0.5, -0.3, -0.1, 0.1])
    assert closing_speed(time, depth, 5, 0.35) == pytest.approx(2.0, rel=1e-12)
    assert closing_speed(time, depth, 3, 0.2) == 0.0  # two instants are no parabola


def test_the_command_draws_and_lists(found, tmp_path):
    picture = tmp_path / "new" / "impact.png"
    shown = CliRunner().invoke(command, [str(found.path), "--output", str(picture)])
    assert shown.exit_code == 0, shown.output
    assert "stop" in shown.output
    assert shown.output.splitlines()[-1] == str(picture)
    assert picture.stat().st_size > 10_000


def test_a_result_without_contact_is_refused_by_a_sentence(tmp_path):
    path = tmp_path / "free.toml"
    path.write_text(SCENE[: SCENE.index("[[connection]]")], encoding="utf-8")
    outcome = run(assemble(load_scene(path)), path.with_suffix(".h5"), Settings(), 0.1)
    with pytest.raises(ResultError, match=r"free\.h5: .*contact"):
        impacts(Result.open(outcome.path))
