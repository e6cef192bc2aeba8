"""Two results side by side, against the closed forms of made-up deployments that differ by known factors."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.axes import Axes
from matplotlib.image import imread
from rich.console import Console

from orchestrator.cli.compare import comparison_table
from orchestrator.cli.main import main
from orchestrator.results.compare import Compared, cells, compare, end_note, labels
from orchestrator.results.result import Result
from orchestrator.views import comparison as compare_plots
from orchestrator.views.plots import write_all
from tests.references import synthetic_result as reference

LATER, STRONGER = 0.25, 1.5
"""B is A with all torques stronger and everything later."""
EVERY_OVERLAY = {"angles", "latch_torques", "interface_loads", "closed_cable_loop_loads", "damper_loads"}


def altered(path, leave_out=()):
    """The made-up deployment with its times shifted, and torques and forces scaled."""
    reference.write(path, leave_out=leave_out)
    with h5py.File(path, "r+") as file:
        file["time"][:] += LATER
        file["events"]["time"][:] += LATER
        for group in file["signals"].values():
            for signal in group.values():
                if signal.attrs["unit"] in ("N", "N.m"):
                    signal[:] *= STRONGER
    return path


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compare")
    return Result.open(reference.write(folder / "a.h5")), Result.open(altered(folder / "b.h5"))


@pytest.fixture(scope="module")
def hinges(tmp_path_factory):
    """Files of both with nothing but the first hinge line, which has two overlays; each takes half a second."""
    folder = tmp_path_factory.mktemp("hinges")
    others = tuple(name for name in reference.signals()[1] if not name.startswith("hl1"))
    return reference.write(folder / "a.h5", leave_out=others), altered(folder / "b.h5", others)


@pytest.fixture(scope="module")
def rows(both):
    return {(row.quantity, row.of): row for row in compare(*both).rows}


def fanfold(*arguments):
    result = CliRunner().invoke(main, ["compare", *(str(a) for a in arguments)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def test_latch_events_shift(rows):
    for line in reference.LINES:
        row = rows["latch-up", line.name]
        assert row.time_a == line.latch_time
        assert row.shift == pytest.approx(LATER, rel=1e-12)
        assert (row.a, row.b, row.ratio, row.unit) == (None, None, None, "s")


def test_peaks_are_the_true_ones_with_ratio_and_shift(rows):
    """Peaks lie between samples; the bound is that of cubic interpolation (test_summary)."""
    for line in reference.LINES:
        row = rows["latch torque peak", line.name]
        assert row.a == pytest.approx(line.torque_peak, rel=2e-5)
        assert row.b == pytest.approx(STRONGER * line.torque_peak, rel=2e-5)
        assert row.ratio == pytest.approx(STRONGER, rel=1e-9)
        assert row.shift == pytest.approx(LATER, rel=1e-6)
        steepest = np.arctan(line.frequency / line.decay)
        after = (steepest - line._phase) / line.frequency
        assert row.time_a == pytest.approx(line.latch_time + after, abs=1e-4)


def test_every_load_is_compared(rows):
    loads = {
        ("interface force peak", "base x"),
        ("interface force peak", "base z"),
        ("interface torque peak", "base y"),
        ("strand A tension peak", "ccl"),
        ("strand B tension peak", "ccl"),
        ("axial force peak", "ccl"),
        ("lateral force peak", "ccl"),
        ("damper torque peak", "damper"),
    }
    of_lines = ("latch-up", "latch rate", "latch torque peak")
    lines = {(q, line.name) for q in of_lines for line in reference.LINES}
    assert set(rows) == loads | lines  # nothing for what is zero in both, such as the force along y
    for key in loads:
        assert rows[key].ratio == pytest.approx(STRONGER, rel=1e-9)
    assert rows["interface force peak", "base z"].a == pytest.approx(3.0, rel=1e-8)


def test_a_result_against_itself(both):
    """Sanity: all ratios are 1, all shifts 0, no signal is missing."""
    found = compare(both[0], both[0])
    assert {row.ratio for row in found.rows} == {None, 1.0}
    assert {row.shift for row in found.rows if row.time_a is not None} == {0.0}
    assert found.only_a == found.only_b == ()


def test_what_only_one_has_is_listed(both, tmp_path):
    short = Result.open(reference.write(tmp_path / "short.h5", leave_out=("damper", "panel2")))
    found = compare(both[0], short)
    assert found.only_a == (
        "damper.damper_torque",
        "damper.dissipated_energy",
        "panel2.frame_position",
        "panel2.frame_orientation",
        "panel2.dissipated_energy",
        "panel2.modal_coordinate",
    )
    assert found.only_b == ()
    row = next(row for row in found.rows if row.quantity == "damper torque peak")
    assert row.a > 0.0
    assert (row.b, row.ratio, row.shift) == (None, None, None)
    mirrored = compare(short, both[0])
    assert mirrored.only_b == found.only_a
    assert next(row for row in mirrored.rows if row.quantity == "damper torque peak").a is None


def test_nothing_to_divide_by_gives_no_ratio():
    assert Compared("force", "x", "N", 0.0, 2.0, 1.0, 1.5).ratio is None
    assert Compared("force", "x", "N", 2.0, 0.0, 1.0, 1.5).ratio == 0.0
    assert Compared("force", "x", "N", 2.0, None, 1.0, None).shift is None


def test_results_have_names_that_differ(both):
    a, b = both
    assert labels(a, b) == ("a", "b")
    elsewhere = replace(b, path=Path("other") / "a.h5")
    assert len(set(labels(a, elsewhere))) == 2
    assert len(set(labels(a, a))) == 2


def test_overlays_hold_both_curves_at_their_own_times(both, tmp_path):
    drawings = list(compare_plots.draw_comparison(*both))
    drawn = {name: figure for name, _, figure in drawings}
    assert set(drawn) == EVERY_OVERLAY
    for figure in drawn.values():
        for axes in filter(Axes.get_visible, figure.axes):
            assert axes.get_ylabel().rpartition(", ")[2] in ("deg", "N", "N.m")
            assert axes.get_xlabel().endswith(", s")
            first, second = axes.lines
            assert first.get_color() != second.get_color()
            assert first.get_linestyle() != second.get_linestyle()
    first, second = drawn["damper_loads"].axes[0].lines
    np.testing.assert_allclose(np.asarray(second.get_xdata()) - first.get_xdata(), LATER, rtol=1e-9)
    np.testing.assert_allclose(second.get_ydata(), STRONGER * np.asarray(first.get_ydata()), rtol=1e-12)
    # the close-ups count from each run's own latch-up, so the shift is gone
    first, second = drawn["latch_torques"].axes[1].lines
    np.testing.assert_allclose(second.get_xdata(), first.get_xdata(), atol=1e-9)
    for path in write_all(drawings, tmp_path / "pictures"):
        assert imread(path)[..., :3].std() > 0.02


def test_overlay_of_what_only_one_has(both, tmp_path):
    short = Result.open(reference.write(tmp_path / "short.h5", leave_out=("damper",)))
    drawn = {name: figure for name, _, figure in compare_plots.draw_comparison(both[0], short)}
    assert len(drawn["damper_loads"].axes[0].lines) == 1


def test_command_prints_a_table_and_draws(hinges, tmp_path):
    result = fanfold(*hinges, "--output", tmp_path / "pictures")
    assert result.exit_code == 0
    assert "latch torque" in result.stdout
    assert "1.5000" in result.stdout
    assert "+0.2500" in result.stdout
    pictures = {path.name for path in (tmp_path / "pictures").iterdir()}
    assert pictures == {"compare_angles.png", "compare_latch_torques.png"}


def test_command_tells_what_only_one_has_and_what_was_interrupted(tmp_path):
    hinges = tuple(name for name in reference.signals()[1] if name.startswith("hl"))
    whole = reference.write(tmp_path / "a.h5", leave_out=(*hinges, "base"))
    short = reference.write(tmp_path / "short.h5", leave_out=(*hinges, "base", "damper", "panel2"))
    with h5py.File(short, "r+") as file:
        file.attrs["complete"] = False
        del file["signals"]["ccl"]["torque_1"]
    result = fanfold(whole, short, "--output", tmp_path)
    assert result.exit_code == 0
    said = result.stdout.splitlines()
    assert "only in a: damper" in said
    assert "only in a: ccl: torque_1" in said
    assert any("short" in line and "14 s" in line for line in said)


def test_json_of_the_command(hinges, tmp_path):
    result = fanfold(*hinges, "--output", tmp_path, "--json")
    content = json.loads(result.stdout)
    row = next(row for row in content["rows"] if (row["quantity"], row["of"]) == ("latch torque peak", "hl1"))
    assert row["ratio"] == pytest.approx(STRONGER)
    assert row["unit"] == "N.m"
    assert content["only_a"] == content["only_b"] == []
    assert len(content["pictures"]) == 2
    assert all(Path(path).is_file() for path in content["pictures"])


def test_what_is_no_result_is_told(both, tmp_path):
    (tmp_path / "no.h5").write_bytes(b"no result")
    result = fanfold(both[0].path, tmp_path / "no.h5")
    assert result.exit_code == 1
    assert f"{tmp_path / 'no.h5'}: " in result.stderr


def test_round_off_is_no_load(both, tmp_path):
    """1e-9 N beside 3 N is noise: no ratio, no shift, and no row where both have no more."""
    noisy = reference.write(tmp_path / "noisy.h5")
    with h5py.File(noisy, "r+") as file:
        file["signals"]["base"]["interface_force"][:, 0] = 1e-9
        file["signals"]["base"]["interface_force"][:, 1] = 1e-9
    found = compare(Result.open(noisy), both[1])
    rows = {row.of: row for row in found.rows if row.quantity == "interface force peak"}
    assert set(rows) == {"base x", "base z"}
    assert (rows["base x"].noise_a, rows["base x"].noise_b) == (True, False)
    assert (rows["base x"].ratio, rows["base x"].shift) == (None, None)
    assert cells(rows["base x"])[0] == "noise"
    assert rows["base z"].ratio == pytest.approx(STRONGER, rel=1e-9)


def test_small_beside_its_like_has_no_ratio(both, tmp_path):
    """Rule: a component below the tolerance beside the largest, 1e-4 of 3 N, is not resolved; "-" for its ratio."""
    path = reference.write(tmp_path / "small.h5")
    with h5py.File(path, "r+") as file:
        file["provenance"]["tolerance"] = "0.0001"
        file["signals"]["base"]["interface_force"][:, 0] = 2e-4
    rows = {(row.quantity, row.of): row for row in compare(Result.open(path), both[1]).rows}
    small, large = rows["interface force peak", "base x"], rows["interface force peak", "base z"]
    assert (small.a, small.noise_a, small.ratio) == (pytest.approx(2e-4), False, None)
    assert cells(small)[2] == "-"
    assert large.ratio == pytest.approx(STRONGER, rel=1e-9)


def test_every_heading_stands_once_and_rows_have_identifiers(both):
    """Regression: tensions of two cables had their heading by turns."""
    quantities = [row.quantity for row in compare(*both).rows]
    assert len(set(quantities)) == sum(a != b for a, b in zip(quantities, ["", *quantities], strict=False))
    names = {row.as_dict()["id"] for row in compare(*both).rows}
    assert {"latch_time.hl1", "latch_rate.hl1", "interface_force_peak.x", "tension_a_peak.ccl"} <= names


def test_table_at_80_columns_is_whole(both):
    """Latch-ups show both times; nothing is cut."""
    console = Console(width=80, record=True)
    console.print(comparison_table(compare(*both), ("a", "b")))
    text = console.export_text()
    assert "\u2026" not in text
    (row,) = (line.split() for line in text.splitlines() if line.split()[:2] == ["hl1", "6.00000"])
    assert row == ["hl1", "6.00000", "6.25000", "+0.25000", "s"]


def test_different_ends_are_told(both):
    assert "a ends at 14 s, b at 14.25 s" in end_note(*both, ("a", "b"))
    assert end_note(both[0], both[0], ("a", "b")) == ""


def test_interrupted_run_is_named_in_the_legend(both):
    stopped = replace(both[1], complete=False)
    drawing = next(compare_plots.draw_comparison(both[0], stopped))
    (legend,) = drawing.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["a", "b, interrupted at t = 14.25 s"]


def test_angles_are_told_in_degrees():
    """For people, as all tables; as plain numbers in rad."""
    row = Compared("attitude peak", "base x", "rad", 0.01, 0.02, 1.0, 1.5)
    assert cells(row)[:2] == ("0.57296", "1.1459")
    assert cells(row)[-1] == "deg"
    assert (row.as_dict()["a"], row.as_dict()["unit"]) == (0.01, "rad")
