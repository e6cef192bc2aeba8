"""Scenes made in code: the tree is that of a scene file, and a scene saved and read is the same scene."""

from __future__ import annotations

import inspect
import re
import tomllib

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.frames import Vector3
from orchestrator.scene import SceneError, list_scenes
from orchestrator.scene.body_tables import Body
from orchestrator.scene.connection_tables import Ccl, Connection, Damper
from orchestrator.scene.hinge_line_tables import Friction, Hinge, HingeLine, Joint
from tests.unit.scene.scene_cases import SCENES

ORIGIN: Vector3 = (0.0, 0.0, 0.0)


def full():
    """One table of every kind, with NumPy's numbers and arrays among the values."""
    scene = fanfold.Scene(
        "full", until="2 s", gravity=np.array([0.0, 0.0, -9.81]), tolerance=np.float64(1e-3)
    )
    base = scene.base("craft", points={"root": np.zeros(3), "far": (5.0, 0.0, 0.0)})
    panel = scene.body(
        "panel",
        rigid={
            "mass": "4 kg",
            "center_of_mass": (0.5, 0.0, 0.0),
            "inertia": [0.4, 1.6, 2.0],
            "points": {"edge": ORIGIN, "tip": (1.0, 0.0, 0.0)},
        },
    )
    scene.hinge_line(
        "root_line", base, panel, axis="-y", aligned_angle="90 deg",
        motor={"stowed": "2 N.m", "deployed": "1 N.m"},
        latch={"stiffness": 200, "effective_inertia": "1.5 kg.m2"},
        hinges={"root_hinge": ("root", "edge")},
    )  # fmt: skip
    scene.damper("brake", "root_hinge", damping_coefficient=2)
    scene.connection(
        "stop", "contact", structure={"normal": (1.0, 0.0, 0.0)},
        ports={"inboard": {"body": base, "point": "far"}, "outboard": {"body": panel, "point": "tip"}},
        parameters={"gap": "-6 m", "reference_penetration": "1 mm"},
    )  # fmt: skip
    scene.joint(damping_ratio=0.02)
    scene.friction(coefficient=np.float64(0.1))
    scene.structural_damping("0.5 %", reference_frequency=1.5)
    scene.variant("cold", {"friction": {"coefficient": 0.15}})
    return scene


def test_presets_are_joints_of_their_kind():
    """Rule: as in files, a distance is held by a spring and every other joint is a hinge."""
    scene = fanfold.Scene("rods", until=1)
    base = scene.base(points={"root": ORIGIN, "far": (2.0, 0.0, 0.0)})
    for preset, parameters in (("distance", {"preload_length": "2 m"}), ("spherical", {})):
        rigid = {"mass": 1, "center_of_mass": ORIGIN, "inertia": (1, 1, 1), "points": {"end": ORIGIN}}
        body = scene.body(f"of_{preset}", rigid=rigid, place={"body": base, "point": "far"})
        ports = {"inboard": (base, "root" if parameters else "far"), "outboard": (body, "end")}
        scene.connection(preset, preset=preset, ports=ports, parameters=parameters)
    assert [one.kind for one in scene.check().connections] == ["spring", "hinge"]


def test_a_scene_is_checked_again_only_after_a_change():
    """Bookkeeping: the same records until something is laid over it or added, which never reaches records told of."""
    scene = full()
    checked = scene.check()
    assert scene.check() is scene.with_variants().with_settings({}).check() is checked
    assert scene.with_variants("cold").check().friction.coefficient == 0.15
    assert scene.with_settings({"friction.coefficient": 0.2}).check().friction.coefficient == 0.2
    scene.friction(coefficient=0.3)
    assert scene.check().friction.coefficient == 0.3
    scene.variant("wrong", {"friction": {"coefficient": -1.0}})
    assert scene.check().friction.coefficient == 0.3  # what is not chosen is not looked at
    (problem,) = scene.variant_problems()
    assert "variant.wrong.friction.coefficient" in problem
    with pytest.raises(SceneError, match=r"variant\.wrong\.friction\.coefficient"):
        scene.with_variants("wrong").check()
    scene.variant("wrong", {})
    assert scene.variant_problems() == []
    scene.damper("second", "root_hinge", damping_coefficient=1)
    assert [damper.name for damper in scene.check().dampers] == ["brake", "second"]
    assert (checked.friction.coefficient, len(checked.dampers), len(checked.tree["damper"])) == (0.1, 1, 1)


