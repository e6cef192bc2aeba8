"""Table of normal modes: effective masses, mechanisms, dominant bodies, and the command."""

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.analysis.modes import Mode, Modes, mode_table
from orchestrator.analysis.vibration import DIRECTIONS
from orchestrator.assembly.statics.configuration import configuration, loaded, placed
from orchestrator.assembly.statics.linear_model import effective_masses, linearise, normal_modes
from orchestrator.cli.main import main
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.builder import Scene
from tests.references.edits import edited

TWO_PANELS = (Path(__file__).parents[2] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
LATCH = 'latch = { kind = "spring", stiffness = 2000, effective_inertia = 5 }\n'
MOTORS = (
    'motor = { stowed = "1.6 N.m", deployed = "1.0 N.m" }\n',
    'motor = { stowed = "2.0 N.m", deployed = "1.2 N.m" }\n',
)


def wing(folder, motors=("", ""), latches=("", "")):
    """The two rigid panels with other motors and with latches."""
    text = TWO_PANELS
    for old, motor, latch in zip(MOTORS, motors, latches, strict=True):
        text = edited(text, (old, motor + latch))
    path = folder / "wing.toml"
    path.write_text(text, encoding="utf-8")
    return path


def model_of(path, *target, how=placed):
    scene = load_scene(path)
    return linearise(how(scene, (), (), configuration(scene, *target)))


def test_unlatched_lines_are_free_motions(tmp_path):
    """Counting: two lines without spring and latch move freely, one latched leaves one."""
    path = wing(tmp_path, latches=(LATCH, LATCH))
    for latched, expected in (("none", 2), ("root_line", 1), ("middle_line", 1), ("all", 0)):
        for angles in ({}, {"root_line": 0.4, "middle_line": 2.0}):
            modes = normal_modes(model_of(path, "deployed", angles, latched))
            assert int(modes.is_free.sum()) == expected


def test_motor_springs_hold_what_is_not_latched(tmp_path):
    """Closed form: planar double pendulum on the motors' rates at rest, M from the sheet of the scene."""
    path = wing(tmp_path, motors=MOTORS)
    rates = np.array([(1.6 - 1.0) / (0.5 * pi), (2.0 - 1.2) / pi])
    mass = np.array([8.0, 7.5])
    arms = np.array([[0.8, 0.0], [1.6, 0.77]])
    matrix = np.diag([1.8, 1.6]) + (arms.T * mass) @ arms
    opening = np.array([[1.0, 0.0], [-1.0, 1.0]])
    square = np.linalg.eigvals(np.linalg.solve(matrix, opening.T @ np.diag(rates) @ opening)).real
    expected = np.sqrt(np.sort(square)) / (2.0 * pi)
    modes = normal_modes(model_of(path, "deployed", {}, "none", how=loaded))
    # bushings of 5e6 N/m carry no force; beside rates below 1 N.m/rad they are rigid to 1e-6
    np.testing.assert_allclose(modes.frequencies[:2], expected, rtol=1e-5)


def test_effective_masses_of_all_modes_make_the_whole(tmp_path):
    """Identity: modes are complete, so effective masses add up to the rigid mass and inertia."""
    for path, how in ((wing(tmp_path), placed), (find_scene("amos3"), loaded)):
        model = model_of(path, "deployed", how=how)
        effective, total = effective_masses(model, normal_modes(model))
        np.testing.assert_allclose(effective.sum(axis=1), total, rtol=1e-9)
        mass = sum(b.body.data.mass for b in model.mechanism.bodies.values() if b.body is not None)
        np.testing.assert_allclose(total[:3], mass, rtol=1e-12)


def test_effective_mass_of_a_latched_panel(tmp_path):
    """Closed form: m_eff = (m a)^2 / J along the motion of the centre of mass, all of J about the line."""
    scene = Scene.load(wing(tmp_path, latches=(LATCH, "")))
    scene.joint(axial_stiffness=1e11, radial_stiffness=1e11, cross_stiffness=1e11)
    removed = {
        "body": [{"name": "outer", "remove": True}],
        "hinge_line": [{"name": "middle_line", "remove": True}],
    }
    model = model_of(scene.with_settings(removed).save(tmp_path / "one.toml"), "deployed")
    listed = mode_table(model, normal_modes(model), 3)
    inertia = 1.8 + 8.0 * 0.8**2
    first = listed[0]
    fractions = dict(zip(DIRECTIONS, first.effective_mass_fractions, strict=True))
    assert first.frequency == pytest.approx(sqrt(2000.0 / inertia) / (2.0 * pi), rel=1e-6)
    assert fractions["z"] == pytest.approx(8.0 * 0.8**2 / inertia, rel=1e-6)
    assert fractions["ry"] == pytest.approx(1.0, rel=1e-6)
    assert max(fractions["x"], fractions["y"], fractions["rx"]) < 1e-6
    assert (first.number, first.body, first.share) == (1, "inner", pytest.approx(1.0))


def test_command_prints_json_and_draws(tmp_path, monkeypatch):
    """Interface: one JSON object with the configuration, free motions and modes; pictures where they are asked for."""
    monkeypatch.chdir(tmp_path)
    arguments = ["analyse", "modes", "amos3", "--rigid", "all", "--configuration", "deployed", "--json"]
    result = CliRunner().invoke(main, [*arguments, "--count", "3", "--plot", "shapes", "--shapes", "1"])
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    assert content["free_motions"] == 0
    assert content["latched"] == ["HL1", "HL2", "HL3"]
    assert [mode["mode"] for mode in content["modes"]] == [1, 2, 3]
    assert content["modes"][0]["body"] == "panel2"
    assert (tmp_path / "shapes" / "mode_01.png").stat().st_size > 10_000
    table = CliRunner().invoke(main, arguments[:-1])
    assert "0 rigid-body modes" in table.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--angle", "HL9=1rad"], "'HL9'"),
        (["--angle", "HL1"], "HL1=45deg"),
        (["--angle", "HL1=4m"], "4rad or 4deg"),
        (["--angle", "HL1=45"], "45rad or 45deg"),
        (["--angle", "HL1=nandeg"], "finite"),
        (["--angle", "HL1=1e9deg"], "360deg"),
        (["--angle", "HL1=1deg,HL1=2deg"], "HL1 "),
        (["--latched", ""], "--latched"),
        (["--shapes", "2"], "--shapes"),
        (["--latched", "HL8"], "'HL8'"),
        (["--rigid", "wing"], "'wing'"),
        (["--configuration", "folded"], "stowed"),
    ],
)
def test_command_refuses_with_a_sentence(arguments, words):
    """Interface: exit code 1 or 2 and a sentence, no traceback."""
    result = CliRunner().invoke(main, ["analyse", "modes", "amos3", *arguments])
    assert result.exit_code in (1, 2)
    assert isinstance(result.exception, SystemExit)
    assert words in result.stderr


