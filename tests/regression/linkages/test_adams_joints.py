"""Joints between placed bodies against figures that Adams computed.

Project Chrono publishes them as validation data (github.com/projectchrono/chrono, data/testing/joints): positions of
the centre of a pendulum of 1 kg with moments of inertia of 0.04, 0.1 and 0.1 kg.m2, gravity 9.80665 m/s2 along -z.
"""

from math import sqrt

import numpy as np
from scipy.interpolate import CubicSpline

import orchestrator as fanfold

GRAVITY = 9.80665
A = sqrt(0.5)
PORTS = {"inboard": {"body": "ground", "point": "pin"}, "outboard": {"body": "pendulum", "point": "end"}}


def scene_of(name, until, place, points, **header):
    """A pendulum above a ground whose point `pin` is at the origin; x is its long axis."""
    scene = fanfold.Scene(
        name, until=until, gravity=(0, 0, -GRAVITY), tolerance=1e-5, preload=False, **header
    )
    scene.joint(radial_stiffness=5e6, cross_stiffness=1e6)
    scene.base("ground", points={"pin": (0, 0, 0)})
    rigid = {"mass": 1, "inertia": (0.04, 0.1, 0.1), "points": points}
    scene.body("pendulum", rigid=rigid, place={"body": "ground", "point": "pin", **place})
    return scene


def joined(scene, preset, axes):
    scene.connection("joint", "hinge", ports=PORTS, preset=preset, axes=axes)


def error(scene, table, origin=(0, 0, 0)):
    """Largest distance of the centre from a table (m over s), of the way that it went; cubics between rows."""
    result = fanfold.simulate(scene, estimate=False)
    at = np.add(result["pendulum", "frame_position"][:], origin)
    way = np.linalg.norm(np.diff(at, axis=0), axis=1).sum()
    apart = CubicSpline(result.time, at)(list(table)) - np.array(list(table.values()))
    return np.linalg.norm(apart, axis=1).max() / way


UNIVERSAL = {
    0.4: (1.31281, 1.31299, -0.743355),
    0.8: (0.205825, 0.215344, -1.97769),
}
"""Universal_Case03 (m over s): both axes of the cross oblique to the motion."""


def test_a_universal_joint():
    """Adams' table to 1e-5 of the way; with the axes of the cross exchanged it is 0.01 m off."""
    scene = scene_of(
        "universal", 0.8, {"offset": (2 * A, 2 * A, 0), "orientation": {"x": (A, A, 0)}}, {"end": (-2, 0, 0)}
    )
    joined(scene, "universal", {"x": (-0.5, 0.5, A), "z": (A, A, 0)})
    assert error(scene, UNIVERSAL) < 1e-5


def test_a_prismatic_joint():
    """Closed form: on a slope of 45 deg the way is g sin(45 deg) t^2 / 2, and the body keeps its attitude.

    A load off the line turns nothing; joints give by its torque of 14 N.m over 1e6 N.m/rad.
    """
    scene = scene_of("prismatic", 0.5, {}, {"end": (0, 0, 2)})
    joined(scene, "prismatic", {"x": (A, 0, -A), "z": (A, 0, A)})
    result = fanfold.simulate(scene, estimate=False)
    way = 0.5 * GRAVITY * A * 0.5**2
    moved = result["pendulum", "frame_position"][-1] - result["pendulum", "frame_position"][0]
    assert np.abs(moved - np.array((A, 0, -A)) * way).max() < 1e-5 * way + 2 * 14 / 1e6
    assert np.abs(result["pendulum", "frame_orientation"][:][:, 1:]).max() < 14 / 1e6


DISTANCE = {0.4: (0, 3.918015, -0.7758810), 0.8: (0, 2.885157, -2.767518), 1.2: (0, -0.1079262, -3.997190)}
"""Distance_Case03 (m over s): the pendulum hangs by its end on a rod of 2 m that turns about the ground."""


def test_a_distance_joint():
    """Adams' table to 1e-5 of the way."""
    scene = scene_of(
        "distance", 1.2, {"offset": (0, 4, 0), "orientation": {"x": (0, -1, 0)}}, {"end": (2, 0, 0)}
    )
    scene.connection("rod", "spring", ports=PORTS, preset="distance", parameters={"preload_length": 2})
    assert error(scene, DISTANCE) < 1e-5


SPRING = {
    0.6: (-0.9998836, 3.982850, 1.241107),
    0.9: (-0.8272010, 3.790390, -0.6723604),
    1.2: (0.3772019, 2.590923, -1.257025),
}
"""TranSpringCB_Case03 (m over s): a spring of 50 e + 10 e |e| N and a damper of 5 N.s/m off the centre of the body."""


def test_a_spring_by_a_table():
    """Adams' table to 1e-5 of the way; the cubics of the table are within 2e-3 N of the spring."""
    scene = scene_of("spring", 1.2, {"offset": (-2, 2, 0)}, {"end": (2, 0, 0)})
    e = np.linspace(-2, 4, 121)
    scene.connection(
        "spring",
        "spring",
        ports=PORTS,
        parameters={"preload_length": 2, "damping": 5},
        structure={"elongation": e.tolist(), "tension": (50 * e + 10 * e * np.abs(e)).tolist()},
    )
    assert error(scene, SPRING, origin=(1, 2, 3)) < 1e-5
