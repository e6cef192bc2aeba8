"""Constraints: the counts of the antenna unit as tried by an independent program, planar loops, hinge lines."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components.contract.frames import exponential, multiply, rotate
from orchestrator.cli.main import main
from orchestrator.scene import SceneError, find_scene, load_scene
from orchestrator.scene.freedoms import find_constraints
from tests.references.edits import edited
from tests.unit.scene.test_loops import FOUR_BAR, scene_of

HEIGHTS = {"generic": 0.5, "folded": 0.0, "straight": 1.0}
SPHERICAL = {"generic": (72, 29), "folded": (67, 34), "straight": (67, 35)}
REVOLUTE = {"generic": (101, 0), "folded": (93, 8), "straight": (94, 8)}
DIAGONAL = {"generic": (36, 17), "folded": (34, 19), "straight": (35, 19)}


def unit(variants, height, length=0.6):
    law = f'connection.motion.structure.law=[{{ profile = "constant", value = {2 * length * height} }}]'
    return find_constraints(load_scene(find_scene("antenna-unit"), variants, [law]))


@pytest.mark.parametrize("position", HEIGHTS)
@pytest.mark.parametrize(
    ("variants", "length", "count", "grubler", "expected"),
    [
        ((), 0.6, 72, 30, SPHERICAL),
        (("without_spacers",), 0.6, 72, 30, SPHERICAL),
        (("revolute",), 0.6, 120, -18, REVOLUTE),
        (("diagonal",), 0.51, 36, 18, DIAGONAL),
    ],
)
def test_the_unit(variants, length, count, grubler, expected, position):
    """Ranks 72/67/67, 101/93/94 and 36/34/35; a motion takes a freedom but in the straight position, its dead point."""
    found = unit(variants, HEIGHTS[position], length)
    rank, driven = expected[position]
    assert (found.count, found.grubler, found.rank) == (count, grubler, rank)
    assert found.freedoms == 6 * len(found.moving) - rank
    assert found.freedoms - found.driven == driven
    assert len(found.redundant) == count - rank
    assert found.is_singular == (position != "generic")
    assert any("singular" in sentence for sentence in found.warnings) == found.is_singular


def test_links_between_balls_spin():
    """All sixteen, and with revolutes none."""
    assert len(unit((), 0.4).spins) == 16
    assert unit(("revolute",), 0.4).spins == ()


def test_a_planar_four_bar_has_three_redundant_constraints():
    """In space 18 - 20 = -2 by count, one in fact: the plane is held four times where once is enough."""
    found = find_constraints(scene_of(FOUR_BAR))
    assert (found.count, found.grubler, found.rank, found.freedoms) == (20, -2, 17, 1)
    assert found.nearby == 17
    assert len(found.redundant) == 3


def test_a_four_bar_of_balls_is_free_of_redundancy():
    """Two revolutes and two balls: 18 - 16 = 2, of which one is the coupler's spin about the line of its balls."""
    text = FOUR_BAR
    for name in ("second", "third"):
        text = text.replace(f'name = "{name}"\npreset = "revolute"', f'name = "{name}"\npreset = "spherical"')
    found = find_constraints(scene_of(text))
    assert (found.grubler, found.freedoms, found.redundant, found.spins) == (2, 2, (), ("coupler",))


def test_hinge_lines_are_joints():
    """Three lines of AMOS-3, each one freedom, whose second hinges hold nothing that the first does not."""
    found = find_constraints(load_scene(find_scene("amos3")))
    assert (len(found.moving), found.freedoms) == (3, 3)
    assert found.grubler < 3


def test_command_and_function_agree():
    run = CliRunner().invoke(main, ["analyse", "constraints", "antenna-unit", "--json"])
    told = json.loads(run.stdout)
    found = fanfold.constraints("antenna-unit")
    assert (told["rank"], told["freedoms"]) == (found.rank, found.freedoms) == (72, 30)
    assert np.isclose(told["smallest_kept"], found.smallest_kept)
    table = CliRunner().invoke(main, ["analyse", "constraints", "antenna-unit", "--variant", "revolute"])
    assert "Gruebler" in table.stdout
    assert "W-redundant" in table.stderr


def test_an_axis_without_stiffness_is_free():
    """A fixed joint that slides along x. Regression: it closed loops and was counted as held, which runs denied."""
    scene = fanfold.Scene("slide", until="1 s")
    base = scene.base(points={"o": (0, 0, 0)})
    block = scene.body(
        "block", place={"body": base, "point": "o", "offset": (0.3, 0, 0)},
        rigid={"mass": 1, "inertia": (1, 1, 1), "points": {"a": (0, 0, 0)}},
    )  # fmt: skip
    scene.connection(
        "guide", preset="fixed", axes={"x": (1, 0, 0)},
        ports={"inboard": (base, "o"), "outboard": (block, "a")},
        parameters={"translational_stiffness": [0, 1e7, 1e7]},
    )  # fmt: skip
    found = fanfold.constraints(scene)
    assert (found.count, found.rank) == (5, 5)


UNIVERSAL = """
[scene]
name = "universal"
until = "1 s"
[base]
name = "ground"
points = { pin = [0, 0, 0] }
[[body]]
name = "shaft"
place = { body = "ground", point = "pin", offset = [0.01, 0.02, 0], orientation = { x = [0.7, 0.1, -0.6] } }
rigid = { mass = 1, inertia = [0.1, 0.1, 0.1], points = { end = [0, 0, 0] } }
[[connection]]
name = "joint"
preset = "universal"
ports = { inboard = { body = "ground", point = "pin" }, outboard = { body = "shaft", point = "end" } }
"""


def test_a_bent_universal_joint_is_held_about_the_normal_of_its_cross():
    """It closes with the outboard x axis normal to the inboard y axis; its row has the direction of the differences."""
    scene = scene_of(UNIVERSAL)
    assert find_constraints(scene).freedoms == 2
    (joint,) = scene.constraints
    shaft = scene.poses["shaft"]
    assert rotate(shaft.orientation, (1.0, 0.0, 0.0))[1] == pytest.approx(0.0, abs=1e-12)
    row, size = joint.rows(scene.poses)[1]["shaft"][-1, 3:], 1e-6
    turns = (multiply(exponential(tuple(v)), shaft.orientation) for v in (size * np.eye(3)).tolist())
    moved = ({**scene.poses, "shaft": shaft._replace(orientation=turn)} for turn in turns)
    slope = np.array([joint.rows(poses)[0][-1] for poses in moved])
    assert slope / np.linalg.norm(slope) == pytest.approx(row, abs=1e-6)


def test_a_distance_joint_takes_one_freedom_and_closes():
    """A rod of 2 m: the body moves along the line to it, and the row is the direction of the line."""
    rod = edited(
        UNIVERSAL, ('preset = "universal"', 'preset = "distance"\nparameters = { preload_length = "2 m" }')
    )
    scene = scene_of(edited(rod, ("offset = [0.01, 0.02, 0]", "offset = [0, 1.6, 1.3]")))
    found = find_constraints(scene)
    assert (found.count, found.freedoms) == (1, 5)
    assert scene.poses["shaft"].position == pytest.approx(2.0 * np.array((0, 1.6, 1.3)) / np.hypot(1.6, 1.3))
    with pytest.raises(SceneError, match=r"preload_length: is missing"):
        scene_of(edited(UNIVERSAL, ('"universal"\nports', '"distance"\nports')))
