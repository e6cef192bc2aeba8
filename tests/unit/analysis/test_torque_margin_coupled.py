"""Margins of lines that cable loops couple: closed forms, and the answer that the start warning gives too."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator.analysis.torque_margin.margins import find_margins, torque_margin
from orchestrator.analysis.torque_margin.rules import GroupTorques, LineTorques, margins
from orchestrator.analysis.torque_margin.standard import FACTORS
from orchestrator.cli.main import main
from orchestrator.cli.torque_margin_table import margin_sentences
from orchestrator.messages import code_of
from orchestrator.scene import find_scene, load_scene
from orchestrator.validity.before_run import scene_warnings
from tests.unit.analysis.friction_balances import BALANCES, balance_scene


@pytest.mark.parametrize("balance", BALANCES, ids=lambda balance: balance.name)
def test_margin_and_start_warning_agree(balance):
    """Closed form: the motors' power over the frictions', at the rates of the pulleys, is 1.01 or 0.99."""
    scene = balance_scene(balance).check()
    (found,) = (one for one in find_margins({"base": scene}, 3, friction="constant") if one.counts)
    assert tuple(found.torques.rates) == tuple(line.name for line in scene.hinge_lines)
    assert bool(np.all(found.torques.net >= 0.0)) is balance.opens
    factor = 1.01 if balance.opens else 0.99
    by_sum = found.margins[0]
    assert by_sum.margin[by_sum.worst] == pytest.approx(factor / 3.0, rel=1e-6)
    told = [one for one in scene_warnings(scene) if "W-motor-short" in one]
    assert len(told) == (0 if balance.opens else 1)
    held = [one for one in margin_sentences(torque_margin({"base": scene}, 3)) if "without factors" in one]
    assert len(held) == len(told)


def line_torques(line, motor, harness, friction, **extra):
    one = np.ones(1)
    return LineTorques(line, 0.3 * one, motor * one, harness * one, -friction * one, extra)


def test_torques_of_a_group_are_weighted_by_rates():
    """Power: a line that closes at half the rate of the first turns its motor into a resistance, factor 1.2."""
    lines = (
        line_torques("A", 2.0, 0.1, 0.2, HY=0.01, TL=0.3),
        line_torques("B", 1.5, -0.1, 0.3),
        line_torques("C", 0.4, 0.2, 0.1, TD=0.02, FR=0.03),
    )
    group = GroupTorques(lines, {"A": 1.0, "B": 2.0, "C": -0.5})
    assert group.line == "A+B+C"
    assert group.driving == pytest.approx(2.0 + 2.0 * 1.5)
    assert group.net == pytest.approx(2.1 - 0.2 + 2.0 * (1.5 - 0.1 - 0.3) - 0.5 * (0.4 + 0.2) - 0.5 * 0.1)
    resisting = (
        3.0 * (0.2 + 2.0 * 0.3 + 0.5 * 0.13) + 3.0 * (2.0 * 0.1 + 0.5 * 0.2) + 1.2 * 0.5 * 0.4 + 3.0 * 0.01
    )
    by_ecss = margins(group, "ECSS", FACTORS["theoretical"])
    assert by_ecss.resisting == pytest.approx(resisting)
    assert by_ecss.available == pytest.approx(0.8 * 5.0 - 1.25 * 0.5 * 0.02 - 0.3)


def test_amos3_is_judged_by_its_lines_together():
    """Closed form: (M1 + 2 M2 + 2 M3) / 3 (R1 + 2 R2 + 2 R3), stowed, as HL2 and HL3 turn twice as fast as HL1."""
    scene = load_scene(find_scene("amos3"))
    found = torque_margin({"base": scene}, 3, friction="constant")
    assert [(one.line, one.counts) for one in found.lines] == [
        ("HL1", False), ("HL2", False), ("HL3", False), ("HL1+HL2+HL3", True)
    ]  # fmt: skip
    by_sum, by_ecss = found.lines[-1].margins
    expected = (1.648 + 2.0 * (1.591 + 2.021)) / (3.0 * (0.15 + 2.0 * (0.20 + 0.17)))
    assert by_sum.margin[by_sum.worst] == pytest.approx(expected, rel=1e-6)
    assert by_ecss.margin[by_ecss.worst] == pytest.approx(0.8 * expected, rel=1e-6)
    assert found.passes
    assert found.without == {"base": {}}


@pytest.mark.parametrize("fidelity", ["rigid", "flexible"])
def test_the_start_warning_is_the_same_at_every_fidelity(fidelity):
    """Rule: torques about lines do not depend on how bodies bend."""
    bodies = [f"body.{name}.fidelity={fidelity}" for name in ("yoke", "panel1", "panel2")]
    (told,) = scene_warnings(
        load_scene(find_scene("amos3"), (), [*bodies, "hinge_line.HL3.friction_preload=5 N.m"])
    )
    assert all(
        part in told
        for part in ("hinge_line.HL1: ", " HL2 and HL3", " 1 : 2 : 2", " 0 deg ", " 8.872 N.m", " 10.79 N.m")
    )
    assert code_of(told) == "W-motor-short"


def test_the_command_tells_a_group(tmp_path):
    """A motor of 0.495 N.m against friction of 0.5 N.m of the other line; neither opens from half of the travel."""
    balance = next(one for one in BALANCES if one.name == "equal_first_drives_below")
    path = tmp_path / "wing.toml"
    path.write_text(balance_scene(balance).to_toml(), encoding="utf-8")
    command = ["analyse", "torque-margin", str(path), "--positions", "2", "--output", str(tmp_path / "out")]
    restarting = ["--restart", "50%", "--until", "3"]
    shown = CliRunner().invoke(main, [*command, *restarting], env={"COLUMNS": "80"})
    assert shown.exit_code == 3, shown.output
    words = " ".join(shown.stdout.split())
    assert (
        max(len(line) for line in shown.stdout.splitlines() if ".h5" not in line and ".png" not in line) <= 80
    )
    assert "L0+L1: " in words
    assert "L0+L1 (base): " in words
    assert "L0, L1 (base) from 50%: " in words
    assert (tmp_path / "out" / "torque_margin_L0+L1.png").stat().st_size > 10_000
    content = json.loads(CliRunner().invoke(main, [*command, "--json"]).stdout)
    rows = {(row["line"], row["rule"]): row for row in content["margins"]}
    assert rows["L0+L1", "sum"]["rates"] == {"L0": 1.0, "L1": 1.0}
    assert [(row["counts"], row["passes"]) for row in rows.values()] == [(False, True)] * 2 + [
        (True, False)
    ] * 2
    assert rows["L0+L1", "sum"]["net_torque"] == pytest.approx(-0.005, rel=1e-4)
