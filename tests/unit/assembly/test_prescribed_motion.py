"""Bases and placed bodies that follow laws in scenes: closed forms, statics and modes as of a fixed base, bad input."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.scene.hinge_line_tables import Joint
from orchestrator.scene.table import SceneError

MASS, LENGTH = 2.0, 0.5
STEP = {"profile": "step", "start": 0.05, "duration": 0.2, "change": 0.3}
BODY = {
    "mass": MASS, "inertia": (0.03, 0.04, 0.05), "points": {"root": (0.0, 0.0, 0.0)}, "center_of_mass": (LENGTH, 0, 0),
}  # fmt: skip


def carried(until=0.3, **base):
    """A beam welded to a base by a stiff joint, its centre of mass half a metre out along x."""
    scene = fanfold.Scene("carried", until=until, largest_step=2e-3)
    scene.base(points={"mount": (0.1, 0.0, 0.0)}, **base)
    scene.body("arm", rigid=BODY, place={"body": "base", "point": "mount"})
    ports = {"inboard": {"body": "base", "point": "mount"}, "outboard": {"body": "arm", "point": "root"}}
    scene.connection("weld", "hinge", ports=ports, preset="fixed", axes={"x": (0, 1, 0)})
    return scene


def law(*terms, **keys):
    return {"motion": {"translation": list(terms), "translation_axis": (0, 3, 0), **keys}}


def test_what_hangs_on_a_base_follows_it():
    """Newton: m a at the mount; its moment m a L; work m v^2 / 2; and steps end where the law changes its form."""
    result = fanfold.simulate(carried(**law(STEP)), estimate=False)
    t = np.array(result["base", "shift"].time)
    for instant in (0.05, 0.25):
        assert np.abs(t - instant).min() < 1e-9
    moving = (t > 0.1) & (t < 0.2)
    acceleration = 0.3 / 0.2**2 * (6.0 - 12.0 * (t - 0.05) / 0.2)
    force = result["base", "interface_force"][:][:, 1]
    # the weld rings by what the jump of the law's acceleration, 45 m/s2, leaves: at most as much again
    assert np.abs(force + MASS * acceleration)[moving].max() < MASS * 45.0
    speed = 0.3 / 0.2 * 1.5
    half_way = np.interp(0.15, t, result["base", "supplied_energy"][:])
    assert half_way == pytest.approx(0.5 * MASS * speed**2, rel=1e-2)
    give = 2.0 * MASS * 45.0 / Joint().radial_stiffness
    assert result["arm", "frame_position"][-1] == pytest.approx((0.1, 0.3, 0.0), abs=give)


def test_a_scene_starts_where_the_laws_do():
    """Definition: turned by a right angle about its pivot and shifted, with what is welded to it."""
    turn = [{"profile": "constant", "value": np.pi / 2}]
    shift = {"profile": "constant", "value": 0.2}
    scene = carried(**law(shift, rotation=turn, pivot=(0.1, 0.0, 0.0)))
    result = fanfold.simulate(scene, until=0.01, estimate=False)
    assert result["base", "frame_position"][0] == pytest.approx((0.1, 0.1, 0.0), abs=1e-12)
    assert result["arm", "frame_position"][0] == pytest.approx((0.1, 0.2, 0.0), abs=1e-12)
    assert np.abs(result["base", "interface_force"][:]).max() < 1e-9


def test_modes_and_constraints_are_those_of_a_fixed_base():
    """Definition: modes are about the pose of the start, where what follows a law stands still."""
    held, led = carried(), carried(**law(STEP))
    assert fanfold.modes(led).frequencies == pytest.approx(fanfold.modes(held).frequencies, rel=1e-9)
    found = fanfold.constraints(led)
    assert (found.moving, found.rank, found.freedoms) == (("arm",), 6, 0)


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ({"motion": {"translation_axis": (0, 0, 1)}}, "neither a translation nor a rotation"),
        ({"motion": {"translation": [{"profile": "leap"}]}}, "profile 'leap' is not a known profile"),
        (
            {**law(STEP), "free": {"mass": 5.0, "inertia": (1.0, 1.0, 1.0)}},
            "free .*motion",
        ),
    ],
)
def test_a_motion_that_is_none_is_a_sentence(keys, sentence):
    """Bad input: what is wrong, where."""
    with pytest.raises(SceneError, match=sentence):
        carried(**keys).check()


def test_a_motion_needs_a_place():
    """Bad input: a body that a hinge line carries cannot follow a law."""
    with pytest.raises(SceneError, match=r"body\.top: .*place"):
        carried().body("top", rigid=BODY, **law(STEP))


LINK = {"mass": 2.0, "inertia": (1e-3, 0.04, 0.04), "center_of_mass": (0.25, 0, 0)}
FOLDED = np.radians(20.0)


def dyad(height, middle="revolute"):
    """Two links of half a metre from 20 deg on, whose end a law leads up to a height above their root."""
    scene = fanfold.Scene("dyad", until="200 ms", tolerance=1e-2)
    scene.base(points={"root": (0, 0, 0)})
    x, z = LENGTH * float(np.cos(FOLDED)), LENGTH * float(np.sin(FOLDED))
    points = {"a": (0, 0, 0), "b": (LENGTH, 0, 0)}
    for name, at, way in (("lower", (0, 0, 0), x), ("upper", (x, 0, z), -x)):
        place = {"body": "base", "point": "root", "offset": at, "orientation": {"x": (way, 0, z)}}
        scene.body(name, rigid={**LINK, "points": points}, place=place)
    rise = [{"profile": "step5", "start": 0.02, "duration": 0.16, "change": height - 2.0 * z}]
    top = {"mass": 1.0, "inertia": (0.1, 0.1, 0.1), "points": {"seat": (0, 0, 0)}}
    place = {"body": "base", "point": "root", "offset": (0, 0, 2.0 * z)}
    scene.body("top", rigid=top, place=place, motion={"translation": rise, "translation_axis": (0, 0, 1)})
    ends = (("base", "root", "lower", "a"), ("lower", "b", "upper", "a"), ("upper", "b", "top", "seat"))
    for name, preset, (body, point, other, seat) in zip(
        ("first", "middle", "last"), ("revolute", middle, "revolute"), ends, strict=True
    ):
        ports = {"inboard": {"body": body, "point": point}, "outboard": {"body": other, "point": seat}}
        scene.connection(name, "hinge", ports=ports, preset=preset, axes={"x": (0, 1, 0)})
    return scene


@pytest.mark.parametrize(
    ("keys", "joint"),
    [
        pytest.param({"height": 1.05}, "first", id="beyond a singular position"),
        pytest.param({"height": 0.9, "middle": "fixed"}, "last", id="against a locked joint"),
    ],
)
def test_a_law_that_joints_cannot_follow_is_told(keys, joint):
    """Sentence: which joint opens, by how much and when, and what leads; all rows are kept."""
    with pytest.warns(fanfold.FanfoldWarning, match=rf"{joint} .*\d\d.\d mm .* top .*W-joint-opened") as told:
        result = fanfold.simulate(dyad(**keys), estimate=False)
    assert len([one for one in told if "opened by" in str(one.message)]) == 1
    assert result.time[-1] == pytest.approx(0.2)
    assert np.isfinite(result["scene", "energy_residual"][:]).all()


def test_a_law_that_joints_can_follow_is_not(recwarn):
    """The same within reach, 26 deg short of straight."""
    fanfold.simulate(dyad(0.9), estimate=False)
    assert not [one for one in recwarn if "opened by" in str(one.message)]
