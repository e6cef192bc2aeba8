"""The data that a report plays: decoded, bodies and stresses are where the result has them, and curves its values."""

from __future__ import annotations

import json
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pytest

import orchestrator as fanfold
from components.flexible.stress import von_mises
from orchestrator.results.key_figures import line_latch_torque
from orchestrator.views.placement import placed
from orchestrator.views.report.scene3d import bodies, content, curves, numbers
from orchestrator.views.viewers.stressed import stressed
from tests.references import synthetic_result as reference

KINDS = {"f32": "<f4", "f64": "<f8", "u32": "<u4", "i16": "<i2"}
HOSTILE = "</script><img src=x onerror=alert(1)>&\u2028\u2029"


def decoded(block):
    values = np.frombuffer(b64decode(block["data"], validate=True), KINDS[block["kind"]]).reshape(
        block["shape"]
    )
    return values * np.array(block["scale"]) if "scale" in block else values


def at(clock, values, times):
    """Values (K, C) of rising times, in straight lines."""
    return (
        np.column_stack([np.interp(times, clock, column) for column in values.T]) if values.size else values
    )


def played(body, times):
    """Nodes (n, D, 3) as the page places them."""
    clock = decoded(body["time"])
    forms, nodes = decoded(body["forms"]), decoded(body["nodes"]).astype(float)
    position, orientation = (
        at(clock, decoded(body[name]).astype(float), times) for name in ("position", "orientation")
    )
    orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
    amplitudes = at(clock, decoded(body["amplitudes"]), times)
    bent = nodes + (amplitudes @ forms.T).reshape(len(times), -1, 3) if forms.shape[1] else nodes[None]
    w, vector = orientation[:, None, :1], orientation[:, None, 1:]
    twice = 2.0 * np.cross(vector, bent)
    return bent + w * twice + np.cross(vector, twice) + position[:, None]


def seen(result):
    return content.content([result], "A", ["A"])


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return fanfold.Result.open(reference.write(tmp_path_factory.mktemp("scene3d") / "run.h5"))


@pytest.fixture(scope="module")
def found(result):
    return seen(result)


@pytest.fixture(scope="module")
def flexible():
    return fanfold.simulate("workbench", until=0.05, tolerance=1e-3, estimate=False)


@pytest.fixture(scope="module")
def plate(flexible):
    return seen(flexible)


def test_bodies_are_where_the_result_has_them(result, found):
    """At every recorded row within the tolerance that is told, by far fewer times than there are rows."""
    assert found.has_bodies
    away = {}
    for body in found.data["results"][0]["bodies"]:
        name = body["name"]
        expected = placed(result, name, result.geometry[name], np.arange(result.time.size))
        away[name] = np.linalg.norm(played(body, result.time) - expected, axis=2).max()
        assert body["time"]["shape"][0] < result.time.size / 2
    assert 0.1 * found.tolerance < max(away.values()) <= found.tolerance, away
    assert found.tolerance < 1e-3


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_a_finer_mesh_takes_the_same_motion(flexible, plate):
    """Corners of the panel are nodes of both meshes."""
    (body,) = [one for one in plate.data["results"][0]["bodies"] if one["name"] == "panel"]
    expected = placed(flexible, "panel", flexible.geometry["panel"], np.arange(flexible.time.size))
    shown = played(body, flexible.time)
    apart = np.linalg.norm(expected[0][:, None] - shown[0][None], axis=2)
    shared = np.flatnonzero(apart.min(axis=1) < plate.tolerance)
    assert shared.size >= 4
    away = np.linalg.norm(expected[:, shared] - shown[:, apart.argmin(axis=1)[shared]], axis=2)
    assert away.max() <= plate.tolerance


def test_stresses_are_those_of_the_analysis(flexible, plate):
    """Rows of 16 bits times coordinates at few times give von Mises stresses within what is told."""
    (body,) = [one for one in plate.data["results"][0]["bodies"] if one["name"] == "panel"]
    stress = body["stress"]
    rows = np.flatnonzero(np.diff(flexible.time, prepend=-np.inf) > 0.0)
    coordinates = at(decoded(stress["time"]), decoded(stress["coordinates"]), flexible.time[rows])
    faces = (coordinates @ decoded(stress["rows"]).T).reshape(rows.size, -1, 2, 3)
    expected = stressed(flexible, "panel", rows).von_mises
    off = np.abs(von_mises(faces).max(axis=2) - expected).max()
    assert off <= plate.stress_tolerance
    assert plate.stress_tolerance < 0.03 * expected.max()


