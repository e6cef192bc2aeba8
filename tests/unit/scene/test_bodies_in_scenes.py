"""Bodies written into a scene file: panels, frames, changes to the catalogue's, and bodies like others."""

import json
from contextlib import suppress

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.frames import rotate
from orchestrator.scene import SceneError
from orchestrator.scene.bodies import body_definition, body_model
from tests.references import catalogue

PANEL = {
    "length": "1.1 m",
    "width": "700 mm",
    "areal_mass": "3.2 kg/m2",
    "sandwich": {"skin": "0.2 mm", "core": "20 mm", "youngs_modulus": "70 GPa", "poisson_ratio": 0.3},
    "arm": {"y": "0.25 m", "length": "40 mm", "patch": "60 mm", "point_mass": "50 g"},
    "hinge_lines": {"inboard": "root", "outboard": "tip"},
    "element_size": "0.2 m",
}


@pytest.fixture(autouse=True, scope="module")
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def wing(**changes):
    """Two panels on a fixed base, the second like the first."""
    scene = fanfold.Scene("own", until="4 s", tolerance=1e-3)
    base = scene.base(points={"left": (0, 0.25, 0), "right": (0, -0.25, 0)})
    first = scene.body("first", panel=PANEL, fixed_interface_modes=2)
    second = scene.body("second", **{"like": first, "panel": {"hinge_lines": {"outboard": ""}}} | changes)
    ends = {"inner": (base, first, "90 deg"), "outer": (first, second, "180 deg")}
    for line, (a, b, angle) in ends.items():
        points = (
            (("left", "root_left"), ("right", "root_right"))
            if a == base
            else (("tip_left", "root_left"), ("tip_right", "root_right"))
        )
        scene.hinge_line(
            line, a, b,
            axis="+y" if a == base else "-y",
            aligned_angle=angle,
            hinges={f"{line}_{side}": pair for side, pair in zip(("left", "right"), points, strict=True)},
            motor={"stowed": "2 N.m", "deployed": "1.5 N.m"},
            latch={"stiffness": 2000, "outboard_stiffness": 2000, "effective_inertia": 0.8},
        )  # fmt: skip
    return scene


def test_like_another_body():
    """Bookkeeping: the second has what the first has, but for what it says itself."""
    first, second = wing().check().bodies
    assert (second.name, second.fixed_interface_modes, second.like) == ("second", 2, None)
    plates = [body_definition(body).panel.plate for body in (first, second)]
    assert plates[0] == plates[1]
    assert body_definition(second).points == ("root_left", "root_right", "center")
    other = wing(panel={"width": "0.8 m", "hinge_lines": {"outboard": ""}}).check().bodies[1]
    assert body_definition(other).panel.plate.width == 0.8


def test_units_are_those_of_scenes():
    """Two ways: texts with units, and plain numbers in SI units."""
    plate = body_definition(wing().check().bodies[0]).panel.plate
    plain = {
        "length": 1.1,
        "width": 0.7,
        "areal_mass": 3.2,
        "hinge_lines": {"inboard": "a"},
        "arm": {"y": 0.25},
    }
    plain["sandwich"] = {"skin": 0.2e-3, "core": 0.02, "youngs_modulus": 70e9, "poisson_ratio": 0.3}
    other = catalogue.built({"panel": plain}).panel.plate
    np.testing.assert_allclose([plate.bending, plate.membrane], [other.bending, other.membrane], rtol=1e-12)
    assert (plate.length, plate.areal_mass) == (other.length, other.areal_mass)
    assert plate.width == pytest.approx(other.width, rel=1e-15)


def test_catalogue_with_changes():
    """Bookkeeping: a change to an entry of the catalogue leaves the rest of it, and the entry, as they are."""
    entry = catalogue.entry("amos3_panel1")
    changed = catalogue.built({"catalogue": "amos3_panel1", "panel": {"width": "1.3 m"}})
    assert changed.panel.plate.width == 1.3
    assert changed.panel.plate.bending == entry.panel.plate.bending
    assert changed.twin == entry.twin
    assert catalogue.entry("amos3_panel1").panel.plate.width == 1.16


def test_runs_in_all_fidelities_and_has_stresses(tmp_path):
    """A wing of one's own, from its file: latches rigid and flexible, twins agree, and its result has stresses."""
    path = wing().save(tmp_path / "own.toml")
    rigid = fanfold.simulate(path, rigid="all", estimate=False)
    mixed = fanfold.simulate(path, rigid="second", estimate=False, save=tmp_path / "own.h5")
    assert set(rigid.latch_times) == {"inner", "outer"}
    for line, time in rigid.latch_times.items():
        assert mixed.latch_times[line] == pytest.approx(time, rel=0.1)
    found = fanfold.stress(tmp_path / "own.h5", "first")
    assert found is not None
    for body in fanfold.load(path).check().bodies:
        stiff, soft = body_model(body, flexible=False), body_model(body, flexible=True)
        assert soft.frequency.size == 2 + 6 * len(body_definition(body).attachment_points) - 6
        assert stiff.mass == pytest.approx(soft.mass, rel=1e-12)
        np.testing.assert_allclose(stiff.inertia, soft.inertia, atol=1e-11)


