"""Stresses of a panel from a result file: against a direct static solution, and whatever can be wrong with it."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.image import imread
from scipy import linalg, sparse
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from components.catalogue import BodyDefinition
from components.contract.frames import skew
from components.flexible.modal import ModalData
from components.flexible.reduction import orthonormal_modes
from components.flexible.stress import hot_spots, stress_recovery
from orchestrator.analysis.stress import model as _stress_model
from orchestrator.analysis.stress.body_acceleration import acceleration_field
from orchestrator.analysis.stress.hot_spots import Choice
from orchestrator.assembly import Geometry
from orchestrator.cli.main import main
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result import Result
from orchestrator.results.result_file import ResultWriter
from orchestrator.scene import find_scene, load_scene
from tests.references import catalogue

ROOTS = ("hl2_left", "hl2_right")
MODES = 4
FELT = np.array([3.0, -1.0, 9.81])
SIGNALS = {
    "frame_position": ("m", 3),
    "frame_orientation": ("1", 4),
    "linear_momentum": ("N.s", 3),
    "angular_momentum": ("N.m.s", 3),
}


@pytest.fixture(autouse=True, scope="module")
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(autouse=True, scope="module")
def _same_finite_elements_once():
    """Finite elements and their modes are made once for all tests here."""
    modes = cache(lambda points, count: orthonormal_modes(_panel(), points, count))
    built, build = {}, BodyDefinition.finite_elements

    def once(definition, masses=()):
        key = repr((definition, masses))
        if key not in built:
            built[key] = build(definition, masses)
        return built[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(BodyDefinition, "finite_elements", once)
        patch.setattr(_stress_model, "orthonormal_modes", lambda _, points, count: modes(points, count))
        yield


def _panel():
    return catalogue.entry("amos3_panel1").finite_elements(())


@dataclass(frozen=True)
class Motion:
    """A body's recorded motion: N times, the construction frame, momenta about the world origin."""

    time: np.ndarray
    position: np.ndarray
    attitude: Rotation
    momentum: np.ndarray
    angular_momentum: np.ndarray

    def rows(self):
        return np.hstack(
            [self.position, self.attitude.as_quat(scalar_first=True), self.momentum, self.angular_momentum]
        )


def motion(data, time, center, attitude, velocity, omega):
    """Motion of a body with modal data, from its centre of mass, attitude and angular velocity in body axes."""
    momentum = data.mass * velocity
    spin = attitude.apply(omega @ data.inertia.T)
    position = center - attitude.apply(data.center_of_mass)
    return Motion(time, position, attitude, momentum, spin + np.cross(center, momentum))


def write(path, moved, geometry, eta=None, settings=(), provenance=None):
    """A result of amos3 in which only panel1 was recorded."""
    signals = dict(SIGNALS) if eta is None else {**SIGNALS, "modal_coordinate": ("kg(1/2).m", eta.shape[1])}
    units, sizes = zip(*signals.values(), strict=True)
    group = SignalGroup("panel1", tuple(signals), units, sizes, ("",) * len(signals))
    if provenance is None:
        layers = ("body.panel1.fixed_interface_modes=4", *settings)
        tree = load_scene(find_scene("amos3"), settings=layers).tree
        provenance = {"scene": "amos3", "scene_tree": json.dumps(tree)}
    rows = moved.rows() if eta is None else np.hstack([moved.rows(), eta])
    with ResultWriter(path, [group], provenance, {"panel1": geometry}, []) as writer:
        for time, row in zip(moved.time, rows, strict=True):
            writer.append(float(time), [row])
    return path


@pytest.fixture(scope="module")
def data():
    return catalogue.entry("amos3_panel1").flexible(MODES)


@pytest.fixture(scope="module")
def geometry(data):
    return Geometry(data.display_positions, data.display_shapes, data.display_faces)


