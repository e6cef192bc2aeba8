"""Signals for other programs: the same numbers under names that they take, and a sentence for whatever is refused."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import loadmat

import orchestrator as fanfold
from orchestrator.cli.main import main
from orchestrator.results.result import Result
from orchestrator.views.viewers.matlab import valid_names
from tests.references import synthetic_result as reference

HOSTILE = "=cmd|' /C calc'!A0, \"é\""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return reference.write(tmp_path_factory.mktemp("viewers") / "run.h5")


@pytest.fixture(scope="module")
def result(path):
    return fanfold.Result.open(path)


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        headings, *rows = csv.reader(file)
    values = np.array(rows, dtype=float)
    return dict(zip(headings, values.T, strict=True))


def told(*arguments):
    """What the command refuses with."""
    run = CliRunner().invoke(main, ["export-view", *map(str, arguments)])
    assert run.exit_code in (1, 2), run.output
    assert isinstance(run.exception, SystemExit), run.exception
    return run.stderr


def test_a_table_holds_every_bit_of_every_signal(result, tmp_path):
    """Texts of numbers read back as the same bits, and no signal is missing; events keep both of their rows."""
    (path,) = fanfold.export_view(result, tmp_path / "run.csv")
    found = table(path)
    np.testing.assert_array_equal(found.pop("time (s)"), result.time)
    for name in result.components:
        for variable in result.variables(name):
            unit, values = result.unit(name, variable), result.signal(name, variable)
            index = [""] if values.ndim == 1 else [f"[{k}]" for k in range(1, values.shape[1] + 1)]
            columns = [found.pop(f"{name}.{variable}{k} ({unit})") for k in index]
            np.testing.assert_array_equal(np.array(columns).T.reshape(values.shape), values)
    assert found == {}


def test_rows_at_equal_spacing_are_those_of_at(path, result, tmp_path):
    """The same numbers as `Result.at` gives one by one, up to the end of the run; only signals that were asked for."""
    out = tmp_path / "run.csv"
    run = CliRunner().invoke(
        main,
        ["export-view", str(path), "--out", str(out), "--every", "0.35", "--signals", "hl1_*.angle,yoke"],
    )
    assert (run.exit_code, run.stdout) == (0, f"{out}\n"), run.output
    found = table(out)
    time = found["time (s)"]
    np.testing.assert_allclose(time, 0.35 * np.arange(round(reference.END / 0.35) + 1), rtol=1e-15)
    assert {name.partition(".")[0] for name in found} == {"time (s)", "hl1_left", "hl1_right", "yoke"}
    np.testing.assert_array_equal(found["hl1_left.angle (rad)"], result["hl1_left", "angle"].at(time))
    expected = result["yoke", "frame_position"].at(time)[:, 2]
    np.testing.assert_array_equal(found["yoke.frame_position[2] (m)"], expected)


def test_a_file_of_matlab_holds_signals_units_events_and_modes(result, tmp_path):
    """Read by SciPy as MATLAB sees it: columns, structs by names that are valid, faces counted from 1."""
    (path,) = fanfold.export_view(result, tmp_path / "run.mat", signals=["hl1_left", "yoke"])
    found = loadmat(path, simplify_cells=True)
    np.testing.assert_array_equal(found["time"], result.time)
    assert set(found["signals"]) == {"hl1_left", "yoke"}
    for name, fields in found["signals"].items():
        for field, values in fields.items():
            variable = found["names"][name][field].removeprefix(f"{name}.")
            np.testing.assert_array_equal(values, result.signal(name, variable))
            assert found["units"][name][field] == result.unit(name, variable)
    assert list(found["events"]["event"]) == [text for _, _, text in result.events]
    np.testing.assert_array_equal(found["events"]["time"], [time for time, _, _ in result.events])
    for name, body in result.geometry.items():
        np.testing.assert_array_equal(found["modes"][name]["positions"], body.positions)
        np.testing.assert_array_equal(found["modes"][name]["faces"], body.faces + 1)
    assert found["run"]["complete"] == 1.0


def test_hostile_names_do_no_harm(result, tmp_path):
    """A name is quoted in tables, where no spreadsheet computes it, and in MATLAB becomes one that is valid."""
    signals = {(HOSTILE, "end"): result.time.copy()}
    hostile = replace(
        result,
        path=None,
        _catalogue={HOSTILE: {"end": result._catalogue["hl1_left"]["motor_energy"]}},
        _signals=signals,
    )
    (path,) = fanfold.export_view(hostile, tmp_path / "run.csv")
    assert list(table(path)) == ["time (s)", f"'{HOSTILE}.end (J)"]
    (path,) = fanfold.export_view(hostile, tmp_path / "run.mat")
    found = loadmat(path, simplify_cells=True)
    ((field, variables),) = found["names"].items()
    assert variables == {"xend": f"{HOSTILE}.end"}
    np.testing.assert_array_equal(found["signals"][field]["xend"], result.time)


def test_names_for_matlab_are_valid_and_distinct():
    """Letters, digits and low lines, a letter first, no keyword, at most 63 characters, none twice."""
    names = ["a.b", "a_b", "a-b", "end", "9", "_x", "é", "y" * 70, "y" * 71, "", "a_b_2"]
    found = valid_names(names)
    assert list(found) == names
    assert len(set(found.values())) == len(names)
    assert found["a.b"] == "a_b"
    for name in found.values():
        assert name.isascii()
        assert name.isidentifier()
        assert name[0].isalpha()
        assert len(name) <= 63
        assert name != "end"


def test_what_cannot_be_written_is_told(path, tmp_path):
    """Each in a sentence, before anything is lost."""
    kept = tmp_path / "kept.csv"
    kept.write_text("mine", encoding="utf-8")
    assert "ends with .csv" in told(path, "--out", tmp_path / "a.mat", "--format", "csv")
    assert "'step'" in told(path, "--out", tmp_path / "a.csv", "--format", "step")
    assert "a.step" in told(path, "--out", tmp_path / "a.step")
    assert "exists already" in told(path, "--out", kept)
    assert "'door'" in told(path, "--out", tmp_path / "a.csv", "--signals", "door")
    assert "more than 10000000" in told(path, "--out", tmp_path / "a.csv", "--every", "1e-9")
    assert kept.read_text(encoding="utf-8") == "mine"
    assert [one.name for one in tmp_path.iterdir()] == ["kept.csv"]
    with pytest.raises(fanfold.FanfoldError, match="every"):
        fanfold.export_view(path, tmp_path / "a.csv", every=math.nan)


def test_the_result_itself_is_never_replaced(path, tmp_path):
    """Even where its name ends like an export and leave is given."""
    itself = tmp_path / "run.csv"
    itself.write_bytes(path.read_bytes())
    assert "itself" in told(itself, "--out", itself, "--replace")
    (tmp_path / "link.csv").hardlink_to(itself)
    assert "itself" in told(itself, "--out", tmp_path / "link.csv", "--replace")
    assert Result.open(itself).complete


@pytest.mark.parametrize("ending", ["csv", "mat", "glb", "pvd"])
def test_folders_that_are_not_there_are_told_at_once(path, tmp_path, ending):
    """Regression: a sentence of SciPy's, and for a series after all of its work."""
    assert str(tmp_path / "none") in told(path, "--out", tmp_path / "none" / f"wing.{ending}")


def test_damaged_and_interrupted_results_are_told(path, tmp_path):
    """A damaged signal leaves no file behind; of an interrupted run a warning says how far it goes."""
    spoiled = tmp_path / "spoiled.h5"
    spoiled.write_bytes(path.read_bytes())
    with h5py.File(spoiled, "r+") as file:
        file["signals/hl1_left/angle"][3] = np.nan
    for name in ("a.csv", "a.mat"):
        assert "hl1_left.angle is damaged" in told(spoiled, "--out", tmp_path / name)
    with h5py.File(spoiled, "r+") as file:
        file.attrs["complete"] = False
    out = tmp_path / "part.csv"
    with pytest.warns(fanfold.FanfoldWarning, match="interrupted at 14 s"):
        fanfold.export_view(spoiled, out, signals="yoke")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["part.csv", "spoiled.h5"]
