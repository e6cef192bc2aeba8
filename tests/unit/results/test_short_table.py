"""The short table of a run: rounding by its rule, rows of a made-up deployment."""

from dataclasses import replace

import pytest

from orchestrator.results.key_figures import headline
from orchestrator.results.result import Result
from orchestrator.results.short_table import line_rows, rounded, short_rows
from orchestrator.results.slack_strands import Slack
from tests.references import synthetic_result as reference


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return Result.open(reference.write(tmp_path_factory.mktemp("short") / "run.h5"))


@pytest.fixture(scope="module")
def found(result):
    return headline(result)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (12.02154, 2.3e-4, "12.0215 ± 0.0002"),
        (47.4612, 0.0951, "47.5 ± 0.1"),
        (12345.0, 280.0, "12300 ± 300"),
        (0.0672443, None, "0.06724"),
        (12.3, 0.0, "12.3"),
        (11.147334567, 1e-9, "11.147335 ± 1e-09"),
        (-0.0002, 0.003, "0.000 ± 0.003"),
    ],
)
def test_numbers_are_rounded_to_their_errors(value, error, text):
    """Rule: the last digit is that of the error's only one; eight digits at most, four where no error is known."""
    assert rounded(value, error) == text


def test_every_line_has_a_row(found):
    rows = {row.line: row for row in line_rows(found)}
    assert set(rows) == {line.name for line in reference.LINES}
    line = reference.LINES[1]
    assert rows["hl2"].latched == "8.2"
    assert float(rows["hl2"].torque) == pytest.approx(line.torque_peak, rel=1e-3)
    assert (rows["hl2"].energy, rows["hl2"].impulse) == ("-", "-")
    waits = line_rows(replace(found, latch_times={}, latch_rates={}, unlatched_angles={"hl1": 1.0}))
    assert [row.latched for row in waits] == ["not latched"]


def test_kinds_of_loads_have_a_row_each(found):
    """Magnitude and components of a force in one row, and the extremes of all strands of all cables."""
    rows = {row.quantity: row for row in short_rows(found)}
    assert rows["spacecraft force peak"].note.startswith("x ")
    assert rows["damper torque peak"].note == "damper"
    low, high = map(float, rows["cable tension min/max"].value.split(" / "))
    strands = [found.force_extremes["ccl"][f"tension_{side}"] for side in "ab"]
    assert low == pytest.approx(min(one[0] for one in strands), rel=1e-3)
    assert high == pytest.approx(max(one[1] for one in strands), rel=1e-3)
    assert "slack" not in rows


def test_a_slack_strand_has_its_time(found):
    slack = replace(found, slack=(Slack("loop", "tension_a", 4.9, 10.0),))
    (row,) = (row for row in short_rows(slack) if row.quantity == "slack")
    assert (row.value, row.note) == ("4.9 s to 10 s", "loop A")


def test_a_scene_without_lines_has_its_end_and_what_it_has(tmp_path):
    """Only a damper and a base are left."""
    kept = ("damper", "base", "scene")
    others = tuple(name for name in reference.signals()[1] if name not in kept)
    bare = headline(Result.open(reference.write(tmp_path / "run.h5", leave_out=others)))
    bare = replace(bare, latch_times={}, latch_rates={}, latch_torque_peaks={})
    quantities = [row.quantity for row in short_rows(bare)]
    assert quantities[0] == "end time"
    assert {"spacecraft force peak", "damper torque peak", "energy residual"} <= set(quantities)
