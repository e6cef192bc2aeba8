"""Estimated errors: from steps twice as long, kept in the file, told of where a number cannot be vouched for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.cosim.settings import Settings
from orchestrator.messages import code_of
from orchestrator.results.error_sources.sampling_error import judged_peaks
from orchestrator.results.estimated_errors import (
    ESTIMATED_ERRORS,
    POINT_PEAKS,
    EstimatedError,
    beside_their_vector,
    error_messages,
    errors_text,
    estimated_errors,
    tabulated_errors,
)
from orchestrator.results.key_figures import headline, headline_rows
from orchestrator.results.result import Result, ResultError
from orchestrator.results.result_file import with_statistics
from orchestrator.run import error_estimate as companion
from orchestrator.run.error_estimate import doubled, halved, with_estimates
from orchestrator.run.run import RunError, run
from tests.unit.analysis.sampling.flap import ANGLE, STIFFNESS, flap
from tests.unit.run.test_verify import smooth_scene

needs_native = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")


def test_doubled_steps():
    """Closed form: two steps as one, segment by segment; an odd one stands alone; the last, which ends it, longer."""
    assert doubled([[0.25, 0.25, 0.5], [], [1.0, 2.0]]) == [[0.5, 1.1 * 0.5], [], [1.1 * 3.0]]


def test_halved_steps():
    """Closed form: each step as two, and the last, which ends its segment, longer."""
    assert halved([[0.25, 0.5], []]) == [[0.125, 0.125, 0.25, 1.1 * 0.25], []]


@needs_native
def test_half_the_steps_tell_where_twice_as_long_fail(estimated, monkeypatch):
    """Against the same reference, within a factor of five. Regression: no error was known, and all was run again."""
    _, truth = estimated
    true = {number.key: number.value for number in truth.numbers()}
    settings, plans = Settings(tolerance=1e-3), []
    outcome = run(smooth_scene(), None, settings, 2.4)

    def once_too_long(*arguments, **others):
        plans.append(arguments[2].step_plan)
        if len(plans) == 1:
            raise RunError("too long")
        return run(*arguments, **others)

    monkeypatch.setattr(companion, "run", once_too_long)
    found = with_estimates(smooth_scene(), outcome, settings, 2.4).headline
    assert plans == [doubled(outcome.segments), halved(outcome.segments)]
    for number in found.numbers():
        if number.quantity in ("latch time", "latch torque peak"):
            error, seen = abs(number.value - true[number.key]), 1e-5 * abs(number.value)
            assert number.error + seen >= 0.2 * error
            assert number.error <= 5.0 * error + seen


@needs_native
@pytest.mark.parametrize(("part", "plans"), [(0.0, 1), (0.1, 2)])
def test_half_the_steps_tell_where_twice_as_long_are_divided(monkeypatch, part, plans):
    """Rule: a companion that takes the run's own steps again tells nothing of them.

    Regression: links of a gram told latch times to 1.5e-7 s that were off by 2.6e-6 s.
    """
    made = []
    outcome = run(smooth_scene(), None, Settings(tolerance=1e-3), 2.4)

    def divided(*arguments, **others):
        made.append(arguments[2].step_plan)
        found = run(*arguments, **others)
        return replace(found, segments=[[*one, *one[: round(part * len(one))]] for one in found.segments])

    monkeypatch.setattr(companion, "run", divided)
    assert with_estimates(smooth_scene(), outcome, Settings(tolerance=1e-3), 2.4).headline.estimated_errors
    assert made == [doubled(outcome.segments), halved(outcome.segments)][:plans]


@needs_native
def test_a_torque_that_comes_at_once_with_a_latch_up():
    """Closed form: a latch of damping ratio z > 1/2 meets the rate sqrt(2 T a / J) with 2 z sqrt(2 k T a), its peak.

    Within ten tolerances, which are promised. The wing has no forces but round-off, of which nothing is said.
    """
    found = fanfold.simulate(flap(damping_ratio=2.0), estimate=True)
    peak = next(one for one in headline(found).numbers() if one.quantity == "latch torque peak")
    assert peak.value == pytest.approx(4.0 * (2.0 * STIFFNESS * ANGLE) ** 0.5, rel=1e-5)
    assert not [sentence for sentence in headline(found).warnings if "force" in sentence]


@pytest.fixture(scope="module")
def estimated(tmp_path_factory):
    """A coarse run with its estimates, and the headline of a run at a hundredth of its tolerance."""
    folder = tmp_path_factory.mktemp("estimated")
    assembly = smooth_scene()
    settings = Settings(tolerance=1e-3)
    outcome = run(assembly, folder / "run.h5", settings, 2.4)
    outcome = with_estimates(assembly, outcome, settings, 2.4)
    tight = run(assembly, folder / "tight.h5", Settings(tolerance=1e-5), 2.4)
    return outcome, tight.headline


@needs_native
@pytest.mark.parametrize("quantity", ["latch time", "latch torque peak"])
def test_estimates_are_near_the_true_errors(estimated, quantity):
    """Against a run at a hundredth of the tolerance: within a factor of five where there is an error to see."""
    outcome, truth = estimated
    true = {number.key: number.value for number in truth.numbers()}
    found = [number for number in outcome.headline.numbers() if number.quantity == quantity]
    assert found
    for number in found:
        error = abs(number.value - true[number.key])
        seen = 1e-5 * abs(number.value)
        assert number.error + seen >= 0.2 * error
        assert number.error <= 5.0 * error + seen


@needs_native
def test_errors_that_nobody_knows_are_told(estimated):
    """Rule: where errors were to be estimated and none are known, no number is vouched for; else nothing is said."""
    outcome, _ = estimated
    nothing = replace(
        outcome.result, statistics={**outcome.result.statistics, ESTIMATED_ERRORS: errors_text({})}
    )
    codes = [[code_of(w) for w in headline(r).warnings] for r in (outcome.result, nothing)]
    assert [found.count("W-error-unknown") for found in codes] == [0, 1]


@needs_native
def test_file_and_table_hold_the_estimates(estimated):
    outcome, _ = estimated
    again = headline(Result.open(outcome.path))
    assert again.estimated_errors == outcome.headline.estimated_errors != {}
    shown = {row[0]: row[-1] for row in headline_rows(again)}
    assert float(shown["latch time"]) > 0.0
    assert shown["end time"] == ""
    told = again.as_dict()["numbers"]
    assert told["end_time"]["estimated_error"] is None
    assert all(told[number.id]["estimated_error"] == number.error for number in again.numbers())
    assert again.estimated_errors["latch rate", next(iter(again.latch_rates))] > 0.0


@needs_native
def test_damaged_estimates_are_told_of(estimated, tmp_path):
    path = tmp_path / "damaged.h5"
    path.write_bytes(estimated[0].path.read_bytes())
    with_statistics(Result.open(path), {"estimated_errors": '[["latch time", 1]]'})
    with pytest.raises(ResultError, match="estimated errors of the result are damaged"):
        headline(Result.open(path))


def test_text_and_back():
    errors = {
        ("latch time", "L1"): EstimatedError(1e-6, 4e-6),
        ("interface force peak", "x"): EstimatedError(0.5, 2.0),
    }
    text = errors_text(errors)

    class Kept:
        statistics = {"estimated_errors": text}  # noqa: RUF012
        path = "kept.h5"

    assert estimated_errors(Kept()) == errors


def test_doubts_name_what_is_off_by_ten_tolerances():
    """A load's component is judged beside the largest, everything else beside itself, by its largest error."""
    numbers = [
        (("latch time", "L1"), 4.0),
        (("latch torque peak", "L1"), 100.0),
        (("interface force peak", "x"), 1000.0),
        (("interface force peak", "y"), 0.01),
        (("motor work", ""), 1.0),
        (("latch torque peak", "L2"), 5.0),
    ]
    most = (0.5e-3, 2.0, 0.1, 0.009, 0.5)
    errors = {key: EstimatedError(0.25 * m, m) for (key, _), m in zip(numbers, most, strict=False)}
    (sentence,) = error_messages(numbers, errors, 1e-3)
    assert code_of(sentence) == "N-tolerance"
    assert "L1" in sentence
    assert " 2 %" in sentence
    assert error_messages(numbers, errors, None) == []