def test_the_tree_is_that_of_a_file(tmp_path):
    """Round trip: what is written is read as the same tree, and checked as the same scene."""
    scene = full()
    scene.check()
    path = scene.save(tmp_path / "full.toml")
    read = tomllib.loads(path.read_text(encoding="utf-8"))
    variants = read.pop("variant")
    assert read == scene.tree
    assert variants == {"cold": {"friction": {"coefficient": 0.15}}}
    assert fanfold.load(path) == scene
    mine, theirs = scene.check(), fanfold.load(path).check()
    assert all(
        getattr(mine, name) == getattr(theirs, name) for name in mine.__dataclass_fields__ if name != "file"
    )


@pytest.mark.parametrize("name", list_scenes())
def test_scenes_that_come_with_fanfold_survive_the_way(name, tmp_path):
    """Round trip: loaded, saved and loaded, under every variant."""
    scene = fanfold.load(name)
    again = fanfold.load(scene.save(tmp_path / f"{name}.toml"))
    assert again == scene
    for variant in scene.variants:
        assert again.with_variants(variant).tree == scene.with_variants(variant).tree
        chosen = scene.with_variants(variant).tree
        chosen["scene"].pop("phases", None)
        assert fanfold.load(scene.with_variants(variant).save(tmp_path / "chosen.toml")).tree == chosen


def test_a_hand_written_file_and_code_are_one():
    """The shipped workbench, once more in code."""
    wing = fanfold.Scene(
        "workbench", description="single panel on a latch-up workbench (Bagnoli 2007, chapter 3)",
        until="5.3 s", tolerance=1e-4, largest_step="20 ms",
    )  # fmt: skip
    points = {"hl_left": ["0 m", "0.565 m", "0 m"], "hl_right": ["0 m", "-0.565 m", "0 m"]}
    table = wing.base("workbench_table", points=points)
    panel = wing.body("panel", catalogue="workbench_panel", fixed_interface_modes=10)
    stiffness = {"axial": "2e6 N/m", "radial": "5e6 N/m", "cross": "2e4 N.m/rad"}
    wing.joint(**{f"{way}_stiffness": value for way, value in stiffness.items()})
    wing.hinge_line(
        "HL", table, panel, axis="+y", aligned_angle="180 deg",
        motor={"stowed": "2.304 N.m", "deployed": "1.434 N.m"},
        latch={
            "stiffness": "4147.8 N.m/rad", "outboard_stiffness": "4147.8 N.m/rad",
            "effective_inertia": "6.2514 kg.m2",
        },
        hinges={
            "hinge_left": {"inboard": "hl_left", "outboard": "hl_left", "kind": "revolute"},
            "hinge_right": {"inboard": "hl_right", "outboard": "hl_right", "kind": "cylindrical"},
        },
    )  # fmt: skip
    flexible = {"scene": {"description": "single panel, flexible hinges"}}
    line = {"name": "HL", "latch": {"stiffness": "1720.2 N.m/rad"}}
    wing.variant("semi_flexible", {**flexible, "hinge_line": [line]})
    assert wing == fanfold.load("workbench")


def test_settings_and_variants_lie_over_what_is_built():
    scene = full()
    cold = scene.with_variants("cold")
    assert scene.tree["friction"]["coefficient"] == 0.1
    assert cold.tree["friction"]["coefficient"] == 0.15
    assert cold.chosen == ("cold",)
    warm = cold.with_settings({"friction.coefficient": np.float64(0.05), "hinge_line.root_line.held": True})
    assert warm.tree["friction"]["coefficient"] == 0.05
    assert warm.tree["hinge_line"][0]["held"] is True
    assert fanfold.load(full(), "cold", {"scene.until": "3 s"}).check().header.until == 3.0
    copy = scene.copy()
    copy.body("more", rigid=scene.tree["body"][0]["rigid"], place={"body": "craft", "point": "far"})
    assert (scene.bodies, copy.bodies) == (("panel",), ("panel", "more"))
    assert scene != copy