def test_settings_reach_into_tables():
    """Bookkeeping: a value of a table can be set and varied, and bodies that are like it follow."""
    scene = wing().with_settings({"body.first.panel.sandwich.skin": "0.4 mm"})
    for body in scene.check().bodies:
        assert body_definition(body).face_sheets.per_force == pytest.approx(1 / 0.8e-3)


BAD = {
    "unit": (
        {"panel": {"length": "1.1 kg"}},
        "body.second.panel.length: is '1.1 kg'; give a number, a space and",
    ),
    "key": (
        {"panel": {"lenght": 1}},
        "body.second.panel.lenght: ",
    ),
    "patch": (
        {"panel": {"arm": {"y": 0.5}}},
        "body.second.panel: ",
    ),
    "unknown": ({"like": "third"}, "body.second.like: "),
    "circle": ({"like": "second"}, "body.second.like: second -> second is a circle"),
    "no table": ({"panel": 3}, "body.second.panel: is 3"),
    "two sources": ({"rigid": {"mass": 1, "inertia": [1, 1, 1], "points": {}}}, "body.second: give either a"),
    "unknown entry": ({"catalogue": "moon"}, "entry 'moon'"),
    "no point": (
        {"attached_masses": [{"point": "top", "mass": 1}]},
        "attached to 'top'",
    ),
    "twin": (
        {"rigid_twin": {"mass": "-1 kg"}},
        "body.second.rigid_twin.mass: ",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_impossible_tables(kind):
    """Messages: what is wrong with a body, with file and key."""
    changes, told = BAD[kind]
    with pytest.raises(SceneError) as caught:
        wing(**changes).check()
    assert any(told in problem for problem in caught.value.problems), caught.value.problems


@pytest.mark.parametrize("seed", range(40))
def test_no_table_ends_in_a_traceback(seed):
    """Random damage to a table: a body, or sentences; never another exception."""
    dice = np.random.default_rng(seed)
    table = json.loads(json.dumps(PANEL))
    values = [-1, 0, 1e9, "x", "1 kg", True, [], {}, [1, 2], {"a": 1}, "3 m", 1e-9, float("nan"), None]
    for _ in range(dice.integers(1, 4)):
        inner = table
        while True:
            key = str(dice.choice(list(inner)))
            if not isinstance(inner[key], dict) or not inner[key] or dice.random() < 0.3:
                break
            inner = inner[key]
        value = values[dice.integers(len(values))]
        if value is None:
            del inner[key]
        else:
            inner[key] = value
    with suppress(fanfold.FanfoldError):
        assert catalogue.built({"panel": table}).points


def test_a_circle_is_not_followed_by_what_its_bodies_lack():
    """Tried by a stranger: what is missing follows from the circle and says nothing."""
    scene = fanfold.Scene("circle", until="1 s")
    scene.base(points={"root": (0, 0, 0)})
    scene.body("first", panel=PANEL)
    scene.variant(
        "round", {"body": [{"name": "second", "like": "third"}, {"name": "third", "like": "second"}]}
    )
    with pytest.raises(SceneError) as refused:
        scene.check()
    told = [
        problem for problem in refused.value.problems if "body.second" in problem or "body.third" in problem
    ]
    assert len(told) == 2
    assert all("is a circle" in problem for problem in told)


def test_hinge_lines_off_the_mid_plane_give_a_stowed_stack_its_thickness():
    """Geometry: folded about an axis 15 mm off both mid-planes these are 30 mm apart, deployed in one plane."""
    scene = fanfold.Scene("stack", until="1 s")
    base = scene.base(points={"left": (0, 0.4, 0), "right": (0, -0.4, 0)})
    panel = {
        "length": "1 m", "width": "1 m", "areal_mass": "3 kg/m2", "arm": {"y": "0.4 m", "length": "40 mm"},
        "sandwich": {"skin": "0.2 mm", "core": "20 mm", "youngs_modulus": "70 GPa", "poisson_ratio": 0.3},
    }  # fmt: skip
    inner = {
        "hinge_lines": {"inboard": "hl1", "outboard": "hl2"},
        "hinge_line_offsets": {"outboard": "15 mm"},
    }
    outer = {"hinge_lines": {"inboard": "hl2"}, "hinge_line_offsets": {"inboard": "15 mm"}}
    bodies = [scene.body(name, panel=panel | more) for name, more in (("panel1", inner), ("panel2", outer))]
    for name, body, to, ends in (
        ("HL1", base, bodies[0], ("left", "hl1_left")),
        ("HL2", bodies[0], bodies[1], ("hl2_left", "hl2_left")),
    ):
        scene.hinge_line(
            name,
            body,
            to,
            axis="+y",
            aligned_angle="180 deg",
            stowed_angle="0 deg",
            hinges={f"{name}_1": ends},
        )
    for angle, apart in ((0.0, 0.03), (np.pi, 0.0)):
        found = scene.with_settings({"hinge_line.HL2.start_angle": f"{np.degrees(angle)} deg"}).check()
        poses = found.poses
        one, other = (poses[name] for name in bodies)
        normal = rotate(one.orientation, (0.0, 0.0, 1.0))
        assert abs(np.dot(np.subtract(other.position, one.position), normal)) == pytest.approx(
            apart, abs=1e-12
        )
