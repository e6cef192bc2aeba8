"""Loops closed before the start, arrays, orientations, joint presets; what cannot be is told."""

import pickle
import tomllib
from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest

from components.contract.frames import rotate
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import SceneError, find_scene, load_scene
from orchestrator.scene.reader import read_scene
from orchestrator.scene.table import Orientation
from tests.references.edits import edited

RIGID = (
    'rigid = {{ mass = "1 kg", inertia = [0.1, 0.1, 0.1], points = {{ a = [{a}, 0, 0], b = [{b}, 0, 0] }} }}'
)
FOUR_BAR = (
    """
[scene]
name = "four_bar"
until = "1 s"
[base]
name = "ground"
points = { left = [0, 0, 0], right = [2, 0, 0] }
[[body]]
name = "crank"
place = { body = "ground", point = "left", orientation = { x = [0.1, 0, 1], z = [1, 0, 0] } }
"""
    + RIGID.format(a=0, b=1)
    + """
[[body]]
name = "coupler"
place = { body = "ground", point = "left", offset = [0.11, 0, 0.98], orientation = { x = [1, 0, 0.3] } }
"""
    + RIGID.format(a=0, b=1.8)
    + """
[[body]]
name = "rocker"
place = { body = "ground", point = "right", orientation = { x = [0, 0, 1], z = [1, 0, 0] } }
"""
    + RIGID.format(a=0, b=1.5)
    + "".join(
        f"""
[[connection]]
name = "{name}"
preset = "revolute"
axes = {{ x = [0, 1, 0] }}
ports = {{ inboard = {{ body = "{i}", point = "{p}" }}, outboard = {{ body = "{o}", point = "{q}" }} }}
"""
        for name, i, p, o, q in (
            ("first", "ground", "left", "crank", "a"),
            ("second", "crank", "b", "coupler", "a"),
            ("third", "coupler", "b", "rocker", "b"),
            ("fourth", "ground", "right", "rocker", "a"),
        )
    )
)


def scene_of(text):
    return read_scene("test.toml", tomllib.loads(text))


def tip(poses, body, x):
    pose = poses[body]
    return np.add(pose.position, rotate(pose.orientation, (x, 0.0, 0.0)))


RAISED = """
[scene]
name = "raised"
until = "1 s"
[base]
name = "ground"
points = { middle = [0, 0, 0] }
[[body]]
name = "lower"
place = { body = "ground", point = "middle" }
rigid = { mass = "4 kg", inertia = [0.3, 0.3, 0.6], points = { edge = [-0.5, 0, 0], middle = [0, 0, 0] } }
[[body]]
name = "upper"
place = { body = "ground", point = "middle", offset = [-0.5, 0, 0] }
rigid = { mass = "1 kg", center_of_mass = [0.5, 0, 0], inertia = [0.1, 0.1, 0.2], points = { edge = [0, 0, 0] } }
[[connection]]
name = "on_it"
preset = "fixed"
ports = { inboard = { body = "lower", point = "edge" }, outboard = { body = "upper", point = "edge" } }
[[connection]]
name = "motion"
kind = "point_motion"
ports = { inboard = { body = "ground", point = "middle" }, outboard = { body = "lower", point = "middle" } }
structure.law = [{ profile = "constant", value = 0.01 }]
"""


def test_what_a_motion_raises_by_its_centre_of_mass_stays_level():
    """By hand: both rise by 10 mm, though one has its origin at its edge."""
    scene = scene_of(RAISED)
    poses = scene.poses
    for name, x in (("lower", 0.0), ("upper", -0.5)):
        assert poses[name].position == pytest.approx((x, 0.0, 0.01), abs=1e-12)
        assert poses[name].orientation == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-12)


def test_a_four_bar_written_roughly_is_closed():
    """Freudenstein's closed form: the coupler's ends meet crank and rocker, links keep their lengths and plane."""
    scene = scene_of(FOUR_BAR)
    poses = scene.poses
    for one, x, other, y in (
        ("crank", 1, "coupler", 0),
        ("coupler", 1.8, "rocker", 1.5),
    ):
        assert tip(poses, one, x) == pytest.approx(tip(poses, other, y), abs=1e-11)
    crank, rocker = tip(poses, "crank", 1.0), tip(poses, "rocker", 1.5) - (2.0, 0.0, 0.0)
    a, b = np.arctan2(crank[2], crank[0]), np.arctan2(rocker[2], rocker[0])
    assert abs(crank[1]) + abs(rocker[1]) < 1e-12
    # r1 = 2, r2 = 1, r3 = 1.8, r4 = 1.5: |(2, 0) + r4 e(b) - r2 e(a)| = r3
    left = (2 + 1.5 * cos(b) - cos(a)) ** 2 + (1.5 * sin(b) - sin(a)) ** 2
    assert left == pytest.approx(1.8**2, abs=1e-11)
    assert sqrt(crank @ crank) == pytest.approx(1.0, abs=1e-12)


def test_closing_changes_little_where_little_is_open():
    """The least displacement is below what is open times the condition of a four-bar far from its dead points."""
    scene = scene_of(FOUR_BAR)
    found = scene.closed
    moves = [
        np.subtract(found.poses[name].position, pose.position) for name, pose in scene.written_poses.items()
    ]
    assert 0.0 < np.abs(moves).max() < 0.4
    assert found.open_by == {}


def test_a_loop_that_cannot_close_names_connection_and_gap():
    with pytest.raises(SceneError, match=r"connection\.\w+: .* [\d.]+ mm"):
        scene_of(FOUR_BAR.replace("b = [1.8, 0, 0]", "b = [5, 0, 0]"))


