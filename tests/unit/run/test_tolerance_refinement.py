"""Runs that are likely to miss their tolerance are repeated at a smaller one, which the result is not judged by."""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path
from shutil import copy

import pytest

from fmus import native_library
from orchestrator.cosim.settings import Settings
from orchestrator.messages import code_of
from orchestrator.results.estimated_errors import (
    ESTIMATED_ERRORS,
    EstimatedError,
    errors_text,
    estimated_errors,
)
from orchestrator.results.key_figures import headline
from orchestrator.results.result import Result
from orchestrator.results.result_file import with_statistics
from orchestrator.run import tolerance_refinement as refinement
from orchestrator.run.error_estimate import with_estimates
from orchestrator.run.run import RunError, run
from orchestrator.run.tolerance_refinement import (
    error_in_tolerances,
    is_too_uncertain,
    refined,
    smaller_tolerance,
)
from tests.unit.run.test_verify import smooth_scene

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
ASKED = Settings(tolerance=1e-3)
LEAST = 1e-5
"""That a run is repeated at whose errors are not known to fall."""
UNTIL = 2.4


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run that keeps its tolerance, and says so."""
    path, assembly = tmp_path_factory.mktemp("finished") / "run.h5", smooth_scene()
    return with_estimates(assembly, run(assembly, path, ASKED, UNTIL), ASKED, UNTIL)


@pytest.fixture
def outcome(finished, tmp_path):
    """The same in a file of its own."""
    path = Path(copy(finished.path, tmp_path))
    return replace(finished, result=replace(finished.result, path=path))


def claiming(outcome, errors):
    """The same with other estimated errors, in its file as well."""
    result = with_statistics(outcome.result, {ESTIMATED_ERRORS: errors_text(errors)})
    return replace(outcome, result=result, headline=headline(result))


def off_by(outcome, likely, most=None):
    """The same that says that its first latch time is off by so many tolerances, likely and at the most."""
    line, time = next(iter(outcome.headline.latch_times.items()))
    error = EstimatedError(*(tolerances * ASKED.tolerance * time for tolerances in (likely, most or likely)))
    return claiming(outcome, {("latch time", line): error})


def numbers(outcome):
    """Headline numbers of a run and their keys."""
    return [(number.key, number.value) for number in outcome.headline.numbers()]


def test_how_far_to_go():
    """Closed form: five times less error a decade of tolerance, aiming at 3 tolerances; down to the least."""
    assert smaller_tolerance(1e-3, 15.0, LEAST) == pytest.approx(1e-4)
    assert smaller_tolerance(1e-3, 75.0, LEAST) == smaller_tolerance(1e-3, 1e9, LEAST) == pytest.approx(LEAST)
    assert smaller_tolerance(1e-3, inf, LEAST) == pytest.approx(1e-4)
    assert smaller_tolerance(2e-10, 1e3, 2e-12) == 1e-10


def test_a_run_that_keeps_its_tolerance_stays(outcome):
    """Rule: it is not repeated, nor one with steps that were given, nor one whose errors nobody estimated.

    Kept is what is likely to be six tolerances off at the most, as estimates are within a factor of two.
    """
    bad = off_by(outcome, 60.0)
    assert refined(smooth_scene(), off_by(outcome, 5.9, 9.0), ASKED, UNTIL)[0].segments == outcome.segments
    assert is_too_uncertain(off_by(outcome, 6.1), ASKED.tolerance)
    given = replace(ASKED, step_plan=outcome.segments)
    assert refined(smooth_scene(), bad, given, UNTIL) == (bad, given)


@pytest.mark.parametrize("unknown", [False, True])
def test_a_run_that_misses_is_repeated(outcome, tmp_path, unknown):
    """Rule: the repetition takes its place, in the file too, and is judged by the tolerance that was asked for."""
    bad, said = claiming(outcome, {}) if unknown else off_by(outcome, 60.0), []
    better, settings = refined(smooth_scene(), bad, ASKED, UNTIL, warn=said.append)
    assert settings.tolerance == smaller_tolerance(1e-3, inf if unknown else 60.0, LEAST)
    assert better.costs.steps > outcome.costs.steps
    assert error_in_tolerances(better, 1e-3).most < error_in_tolerances(outcome, 1e-3).most < 10.0
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]
    kept = Result.open(tmp_path / "run.h5")
    assert (kept.provenance["tolerance"], headline(kept)) == ("0.001", better.headline)
    (sentence,) = said
    assert code_of(sentence) == "N-repeated"
    assert f" {settings.tolerance:.2g}." in sentence
    assert unknown or re.search(r"latch time of \w+ .* 60 times", sentence)


def test_a_repetition_is_no_surer_than_its_numbers_moved(outcome):
    """Closed form: a decade leaves a fifth of an error, a quarter of what a number moved by; twice that at the most."""
    bad = off_by(outcome, 15.0)
    key, before = next((key, value - 2e-3) for key, value in numbers(bad) if key[0] == "latch time")
    far = replace(bad, headline=replace(bad.headline, latch_times={key[1]: before}))
    better, _ = refined(smooth_scene(), far, ASKED, UNTIL)
    moved = dict(numbers(better))[key] - before
    found = estimated_errors(better.result)[key]
    # 15 tolerances of a time that is a little less make a little more than a decade
    assert tuple(found) == pytest.approx((0.25 * moved, 0.5 * moved), rel=5e-3)
    assert estimated_errors(Result.open(better.path))[key] == found


def test_numbers_of_latch_ups_are_held_to_what_they_may_be_off_by(outcome):
    """Rule: such a run is repeated though nothing is likely to be wrong; for the load of an interface it is not."""
    quantity, peaks = "interface force peak", outcome.headline.interface_force_peaks
    error = EstimatedError(*(n * ASKED.tolerance * max(peaks) for n in (5.0, 75.0)))
    loaded = claiming(outcome, {(quantity, "xyz"[peaks.index(max(peaks))]): error})
    assert refined(smooth_scene(), loaded, ASKED, UNTIL) == (loaded, ASKED)
    said = []
    settings = refined(smooth_scene(), off_by(outcome, 5.0, 75.0), ASKED, UNTIL, warn=said.append)[1]
    assert settings.tolerance == smaller_tolerance(1e-3, 75.0, LEAST)
    assert re.search(r"latch time of \w+ .* 75 times .* 0.001", said[0])


def test_errors_that_do_not_fall_lead_to_the_smallest_tolerance(outcome, monkeypatch):
    """Rule: a hundredth of the tolerance asked for is tried before it is given up, and nothing beyond it."""
    said = []
    monkeypatch.setattr(refinement, "with_estimates", lambda _, found, *__: off_by(found, 20.0))
    settings = refined(smooth_scene(), off_by(outcome, 20.0), ASKED, UNTIL, warn=said.append)[1]
    assert settings.tolerance == pytest.approx(1e-5)
    assert len(said) == 2


def test_errors_that_fall_lead_further(outcome, monkeypatch):
    """Rule: where errors have fallen, a thousandth is tried. Regression: impulses ended at 18 and 20 tolerances."""
    errors = iter((300.0, 60.0, 12.0, 11.0))
    monkeypatch.setattr(refinement, "_MOST_TIMES", 100.0)
    monkeypatch.setattr(refinement, "with_estimates", lambda _, found, *__: off_by(found, next(errors)))
    settings = refined(smooth_scene(), off_by(outcome, 1500.0), ASKED, UNTIL)[1]
    assert settings.tolerance == pytest.approx(1e-6)
    assert next(errors) == 12.0


@pytest.mark.parametrize("predicted", [None, 1.0])
def test_a_repetition_that_costs_too_much_is_not_made(outcome, monkeypatch, predicted):
    """Rule: neither one that its tolerance makes costly, nor one that turns out so. The result states the cost."""
    said, bad = [], off_by(outcome, 60.0)
    monkeypatch.setattr(refinement, "_MOST_TIMES", 1.5)
    if predicted:
        monkeypatch.setattr(refinement, "_predicted_times", lambda *_: predicted)
    assert refined(smooth_scene(), bad, ASKED, UNTIL, warn=said.append) == (bad, ASKED)
    tolerance = smaller_tolerance(1e-3, 60.0, LEAST)
    assert code_of(said[-1]) == "N-repetition-costly"
    assert re.search(rf"{tolerance:.2g} .* \d+ times .* {outcome.costs.steps} steps", said[-1])
    assert Result.open(outcome.path).provenance["tolerance"] == "0.001"


def test_a_repetition_that_fails_leaves_the_run(outcome, tmp_path):
    """Bad input: failing on its way, it leaves the result as it was, no file beside it, and says why."""
    bad, said = off_by(outcome, 60.0), []
    other = tmp_path / "run.refined.h5"
    other.write_text("a file of the user's")

    @contextmanager
    def failing(_, __):
        def watch(time, h):
            if time > 1.0:
                raise RunError("run: it fails at t = 1", reason="it fails at t = 1")

        yield watch

    assert refined(smooth_scene(), bad, ASKED, UNTIL, failing, said.append) == (bad, ASKED)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.h5", "run.refined.h5"]
    assert other.read_text() == "a file of the user's"
    assert code_of(said[-1]) == "N-repetition-failed"
    assert "it fails at t = 1" in said[-1]


def test_doubts_of_a_repeated_run(outcome):
    """Rule: where a smaller tolerance was taken already, it is not advised."""
    result = replace(outcome.result, provenance={**outcome.result.provenance, "refined_tolerance": "1e-05"})
    (sentence,) = headline(off_by(replace(outcome, result=result), 60.0).result).warnings
    assert code_of(sentence) == "W-error"
    assert "1e-05" in sentence
    assert "--tolerance" not in sentence


@pytest.mark.parametrize("latched", [True, False])
def test_the_number_that_a_repetition_is_made_for_is_named(outcome, latched):
    """Regression: where loads alone were, a latch was named with 0 tolerances, and without latches it failed."""
    sizes = (20.0 * ASKED.tolerance * max(outcome.headline.interface_force_peaks),)
    errors = {("interface force peak", "x"): EstimatedError(0.0, *sizes)}
    if latched:
        errors |= {("latch time", line): EstimatedError(0.0, 0.0) for line in outcome.headline.latch_times}
    sentence = refinement._sentence("wing", claiming(outcome, errors), ASKED.tolerance, 1e-4)
    assert re.search(r"interface force peak of x .* 20 times", sentence)
