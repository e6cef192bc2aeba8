"""Where bodies stand at the start: against the planar angles of the data sheet, and as their hinges see it."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

from components import REGISTRY, rotation_matrix
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.participant import InProcess
from orchestrator.scene.builder import Scene
from tests.unit.scene.scene_cases import AMOS3_BODIES, amos3, parts_of


def planar_angles(phi):
    """Absolute angles of the data sheet: a1 = phi1, a2 = a1 + pi - phi2, a3 = a2 - pi + phi3."""
    yoke = phi[0]
    panel1 = yoke + pi - phi[1]
    return yoke, panel1, panel1 - pi + phi[2]


@pytest.mark.parametrize("degrees", [(0, 0, 0), (30, 100, 130), (90, 180, 180)], ids=str)
def test_start_poses_are_those_of_the_planar_angles(degrees):
    """Data sheet of AMOS-3: bodies in the x-z plane, one behind the other; to round-off."""
    angles = zip(("HL1", "HL2", "HL3"), degrees, strict=True)
    lines = [{"name": name, "stowed_angle": f"{at} deg", "latch_angle": "181 deg"} for name, at in angles]
    scene = Scene.load("amos3", settings={"hinge_line": lines})
    parts = parts_of(assemble(scene.check(), rigid={"all"}))
    root = np.zeros(3)
    for body, a, length in zip(
        AMOS3_BODIES, planar_angles([radians(d) for d in degrees]), (0.95, 1.61, 0), strict=True
    ):
        along = np.array([sin(a), 0.0, cos(a)])  # along +z at a = 0, along +x at a = 90 degrees
        turn = rotation_matrix(parts[body].start["initial_orientation"])
        np.testing.assert_allclose(turn @ [1.0, 0.0, 0.0], along, rtol=0, atol=1e-12)
        np.testing.assert_allclose(turn @ [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(parts[body].start["initial_position"], root, rtol=0, atol=1e-12)
        root = root + length * along


def test_hinges_read_their_stowed_angle_and_meet_at_the_start():
    """Consistency: hinges on the poses of the bodies. 1e-6 N is 2e-13 m of 5e6 N/m, round-off of places of 1 m."""
    scene = amos3()
    assembly = assemble(scene, rigid={"all"})
    parts = parts_of(assembly)
    running = {}
    for part in assembly.parts:
        if part.kind in ("fixed_base", "body"):
            running[part.name] = InProcess(part.name, REGISTRY[part.kind](**part.structure), part.start)
            running[part.name].initialize(0.0)
            running[part.name].read()
    for name in (hinge for line in assembly.hinge_lines for hinge in line.hinges):
        hinge = InProcess(name, REGISTRY["hinge"](**parts[name].structure), parts[name].start)
        for link in assembly.links:
            if link.connection[0] == name:
                body = running[link.body[0]]
                for quantity in ("position", "orientation"):
                    from_body = body.output_layout[f"{link.body[1]}.{quantity}"]
                    hinge.inputs[hinge.input_layout[f"{link.connection[1]}.{quantity}"]] = body.outputs[
                        from_body
                    ]
        hinge.initialize(0.0)
        seen = dict(zip(hinge.observation_layout.scalar_names(), hinge.observe(), strict=True))
        assert seen["angle"] == pytest.approx(0.0, abs=1e-12)
        assert seen["radial_force"] < 1e-6
        assert seen["axial_force"] == pytest.approx(0.0, abs=1e-6)
