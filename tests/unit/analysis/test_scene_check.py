"""A scene looked at before its run: what it is made of against the scene's own numbers, problems, the picture."""

import json
import re
from dataclasses import replace
from math import radians

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.cli.main import main
from orchestrator.cli.scene_tables import scene_tables
from orchestrator.messages import code_of
from orchestrator.views.scene_check import apart, draw_scene
from tests.unit.scene.scene_cases import SCENES

WING = SCENES / "four_panels_free.toml"


@pytest.fixture(scope="module")
def checked():
    return fanfold.check_scene("amos3")


def test_bodies_lines_and_loops_are_those_of_the_scene(checked):
    """AMOS-3 data sheet: masses, angles, torques, radii."""
    masses = {body.name: body.mass for body in checked.bodies}
    assert masses == {
        "spacecraft": None, "yoke": pytest.approx(1.8), "panel1": pytest.approx(8.08, abs=0.01),
        "panel2": pytest.approx(7.78, abs=0.01),
    }  # fmt: skip
    first = checked.lines[0]
    assert (first.travel, first.motor, first.latch) == (
        pytest.approx(radians(90)),
        (1.648, 1.048),
        "kinematic",
    )
    assert first.motor_energy == pytest.approx(0.5 * (1.648 + 1.048) * radians(90))
    assert [loop.mismatch for loop in checked.loops] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert checked.connections == {"damper": "eddy_current_damper"}
    assert checked.problems == checked.warnings == ()


def test_a_held_body_is_shown_as_it_runs():
    """Regression: a body that a held line makes one rigid piece with the base was shown as flexible."""
    found = fanfold.check_scene("amos3", settings={"hinge_line.HL1.held": True}, flexible="all")
    assert found.problems == ()
    models = {body.name: body.model for body in found.bodies}
    assert models["yoke"].startswith("rigid")
    assert models["panel1"].startswith("flexible")


def one_panel(**keys):
    """A panel on a fixed base, with further keys of its body."""
    scene = fanfold.Scene("own", until="4 s")
    base = scene.base(points={"left": (0, 0.25, 0), "right": (0, -0.25, 0)})
    panel = scene.body(
        "panel",
        panel={
            "length": 1.1, "width": 0.7, "areal_mass": 3.2, "element_size": 0.2,
            "sandwich": {"skin": 0.2e-3, "core": 0.02, "youngs_modulus": 70e9, "poisson_ratio": 0.3},
            "arm": {"y": 0.25, "length": 0.04, "patch": 0.06}, "hinge_lines": {"inboard": "root"},
        },
        **keys,
    )  # fmt: skip
    scene.hinge_line(
        "L", base, panel, axis="+y", aligned_angle="90 deg",
        hinges={"l": ("left", "root_left"), "r": ("right", "root_right")},
    )  # fmt: skip
    return scene


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"modes_off": [99]}, "panel: .*99"),
        ({"fixed_interface_modes": 10_000}, "panel: .*10000 modes"),
        ({"second_order_modes": 400}, "panel: .*modes"),
    ],
)
def test_what_a_run_refuses_is_told(keys, told):
    """Regression: no problem was found in modes that a body has not, and a run ended at them."""
    (problem,) = fanfold.check_scene(one_panel(**keys)).problems
    assert re.search(told, problem)


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"frequencies_off": [["40 Hz", "20 Hz"]]}, "frequencies_off .*40 .*20 Hz"),
        ({"damping_ratio": 5.0}, "body.panel.damping_ratio: .*5.0.* 1"),
        ({"imported": {}}, "body.panel.imported: .*import"),
    ],
)
def test_keys_that_cannot_be(keys, told):
    """Messages: a band upside down, 5 meant as per cent, and the key of which no other may be told."""
    with pytest.raises(fanfold.FanfoldError, match=told):
        fanfold.check_scene(one_panel(**keys))


def test_a_flexible_body_shows_its_own_mass_and_a_doubt_about_its_twin():
    """Closed form: 3.2 kg/m2 over 1.1 x 0.7 m. Regression: 60 kg were shown, and nothing was told."""
    found = fanfold.check_scene(one_panel(rigid_twin={"mass": 60.0}))
    assert found.bodies[-1].mass == pytest.approx(3.2 * 1.1 * 0.7)
    assert any("W-rigid-twin" in one and "60 kg" in one and "2.464 kg" in one for one in found.warnings)