@pytest.fixture(scope="module")
def accelerated(data):
    """Held at the inboard hinges and accelerated evenly from rest at an odd attitude."""
    time = np.array([0.0, 0.1, 0.1, 0.3, 0.4])
    attitude = Rotation.from_rotvec(np.tile([0.4, -1.1, 0.7], (time.size, 1)))
    acceleration = attitude[0].apply(FELT)
    return motion(
        data,
        time,
        np.array([1.0, 2.0, 3.0]) + 0.5 * time[:, None] ** 2 * acceleration,
        attitude,
        time[:, None] * acceleration,
        np.zeros((time.size, 3)),
    )


@pytest.fixture(scope="module")
def static(data):
    """Modal coordinates of the panel under FELT with its inboard hinges held, from the modal data alone."""
    held = [data.point_names.index(name) for name in ROOTS]
    arms = data.point_positions[held] - data.center_of_mass
    rigid = np.zeros((12, 6))
    for k, arm in enumerate(arms):
        rigid[6 * k : 6 * k + 6] = np.eye(6)
        rigid[6 * k : 6 * k + 3, 3:] = -skew(arm)
    elastic = np.concatenate([np.vstack([data.translation[k], data.rotation[k]]) for k in held])
    allowed = linalg.null_space(np.hstack([rigid, elastic]))
    stiffness = np.concatenate([np.zeros(6), data.frequency**2])[:, None]
    load = np.concatenate([-data.mass * FELT, np.zeros(3 + data.frequency.size)])
    solution = np.linalg.solve(allowed.T @ (stiffness * allowed), allowed.T @ load)
    return (allowed @ solution)[6:]


@pytest.fixture(scope="module")
def direct():
    """Von Mises stress of the finite elements themselves under FELT, in Pa, and where."""
    model = _panel()
    held = np.concatenate([model.attachment_dofs[name] for name in ROOTS])
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
    load = -model.mass_matrix @ (model.rigid_motions[:, :3] @ FELT)
    displacement = np.zeros_like(load)
    displacement[free] = splu(sparse.csc_array(model.stiffness)[free][:, free]).solve(load[free])
    recovery = stress_recovery(model, catalogue.entry("amos3_panel1").face_sheets, displacement[:, None])
    return recovery.von_mises(np.ones(1)), model.plate.positions


@pytest.fixture(scope="module")
def result(tmp_path_factory, accelerated, geometry, static):
    """The static deflection in the last row but one and less elsewhere, so that the peak is known to be there."""
    eta = np.outer([0.2, 0.4, 0.4, 1.0, 0.9], static)
    return write(tmp_path_factory.mktemp("stress") / "run.h5", accelerated, geometry, eta)


def stress(*arguments):
    """Run the analysis; whatever happens, no traceback."""
    found = CliRunner().invoke(main, ["analyse", "stress", *(str(a) for a in arguments)])
    assert found.exception is None or isinstance(found.exception, SystemExit), found.exception
    return found


