"""Estimated errors of headline numbers: reference values, messages, and how files keep them."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import h5py
import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.messages import code_of
from orchestrator.results.estimated_errors import error_messages, largest_error, relative_errors
from orchestrator.results.key_figures import headline, headline_rows
from orchestrator.results.result import Result, ResultError
from orchestrator.results.result_file import save, with_errors
from tests.references.synthetic_result import write

ERRORS = {
    ("latch time", "hl1"): 1e-6,
    ("interface force peak", "x"): 0.5,
    ("latch torque peak", "hl1"): inf,
}


@pytest.fixture
def result(tmp_path):
    return Result.open(write(tmp_path / "made.h5"))


@pytest.mark.parametrize("errors", [None, {}, ERRORS])
def test_a_file_keeps_errors(result, tmp_path, errors):
    """Consistency: none requested, none known, and known ones come back from the file, and from a copy."""
    kept = result if errors is None else with_errors(result, errors)
    assert Result.open(result.path).estimated_errors == kept.estimated_errors == errors
    assert save(kept, tmp_path / "copy.h5").estimated_errors == errors


def test_tables_and_json_have_the_errors(result):
    found = headline(with_errors(result, ERRORS))
    by_id = {number.id: number.error for number in found.numbers()}
    assert by_id["latch_time.hl1"] == 1e-6
    assert by_id["latch_torque_peak.hl1"] is by_id["end_time"] is None
    told = found.as_dict()["numbers"]
    assert {name: number["estimated_error"] for name, number in told.items()} == by_id
    shown = {(row[0], row[1]): row[-1] for row in headline_rows(found)}
    assert float(shown["latch time", "hl1"]) == 1e-6


def test_unknown_errors_warn(result):
    """Rule: where errors were requested and none are known; not where none were requested."""
    codes = [
        [code_of(one) for one in headline(found).warnings]
        for found in (result, with_errors(result, {}), with_errors(result, ERRORS))
    ]
    assert [found.count("W-error-unknown") for found in codes] == [0, 1, 0]


@pytest.mark.parametrize("error", [-1.0, float("nan")])
def test_damaged_errors_are_refused(result, error):
    with_errors(result, ERRORS)
    with h5py.File(result.path, "r+") as file:
        file["estimated_errors/error"][0] = error
    with pytest.raises(ResultError, match="damaged"):
        Result.open(result.path)


def test_notes_name_what_is_off_by_ten_tolerances():
    """Convention: a load's component is judged relative to the largest, everything else relative to itself."""
    numbers = [
        (("latch time", "L1"), 4.0),
        (("latch torque peak", "L1"), 100.0),
        (("interface force peak", "x"), 1000.0),
        (("interface force peak", "y"), 0.01),
        (("motor work", ""), 1.0),
        (("latch torque peak", "L2"), 5.0),
    ]
    sizes = (0.5e-3, 0.9, 0.1, 0.009, 0.5)
    errors = {key: size for (key, _), size in zip(numbers, sizes, strict=False)}
    assert error_messages(numbers, errors, 1e-3) == []
    errors["latch torque peak", "L1"] = 1.01
    (sentence,) = error_messages(numbers, errors, 1e-4)[:1]
    assert code_of(sentence) == "W-error"
    errors["latch torque peak", "L1"] = 0.5
    (sentence,) = error_messages(numbers, errors, 1e-4)
    assert code_of(sentence) == "N-tolerance"
    assert "L1" in sentence
    assert " 0.5 %" in sentence
    assert error_messages(numbers, errors, None) == []
    assert largest_error(numbers, errors) == ("latch torque peak of L1", 5e-3)


@pytest.mark.parametrize(("fixed_step", "option"), [(False, "--tolerance"), (True, "--step")])
def test_an_error_that_changes_the_second_digit_is_a_warning(fixed_step, option):
    """Rule: from one per cent on, of numbers that a run promises; loads at single hinges are noted."""
    torque, hinge = ("latch torque peak", "L1"), ("hinge torque peak", "h1")
    errors = {torque: 3.0, hinge: 90.0}
    found = error_messages([(torque, 100.0), (hinge, 100.0)], errors, 1e-4, fixed_step=fixed_step)
    assert [code_of(one) for one in found] == ["W-error", "N-tolerance"]
    assert " 3 %" in found[0]
    assert option in found[0]


def test_what_only_one_run_has_is_a_warning():
    """Rule: a line that latches in one of two runs has a latch time without an error; a repetition is named."""
    key = ("latch time", "L1")
    for numbers in ([(key, 4.0)], []):
        (sentence,) = error_messages(numbers, {key: inf}, 1e-4, refined=1e-5)
        assert code_of(sentence) == "W-error"
        assert "1e-05" in sentence
        assert "--tolerance" not in sentence
        assert largest_error(numbers, {key: inf}) == ("latch time of L1", inf)


@pytest.mark.parametrize(
    ("quantity", "of", "values", "errors", "named"),
    [
        ("stop torque peak", ("root", "tip"), (4000.0, 40.0), (80.0, 20.0), "root"),
        ("contact force max", ("p0", "p1", "p2"), (100.0, 5.0, 9.0), (2.0, 0.5, 1.5), "p0, p2"),
        ("hinge force peak", ("h0", "h1", "h2"), (3.0, 100.0, 5.0), (0.5, 1.5, 2.0), "h1, h2"),
        ("interface force peak", ("x", "y", "z"), (1000.0, 0.0, 500.0), (0.1, 15.0, 20.0), "y, z"),
    ],
)
def test_loads_of_a_kind_are_judged_relative_to_the_largest_in_one_sentence(
    quantity, of, values, errors, named
):
    """Convention: 2 % of the largest; one with a hundredth of that may be off by half of its own value."""
    numbers = [((quantity, one), value) for one, value in zip(of, values, strict=True)]
    (sentence,) = error_messages(numbers, {key: e for (key, _), e in zip(numbers, errors, strict=True)}, 1e-3)
    assert f"of {named}: " in sentence
    assert " 2 %" in sentence


def test_round_off_has_no_relative_error():
    """Rule: a component that is round-off in both runs, and all loads that are round-off relative to others."""
    load = "interface force peak"
    numbers = [((load, axis), value) for axis, value in zip("xyz", (500.0, 1e-7, 1000.0), strict=True)]
    numbers.append((("interface torque peak", "x"), 1e-9))
    errors = {(load, "x"): 20.0, (load, "y"): 1e-7, ("interface torque peak", "x"): 1e-9}
    assert relative_errors(numbers, errors) == {(load, "x"): 0.02}


@pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
def test_a_reduced_recording_keeps_the_errors(tmp_path):
    found = fanfold.simulate("workbench", rigid="all", record=0.01, save=tmp_path / "run.h5")
    again = Result.open(tmp_path / "run.h5")
    assert again.estimated_errors
    assert headline(again).estimated_errors == found.headline.estimated_errors
    assert headline(replace(again, estimated_errors=None)).messages == headline(again).energy_messages
