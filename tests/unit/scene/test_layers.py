"""Layers of a scene: what it extends, variants, single settings; every mistake a sentence."""

import tomllib
from pathlib import Path

import pytest

from orchestrator.scene import SceneError, find_scene, load_scene, scene_variants
from tests.references.edits import edited

TWO_PANELS = (Path(__file__).parents[2] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
VARIANTS = """
[variant.heavy]
body = [{ name = "inner", rigid.mass = "9 kg" }]
[variant.fast]
scene.until = 1.0
hinge_line = [{ name = "root_line", motor.stowed = "3 N.m" }]
"""


def written(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def problems_of(path, *layers):
    with pytest.raises(SceneError) as caught:
        load_scene(path, *layers)
    return " ".join(caught.value.problems)


def test_a_scene_that_extends_another_changes_only_what_it_names(tmp_path):
    below = written(tmp_path, "below.toml", TWO_PANELS)
    above = written(
        tmp_path,
        "above.toml",
        'extends = "below.toml"\nbody = [{ name = "inner", rigid.mass = "9 kg" }]\n[scene]\nuntil = 3.0\n',
    )
    before, after = load_scene(below), load_scene(above)
    assert after.bodies[0].rigid.mass == 9.0
    assert after.bodies[0].rigid.inertia == before.bodies[0].rigid.inertia
    assert (after.bodies[1], after.hinge_lines, after.base) == (
        before.bodies[1],
        before.hinge_lines,
        before.base,
    )
    assert (after.header.name, after.header.until) == ("two_panels", 3.0)


def test_entries_are_added_and_removed_by_name(tmp_path):
    written(
        tmp_path,
        "below.toml",
        TWO_PANELS + '[[damper]]\nname = "d"\nhinge = "root"\ndamping_coefficient = 1.0\n',
    )
    extra = '[[damper]]\nname = "d"\nremove = true\n[[damper]]\nname = "e"\nhinge = "root"\ndamping_coefficient = 2.0\n'
    scene = load_scene(written(tmp_path, "above.toml", 'extends = "below.toml"\n' + extra))
    assert [(damper.name, damper.damping_coefficient) for damper in scene.dampers] == [("e", 2.0)]


def test_a_mark_of_the_byte_order_is_no_text(tmp_path):
    """As editors of Windows write it. Regression: "invalid statement" in a line that looks right."""
    path = tmp_path / "wing.toml"
    path.write_text(TWO_PANELS, encoding="utf-8-sig")
    assert load_scene(path).header.name == "two_panels"


def test_an_empty_array_takes_all_entries_away(tmp_path):
    """Regression: it was taken for nothing said, so a wing without its dampers kept them."""
    damper = '[[damper]]\nname = "d"\nhinge = "root"\ndamping_coefficient = 1.0\n'
    path = written(tmp_path, "wing.toml", TWO_PANELS + damper + "[variant.bare]\ndamper = []\n")
    assert len(load_scene(path).dampers) == 1
    assert load_scene(path, ("bare",)).dampers == load_scene(path, (), ("damper=[]",)).dampers == ()


def test_variants_lie_over_the_scene_in_order_and_settings_over_them(tmp_path):
    path = written(tmp_path, "wing.toml", TWO_PANELS + VARIANTS)
    assert scene_variants(path) == ("heavy", "fast")
    scene = load_scene(
        path, ("heavy", "fast"), ("scene.until=0.5", "hinge_line.root_line.friction_preload=20 N.mm")
    )
    line = scene.hinge_lines[0]
    assert scene.bodies[0].rigid.mass == 9.0
    assert scene.header.until == 0.5
    assert (line.motor.stowed, line.motor.deployed, line.friction_preload) == (3.0, 1.0, 0.02)
    assert load_scene(path).bodies[0].rigid.mass == 8.0


@pytest.mark.parametrize(
    ("layers", "sentence"),
    [
        ((("cold",),), "'cold'"),
        (((), ("until",)), "'until'"),
        (
            ((), ("body.panel.mass=1",)),
            "'body.panel.mass=1'",
        ),
        (((), ("scene.until=soon",)), "scene.until: is 'soon'; give a number"),
        (((), ("scene.colour=1",)), "scene.colour: is not a known key"),
    ],
)
def test_impossible_layers_are_sentences(tmp_path, layers, sentence):
    assert sentence in problems_of(written(tmp_path, "wing.toml", TWO_PANELS + VARIANTS), *layers)


BAD_VARIANTS = """
[variant.slow]
sene.until = 9.0
[variant.stiff]
hinge_line = [{ name = "HL7", held = true }, { name = "root_line", motor.stowed = "3 kg" }]
[variant.less]
body = [{ name = "outr", remove = true }]
"""


@pytest.mark.parametrize("chosen", [(), ("heavy",), ("slow",)])
def test_every_variant_of_a_file_is_checked_chosen_or_not(tmp_path, chosen):
    text = edited(TWO_PANELS, ("until = 2.0", "until = true"))
    path = written(tmp_path, "wing.toml", text + VARIANTS + BAD_VARIANTS)
    with pytest.raises(SceneError) as caught:
        load_scene(path, chosen)
    starts = (
        "wing.toml: scene.until: is True",
        "wing.toml: variant.slow.sene: is not a known table",
        "wing.toml: variant.stiff.hinge_line.HL7: ",
        "wing.toml: variant.stiff.hinge_line.root_line.motor.stowed: is '3 kg'",
        "wing.toml: variant.less.body.outr: ",
    )
    assert len(caught.value.problems) == len(starts)
    for problem, start in zip(sorted(caught.value.problems), sorted(starts), strict=True):
        assert problem.startswith(start)


def test_an_entry_for_nothing_is_one_problem_and_tells_what_a_new_one_needs(tmp_path):
    written(tmp_path, "below.toml", TWO_PANELS)
    layer = """extends = "below.toml"
body = [{ name = "iner", fixed_interface_modes = 3 }]
hinge_line = [{ name = "root_line", hinges = [{ name = "rot", harness = true }] }]
"""
    found = problems_of(written(tmp_path, "above.toml", layer))
    body, hinge = found.split("above.toml: ")[1:]
    assert body.startswith("body.iner: ")
    assert "inner, outer" in body
    assert hinge.startswith("hinge_line.root_line.hinges.rot: ")
    assert "inboard, outboard" in hinge


def test_a_circle_of_scenes_and_an_unknown_one_are_sentences(tmp_path):
    a = written(tmp_path, "a.toml", 'extends = "b.toml"\n')
    written(tmp_path, "b.toml", 'extends = "a.toml"\n')
    assert "extends: a.toml -> b.toml -> a.toml is a circle" in problems_of(a)
    assert "no file 'nowhere'" in problems_of(written(tmp_path, "c.toml", 'extends = "nowhere"\n'))
    assert "extends: is 3" in problems_of(written(tmp_path, "d.toml", "extends = 3\n"))


def test_a_circle_over_another_folder_is_told(tmp_path):
    """Every turn makes the relative path longer, so paths must be compared by what they mean."""
    a = written(tmp_path, "a.toml", f'extends = "../{tmp_path.name}/a.toml"\n')
    assert "extends: a.toml -> a.toml is a circle" in problems_of(a)


@pytest.mark.parametrize(
    ("extra", "sentence"),
    [
        (
            '[[body]]\nname = "outr"\nremove = true\n',
            "body.outr: ",
        ),
        ('[[body]]\nname = ["inner"]\n', "body[1].name: is ['inner']"),
        (
            '[scene]\nphases = ["one"]\n',
            "above.toml: scene.phases: ",
        ),
    ],
)
def test_a_layer_about_nothing_is_told(tmp_path, extra, sentence):
    written(tmp_path, "below.toml", TWO_PANELS)
    assert sentence in problems_of(written(tmp_path, "above.toml", 'extends = "below.toml"\n' + extra))


def test_a_layer_over_two_entries_of_one_name_is_told(tmp_path):
    twice = edited(TWO_PANELS, ('name = "outer"', 'name = "inner"'), count=1)
    path = written(tmp_path, "wing.toml", twice)
    assert "wing.toml: body: " in problems_of(path, (), ("body.inner.rigid.mass=2",))
    assert "wing.toml: body.inner: " in problems_of(path)


def test_two_entries_of_one_name_in_a_layer_are_told(tmp_path):
    """Regression: they became one entry, without a word."""
    written(tmp_path, "below.toml", TWO_PANELS)
    twice = 2 * '[[body]]\nname = "inner"\n'
    assert "above.toml: body: " in problems_of(
        written(tmp_path, "above.toml", 'extends = "below.toml"\n' + twice)
    )


def test_a_named_scene_can_be_extended(tmp_path):
    scene = load_scene(written(tmp_path, "mine.toml", 'extends = "amos3"\n[scene]\nuntil = 2.0\n'))
    assert [body.name for body in scene.bodies] == [
        body.name for body in load_scene(find_scene("amos3")).bodies
    ]


def test_a_dot_in_the_name_of_an_entry_is_told(tmp_path):
    """It was a KeyError."""
    text = 'extends = "workbench"\n[variant.v]\nhinge_line = [{ name = "H.L", latch.stiffness = 5000 }]\n'
    (tmp_path / "dotted.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=r"hinge_line\.H\.L: .*HL"):
        load_scene(tmp_path / "dotted.toml", ["v"])


def test_values_nested_without_end_are_told(tmp_path):
    """It was a RecursionError."""
    (tmp_path / "deep.toml").write_text(f"x = {'[' * 3000}{']' * 3000}\n", encoding="utf-8")
    with pytest.raises(SceneError, match=r"deep.toml: "):
        load_scene(tmp_path / "deep.toml")


TABLE = {"angle": ["0 deg", "90 deg"], "torque": ["2 N.m", "1 N.m"]}


@pytest.mark.parametrize("laid", [["table", "spring"], ["spring", "table"], ["spring", "table", "spring"]])
def test_the_motor_that_is_laid_last_counts(tmp_path, laid):
    """Definition of layers. Regression: a spring laid over a table did nothing, in variants, settings and studies."""
    spring = {"stowed": "5 N.m", "deployed": "4 N.m"}
    path = written(tmp_path, "wing.toml", TWO_PANELS)
    kinds = {"table": TABLE, "spring": spring}
    settings = [
        (f"hinge_line.root_line.motor.{key}", value) for kind in laid for key, value in kinds[kind].items()
    ]
    line = next(one for one in load_scene(path, (), settings).hinge_lines if one.name == "root_line")
    assert (line.motor.loop is None) == (laid[-1] == "spring")
    assert line.motor.stowed == (5.0 if laid[-1] == "spring" else None)


def test_a_motor_of_both_kinds_is_a_sentence(tmp_path):
    both = (
        'stowed = "1.6 N.m", deployed',
        'angle = [0.0, 1.5], torque = [2, 1], stowed = "1.6 N.m", deployed',
    )
    path = written(tmp_path, "wing.toml", edited(TWO_PANELS, both))
    assert "root_line.motor: is a spring (stowed, deployed) and a table" in problems_of(path)


def test_a_variant_that_changes_what_another_removed_says_so():
    """Regression: a bare entry was read as a new one that lacks its ports."""
    with pytest.raises(SceneError, match="combine") as caught:
        load_scene(find_scene("antenna-unit"), ["diagonal", "revolute"])
    assert len(caught.value.problems) == 1


def test_a_scene_drops_a_variant_of_what_it_extends():
    assert "free" in scene_variants(find_scene("amos3"))
    assert "free" not in scene_variants(find_scene("amos3-ground"))


@pytest.mark.parametrize("name", ["x" * 5000, "a\\u0000b", "/dev/zero", "/"])
def test_names_that_no_file_has_are_sentences(tmp_path, name):
    """Reproduction: OSError of a name of 5000 characters. A device is no file, as reading it never ends."""
    path = written(tmp_path, "above.toml", f'extends = "{name}"\n')
    assert "amos3" in problems_of(path)
    tables = (
        f'[[body]]\nname = "panel"\nimport = {{ stiffness = "{name}", mass = "{name}", coordinates = "{name}" }}',
        f'[[fmu]]\nname = "x"\nfile = "{name}"\nstep = 0.1',
        f'[scene]\nplugins = ["{name}.py"]',
    )
    for table in tables:
        assert problems_of(written(tmp_path, "above.toml", f'extends = "workbench"\n{table}\n'))


def test_a_layer_removes_an_entry_and_writes_it_again(tmp_path):
    """Regression: fewer keys than before were read as a change of what another variant removed."""
    base = written(tmp_path, "wing.toml", TWO_PANELS)
    line = next(one for one in tomllib.loads(TWO_PANELS)["hinge_line"] if one["name"] == "middle_line")
    again = {key: value for key, value in line.items() if key != "motor"}
    settings = [("hinge_line", [{"name": "middle_line", "remove": True}, again])]
    lines = {one.name: one for one in load_scene(base, (), settings).hinge_lines}
    assert lines["middle_line"].motor is None