def table(folder, body="panel1"):
    with (folder / f"{body}_hot_spots.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_hot_spots_are_those_of_the_direct_solution(result, tmp_path, direct):
    """Direct finite-element solution, with 4 fixed-interface modes and the static correction from the momenta."""
    found = stress(result, "--body", "panel1", "--count", 6, "--radius", 0.1, "--output", tmp_path)
    assert found.exit_code == 0, found.output
    values, positions = direct
    expected = hot_spots(values, positions, 0.1, 6)
    rows = table(tmp_path)
    assert len(rows) == 6
    np.testing.assert_allclose(
        [float(row["von Mises, MPa"]) for row in rows], 1e-6 * values[expected], atol=1e-3
    )
    np.testing.assert_array_equal([float(row["time, s"]) for row in rows], 0.3)
    for row in rows:  # mirror images are as hot as each other, so the order of a pair is open
        place = positions[int(row["node"])]
        np.testing.assert_allclose([float(row["x, m"]), float(row["y, m"])], place[:2], atol=1e-4)
        assert np.linalg.norm(positions[expected] - place, axis=1).min() < 0.06
    assert rows[0]["insert"] == "yes"
    assert f"{float(rows[0]['von Mises, MPa']):.4f}" in found.stdout
    for name in ("field", "histories"):
        path = tmp_path / f"panel1_stress_{name}.png"
        assert str(path) in found.stdout
        assert imread(path)[..., :3].std() > 0.02


@pytest.mark.parametrize(
    ("choice", "inside"),
    [
        (Choice(within=(0.41, 0.9, -0.31, 0.21)), lambda x, y: 0.41 <= x <= 0.9 and -0.31 <= y <= 0.21),
        (Choice(around=(0.8, 0.1, 0.25)), lambda x, y: np.hypot(x - 0.8, y - 0.1) <= 0.25),
        (Choice(insert_margin=0.21), lambda x, y: insert_distance(x, y) >= 0.21),
        (Choice((3, 312, 3, 512), around=(0.8, 0.0, 0.5)), lambda x, y: (x, y) in places([312, 512])),
        (Choice(), lambda x, y: True),
    ],
)
def test_nodes_asked_for(choice, inside):
    """Brute force over the nodes, with the inserts of the data sheet: 30 mm squares at the four corners."""
    positions = _panel().plate.positions[:, :2]
    expected = [k for k, (x, y) in enumerate(positions.tolist()) if inside(x, y)]
    assert len(expected) > 1
    np.testing.assert_array_equal(choice(_panel().plate), expected)


def places(nodes):
    return {tuple(p) for p in _panel().plate.positions[nodes, :2].tolist()}


def insert_distance(x, y):
    """Distance to the nearest insert by the symmetry of the panel, m."""
    along, across = 0.75 - abs(x - 0.805), 0.58 - abs(y)
    return np.hypot(max(along - 0.03, 0.0), max(across - 0.03, 0.0))


def test_scattered_nodes(result, tmp_path):
    """Nodes without a whole element between them are drawn as points."""
    stress(result, "--body", "panel1", "--nodes", "400, 77,77,12", "--radius", 0.0, "--output", tmp_path)
    assert {row["node"] for row in table(tmp_path)} == {"12", "77", "400"}
    assert imread(tmp_path / "panel1_stress_field.png")[..., :3].std() > 0.02


def test_signs_and_switched_off_modes_are_those_of_the_run(tmp_path, accelerated, data, geometry):
    """Invariance: a run whose solver chose other signs of the modes, and that lacks two, gives the same stresses."""
    kept = data.switch_off((1, 6))
    eta = np.random.default_rng(3).standard_normal((5, kept.frequency.size)) / kept.frequency
    signs = np.where(np.arange(kept.frequency.size) % 3, 1.0, -1.0)
    spots = []
    for name, sign in (("run", np.ones_like(signs)), ("other", signs)):
        shown = Geometry(geometry.positions, kept.display_shapes * sign, geometry.faces)
        settings = ("body.panel1.modes_off=[1,6]",)
        path = write(tmp_path / f"{name}.h5", accelerated, shown, eta * sign, settings)
        assert stress(path, "--body", "panel1").exit_code == 0
        spots.append(table(tmp_path / name))
    assert spots[0] == spots[1]


def test_acceleration_field_of_a_turning_body(tmp_path, geometry):
    """Closed form: a body turns about a fixed axis in gravity; a(s) - g from the acceleration of its points.

    Mean slopes err by h² / 6 of third derivatives, here those of sines at 2 rad/s: below 1e-5 of them.
    """
    data = ModalData.rigid(5.0, (0.7, 0.1, 0.0), np.diag([1.0, 2.0, 3.0]), {"hinge": (0.0, 0.0, 0.0)})
    time, gravity = np.linspace(0.0, 1.0, 401), (0.0, 0.0, -9.81)
    angle, rate, turning = np.sin(2 * time), 2 * np.cos(2 * time), -4 * np.sin(2 * time)
    axis = np.array([0.0, 1.0, 0.0])
    attitude = Rotation.from_rotvec(angle[:, None] * axis)
    center = attitude.apply(data.center_of_mass)
    omega = rate[:, None] * axis
    moved = motion(data, time, center, attitude, np.cross(omega, center), omega)
    result = Result.open(write(tmp_path / "run.h5", moved, geometry))
    field = acceleration_field(result, "panel1", data, gravity)
    s = np.array([0.3, -0.2, 0.5])
    found = field[:, :3] + field[:, 3:].reshape(-1, 3, 3).transpose(0, 2, 1) @ s
    arm = data.center_of_mass + s
    expected = turning[:, None] * np.cross(axis, arm) + rate[:, None] ** 2 * np.cross(
        axis, np.cross(axis, arm)
    )
    expected -= attitude.apply(np.array(gravity), inverse=True)
    np.testing.assert_allclose(found[1:-1], expected[1:-1], atol=1e-4)


def test_impulses_are_no_acceleration(tmp_path, data, geometry):
    """A jump of the momenta in a step of no length leaves the accelerations on both sides."""
    time = np.array([0.0, 0.5, 0.5, 1.0])
    velocity = np.array([0.0, 1.0, 7.0, 8.0])[:, None] * [1.0, 0.0, 0.0]
    moved = motion(data, time, np.zeros((4, 3)), Rotation.identity(4), velocity, np.zeros((4, 3)))
    result = Result.open(write(tmp_path / "run.h5", moved, geometry))
    field = acceleration_field(result, "panel1", data, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(field[:, 0], 2.0, rtol=1e-12)
    np.testing.assert_allclose(field[:, 1:], 0.0, atol=1e-12)


def test_what_is_wrong_is_told(result, tmp_path, accelerated, geometry, static):
    eta = np.tile(static, (5, 1))
    rigid = write(tmp_path / "rigid.h5", accelerated, geometry)
    bare = write(tmp_path / "bare.h5", accelerated, geometry, eta, provenance={})
    shapes = geometry.shapes.copy()
    shapes[:, :, 2] *= 1.01
    other = Geometry(geometry.positions, shapes, geometry.faces)
    changed = write(tmp_path / "changed.h5", accelerated, other, eta)
    for arguments, sentence in (
        (
            (rigid, "--body", "panel1"),
            "modal coordinates",
        ),
        ((result, "--body", "panel9"), "'panel9'"),
        ((bare, "--body", "panel1"), "scene"),
        ((changed, "--body", "panel1"), "modes"),
        ((result, "--body", "panel1", "--nodes", "1,100000"), "mesh"),
        ((result, "--body", "panel1", "--nodes", "one"), "'--nodes': 'one'"),
        ((result, "--body", "panel1", "--within", 1, 0, 0, 1), "x0 <= x1"),
        ((result, "--body", "panel1", "--around", 9, 9, 0.1), "no node"),
        ((result, "--body", "panel1", "--radius", "nan"), "not a finite number"),
    ):
        found = stress(*arguments)
        assert found.exit_code != 0
        assert sentence in found.stderr.replace("\n", " ")


def test_a_real_run(tmp_path):
    """End to end: a flexible panel of a deployment; preload of the cable loops stresses it from the start."""
    path = tmp_path / "amos3.h5"
    options = ("--until", "0.05", "--flexible", "panel1,yoke", "--rigid", "panel2", "--output", str(path))
    ran = CliRunner().invoke(main, ["run", "amos3", *options])
    assert ran.exit_code == 3, ran.output
    found = stress(path, "--body", "panel1", "--count", 4, "--radius", 0.2)
    assert found.exit_code == 0, found.output
    rows = table(tmp_path / "amos3")
    values = [float(row["von Mises, MPa"]) for row in rows]
    assert values == sorted(values, reverse=True)
    places = np.array([[float(row["x, m"]), float(row["y, m"])] for row in rows])
    gaps = np.linalg.norm(places[:, None] - places, axis=2)[~np.eye(4, dtype=bool)]
    assert gaps.min() > 0.2
    assert all(0.0 <= float(row["time, s"]) <= 0.05 for row in rows)
    assert values[0] > 0.1
    refused = stress(path, "--body", "yoke")
    assert refused.exit_code == 1
    assert "yoke: " in refused.stderr
