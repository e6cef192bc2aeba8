"""Mass properties of what a driven base carries: closed forms, momenta and loads of a stiff wing, bent beams."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from components.contract.frames import skew
from fmus import Experiment, native_library
from orchestrator.api.simulate import as_scene
from orchestrator.assembly.assemble import assemble
from orchestrator.run.as_one.export import export_as_one
from tests.unit.run.as_one.host import TWO_PANELS, Host

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
SIDES, MASS = np.array([1.2, 0.8, 0.03]), 6.0
BOX = MASS / 12.0 * (SIDES @ SIDES - SIDES**2)
"""Inertia of a box of that mass (kg) and those sides (m) about its centre."""
ROOT = np.array([0.1, 0.0, 0.2])
STIFFNESS = 1e9
"""Of joints, N/m; a tenth of it in N.m/rad."""


def boxes(*directions):
    """Box panels, fixed one to the end of the other, that point along world directions in the plane of x and z."""
    damping = 2.0 * np.sqrt(STIFFNESS * 2.0 * MASS)
    stiff = {
        "translational_stiffness": [STIFFNESS] * 3,
        "rotational_stiffness": [0.1 * STIFFNESS] * 3,
        "translational_damping": [damping] * 3,
        "rotational_damping": [0.5 * damping] * 3,
    }
    points = {"in": [0.0, 0.0, 0.0], "out": [SIDES[0], 0.0, 0.0]}
    rigid = {"mass": MASS, "center_of_mass": [0.5 * SIDES[0], 0.0, 0.0], "inertia": BOX.tolist()}
    scene, inboard, end = fanfold.Scene("boxes", until="1 s"), ("base", "root"), np.zeros(3)
    scene.base("base", points={"root": ROOT.tolist()})
    for number, (x, z) in enumerate(directions):
        turned = {"x": [x, 0.0, z], "z": [-z, 0.0, x]}
        place = {"body": "base", "point": "root", "offset": end.tolist(), "orientation": turned}
        name = f"panel{number}"
        scene.body(name, rigid=rigid | {"points": points}, place=place)
        scene.connection(
            f"joint{number}",
            preset="fixed",
            parameters=stiff,
            axes={"x": [1, 0, 0], "z": [0, 0, 1]},
            ports={"inboard": inboard, "outboard": (name, "in")},
        )
        inboard, end = (name, "out"), end + SIDES[0] * np.array([x, 0.0, z])
    return scene


def hosted(scene, folder):
    """An instance of the FMU, which is written without a picture."""
    assembly = assemble(as_scene(scene).check_one_run(), (), (), "mean")
    return Host(export_as_one(assembly, folder, Experiment(), driven_base=True)).start()


def vector(host, name, size=3):
    return np.array([host[f"{name}[{i + 1}]"] for i in range(size)])


def mass_matrix(host):
    """(6, 6) of translation and rotation of the base's frame, its axes."""
    mass, arm = host["base.appendage_mass"], skew(vector(host, "base.appendage_center_of_mass"))
    xx, yy, zz, xy, xz, yz = vector(host, "base.appendage_inertia", 6)
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.block([[mass * np.eye(3), -mass * arm], [mass * arm, inertia]])


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    """The straight wing at 0.4 s; accelerations of its base rise smoothly to constant ones within 0.2 s."""
    host = hosted(boxes((1.0, 0.0), (1.0, 0.0)), tmp_path_factory.mktemp("straight"))
    host.at_start, rise, h = mass_matrix(host), 0.2, 2e-3
    for time in np.arange(0.0, 0.4 - 0.5 * h, h):
        reached = 0.5 * (1.0 - np.cos(np.pi * min(time / rise, 1.0)))
        rate = (
            0.5 * time - rise / (2.0 * np.pi) * np.sin(np.pi * time / rise)
            if time < rise
            else time - 0.5 * rise
        )
        for name, values in ACCELERATION.items():
            for i, value in enumerate(values, 1):
                host[f"base.{name}acceleration[{i}]"] = reached * value
                host[f"base.{name}velocity[{i}]"] = rate * value
        host.to(host.time + h, h)
    host.rate = 0.3
    """s, of constant accelerations that lead to the present rates."""
    return host


ACCELERATION = {"": np.array([0.5, -0.3, 0.8]), "angular_": np.array([0.3, 0.6, -0.4])}


@pytest.mark.parametrize("folded", [False, True], ids=["straight", "folded"])
def test_wings_of_boxes_have_the_inertia_of_the_parallel_axis_theorem(straight, tmp_path, folded):
    """Closed form: centres at half a panel and, straight, at one and a half panels from the root."""
    found = mass_matrix(hosted(boxes((1.0, 0.0), (-1.0, 0.0)), tmp_path)) if folded else straight.at_start
    centers = ROOT + np.outer((0.5, 0.5 if folded else 1.5), (SIDES[0], 0.0, 0.0))
    expected = np.zeros((6, 6))
    for center in centers:
        motion = np.block([[np.eye(3), -skew(center)], [np.zeros((3, 3)), np.eye(3)]])
        expected += motion.T @ np.diag([MASS] * 3 + BOX.tolist()) @ motion
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


