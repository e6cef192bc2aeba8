"""A run as a series of VTU files, read back by meshio: places, stress and times are those of the result."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.analysis.stress.model import body_stress
from orchestrator.views.placement import placed
from tests.references import synthetic_result as reference

pytestmark = pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before

TIMES = [0.0, 0.03, 0.05]


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate("workbench", until=0.05, tolerance=1e-3, estimate=False)


@pytest.fixture(scope="module")
def series(result, tmp_path_factory):
    (path,) = fanfold.export_view(result, tmp_path_factory.mktemp("series") / "run.pvd", times=TIMES)
    return path


def frames(path: Path):
    listed = ElementTree.parse(path).getroot().iter("DataSet")
    return [(float(one.get("timestep")), meshio.read(path.parent / one.get("file"))) for one in listed]


def rows(result, found):
    return [int(np.flatnonzero(result.time == time)[-1]) for time, _ in found]


def test_times_are_rows_of_the_result(result, series):
    """Each is a recorded row, none farther from what was asked than the rows are apart."""
    times = np.array([time for time, _ in frames(series)])
    assert set(times) <= set(result.time)
    assert np.abs(times - TIMES).max() <= np.diff(result.time).max()


def test_nodes_are_where_the_result_has_them(result, series):
    """Nodes that the picture's mesh shares with the finer one of the stresses stay together in every frame."""
    found = frames(series)
    at = np.array(rows(result, found))
    for name, body in result.geometry.items():
        here = placed(result, name, body, at)
        there = np.array([mesh.points for _, mesh in found])
        apart = np.linalg.norm(here[0][:, None] - there[0][None], axis=2)
        shared = np.flatnonzero(apart.min(axis=1) < 1e-9)
        assert shared.size >= 4, name  # its corners at least
        away = here[:, shared] - there[:, apart.argmin(axis=1)[shared]]
        assert np.linalg.norm(away, axis=2).max() < 1e-9, name


def test_deformation_and_displacement_are_apart(series):
    """At the start nothing has moved; later the panel has turned by far more than it bends."""
    (_, first), *_, (_, last) = frames(series)
    assert np.abs(first.point_data["displacement"]).max() == 0.0
    moved, bent = (np.abs(last.point_data[name]).max() for name in ("displacement", "deformation"))
    assert 0.0 < bent < 0.1 * moved


def test_stress_is_that_of_the_analysis(result, series):
    """The largest of every frame is the one that the analysis of stresses finds at that row."""
    found = frames(series)
    stress = body_stress(result, "panel", lambda plate: np.arange(len(plate.positions)))
    expected = stress.recovery.von_mises(stress.coordinates[rows(result, found)])
    for (_, mesh), values in zip(found, expected, strict=True):
        here = mesh.point_data["von_mises"]
        assert np.isfinite(here).sum() > 100
        assert np.nanmax(here) == pytest.approx(values[np.unique(stress.plate.faces)].max(), rel=1e-12)


def test_bodies_are_named(series, result):
    """Numbers of cells lead to names."""
    (_, mesh), *_ = frames(series)
    names = dict(
        line.split(",") for line in (series.with_suffix("") / "bodies.csv").read_text().splitlines()[1:]
    )
    assert {names[str(int(k))] for part in mesh.cell_data["body"] for k in part} == set(result.geometry)


def test_what_no_series_holds_is_not_lost(result, tmp_path):
    """Other files of the folder, such as pictures of the result, stay; those of a series are replaced when asked."""
    path, folder = tmp_path / "run.pvd", tmp_path / "run"
    fanfold.export_view(result, path, frames=2, stress=False)
    path.unlink()
    with pytest.raises(fanfold.FanfoldError, match="series"):
        fanfold.export_view(result, path, frames=2)
    fanfold.export_view(result, path, frames=1, stress=False, replace=True)
    assert sorted(one.name for one in folder.iterdir()) == ["bodies.csv", "run_0000.vtu"]
    (folder / "steps.png").write_text("mine")
    (folder / "run_0000.vtu").unlink()
    fanfold.export_view(result, path, frames=2, stress=False, replace=True)
    assert sorted(one.name for one in folder.iterdir()) == [
        "bodies.csv",
        "run_0000.vtu",
        "run_0001.vtu",
        "steps.png",
    ]
    assert (folder / "steps.png").read_text() == "mine"


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"times": [99.0]}, "99 s"),
        ({"times": []}, "times"),
        ({"times": [0.0], "frames": 3}, "not both"),
        ({"frames": 0}, "1 to"),
        ({"tolerance": 1e-3}, "tolerance .*vtu"),
    ],
)
def test_what_cannot_be_shown_is_refused(tmp_path, options, sentence):
    """Before anything is written."""
    result = fanfold.Result.open(reference.write(tmp_path / "run.h5"))
    with pytest.raises(fanfold.FanfoldError, match=sentence):
        fanfold.export_view(result, tmp_path / "run.pvd", **options)
    assert not (tmp_path / "run.pvd").exists()