def test_table_fits_80_columns():
    """Nothing is cut: a hundred percent and the body that moves most are there."""
    arguments = ["analyse", "modes", "amos3", "--rigid", "all", "--count", "12"]
    result = CliRunner().invoke(main, arguments, env={"COLUMNS": "80"})
    assert result.exit_code == 0, result.output
    assert "\u2026" not in result.stdout
    rows = [line.split() for line in result.stdout.splitlines() if line.split() and line.split()[0].isdigit()]
    assert [row[0] for row in rows if len(row) == 11 and row[10].isdigit()] == [f"{k}" for k in range(1, 13)]


@pytest.mark.parametrize(
    ("second", "damping", "close"),
    [(1.09, 0.01, True), (1.11, 0.01, False), (1.11, 0.03, True), (1.16, 0.03, False), (1.0, 0.01, False)],
)
def test_closely_spaced_modes_are_those_of_the_regulatory_guide(second, damping, close):
    """US NRC Regulatory Guide 1.92: within 10 %, or five damping ratios above 2 %; equal ones do not beat."""
    pair = [
        Mode(k, f, damping, (), "", 1.0, {}, coupled_by_damping=False) for k, f in ((1, 1.0), (2, second))
    ]
    found = Modes("", None, "fixed", tuple(pair), 0, (0.0, 0.0), None, None, None)
    assert [(a.number, b.number) for a, b in found.closely_spaced] == ([(1, 2)] if close else [])