def test_ports_of_a_hinge_are_together(flexible, plate):
    """Where a run begins, points of both bodies are one place in the world, through nodes that the page takes."""
    shown = plate.data["results"][0]
    places = {}
    for port in shown["marks"]["ports"]:
        name, _, side = port["name"].rpartition(".")
        point = np.array(port["point"])
        for body in shown["bodies"]:
            if body["name"] == port["body"]:
                nodes = decoded(body["nodes"])
                node = np.argmin(np.linalg.norm(nodes - point, axis=1))
                moved = {
                    **body,
                    "nodes": numbers.single([point]),
                    "forms": numbers.short(
                        decoded(body["forms"]).reshape(-1, 3, body["forms"]["shape"][1])[node]
                    ),
                }
                point = played(moved, flexible.time[:1])[0, 0]
        places.setdefault(name, {})[side] = point
    hinges = [hinge for line in flexible.hinge_lines for hinge in line.hinges]
    assert hinges
    for hinge in hinges:
        np.testing.assert_allclose(places[hinge]["inboard"], places[hinge]["outboard"], atol=1e-3)
    assert len(shown["marks"]["axes"]) == len(hinges)


def test_curves_are_the_recorded_values(result, found):
    """Every row of the run, times in every bit, values in single precision."""
    (one,) = found.data["results"]
    np.testing.assert_array_equal(decoded(one["clock"]), result.time)
    plots = {plot["title"]: {curve["label"]: curve for curve in plot["curves"]} for plot in one["plots"]}
    torque = plots["Latch torques, sum over the hinges of a line"]["hl2"]
    assert torque["rows"] is None
    np.testing.assert_array_equal(
        decoded(torque["values"]), np.float32(line_latch_torque(result, result.hinge_lines[1]))
    )
    angle = plots["Deployment angles"]["hl1"]
    np.testing.assert_array_equal(
        decoded(angle["values"]), np.float32(np.rad2deg(result.signal("hl1_left", "angle")))
    )
    force = plots["Loads: interface, N"]["interface force z"]
    np.testing.assert_array_equal(
        decoded(force["values"]), np.float32(result.signal("base", "interface_force")[:, 2])
    )
    assert {"stored", "dissipated"} <= set(plots["Energy"])


def test_curves_of_long_runs_keep_their_extremes(result, monkeypatch):
    """Fewer rows, each as recorded; the lowest and the highest among them."""
    monkeypatch.setattr(curves, "_LARGEST", 100_000)
    made = curves.contents(curves.panels(result))
    assert sum(len(curve["values"]["data"]) for plot in made for curve in plot["curves"]) < 100_000
    torque = line_latch_torque(result, result.hinge_lines[0])
    (plot,) = [one for one in made if one["title"].startswith("Latch torques")]
    rows, values = (decoded(plot["curves"][0][name]) for name in ("rows", "values"))
    np.testing.assert_array_equal(values, np.float32(torque[rows]))
    assert np.all(np.diff(rows.astype(int)) > 0)
    assert (rows[0], rows[-1]) == (0, result.time.size - 1)
    assert (values.min(), values.max()) == (np.float32(torque.min()), np.float32(torque.max()))


def test_sixteen_bits_are_off_by_half_a_step():
    """The precision that is told; a column of zeros stays one, and no columns are none."""
    values = np.random.default_rng(3).normal(size=(200, 3)) * [1.0, 1e-6, 0.0]
    back = decoded(numbers.short(values))
    largest = np.abs(values).max(axis=0)
    assert np.all(np.abs(back - values) <= 0.5 * numbers.STEP * largest * (1.0 + 1e-12))
    assert decoded(numbers.short(np.zeros((4, 0)))).shape == (4, 0)


def test_no_text_ends_the_script():
    """Bad input: names that are markup come back as they were, and no sign of markup is in the page's data."""
    told = numbers.safe_json({HOSTILE: [HOSTILE, 0.1]})
    assert not set("<>&\u2028\u2029") & set(told)
    assert json.loads(told) == {HOSTILE: [HOSTILE, 0.1]}


def test_what_cannot_be_shown_is_told(result, flexible, monkeypatch):
    """No scene, no face sheets, no room for stresses, a motion that is not finite."""
    assert any(one.startswith("Ports") for one in seen(result).remarks)
    monkeypatch.setattr(bodies.Room, "takes", lambda self, rows: False)
    told = seen(flexible)
    assert any("Stress of panel" in one for one in told.remarks)
    assert told.stress_tolerance == 0.0
    broken = np.array(flexible.signal("panel", "frame_position"))
    broken[3, 0] = np.nan
    wild = replace(flexible, _signals={**flexible._signals, ("panel", "frame_position"): broken})
    told = seen(wild)
    assert any("panel" in one and "finite" in one for one in told.remarks)
    assert "panel" not in [one["name"] for one in told.data["results"][0]["bodies"]]


def test_results_without_bodies_have_plots(result):
    found = seen(replace(result, geometry={}))
    assert (found.has_bodies, found.has_curves) == (False, True)
    assert found.data["results"][0]["bodies"] == []
    json.loads(numbers.safe_json(found.data))