@pytest.mark.parametrize("end", ["axes = { x = [0, 1, 0] }", "axes = { x = [0, 1, 0], z = [1, 0, 0] }"])
def test_ports_are_parallel_where_axes_are_written(end):
    """Both ports of a joint have the axes that its connection says, in poses as written."""
    parts = assemble(scene_of(FOUR_BAR.replace("axes = { x = [0, 1, 0] }", end)))
    hinge = next(part for part in parts.parts if part.name == "first")
    inboard, outboard = hinge.start["inboard.orientation"], hinge.start["outboard.orientation"]
    # the crank starts turned by what closing did, about y alone
    relative = np.abs(np.dot(inboard, outboard))
    assert relative > cos(radians(10))
    assert rotate(tuple(inboard), (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    assert rotate(tuple(outboard), (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("x", [(1, 0, 0), (-1, 0, 0), (1, 2, 3), (0, -1, 0.2)])
def test_orientations(x):
    """X lies along x, z in the plane of both, and the axes are right-handed."""
    z = (0.3, -0.2, 1.0)
    q = Orientation(x=list(x), z=list(z)).quaternion
    found = [np.array(rotate(q, axis)) for axis in np.eye(3).tolist()]
    assert found[0] == pytest.approx(np.array(x) / np.linalg.norm(x), abs=1e-15)
    assert np.cross(found[0], found[1]) == pytest.approx(found[2], abs=1e-15)
    assert found[1] @ np.array(z) == pytest.approx(0.0, abs=1e-15)
    assert found[2] @ np.array(z) > 0.0


RING = """
[scene]
name = "ring"
until = "1 s"
[base]
name = "hub"
points = { centre = [0, 0, 0] }
[[array]]
name = "spokes"
count = 3
axis = "+z"
[[array.body]]
name = "spoke_{i}"
place = { body = "hub", point = "centre", offset = ["500 mm", 0, 0] }
rigid = { mass = "1 kg", inertia = [0.1, 0.1, 0.1], points = { tip = [0.5, 0, 0] } }
[[array.connection]]
name = "tie_{i}"
kind = "suspension"
ports = { upper = { body = "spoke_{i}", point = "tip" }, lower = { body = "spoke_{next}", point = "tip" } }
"""


def test_an_array_goes_around():
    scene = scene_of(RING)
    poses = scene.poses
    for i in range(3):
        angle = 2 * pi * i / 3
        assert tip(poses, f"spoke_{i + 1}", 0.5) == pytest.approx((cos(angle), sin(angle), 0.0), abs=1e-12)
    assert [c.ports["lower"].body for c in scene.connections] == ["spoke_2", "spoke_3", "spoke_1"]


def test_motions_of_an_array_go_around():
    """Regression: places were turned and the axes of motions were not, so that spokes went different ways."""
    law = 'motion = { translation = [{ profile = "step5", duration = 1, change = 0.1 }] }'
    scene = scene_of(RING.replace("rigid =", f"{law}\nrigid ="))
    for i, body in enumerate(scene.bodies):
        angle = 2 * pi * i / 3
        assert body.motion.translation_axis == pytest.approx((cos(angle), sin(angle), 0.0), abs=1e-12)
        assert body.motion.rotation_axis == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("count = 3", "count = 0", "array.spokes.count: "),
        ("count = 3", "cuont = 3", "count"),
        ('axis = "+z"', "axis = [0, 0, 0]", "array.spokes.axis"),
    ],
)
def test_what_is_no_array_is_told(old, new, words):
    with pytest.raises(SceneError, match=words):
        scene_of(RING.replace(old, new))


def test_an_orientation_without_two_directions_is_told():
    with pytest.raises(SceneError, match="orientation: x and z"):
        scene_of(FOUR_BAR.replace("z = [1, 0, 0]", "z = [0.1, 0, 1]"))


@pytest.mark.parametrize(
    ("damping", "time"),
    [
        ('structural_damping = { ratio = "0.5 %", reference_frequency = "1.5 Hz" }\n', 0.005 / (pi * 1.5)),
        ('joint = { damping_ratio = "2 %", damping_frequency = "10 Hz" }\n', 0.02 / (pi * 10.0)),
    ],
)
def test_a_joints_own_stiffness_is_damped_in_proportion(damping, time):
    """By hand: 2 zeta K / omega, of what is given as of what is not."""
    own = 'preset = "fixed"\nparameters.rotational_stiffness = ["200 N.m/rad", 0, "2 N.m/deg"]'
    text = damping + edited(
        RAISED, ('preset = "fixed"', own), ("structure.law", "[connection.structure]\nlaw")
    )
    (joint,) = [part for part in assemble(scene_of(text)).parts if part.name == "on_it"]
    stiffness = [200.0, 0.0, 360.0 / pi]
    assert joint.start["rotational_stiffness"] == pytest.approx(stiffness)
    assert joint.start["rotational_damping"] == pytest.approx([time * k for k in stiffness])
    linear = np.array(joint.start["translational_stiffness"])
    assert np.allclose(joint.start["translational_damping"], time * linear)


def test_where_bodies_start_belongs_to_one_scene():
    """Definition: computed once, anew for other angles, and not part of what is sent to another process."""
    scene = scene_of(FOUR_BAR)
    assert scene.closed is scene.closed
    assert pickle.loads(pickle.dumps(scene)).poses == scene.poses
    lines = load_scene(find_scene("amos3"))
    turned = lines.with_angles({"HL1": 1.0})
    assert turned.poses["yoke"] != lines.poses["yoke"]
    assert turned.deployed.poses == lines.deployed.poses
