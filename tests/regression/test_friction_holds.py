"""Whether a line opens that friction resists: it does where its motors exceed the friction, and stands still elsewhere.

Closed forms: a constant torque T against a constant friction F turns an inertia J by an angle a in the time
sqrt(2 a J / (T - F)); a motor that weakens stalls where the works of motor and friction are equal.
"""

from __future__ import annotations

import json
from math import degrees, pi, sqrt

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.cli.main import main
from tests.references.random_wings import random_wing
from tests.unit.analysis.friction_balances import BALANCES, balance_scene

pytestmark = pytest.mark.filterwarnings(
    "ignore::orchestrator.FanfoldWarning"
)  # lines that stop are the subject

INERTIA = 0.3 + 3.0 * 0.5**2
"""kg.m2, of the rigid panel about its hinge line."""
RIGID = {
    "rigid": {
        "mass": "3 kg",
        "center_of_mass": [0.5, 0, 0],
        "inertia": ["0.2 kg.m2", "0.3 kg.m2", "0.45 kg.m2"],
        "points": {"left": [0, 0.4, 0], "right": [0, -0.4, 0]},
    }
}
STIFF = {
    "panel": {
        "length": "1 m",
        "width": "0.8 m",
        "areal_mass": "3.5 kg/m2",
        "sandwich": {"skin": "1 mm", "core": "40 mm", "youngs_modulus": "200 GPa", "poisson_ratio": 0.3},
        "hinge_lines": {"inboard": "inner", "outboard": ""},
        "arm": {"y": "0.3 m", "length": "40 mm", "patch": "60 mm"},
    }
}
SOFT = {
    "panel": STIFF["panel"] | {"sandwich": STIFF["panel"]["sandwich"] | {"skin": "0.2 mm", "core": "10 mm"}}
}


def door(motor, friction, body=RIGID, *, until="60 s", law="sticking", **header):
    """A panel on a fixed base with a spring motor (N.m stowed, deployed), friction (N.m) and a latch."""
    sides = ("left", "right") if "rigid" in body else ("inner_left", "inner_right")
    y = 0.4 if "rigid" in body else 0.3
    scene = fanfold.Scene("door", until=until, **header)
    scene.friction(law=law)
    base = scene.base(points={"left": (0, y, 0), "right": (0, -y, 0)})
    scene.hinge_line(
        "HL", base, scene.body("door", **body), axis="+y", aligned_angle="90 deg",
        hinges={"hl_left": ("left", sides[0]), "hl_right": ("right", sides[1])},
        motor={"stowed": motor[0], "deployed": motor[1]}, friction_preload=friction,
        latch={"stiffness": 3000},
    )  # fmt: skip
    return scene


def deployed(scene, **options):
    return fanfold.simulate(scene, estimate=False, refine=False, **options)


@pytest.mark.parametrize(("torque", "friction"), [(1.2, 0.8), (0.3, 0.25), (0.5, 0.0)])
def test_latch_time_of_a_constant_torque_against_a_constant_friction(torque, friction):
    """Closed form, within 1e-5 at the default tolerance."""
    found = deployed(door((torque, torque), friction))
    assert found.latch_times["HL"] == pytest.approx(sqrt(pi * INERTIA / (torque - friction)), rel=1e-5)


@pytest.mark.parametrize("body", [RIGID, STIFF, SOFT], ids=["rigid", "stiff", "soft"])
def test_a_motor_that_weakens_stalls_where_the_works_are_equal(body):
    """Closed form: at 2 (1.6 - 1) / (1.6 - 0.2) of the travel, 77.14 deg, and from there on not a microradian more."""
    found = deployed(door((1.6, 0.2), 1.0, body))
    angle = found["hl_left", "angle"]
    assert degrees(angle[-1]) == pytest.approx(540.0 / 7.0, abs=0.05)
    assert np.ptp(angle[found.time > 40.0]) < 1e-9
    (stuck,) = found.headline.not_opened.values()
    assert (stuck.is_stuck, stuck.friction) == (True, pytest.approx(1.0))
    assert stuck.driving == pytest.approx(0.4, abs=1e-3)


@pytest.mark.parametrize("body", [RIGID, SOFT], ids=["rigid", "flexible"])
def test_a_line_that_friction_holds_stands_still_for_an_hour(body):
    """At steps as long as the scene allows; with the smooth law, as a control, it creeps open."""
    scene = door((0.1, 0.1), 0.2, body, until="3600 s", largest_step="1 s")
    found = deployed(scene)
    assert np.ptp(found["hl_left", "angle"][found.time > 60.0]) == 0.0
    assert found.costs["steps"] < 4000
    crept = deployed(door((0.1, 0.1), 0.2, RIGID, until="600 s", law="smooth"))
    assert crept.latch_times["HL"] > 100.0


