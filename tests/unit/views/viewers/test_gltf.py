"""Animated bodies as binary glTF: played by the letter of the standard, every node is where the result has it."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly import Geometry
from orchestrator.results.parts import Meaning
from orchestrator.views.placement import placed
from orchestrator.views.viewers.surface import surface
from tests.references import synthetic_result as reference
from tests.unit.views.viewers.gltf_reader import Glb

SINGLE = 3e-6
"""m; nodes are within 8 m, where single precision has steps of 5e-7 m, and a place is the sum of several numbers."""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return fanfold.Result.open(reference.write(tmp_path_factory.mktemp("gltf") / "run.h5"))


@pytest.fixture(scope="module")
def exported(result, tmp_path_factory):
    """With the default tolerance."""
    return Glb.open(fanfold.export_view(result, tmp_path_factory.mktemp("default") / "run.glb")[0])


def farthest(glb, result, name, rows):
    """How far (m) a node of a body is from its place in the result at the most; y up turned back into z up."""
    x, y, z = np.moveaxis([glb.played(name, result.time[row]) for row in rows], -1, 0)
    away = np.stack([x, -z, y], axis=-1) - placed(result, name, result.geometry[name], rows)
    return np.linalg.norm(away, axis=-1).max()


def key_count(glb, name):
    (*_, sampler) = [
        animation["samplers"][channel["sampler"]]
        for animation in glb.document["animations"]
        for channel in animation["channels"]
        if channel["target"]["node"] == glb.node(name)
    ]
    return glb.document["accessors"][sampler["input"]]["count"]


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_bodies_are_where_the_result_has_them(result, tmp_path, tolerance):
    """At rows all over the run, with keys far fewer than rows, and no fewer than the tolerance asks for.

    Between two keys a straight line is off by a tolerance at the most, and in a curve by about as much somewhere.
    """
    (path,) = fanfold.export_view(result, tmp_path / "run.glb", tolerance=tolerance)
    glb = Glb.open(path)
    rows = np.arange(0, result.time.size, 23)
    found = {name: farthest(glb, result, name, rows) for name in result.geometry}
    assert max(found.values()) <= tolerance + SINGLE, found
    assert max(found.values()) > 0.3 * tolerance, found
    assert all(2 < key_count(glb, name) < result.time.size / 3 for name in found)
    extras = glb.document["scenes"][0]["extras"]
    assert extras["interpolation_tolerance_m"] == tolerance
    assert [one["event"] for one in extras["events"]] == [text for _, _, text in result.events]


def test_the_default_tolerance_is_told_and_kept(result, exported):
    """It is 1e-4 of the box around all that is shown, which the deployed wing of 5.1 x 1.5 m makes at least 0.5 mm."""
    glb = exported
    tolerance = glb.document["scenes"][0]["extras"]["interpolation_tolerance_m"]
    assert 0.5e-3 < tolerance < 1e-3
    rows = np.arange(3, result.time.size, 41)
    assert all(farthest(glb, result, name, rows) <= tolerance + SINGLE for name in result.geometry)


def test_modes_are_morph_targets_of_the_body(result, exported):
    """Target times weight is shape times modal coordinate from its least; a frame of beams is lines."""
    glb = exported
    node = glb.document["nodes"][glb.node("panel1")]
    mesh = glb.document["meshes"][node["mesh"]]
    (primitive,) = mesh["primitives"]
    assert mesh["extras"]["targetNames"] == ["mode 1", "mode 2"]
    shapes, coordinates = result.geometry["panel1"].shapes, result.signal("panel1", "modal_coordinate")
    for k, target in enumerate(primitive["targets"]):
        expected = shapes[:, :, k] * np.ptp(coordinates[:, k])
        np.testing.assert_allclose(glb.accessor(target["POSITION"]), expected, atol=1e-7)
    weights = [
        glb.accessor(animation["samplers"][channel["sampler"]]["output"])
        for animation in glb.document["animations"]
        for channel in animation["channels"]
        if channel["target"] == {"node": glb.node("panel1"), "path": "weights"}
    ]
    assert len(weights) == 1
    assert weights[0].min() == 0.0, "importers clip weights below 0, as Blender does"
    assert weights[0].max() == 1.0, "and above 1"
    yoke = glb.document["meshes"][glb.document["nodes"][glb.node("yoke")]["mesh"]]
    assert [one["mode"] for one in yoke["primitives"]] == [1]
    assert [one["mode"] for one in mesh["primitives"]] == [4]


def test_faces_become_triangles_of_the_same_area():
    """Of a plate of 2 x 1.5 m all of it, each way round; three corners make one triangle, two a line, one nothing."""
    body = reference.geometry()["panel1"]
    found = surface(body.faces)
    a, b, c = np.moveaxis(np.asarray(body.positions)[found.triangles], 1, 0)
    areas = 0.5 * np.cross(b - a, c - a)
    assert areas[:, 2].min() > 0.0
    assert areas[:, 2].sum() == pytest.approx(3.0)
    mixed = surface(np.array([[3, 0, 1, 1], [0, 1, 1, 0], [2, 2, 2, 2], [4, 4, 5, 6]]))
    assert mixed.triangles.tolist() == [[3, 0, 1], [4, 5, 6]]
    assert mixed.lines.tolist() == [[0, 1]]


def beam(result):
    """In memory: a cantilever of 2 m, 11 nodes, that turns by a radian while it bends into an arc of a quarter turn."""
    share = np.linspace(0.0, 1.0, 201)
    bent = np.maximum(0.5 * np.pi * share, 1e-9)[:, None]
    s = np.linspace(0.0, 1.0, 11)
    x, z = 2.0 * np.sin(bent * s) / bent, 2.0 * (1.0 - np.cos(bent * s)) / bent
    cosine, sine = np.cos(share)[:, None], np.sin(share)[:, None]
    nodes = np.stack([cosine * x, sine * x, z], axis=-1)
    faces = np.array([[k, k + 1, k + 1, k] for k in range(10)])
    return replace(
        result,
        path=None,
        time=3.0 * share,
        events=[],
        geometry={"boom": Geometry(nodes[0], np.zeros((11, 3, 0)), faces)},
        _catalogue={"boom": {"node_position": Meaning("m", "nodes")}},
        _signals={("boom", "node_position"): nodes.reshape(201, 33)},
    )


def test_beams_of_large_deformation_move_in_principal_forms(result, tmp_path):
    """Within the tolerance, by forms that are far fewer than the 33 coordinates of its nodes."""
    bending = beam(result)
    glb = Glb.open(fanfold.export_view(bending, tmp_path / "run.glb", tolerance=1e-3)[0])
    assert 1e-4 < farthest(glb, bending, "boom", np.arange(0, 201, 3)) <= 1e-3 + SINGLE
    names = glb.document["meshes"][0]["extras"]["targetNames"]
    assert 2 <= len(names) <= 8
    assert names[0] == "form 1"


def test_what_glb_cannot_show_is_told(result, tmp_path, monkeypatch):
    """A library that is not installed, a result without surfaces, and options of other formats."""
    path = tmp_path / "run.glb"
    with pytest.raises(fanfold.FanfoldError, match="surface"):
        fanfold.export_view(replace(result, geometry={}), path)
    with pytest.raises(fanfold.FanfoldError, match=r"every .*glb, .*csv .*mat"):
        fanfold.export_view(result, path, every=0.1)
    with pytest.raises(fanfold.FanfoldError, match="a length above 0"):
        fanfold.export_view(result, path, tolerance=float("nan"))
    monkeypatch.setitem(sys.modules, "pygltflib", None)
    with pytest.raises(fanfold.FanfoldError, match=r"needs pygltflib; .* pip install 'fanfold\[viewers\]'"):
        fanfold.export_view(result, path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("ending", [".glb", ".pvd"])
@pytest.mark.parametrize(
    ("part", "value"), [("positions", np.nan), ("positions", 1e300), ("shapes", np.inf), ("faces", 10**6)]
)
def test_damaged_geometry_is_a_sentence(result, tmp_path, part, value, ending):
    """Reproduction: flipped bits of a result ended in an error of JSON."""
    name, body = next((n, b) for n, b in result.geometry.items() if np.size(b.shapes))
    array = np.array(getattr(body, part))
    array.flat[0] = value
    damaged = replace(result, geometry=dict(result.geometry) | {name: replace(body, **{part: array})})
    with pytest.raises(fanfold.FanfoldError, match=f"{name} .*damaged"):
        fanfold.export_view(damaged, tmp_path / f"a{ending}")
    assert list(tmp_path.iterdir()) == []