def test_momenta_of_a_stiff_wing_are_its_mass_times_the_rates_of_the_base(straight):
    """Definition: bodies' own momenta, which the scheme integrates. Joints give by (rise / period of the wing)^-2."""
    turn = Rotation.from_quat(vector(straight, "base.frame_orientation", 4)[[1, 2, 3, 0]])
    rates = straight.rate * np.concatenate([turn.inv().apply(one) for one in ACCELERATION.values()])
    linear, about_root = (turn.apply(part) for part in np.split(mass_matrix(straight) @ rates, 2))
    angular = about_root + np.cross(vector(straight, "base.frame_position"), linear)
    for name, expected in (("linear", linear), ("angular", angular)):
        found = sum(vector(straight, f"panel{k}.{name}_momentum") for k in (0, 1))
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=3e-6 * np.linalg.norm(expected))


def test_loads_of_a_stiff_wing_are_its_mass_times_the_acceleration_of_the_base(straight):
    """Newton and Euler for one rigid body, with centrifugal and gyroscopic terms; joints give as above."""
    turn = Rotation.from_quat(vector(straight, "base.frame_orientation", 4)[[1, 2, 3, 0]])
    acceleration = np.concatenate([turn.inv().apply(one) for one in ACCELERATION.values()])
    rate, matrix = straight.rate * acceleration[3:], mass_matrix(straight)
    arm = vector(straight, "base.appendage_center_of_mass")
    bias = MASS * 2.0 * np.cross(rate, np.cross(rate, arm)), np.cross(rate, matrix[3:, 3:] @ rate)
    expected = -(matrix @ acceleration + np.concatenate(bias))
    for part, name in zip(np.split(expected, 2), ("force", "torque"), strict=True):
        found = vector(straight, f"base.interface_{name}")
        np.testing.assert_allclose(found, part, rtol=0.0, atol=3e-6 * np.linalg.norm(part))


def test_it_is_the_rigid_mass_of_the_linear_appendage(tmp_path):
    """Two formulations: the mass matrix of the linear model of that configuration, by Jacobians of its bodies."""
    (expected,) = fanfold.appendage(TWO_PANELS, as_posed=True)
    found = mass_matrix(hosted(TWO_PANELS, tmp_path))
    np.testing.assert_allclose(found, expected.rigid_mass, rtol=1e-9, atol=1e-9)


def test_bent_beams_have_the_inertia_of_their_sections_where_they_are(tmp_path):
    """Independent formulation: the consistent mass matrix of the elements under rigid motions of the bent beam."""
    length, width, height, density, elements = 1.0, 0.06, 0.004, 2700.0, 4
    scene = fanfold.Scene("boom", until="1 s")
    scene.base("base", points={"root": ROOT.tolist()})
    rectangle = {
        "width": width,
        "height": height,
        "youngs_modulus": 7e10,
        "poisson_ratio": 0.3,
        "density": density,
    }
    beam = {"length": length, "elements": elements, "rectangle": rectangle}
    beam |= {"attachment_points": {"root": 0.0, "tip": length}}
    scene.body("boom", place={"body": "base", "point": "root"}, fidelity="large_deformation", beam=beam)
    scene.connection(
        "clamp", preset="fixed", ports={"inboard": ("base", "root"), "outboard": ("boom", "root")}
    )
    force = [{"profile": "step5", "start": 0.0, "duration": 0.2, "change": 8.0}]
    scene.connection(
        "pull", "load", ports={"body": ("boom", "tip")}, structure={"direction": (0, 0.2, 1), "force": force}
    )
    host = hosted(scene, tmp_path).to(0.2, 0.1)
    positions = vector(host, "boom.node_position", 3 * (elements + 1)).reshape(-1, 3)
    turns = vector(host, "boom.node_orientation", 4 * (elements + 1)).reshape(-1, 4)
    assert positions[-1, 2] - ROOT[2] > 0.1
    motions = np.array([np.hstack((np.eye(3), -skew(position))) for position in positions])
    line_mass, span = density * width * height, length / elements
    expected = np.zeros((6, 6))
    for a, b in pairwise(motions):
        expected += line_mass * span / 6.0 * (2.0 * (a.T @ a + b.T @ b) + a.T @ b + b.T @ a)
    areas = density / 12.0 * width * height * np.array([width**2 + height**2, height**2, width**2])
    for turn, share in zip(turns, [0.5] + [1.0] * (elements - 1) + [0.5], strict=True):
        axes = Rotation.from_quat(turn[[1, 2, 3, 0]]).as_matrix()
        expected[3:, 3:] += share * span * axes @ np.diag(areas) @ axes.T
    np.testing.assert_allclose(mass_matrix(host), expected, rtol=1e-6, atol=1e-8)