@pytest.mark.parametrize(("fixed_step", "option"), [(False, "--tolerance"), (True, "--step")])
def test_an_error_that_changes_the_second_digit_is_a_warning(fixed_step, option):
    """Rule: from one per cent on, of numbers that a run promises; what a table shows is what the warning says."""
    torque, hinge = ("latch torque peak", "L1"), ("hinge torque peak", "h1")
    errors = {torque: EstimatedError(1.2, 3.0), hinge: EstimatedError(50.0, 90.0)}
    found = error_messages([(torque, 100.0), (hinge, 100.0)], errors, 1e-4, fixed_step=fixed_step)
    assert [code_of(one) for one in found] == ["W-error", "N-tolerance"]
    assert " 3 %" in found[0]
    assert option in found[0]


def test_the_table_has_the_error_that_the_sentence_tells():
    """Regression, wing 910108: 2.1e-4 N.m in the table for what the sentence told to be off by a tenth of 42 N.m."""
    sure, unsure = ("latch time", "L1"), ("interface torque peak", "y")
    errors = {sure: EstimatedError(1e-4, 4e-4), unsure: EstimatedError(2.1e-4, 4.2)}
    numbers = [(sure, 4.0), (unsure, 42.0)]
    assert tabulated_errors(numbers, errors, 1e-4) == {sure: 1e-4, unsure: 4.2}
    (sentence,) = error_messages(numbers, errors, 1e-4)
    assert " 10 %" in sentence
    assert tabulated_errors(numbers, errors, None) == {sure: 1e-4, unsure: 2.1e-4}