def test_a_rigid_choice_is_shown():
    """The latch of HL1 is a spring where the yoke is rigid."""
    found = fanfold.check_scene("amos3", rigid="all")
    assert {body.model for body in found.bodies} == {"fixed", "rigid"}
    assert found.lines[0].latch == "spring, 2500 N.m/rad"


def test_the_deployed_wing_is_straight_and_the_stowed_one_a_stack(checked):
    """Geometry of the sheet: a stack in the plane x = 0, then a wing along x; lines are normal to their travel."""
    stowed, deployed = (
        np.concatenate([faces.reshape(-1, 3) for faces in sketch.faces.values()])
        for sketch in (checked.stowed, checked.deployed)
    )
    assert np.ptp(stowed[:, 0]) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(deployed[:, 2]) == pytest.approx(0.0, abs=1e-12)
    assert deployed[:, 0].max() == pytest.approx(4.2, abs=0.2)
    assert set(checked.deployed.axes) == {"HL1", "HL2", "HL3"}
    for ends in checked.deployed.axes.values():
        assert np.ptp(ends, axis=0)[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert checked.deployed.loops["yoke_loop"].shape == (3, 3)
    assert checked.deployed.loops["panel_loop"].shape == (2, 3)


@pytest.mark.parametrize(("variant", "joints", "length"), [((), 0.2, 0.6), ("diagonal", 0.0, 0.51)])
def test_the_deployed_unit_is_where_its_motion_leads(variant, joints, length):
    """Closed form: the top at 99 % of the height 2 L of two links and the spacers, each at asin(0.99)."""
    found = fanfold.check_scene("antenna-unit", variant=variant)
    assert found.warnings == ()
    for sketch, share in ((found.stowed, 0.01), (found.deployed, 0.99)):
        height = share * 2 * length
        assert sketch.frames["top"][0] == pytest.approx((0.5, 0.5, joints + height), abs=1e-9)
        for name, quarter in (("x_lower_1", 0.25), ("x_upper_1", 0.75)):
            origin, axes = sketch.frames[name]
            assert origin[2] == pytest.approx(0.5 * joints + quarter * height, abs=1e-9)
            assert np.hypot(*origin[:2]) == pytest.approx(0.5 * length * np.sqrt(1 - share**2), abs=1e-9)
            assert abs(axes[2, 0]) == pytest.approx(share, abs=1e-9)


def test_a_motion_beyond_the_reach_of_its_links_is_told():
    """Two links of 0.51 m reach 1.02 m: a law to 1.3 m leaves gaps in its loops, told before the run."""
    scene = fanfold.load("antenna-unit", variant="diagonal")
    law = [
        {"profile": "constant", "value": 0.1},
        {"profile": "ramp", "duration": 1.0, "change": 1.2},
    ]
    beyond = scene.with_settings({"connection.motion.structure.law": law})
    (sentence,) = fanfold.check_scene(beyond).warnings
    assert "connection.x_mid_4: " in sentence
    assert "mm" in sentence


def test_problems_are_a_record():
    found = fanfold.check_scene("amos3", settings={"friction.pin_radius": 6})
    (sentence,) = found.problems
    assert sentence.startswith("amos3.toml: friction.pin_radius: ")
    assert "1 m" in sentence
    assert found.bodies == ()
    (sentence,) = fanfold.check_scene("arabsat").problems
    assert "phase1, phase2" in sentence


def test_a_first_wing_on_a_free_spacecraft(tmp_path):
    """Written from the README alone: everything is there, and a latch that is forgotten is told of."""
    found = fanfold.check_scene(WING)
    assert found.warnings == ()
    assert {body.name for body in found.bodies if body.name in found.deployed.faces} == {
        "spacecraft", "panel1", "panel2", "panel3", "panel4",
    }  # fmt: skip
    text = WING.read_text(encoding="utf-8")
    start = text.index("latch", text.index('name = "HL3"'))
    forgotten = tmp_path / "wing.toml"
    forgotten.write_text(text[:start] + text[text.index("\n", start) + 1 :], encoding="utf-8")
    (sentence,) = fanfold.check_scene(forgotten).warnings
    assert sentence.startswith("hinge_line.HL3:")
    assert sentence.endswith("[W-no-end]")


def test_the_picture_has_bodies_lines_loops_ports_and_frames(checked):
    """Every mark of the legend is drawn, in both configurations."""
    from orchestrator.views.scene_check import draw_scene

    figure = draw_scene(checked)
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert {"HL1", "HL2", "HL3"} == {name for text in axes.texts for name in text.get_text().split(", ")}
        marked = 1 + 2 + 3 + 3 * 4  # ports, loops, lines, axes of frames
        assert len(axes.lines) == marked
    assert {"yoke", "cable loop", "port"} <= {text.get_text() for text in figure.legends[0].get_texts()}


def test_the_command_tells_and_draws(tmp_path):
    run = CliRunner().invoke(main, ["check", "amos3", "--output", str(tmp_path)])
    assert run.exit_code == 0, run.output
    assert "travel" in run.output
    assert "amos3: OK" in run.output
    assert (tmp_path / "scene.png").stat().st_size > 10_000
    assert max(map(len, run.output.splitlines())) <= max(80, len(str(tmp_path)) + 12)


def test_the_command_refuses_and_lists_every_problem(tmp_path):
    bad = ["check", "amos3", "--set", "friction.pin_radius=6", "--set", "joint.axial_stifness=1", "--json"]
    run = CliRunner().invoke(main, bad)
    assert run.exit_code == 1
    first, second = json.loads(run.output)["problems"]
    assert "joint.axial_stifness: " in first
    assert "axial_stiffness, " in first
    assert "pin_radius: is 6" in second
    assert CliRunner().invoke(main, ["check", "amos3", "workbench"]).exit_code == 2


def test_scenes_in_phases_are_checked_phase_by_phase():
    run = CliRunner().invoke(main, ["check", "arabsat", "--json"])
    assert run.exit_code == 0, run.output
    runs = json.loads(run.output)["runs"]
    assert set(runs) == {"phase1", "phase2"}
    assert [line["held"] for line in runs["phase1"]["lines"]] == [True] * 5 + [False]


def test_bodies_of_a_folded_stack_are_drawn_apart(checked):
    """Tried by a stranger: of panels in one plane the picture showed the last alone; what lies apart stays."""
    plate = np.array([[[0, 0, 0], [0, 1, 0], [0, 1, 2], [0, 0, 2]]], dtype=float)
    above, near = plate + np.array([0, 0, 3]), plate + np.array([0.01, 0, 0])
    found = apart({"first": plate, "other": above, "second": plate, "third": near})
    assert np.array_equal(found["first"], plate)
    assert np.array_equal(found["other"], above)
    places = [found[name][..., 0].mean() for name in ("first", "second", "third")]
    assert np.diff(places).min() > 0.05
    assert np.array_equal(found["second"][..., 1:], plate[..., 1:])


def test_tables_and_legend_leave_out_what_a_scene_has_not(checked):
    """Tried by a stranger: no empty tables, no mark that is not drawn."""
    bare = replace(
        checked, lines=(), loops=(), stowed=replace(checked.stowed, axes={}, loops={}), deployed=None
    )
    assert len(list(scene_tables(checked))) == len(list(scene_tables(bare))) + 3
    shown = [{text.get_text() for text in draw_scene(one).legends[0].get_texts()} for one in (checked, bare)]
    assert shown[0] - shown[1] == {"hinge line", "cable loop"}


def test_variants_that_are_not_chosen_are_checked():
    """Where runs look only at what they take."""
    scene = fanfold.load("amos3")
    scene.variant("odd", {"friction": {"coefficient": -1.0}})
    assert scene.check().friction.coefficient == 0.1
    (problem,) = fanfold.check_scene(scene).problems
    assert problem.startswith("amos3.toml: variant.odd.friction.coefficient: is -1")


@pytest.mark.parametrize(("rigid", "codes"), [((), []), ("all", ["W-motion-reach"])])
def test_motions_lead_flexible_bodies_farther_than_their_joints(rigid, codes):
    """Rule: a motion that bends a membrane is meant; a rigid one cannot follow."""
    found = fanfold.check_scene("membrane-isolated", rigid=rigid)
    assert [code_of(one) for one in found.warnings] == codes