def test_rigid_and_stiff_flexible_bodies_latch_together():
    """One panel at both fidelities, through friction of pins as well: within 1e-3."""
    times = []
    for rigid in ("all", ()):
        scene = door((1.2, 0.9), 0.4, STIFF)
        scene = scene.with_settings({"friction.coefficient": 0.2, "friction.pin_radius": "8 mm"})
        times.append(deployed(scene, rigid=rigid).latch_times["HL"])
    assert times[1] == pytest.approx(times[0], rel=1e-3)


@pytest.mark.parametrize(
    "balance",
    [
        pytest.param(b, marks=[] if b.name.startswith(("single", "chain")) else [pytest.mark.thorough])
        for b in BALANCES
    ],
    ids=[balance.name for balance in BALANCES],
)
def test_margin_restart_study_and_run_answer_alike(balance):
    """Each alone: the torque margin without factors, a restart from rest, a study, and the verdict of a run."""
    scene, options = balance_scene(balance), {"rigid": "all", "until": "60 s"}
    margin = fanfold.torque_margin(scene, friction="static", positions=3)
    by_margin = all(np.all(one.torques.net > 0.0) for one in margin.lines if one.counts)
    by_restart = all(line.opens for case in fanfold.restart(scene, ["0%"]) for line in case.lines)
    varied = {f"body.panel{k}.rigid.mass": "uniform(1.99, 2.01)" for k in range(len(balance.motors))}
    latched = np.array([*fanfold.study(scene, varied, runs=1, **options).opened.values()])
    by_study = np.all(latched == 1.0, axis=0).tolist()
    by_run = not deployed(scene, **options).headline.not_opened
    assert (by_margin, by_restart, *by_study, by_run) == (balance.opens,) * 4


@pytest.mark.parametrize(
    "seed", [4001, 4002, *(pytest.param(seed, marks=pytest.mark.thorough) for seed in (4003, 4004))]
)
def test_random_panels_open_if_their_motor_exceeds_friction_by_one_per_cent(seed):
    """Coulomb's law, for bodies, joints and latches that nothing was tuned to; half of them have flexible modes."""
    for factor in (1.01, 0.99):
        tree = random_wing(seed, (1, 1))
        (line,) = tree["hinge_line"]
        torque = line["motor"]["deployed"]
        line["motor"] = {"stowed": torque, "deployed": torque}
        line.pop("harness", None)
        for hinge in line["hinges"]:
            hinge.pop("harness", None)
        line["friction_preload"] = torque / factor
        line["latch"] = {"stiffness": 2000.0, "damping_ratio": 0.1}
        tree["friction"]["coefficient"] = 0.0
        tree["scene"].pop("gravity", None)
        tree["scene"] |= {"until": 60.0 * tree["scene"]["until"], "tolerance": 1e-3}
        found = deployed(fanfold.Scene.of_tree("panel.toml", tree))
        assert bool(found.latch_times) is (factor > 1.0), found.headline.verdict


def test_the_command_says_which_line_is_stuck_and_why(tmp_path):
    """Exit code 3 and the verdict of JSON; 0 for a line that opens."""
    for motor, code in (("0.1 N.m", 3), ("0.4 N.m", 0)):
        path = door((motor, motor), "0.2 N.m", until="20 s").save(tmp_path / "door.toml")
        found = CliRunner().invoke(
            main,
            ["run", str(path), "--no-estimate", "--json", "--replace", "--output", str(tmp_path / "r.h5")],
        )
        assert found.exit_code == code
        content = json.loads(found.stdout)
        assert list(content["not_opened"]) == ["HL"] * (code == 3)
        assert "HL" in content["verdict"]


def test_a_wing_as_one_fmu_stands_still_in_another_tool(tmp_path):
    """Driven by FMPy, motor 0.8 N.m against friction of 1.6 N.m: not a bit of an angle changes in a minute."""
    (path,) = fanfold.export(door((0.8, 0.8), 1.6), tmp_path, as_one=True)
    rows = fmpy.simulate_fmu(str(path), stop_time=60.0, output_interval=0.1)
    assert np.ptp(np.asarray(rows["hl_left.angle"])) == 0.0
    assert rows["time"][-1] == pytest.approx(60.0)
