"""Held hinge lines: the bodies they join are one rigid piece, without connections inside."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from components import rotation_matrix
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import run
from orchestrator.scene import SceneError, load_scene
from tests.references.edits import edited

SCENES = Path(__file__).parents[2] / "scenes"
TIP = """
[[body]]
name = "tip"
[body.rigid]
mass = 2.0
center_of_mass = [0.3, 0.1, 0.05]
inertia = [0.1, 0.2, 0.3]
points = { left = [0.0, 0.4, 0.0] }
[[hinge_line]]
name = "tip_line"
inboard = "outer"
outboard = "tip"
axis = "+y"
aligned_angle = "120 deg"
motor = { stowed = "1 N.m", deployed = "0.5 N.m" }
hinges = [{ name = "tip_hinge", inboard = "tip", outboard = "left" }]
[[damper]]
name = "inner_damper"
hinge = "root"
damping_coefficient = 2.0
"""
TWO_PANELS = (SCENES / "two_panels.toml").read_text(encoding="utf-8")
THREE = edited(TWO_PANELS, ("points = { left", "points = { tip = [1.4, 0.4, 0.0], left")) + TIP


def scene_with(folder, held, extra=""):
    path = folder / "wing.toml"
    text = THREE + extra
    for line in held:
        text = edited(text, (f'name = "{line}"\n', f'name = "{line}"\nheld = true\n'))
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def parts_of(assembly):
    return {part.name: part for part in assembly.parts}


def test_everything_held_against_a_fixed_base_costs_one_body(tmp_path):
    """Only what moves is left: the base with one port, one hinge, one body."""
    assembly = assemble(scene_with(tmp_path, ("root_line", "middle_line")))
    assert set(parts_of(assembly)) == {"base", "tip", "tip_hinge"}
    assert [line.name for line in assembly.hinge_lines] == ["tip_line"]
    (port,) = parts_of(assembly)["base"].structure["ports"]
    free = parts_of(assemble(scene_with(tmp_path, ())))
    start = free["tip_hinge"].start
    assert port["position"] == pytest.approx(start["inboard.position"])
    assert port["orientation"] == pytest.approx(start["inboard.orientation"])


def test_a_scene_in_which_nothing_moves_is_told(tmp_path):
    with pytest.raises(SceneError, match="acts"):
        assemble(scene_with(tmp_path, ("root_line", "middle_line", "tip_line")))


def test_a_joined_piece_has_the_mass_properties_of_its_bodies(tmp_path):
    """Independent sum over sampled mass points of both bodies in world axes."""
    free = parts_of(assemble(scene_with(tmp_path, ())))
    joined = parts_of(assemble(scene_with(tmp_path, ("middle_line",))))["inner"]
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for name in ("inner", "outer"):
        part = free[name]
        turn = rotation_matrix(tuple(part.start["initial_orientation"]))
        modal = part.structure["modal"]
        center = np.array(part.start["initial_position"]) + turn @ np.array(modal["center_of_mass"])
        moments = np.linalg.eigh(np.array(modal["inertia"]).reshape(3, 3))
        spread = np.sqrt((0.5 * moments.eigenvalues.sum() - moments.eigenvalues) / modal["mass"])
        for axis, arm in zip(moments.eigenvectors.T, spread, strict=True):
            for sign in (-1.0, 1.0):
                # six points at sqrt(3) times the radius of each axis have the body's second moments
                point = center + sign * np.sqrt(3.0) * arm * (turn @ axis)
                weight = modal["mass"] / 6.0
                mass += weight
                first += weight * point
                second += weight * (point @ point * np.eye(3) - np.outer(point, point))
    turn = rotation_matrix(tuple(joined.start["initial_orientation"]))
    modal = joined.structure["modal"]
    center = np.array(joined.start["initial_position"]) + turn @ np.array(modal["center_of_mass"])
    inertia = second - mass * (center @ center * np.eye(3) - np.outer(center, center))
    assert modal["mass"] == pytest.approx(mass)
    assert center == pytest.approx(first / mass)
    assert turn @ np.array(modal["inertia"]).reshape(3, 3) @ turn.T == pytest.approx(inertia, abs=1e-12)


def test_a_joined_piece_moves_as_bodies_behind_a_stiff_line(tmp_path):
    """Held where it is aligned, against a stiff bushing there, which gives way by 2 N.m over 1e5 N.m/rad."""
    free = scene_with(tmp_path, ())
    root, line, tip = free.hinge_lines
    line = line.model_copy(update={"start_angle": line.aligned_angle})
    held = line.model_copy(update={"held": True})
    bushing = {"kind": "bushing", "translational_stiffness": (1e6,) * 3, "rotational_stiffness": (1e5,) * 3}
    hinge = line.hinges[0].model_copy(update=bushing)
    stiff = line.model_copy(update={"hinges": (hinge,), "motor": None})
    angles = []
    for number, middle in enumerate((held, stiff)):
        scene = replace(free, hinge_lines=(root, middle, tip))
        outcome = run(assemble(scene), tmp_path / f"{number}.h5", Settings(), 0.6)
        result = Result.open(outcome.path)
        angles.append([result.signal(name, "angle")[-1] for name in ("root", "tip_hinge")])
    assert angles[0] == pytest.approx(angles[1], abs=1e-4)


def test_start_angles_leave_the_motor_law_alone(tmp_path):
    """A wing stopped midway: the spring is that of the stowed wing, the pose the given one."""
    scene = scene_with(tmp_path, ())
    midway = scene.hinge_lines[2].model_copy(update={"start_angle": 1.0})
    moved = replace(scene, hinge_lines=(*scene.hinge_lines[:2], midway))
    before, after = (parts_of(assemble(s))["tip_hinge"].start for s in (scene, moved))
    assert after["stowed_angle"] == 1.0
    assert {k: after[k] for k in ("motor_stiffness", "motor_wind_up", "latch_angle")} == {
        k: before[k] for k in ("motor_stiffness", "motor_wind_up", "latch_angle")
    }
    assert after["outboard.orientation"] != before["outboard.orientation"]
