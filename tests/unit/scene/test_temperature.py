"""Values from measured columns at the temperature of a scene."""

import pytest

from orchestrator.analysis.sampling.varied import multiplied
from orchestrator.scene import SceneError, load_scene
from orchestrator.scene.builder import Scene
from orchestrator.scene.temperature import at_temperature
from orchestrator.scene.units import kelvin
from tests.unit.scene.scene_cases import TWO_PANELS

COLUMNS = {"temperature": ["-60 C", "213.65 K", "20 C"], "value": ["0.2 N.m", "0.1 N.m", "0.05 N.m"]}
LAYER = """
extends = "base.toml"
scene.name = "thermal"
scene.temperature = "-19.75 C"
friction.coefficient = { temperature = ["-60 C", "20.5 C"], value = [0.2, 0.1] }
[[hinge_line]]
name = "root_line"
friction_preload = { temperature = ["-59.5 C", "20 C"], value = ["0.1 N.m", "0.05 N.m"] }
"""


@pytest.mark.parametrize(
    ("temperature", "torque"),
    [("-60 C", 0.2), ("-59.75 C", 0.15), ("213.65 K", 0.1), ("-19.75 C", 0.075), (293.15, 0.05)],
)
def test_values_are_linear_between_columns(temperature, torque):
    """Definition; a plain number is in K, 0 C is 273.15 K."""
    tree, problems = at_temperature(
        {"scene": {"temperature": temperature}, "a": [{"name": "b", "c": COLUMNS}]}
    )
    assert problems == []
    number, unit = tree["a"][0]["c"].split()
    assert (float(number), unit) == (pytest.approx(torque, rel=1e-12), "N.m")
    lists = {"temperature": [0, 400], "value": [[0, "1 deg"], [4, "5 deg"]]}
    quarter = at_temperature({"scene": {"temperature": 100}, "a": lists})[0]["a"]
    assert quarter == [1.0, "2.0 deg"]
    assert kelvin("20 degC") == 293.15


def test_scenes_have_the_values_of_their_temperature(tmp_path):
    """Halfway between both columns; settings replace columns, or the temperature; a result reads the same tree."""
    (tmp_path / "base.toml").write_text(TWO_PANELS)
    path = tmp_path / "thermal.toml"
    path.write_text(LAYER)
    scene = load_scene(path)
    assert scene.friction.coefficient == pytest.approx(0.15, rel=1e-12)
    lines = {line.name: line for line in scene.hinge_lines}
    assert lines["root_line"].friction_preload == pytest.approx(0.075, rel=1e-12)
    one = load_scene(path, (), ["hinge_line.root_line.friction_preload=0.3", "scene.temperature=-59.5 C"])
    assert {line.name: line for line in one.hinge_lines}["root_line"].friction_preload == 0.3
    built = Scene.load(path).with_settings(
        {"friction.coefficient": {"temperature": [200, 300], "value": [0.3, 0.4]}}
    )
    assert built.check().friction.coefficient == pytest.approx(0.3 + 0.1 * (253.4 - 200) / 100, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("scene.temperature", "60 C", r"friction_preload: .*-59\.5 C to 20 C.*60 C"),
        ("scene.temperature", "60 F", r"scene\.temperature: .*60 F"),
        (
            "friction.coefficient",
            {"temperature": [200, 300], "value": [0.3]},
            r"friction\.coefficient: .*one length",
        ),
        ("friction.coefficient", {"temperature": [300, 200], "value": [0.3, 0.1]}, "increasing"),
        ("friction.coefficient", {"temperature": [200, 300], "value": ["1 %", 0.1]}, "one unit"),
    ],
)
def test_no_value_is_a_sentence(tmp_path, key, value, told):
    (tmp_path / "base.toml").write_text(TWO_PANELS)
    path = tmp_path / "thermal.toml"
    path.write_text(LAYER)
    with pytest.raises(SceneError, match=told):
        load_scene(path, (), [(key, value)])
    path.write_text(LAYER.replace("scene.temperature", "# scene.temperature"))
    with pytest.raises(SceneError, match=r"friction_preload: .*temperature in \[scene\]"):
        load_scene(path)


def test_a_study_multiplies_columns():
    """Their values; the temperature of a sample then chooses between these."""
    (found,) = multiplied({"friction": {"coefficient": COLUMNS}}, ["friction.coefficient"], 2.0).values()
    assert found == {**COLUMNS, "value": ["0.4 N.m", "0.2 N.m", "0.1 N.m"]}