@pytest.mark.parametrize(
    ("act", "sentence"),
    [
        (lambda s: s.body("door", mas=3), "full: body.door.mas: is not a known key"),
        (lambda s: s.body("door", catalogue="x", fidelity="soft"), "full: body.door.fidelity: is 'soft'"),
        (lambda s: s.body("door", catalogue=object()), "full: body.door.catalogue: is <object"),
        (
            lambda s: s.base(points={"a": (0, 0)}),
            "full: base.points.a: ",
        ),
        (lambda s: s.damper("brake", "hinge"), "full: damper.brake.damping_coefficient: is missing"),
        (
            lambda s: s.friction(coefficient=-1),
            "full: friction.coefficient: ",
        ),
        (lambda s: s.with_variants("hot"), "'hot'"),
        (lambda s: fanfold.Scene("a b", until=1.0), "a b: scene.name: "),
        (
            lambda s: fanfold.Scene("a", until="1 m"),
            "a: scene.until: ",
        ),
    ],
)
def test_mistakes_are_told_where_they_are_made(act, sentence):
    scene = full()
    before = scene.tree
    with pytest.raises(SceneError) as caught:
        act(scene)
    assert sentence in str(caught.value)
    assert scene.tree == before


def test_what_tables_say_about_each_other_is_told_by_the_check():
    scene = full()
    scene.damper("other", "no_hinge", damping_coefficient=1)
    scene.variant("odd", {"friction": {"coefficient": -1}})
    with pytest.raises(SceneError) as caught:
        scene.check()
    assert "full: damper.other.hinge: " in caught.value.problems[0]
    assert "full: variant.odd.friction.coefficient: is -1" in caught.value.problems[-1]


TABLES = {"body": (Body,), "hinge_line": (HingeLine, Hinge), "ccl": (Ccl,), "damper": (Damper,),
          "connection": (Connection,), "joint": (Joint,), "friction": (Friction,)}  # fmt: skip


@pytest.mark.parametrize("method", TABLES)
def test_help_names_every_key(method):
    """Completeness: `help` of a method names every key of its table."""
    function = getattr(fanfold.Scene, method)
    told = set(re.findall(r"\w+", f"{inspect.signature(function)} {function.__doc__}"))
    keys = {field.alias or key for table in TABLES[method] for key, field in table.model_fields.items()}
    assert keys <= told


def test_a_scene_shows_what_it_is():
    assert repr(fanfold.load("amos3", "cold")).startswith(
        "<Scene amos3.cold: bodies yoke, panel1, panel2; hinge lines HL1, HL2, HL3; variants cold, "
    )
    assert repr(fanfold.Scene("bare", until=1.0)) == "<Scene bare: empty>"
    assert fanfold.load(SCENES / "two_panels.toml").hinge_lines == ("root_line", "middle_line")


def test_hinges_may_be_the_tables_of_a_scene_file():
    """Tried by a stranger: a list as scene files have it is the same as hinges by name; anything else is told."""
    by_name, listed = full(), fanfold.Scene("full", until="2 s")
    listed.base("craft", points={"root": ORIGIN})
    keys = {"axis": "-y", "aligned_angle": "90 deg", "inboard": "craft", "outboard": "panel"}
    entry = {"name": "root_hinge", "inboard": "root", "outboard": "edge"}
    listed.hinge_line("root_line", hinges=[entry], **keys)
    assert listed.tree["hinge_line"][0]["hinges"] == by_name.tree["hinge_line"][0]["hinges"]
    with pytest.raises(SceneError, match=r"hinge_line\.other\.hinges"):
        listed.hinge_line("other", hinges=["root_hinge"], **keys)


def test_none_is_not_given():
    """A panel with a damper or without, by one argument."""
    scenes = []
    for keys in ({}, {"tolerance": None}):
        scene = fanfold.Scene("wing", until=1.0, **keys)
        scene.base(points={"root": (0, 0, 0)}, free=None)
        scenes.append(scene.tree)
    assert scenes[0] == scenes[1]


def test_a_result_is_no_scene_and_points_are_one_or_two(tmp_path):
    """Sentences, for what people confuse."""
    path = tmp_path / "wing.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(8))
    with pytest.raises(SceneError, match=r"wing.h5: is a result, not a scene; use `fanfold plot`"):
        fanfold.Scene.load(path)
    scene = fanfold.Scene("two", until=1)
    with pytest.raises(SceneError, match="'a', 'b', 'c'"):
        scene.hinge_line(
            "line", "base", "body", axis="+y", aligned_angle="0 rad", hinges={"hinge": ("a", "b", "c")}
        )


def test_settings_and_results_that_are_none():
    """Messages. Regression: Python's own errors."""
    with pytest.raises(fanfold.FanfoldError, match="the setting 1 is neither"):
        fanfold.load("workbench", settings=[1])
    with pytest.raises(fanfold.FanfoldError, match="3 is no"):
        fanfold.compare(3, 3)
