"""Lines without a torque margin of their own, margins where nothing resists, and the tables that tell of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator.analysis.torque_margin import sweep as sweep_module
from orchestrator.analysis.torque_margin import undriven
from orchestrator.analysis.torque_margin.margins import TorqueMargin
from orchestrator.analysis.torque_margin.restart import CaseRestart, Restart
from orchestrator.analysis.torque_margin.rules import Found, LineTorques, margins
from orchestrator.analysis.torque_margin.standard import FACTORS
from orchestrator.analysis.torque_margin.undriven import without_margin
from orchestrator.cli.main import main
from orchestrator.cli.torque_margin_table import (
    margin_table,
    restart_sentences,
    restart_table,
    sentences_without_margin,
)
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.builder import Scene
from tests.unit.scene.scene_cases import TWO_PANELS, load_text


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def scene(name, *variants):
    return load_scene(find_scene(name), variants)


DRIVE = """
[[connection]]
name = "motor"
kind = "drive"
structure = { axis = [0.0, 1.0, 0.0] }
ports.inboard = { body = "base", point = "root" }
ports.outboard = { body = "BODY", point = "POINT" }
parameters = { aligned_angle = "90 deg", start_angle = "0.2 rad", end_angle = "1 rad", stiffness = "10 N.m/rad" }
"""


def test_a_motor_between_the_bodies_of_a_line_is_counted(tmp_path, monkeypatch):
    """Closed form: its stiffness times the angle that it is ahead; it was ignored without a word.

    A drive stands for a component that tells a motor torque, which is what decides.
    """
    for module in (undriven, sweep_module):
        monkeypatch.setattr(module, "MOTOR_TORQUE", "drive_torque")
    bare = load_text(tmp_path, TWO_PANELS)
    driven = load_text(tmp_path, TWO_PANELS + DRIVE.replace("BODY", "inner").replace("POINT", "root"))
    without, having = (sweep_module.sweep(one, [0.0], "constant", {}) for one in (bare, driven))
    assert having[0].motor[0] - without[0].motor[0] == pytest.approx(
        10 * 0.2, rel=1e-5
    )  # hinges are held by 1e7 N.m/rad
    assert having[1].motor[0] == pytest.approx(without[1].motor[0])
    across = load_text(tmp_path, TWO_PANELS + DRIVE.replace("BODY", "outer").replace("POINT", "left"))
    assert "motor" in undriven.uncounted(across)


def test_a_drive_is_named_as_left_out():
    """Its torque is whatever its command takes, and so no margin counts the lines that the loops couple to it."""
    found = undriven.uncounted(scene("arabsat", "phase2"))
    assert list(found) == ["sadm", "panel4_loop"]
    assert "HL1, HL2, HL3, HL4, HL5, HL6" in found["panel4_loop"]
    assert "sadm" in found["panel4_loop"]
    assert undriven.uncounted(scene("amos3")) == {}


def test_what_resists_beside_a_line_is_named_as_left_out():
    """Rule: gravity and loads are in no margin, and said to be; a line that a loop leads is in that of its group."""
    settings = ["scene.gravity=[0, 0, -9.81]", "hinge_line.HL2.friction_preload=0.1 N.m"]
    one = load_scene(find_scene("amos3"), (), [*settings, "hinge_line.HL2.motor.stowed=1 N.m"])
    assert sorted(undriven.uncounted(one)) == ["gravity"]
    tree = Scene.load("amos3", settings=settings).tree
    for line in tree["hinge_line"]:
        if line["name"] == "HL2":
            del line["motor"]
    ports = {"body": {"body": "panel2", "point": "center"}}
    push = {"name": "push", "kind": "load", "ports": ports, "structure": {"direction": [0, 0, 1]}}
    tree["connection"] = [*tree.get("connection", []), push]
    found = undriven.uncounted(Scene.of_tree("wing.toml", tree).check())
    assert sorted(found) == ["gravity", "push"]
    held = load_scene(find_scene("amos3"), (), ["hinge_line.HL1.held=true"])
    assert set(undriven.uncounted(held)) == {"yoke_loop", "panel_loop"}


def test_every_line_without_a_motor_says_what_turns_it():
    """ARABSAT data sheet: the motor turns HL1, the loops pass it on from line to line; only HL6 has springs."""
    loops = ["yoke_loop", "panel1_loop", "panel2_loop", "panel3_loop", "panel4_loop"]
    turning = {"HL1": ("sadm", "yoke_loop")}
    for k, line in enumerate(("HL2", "HL3", "HL4", "HL5")):
        turning[line] = (loops[k], loops[k + 1])
    said = without_margin(scene("arabsat", "phase2"))
    assert {
        line: tuple(name for name in ("sadm", *loops) if name in words) for line, words in said.items()
    } == turning
    held = without_margin(scene("arabsat", "phase1"))
    assert list(held) == ["HL1", "HL2", "HL3", "HL4", "HL5"]
    assert all("held" in words for words in held.values())
    (kept,) = without_margin(scene("bepicolombo")).items()
    assert kept[0] == "HL1"
    assert "4 N.m" in kept[1]
    assert without_margin(scene("amos3")) == {}


def test_sentences_name_lines_once_and_cases_where_they_differ():
    cases = {"base": {"A": "x", "B": "x", "C": "y"}, "cold": {"A": "x", "B": "x"}}
    both, one = sentences_without_margin(cases)
    assert (both[:5], both[-3:]) == ("A, B ", ": x")
    assert (one[:9], one[-3:]) == ("C (base) ", ": y")


def torques(motor, friction, **extra):
    """A line at one angle."""
    one = np.ones(1)
    return LineTorques("line", 0.0 * one, motor * one, 0.0 * one, -friction * one, extra)


def test_round_off_of_the_friction_resists_nothing():
    """Frictions of 1e-9 of what drives come from round-off of the reactions; 1e-5 is a resistance."""
    for friction, margin in ((2e-9, np.inf), (2e-5, 2.0 / 6e-5)):
        found = margins(torques(2.0, friction), "sum", FACTORS["theoretical"])
        assert found.margin[0] == pytest.approx(margin, rel=1e-12)
        assert found.passes


def fanfold(*arguments):
    result = CliRunner().invoke(main, ["analyse", "torque-margin", *arguments], env={"COLUMNS": "80"})
    assert result.exit_code == (3 if "FAILS" in result.output or '"passes": false' in result.output else 0), (
        result.output
    )
    return result.stdout


def test_nothing_resists_in_words():
    """The workbench has no friction; a demand on top of it fails without a number that would mean nothing."""
    shown = fanfold("workbench", "--positions", "2", "--torque", "HL.TD=10N.m")
    assert "inf" not in shown
    rows = {line.split()[2]: line for line in shown.splitlines() if line.strip().startswith("HL ")}
    assert "torque" in rows["sum"]
    assert "FAILS by" in rows["ECSS"]


def test_the_command_tells_of_lines_without_margin():
    shown = fanfold("bepicolombo", "--positions", "2")
    assert "HL1 " in " ".join(shown.split())
    assert max(map(len, shown.splitlines())) <= 80
    content = json.loads(fanfold("bepicolombo", "--positions", "2", "--json"))
    assert [(row["case"], row["line"]) for row in content["without_margin"]] == [
        ("base", "HL1"),
        ("cold", "HL1"),
    ]


def test_every_end_of_a_restart_has_its_verdict():
    """Columns have their units, a run that was too short is no failure to open, and who opens though held is told."""
    ends = {
        "opens": {"moves": True, "still_opening": False, "opened_at": 2.5, "net": 0.1},
        "NOT OPEN YET": {"moves": True, "still_opening": True, "opened_at": None, "net": 0.1},
        "stops, DOES NOT OPEN": {"moves": True, "still_opening": False, "opened_at": None, "net": 0.1},
        "DOES NOT MOVE": {"moves": False, "still_opening": False, "opened_at": None, "net": -0.25},
        "opens, HELD AT REST": {"moves": True, "still_opening": False, "opened_at": 2.5, "net": -0.5},
    }
    lines = [Restart(f"L{k}", 0.0, 1.0, 0.1, **end) for k, end in enumerate(ends.values())]
    run = CaseRestart("base", "25%", Path("run.h5"), lines)
    stays, creeps = restart_sentences([run])[1:]
    assert stays.startswith("L3 (base) from 25%: ")
    assert "0.25 N.m" in stays
    assert creeps.startswith("L4 (base) from 25%: ")
    assert "0.5 N.m" in creeps
    assert ("creep" in creeps, "creep" in stays) == (True, False)
    table = restart_table([run])
    headings = [" ".join(str(column.header).split()) for column in table.columns]
    assert headings == [
        "case", "stopped at", "line", "start, deg", "end, deg", "fastest, deg/s", "opened after, s", "verdict",
    ]  # fmt: skip
    assert list(table.columns[-1].cells) == list(ends)
    assert list(table.columns[-2].cells) == ["2.5000", "-", "-", "-", "2.5000"]
    assert list(table.columns[4].cells) == ["57.30"] * 5


def test_margins_stay_in_the_order_of_the_scene():
    """HL10 comes after HL2, as in the scene."""
    one = margins(torques(2.0, 0.1), "sum", FACTORS["theoretical"])
    found = [
        Found(case, replace(torques(2.0, 0.1), line=line), (one,))
        for case in ("base", "cold")
        for line in ("HL2", "HL10")
    ]
    table = margin_table(TorqueMargin("theoretical", "sliding", found, {}))
    rows = list(zip(table.columns[0].cells, table.columns[1].cells, strict=True))
    assert rows == [("HL2", "base"), ("HL2", "cold"), ("HL10", "base"), ("HL10", "cold")]


def test_what_moves_a_base_or_a_body_is_not_counted():
    """Rule: a spin pulls lines open or shut by more than motors do.

    Regression: a margin of 4.4 for a line that it kept shut.
    """
    tree = Scene.load("workbench").tree
    tree["base"]["motion"] = {"rotation": [{"profile": "ramp", "duration": 100.0, "change": 120.0}]}
    found = undriven.uncounted(Scene.of_tree("wing.toml", tree).check())
    assert list(found) == [f"motion of {tree['base'].get('name', 'base')}"]