def test_a_stop_is_doubted_beside_the_one_that_is_struck_the_hardest():
    """Convention: 2 % of the largest; one that is touched with a hundredth of that may be off by half of it."""
    hard, soft = ("stop torque peak", "root_stop"), ("stop torque peak", "tip_stop")
    errors = {hard: EstimatedError(40.0, 80.0), soft: EstimatedError(5.0, 20.0)}
    (sentence,) = error_messages([(hard, 4000.0), (soft, 40.0)], errors, 1e-3)
    assert "root_stop" in sentence
    assert "tip_stop" not in sentence
    assert " 2 %" in sentence


@pytest.mark.parametrize(
    ("quantity", "of", "values", "most", "told"),
    [
        (
            "contact force max", ("pad0", "pad1", "pad2"), (100.0, 5.0, 9.0), (4.0, 0.5, 2.0),
            "pad0, pad2",
        ),
        (
            "hinge force peak", ("h0", "h1", "h2"), (3.0, 100.0, 5.0), (0.5, 2.0, 4.0),
            "h1, h2",
        ),
    ],
)  # fmt: skip
def test_loads_of_a_kind_are_doubted_beside_the_largest_in_one_sentence(quantity, of, values, most, told):
    """Convention as for stops. Regression: nothing said that forces of contacts, or at hinges, may be off."""
    keys = [(quantity, name) for name in of]
    errors = {key: EstimatedError(1.0, error) for key, error in zip(keys, most, strict=True)}
    (sentence,) = error_messages(list(zip(keys, values, strict=True)), errors, 1e-3)
    assert told in sentence
    assert " 4 %" in sentence


@needs_native
def test_rows_tell_of_the_peak_at_every_port_and_hinge(estimated):
    """Definition: of every load with an error that steps leave, the signal whose largest magnitude it is."""
    outcome, _ = estimated
    told = {number.key: number.value for number in outcome.headline.numbers()}
    judged = dict(judged_peaks(outcome.result))
    assert {key for key in told if key[0] in POINT_PEAKS} == {key for key in judged if key[0] in POINT_PEAKS}
    for key, values in judged.items():
        assert np.abs(values).max() == pytest.approx(told[key], rel=1e-3, abs=1e-8)


def test_components_of_a_load_are_doubted_in_one_sentence():
    """Rule: a component that is nothing has no size of its own that it could be off by."""
    load = "interface force peak"
    numbers = [((load, axis), value) for axis, value in zip("xyz", (1000.0, 0.0, 500.0), strict=True)]
    errors = {(load, "y"): EstimatedError(10.0, 40.0), (load, "z"): EstimatedError(5.0, 20.0)}
    (sentence,) = error_messages(numbers, errors, 1e-3)
    assert "y, z" in sentence
    assert " 4 %" in sentence


def test_a_component_that_is_round_off_in_both_runs_is_not_doubted():
    """Rule. Regression: errors of its neighbours were said of a component that is zero by symmetry."""
    load = "interface force peak"
    numbers = [((load, axis), value) for axis, value in zip("xyz", (500.0, 1e-7, 1000.0), strict=True)]
    errors = {(load, "x"): EstimatedError(5.0, 20.0), (load, "y"): EstimatedError(1e-7, 1e-7)}
    errors[load, "z"] = EstimatedError(400.0, 700.0)
    large, small = error_messages(numbers, beside_their_vector(errors), 1e-3)
    assert [code_of(large), code_of(small)] == ["W-error", "N-tolerance"]
    assert " of z: " in large
    assert " 70 %" in large
    assert " of x: " in small


def test_components_of_one_load_ring_together():
    """Wing 60 of the campaign: torque about x was off by 12 tolerances, of which neighbours told and it did not."""
    load = "interface torque peak"
    errors = {(load, "x"): EstimatedError(1.0, 4.0), (load, "y"): EstimatedError(100.0, 400.0)}
    errors[("latch torque peak", "L")] = EstimatedError(0.1, 0.4)
    found = beside_their_vector(errors)
    assert found[load, "x"] == EstimatedError(1.0, 40.0)
    assert [found[key] for key in list(errors)[1:]] == [errors[key] for key in list(errors)[1:]]