FREE = "free = { mass = 40.0, center_of_mass = [-0.5, 0.0, 0.0], inertia = [9.0, 9.0, 9.0] }\n"


def on_free_base(folder):
    """The two rigid panels on spring latches, on ground and on a free spacecraft."""
    fixed = wing(folder, latches=(LATCH, LATCH))
    free = folder / "free.toml"
    free.write_text(
        edited(fixed.read_text(encoding="utf-8"), ("[base]\n", f"[base]\n{FREE}")), encoding="utf-8"
    )
    return fixed, free


def test_a_free_base_is_held_or_swings_with_the_wing(tmp_path):
    """Held it is a ground: frequencies, translational effective masses; free, no mode has momentum."""
    fixed, free = (fanfold.modes(scene, "deployed", count=4) for scene in on_free_base(tmp_path))
    held = fanfold.modes(on_free_base(tmp_path)[1], "deployed", base="held", count=4)
    assert (fixed.base, free.base, held.base) == ("fixed", "free", "held")
    assert (fixed.free_motions, free.free_motions, held.free_motions) == (0, 6, 0)
    assert held.frequencies == pytest.approx(fixed.frequencies, rel=1e-9)
    assert held.damping_ratios == pytest.approx(fixed.damping_ratios, rel=1e-9)
    for ours, grounds in zip(held.listed, fixed.listed, strict=True):
        fractions = ours.effective_mass_fractions[:3], grounds.effective_mass_fractions[:3]
        assert fractions[0] == pytest.approx(fractions[1], abs=1e-9)
    assert free.frequencies[0] > 1.01 * held.frequencies[0]
    assert max(max(mode.effective_mass_fractions) for mode in free.listed) < 1e-9


def test_the_command_says_which_base(tmp_path):
    """Interface: a free base's table has no columns of zeros, and says why; the configuration stands below."""
    _, free = on_free_base(tmp_path)
    shown = {
        base: CliRunner()
        .invoke(main, ["analyse", "modes", str(free), "--configuration", "deployed", "--base", base])
        .stdout
        for base in ("as-built", "held")
    }
    assert "base free" in shown["as-built"]
    assert "--base held" in " ".join(shown["as-built"].split())
    assert "rx" not in shown["as-built"]
    assert "base held" in shown["held"]
    assert "rx" in shown["held"]
    assert all(
        "root_line at " in text and "latched: root_line, middle_line" in text for text in shown.values()
    )
    response = CliRunner().invoke(main, ["analyse", "frequency-response", str(free)]).stdout
    told = " ".join(response.split())
    assert "in z" in told
    assert "prescribed" in told
    assert "--plot FILE" in told


@pytest.mark.parametrize("preload", [1.0, 30.0, 3000.0])
def test_pads_that_are_pressed_a_little_are_as_stiff_as_others(preload):
    """Closed form: bolt and pad beside each other, sqrt((k + K) / m), pressed by 20 nm or 70 um.

    Regression: derivatives over 10 um to both sides had a part of the open pad in them.
    """
    scene = fanfold.Scene("pressed", until="1 s", preload=True)
    base = scene.base(points={"p": (0, 0, 0)})
    rigid = {"mass": 20.0, "inertia": (2, 2, 3), "points": {"p": (0, 0, 0)}}
    block = scene.body("block", place={"body": base, "point": "p"}, rigid=rigid)
    ports = {"inboard": (base, "p"), "outboard": (block, "p")}
    stiffness = {"translational_stiffness": [1e6, 1e6, 1e7], "preload": preload}
    scene.connection("bolt", "hold_down", structure={"axis": (0, 0, 1)}, ports=ports, parameters=stiffness)
    pad = {"reference_force": 3000, "reference_penetration": 1e-4, "exponent": 1}
    scene.connection("pad", "contact", structure={"normal": (0, 0, 1)}, ports=ports, parameters=pad)
    free = {"rotational_stiffness": [1e5] * 3, "translational_stiffness": [0] * 3}
    scene.connection("turns", preset="bushing", axes={"x": (1, 0, 0)}, ports=ports, parameters=free)
    found = 2.0 * np.pi * fanfold.modes(scene).frequencies
    assert np.abs(found - ((1e7 + 3e7) / 20.0) ** 0.5).min() < 1e-3
