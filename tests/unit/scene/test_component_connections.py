"""[[connection]] tables: any registered component by its own ports, structure and parameters; placed bodies."""

from pathlib import Path

import pytest

from components import Quantity
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import SceneError, load_scene
from orchestrator.scene.component_connections import number_of
from tests.references.edits import edited

TWO_PANELS = (Path(__file__).parents[2] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
DAMPER = """
[[connection]]
name = "brake"
kind = "eddy_current_damper"
structure = { axis = [0.0, 1.0, 0.0] }
ports.inboard = { body = "base", point = "root" }
ports.outboard = { body = "inner", point = "root", offset = ["0 m", "10 mm", "0 m"] }
parameters = { damping_coefficient = "2 N.m.s/deg" }
"""
WEIGHT = """
[[body]]
name = "weight"
place = { body = "inner", point = "tip_left", offset = [0.0, 1.0, 0.0] }
rigid = { mass = 1.0, inertia = [0.1, 0.1, 0.1], points = { eye = [0.0, 0.0, 0.0] } }
"""


def load_text(folder, text):
    path = folder / "wing.toml"
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def test_a_connection_becomes_a_part_with_si_values_and_the_mode_of_the_run(tmp_path):
    assembly = assemble(load_text(tmp_path, TWO_PANELS + DAMPER), wrench_mode="endpoint")
    part = next(part for part in assembly.parts if part.name == "brake")
    assert part.kind == "eddy_current_damper"
    assert part.start["damping_coefficient"] == pytest.approx(2.0 * 180.0 / 3.141592653589793)
    assert tuple(part.structure["axis"]) == (0.0, 1.0, 0.0)
    assert {link.body[0]: link.connection[1] for link in assembly.links if link.connection[0] == "brake"} == {
        "base": "inboard",
        "inner": "outboard",
    }


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_the_wrench_mode_reaches_the_component(tmp_path, mode):
    assembly = assemble(load_text(tmp_path, TWO_PANELS + DAMPER), wrench_mode=mode)
    part = next(part for part in assembly.parts if part.name == "brake")
    assert part.structure["wrench_mode"] == mode


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('kind = "eddy_current_damper"', 'kind = "magnet"', "connection.brake.kind: 'magnet' is not a known component"),
        ('kind = "eddy_current_damper"', 'kind = "body"', "connection.brake.kind: body is a body; it cannot"),
        ("axis = [0.0, 1.0, 0.0]", "axsi = 1", "brake.structure.axsi: "),
        ("axis = [0.0, 1.0, 0.0]", "axis = [0.0, 0.0, 0.0]", "connection.brake.structure: axis"),
        ("axis = [0.0, 1.0, 0.0]", "axis = [0.0, 1.0]", "connection.brake.structure: axis has 2 numbers"),
        ("axis = [0.0, 1.0, 0.0]", 'axis = "+y"', "'+y'"),
        ("axis = [0.0, 1.0, 0.0]", "axis = 3", "connection.brake.structure: eddy_current_damper cannot be"),
        ("ports.outboard", "ports.tip", "connection.brake.ports.outboard: is missing"),
        ("ports.outboard", "ports.tip", "connection.brake.ports.tip: "),
        ("damping_coefficient", "damping", "connection.brake.parameters.damping: is not a known parameter; "),
        ("2 N.m.s/deg", "2 N", "connection.brake.parameters.damping_coefficient: is '2 N'; give a number"),
        ("2 N.m.s/deg", "-2 N.m.s/deg", "'-2 N.m.s/deg'"),
        ('point = "root" }\nports', 'point = "rot" }\nports', "connection.brake.ports.inboard: "),
    ],
)  # fmt: skip
def test_what_a_component_does_not_accept_is_a_sentence_with_its_key(tmp_path, old, new, sentence):
    with pytest.raises(SceneError) as caught:
        load_text(tmp_path, TWO_PANELS + edited(DAMPER, (old, new), count=1))
    assert any(sentence in problem for problem in caught.value.problems), caught.value.problems


CABLE = """
[[connection]]
name = "cable"
kind = "ccl"
structure = { axis = [0.0, 1.0, 0.0], guided = false }
ports.pulley_1 = { body = "base", point = "root" }
ports.pulley_2 = { body = "outer", point = "left" }
parameters = { preload = 1.0, strand_stiffness = 1e3, radius_1 = 0.02, radius_2 = 0.02, cut = true, order = 2 }
"""


def test_booleans_and_whole_numbers_are_such(tmp_path):
    """Definition: true is 1, as FMUs have it; what is neither, or no whole number, is refused with its key."""
    assembly = assemble(load_text(tmp_path, TWO_PANELS + CABLE))
    assert next(part.start["cut"] for part in assembly.parts if part.name == "cable") == 1.0
    for old, new, sentence in (
        ("cut = true", "cut = 0.7", "parameters.cut: is 0.7; it must be true or false"),
        ("order = 2", "order = 2.5", "parameters.order: is 2.5; it must be a whole number"),
        ("guided = false", 'guided = "false"', "structure.guided: is 'false'; it must be true or false"),
    ):
        with pytest.raises(SceneError) as caught:
            load_text(tmp_path, TWO_PANELS + edited(CABLE, (old, new)))
        assert any(f"connection.cable.{sentence}" in problem for problem in caught.value.problems)


@pytest.mark.parametrize("kind", ["load", "contact", "drag", "suspension", "point_motion"])
def test_a_mistyped_key_of_structure_is_a_sentence(tmp_path, kind):
    """Regression: "load cannot be made of {...}: Load.__init__() got an unexpected keyword argument"."""
    text = TWO_PANELS + edited(
        DAMPER, ("axis = [0.0, 1.0, 0.0]", "axsi = 1"), ("eddy_current_damper", kind), count=1
    )
    with pytest.raises(SceneError) as caught:
        load_text(tmp_path, text)
    (problem,) = (one for one in caught.value.problems if "brake.structure" in one)
    assert "connection.brake.structure.axsi: is not a known key" in problem
    assert "__init__" not in problem


def test_a_unit_that_only_the_component_knows_may_stand_behind_a_number():
    """Definition of a plugin's unit. Regression: its own unit was refused, and "a finite number of it" asked for."""
    counted = Quantity("turns", "widget/s", "How many")
    assert number_of(counted, "3 widget/s") == number_of(counted, 3) == 3.0
    with pytest.raises(ValueError, match="widget/s"):
        number_of(counted, "3 m")


def test_a_placed_body_starts_beside_a_point_of_another(tmp_path):
    seat = 'body = "inner", point = "root", offset = ["0 m", "10 mm", "0 m"]'
    rope = edited(DAMPER, ("brake", "rope"), (seat, 'body = "weight", point = "eye"'))
    assembly = assemble(load_text(tmp_path, TWO_PANELS + WEIGHT + rope))
    start = {part.name: part.start for part in assembly.parts}
    at = start["middle_left"]["inboard.position"]
    assert start["weight"]["initial_position"] == pytest.approx((at[0], at[1] + 1.0, at[2]))
    assert start["weight"]["initial_orientation"] == (1.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            'place = { body = "inner"',
            'place = { body = "weight"',
            "body.weight.place.body: ",
        ),
        ('point = "tip_left"', 'point = "tip"', "body.weight.place.point: "),
    ],
)
def test_a_place_that_does_not_exist_is_a_sentence(tmp_path, old, new, sentence):
    with pytest.raises(SceneError) as caught:
        load_text(tmp_path, TWO_PANELS + edited(WEIGHT, (old, new)))
    assert any(sentence in problem for problem in caught.value.problems), caught.value.problems
