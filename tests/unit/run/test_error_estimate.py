"""Errors of a run from a coarser one, and repetitions where they are too large."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path
from shutil import copy

import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.cosim.settings import Settings
from orchestrator.messages import code_of
from orchestrator.results.key_figures import headline
from orchestrator.results.result import Result
from orchestrator.run import error_estimate
from orchestrator.run.error_estimate import with_estimates
from orchestrator.run.run import RunError, run
from tests.references.random_wings import load_wing
from tests.unit.analysis.sampling.flap import ANGLE, STIFFNESS, flap
from tests.unit.run.test_verify import smooth_scene

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
ASKED = Settings(tolerance=1e-3)
UNTIL = 2.4


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run without estimates, and runs at ten times, a tenth and a hundredth of its tolerance."""
    path, assembly = tmp_path_factory.mktemp("finished") / "run.h5", smooth_scene()
    finer = {t: run(assembly, None, replace(ASKED, tolerance=t), UNTIL) for t in (1e-4, 1e-5)}
    coarser = run(assembly, None, error_estimate._coarser(ASKED), UNTIL)
    return {1e-2: coarser, 1e-3: run(assembly, path, ASKED, UNTIL), **finer}


@pytest.fixture
def outcome(finished, tmp_path):
    """The run in a file of its own."""
    found = finished[1e-3]
    return replace(found, result=replace(found.result, path=Path(copy(found.path, tmp_path))))


@pytest.fixture
def scripted(finished, monkeypatch):
    """Other runs are those that are finished, with a factor on their latch times; None fails."""
    factors = {}

    def replayed(assembly, output, settings, *_, **__):
        factor = factors.get(settings.tolerance, 1.0)
        if factor is None:
            raise RunError("run: it fails at t = 1", reason="it fails at t = 1")
        found = finished[min(finished, key=lambda t: abs(t / settings.tolerance - 1.0))]
        if output is not None:
            found = run(assembly, output, settings, UNTIL)
        times = {line: factor * time for line, time in found.headline.latch_times.items()}
        return replace(found, headline=replace(found.headline, latch_times=times))

    monkeypatch.setattr(error_estimate, "run", replayed)
    return factors


def numbers(outcome, *quantities):
    return {n.key: n.value for n in outcome.headline.numbers() if not quantities or n.quantity in quantities}


def test_errors_are_differences_and_cover_the_true_ones(finished, outcome, tmp_path):
    """Against a run at a hundredth of the tolerance; the file has the errors as well."""
    found, settings = with_estimates(smooth_scene(), outcome, ASKED, UNTIL)
    assert settings == ASKED
    coarser, true = numbers(finished[1e-2]), numbers(finished[1e-5])
    errors = found.headline.estimated_errors
    for key, value in numbers(found, "latch time", "latch torque peak", "interface force peak").items():
        assert errors[key] == pytest.approx(abs(value - coarser[key]), rel=1e-3, abs=1e-7)
        assert abs(value - true[key]) <= errors[key] + 1e-7  # of forces that are round-off
    assert headline(Result.open(outcome.path)) == found.headline


@pytest.mark.parametrize(("factor", "repeated"), [(1.028, False), (1.033, True), (None, True)])
def test_a_run_that_is_likely_to_miss_is_repeated(outcome, scripted, tmp_path, factor, repeated):
    """Rule: from thirty tolerances on, of which a third is likely, or where no error is known."""
    scripted[1e-2], said = factor, []
    found, settings = with_estimates(smooth_scene(), outcome, ASKED, UNTIL, note=said.append)
    assert settings.tolerance == pytest.approx(1e-4 if repeated else 1e-3)
    assert [code_of(one) for one in said] == ["N-repeated"] * repeated
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]
    kept = Result.open(tmp_path / "run.h5")
    assert kept.provenance["tolerance"] == "0.001"
    assert ("refined_tolerance" in kept.provenance) == repeated
    assert kept.estimated_errors == found.headline.estimated_errors


def test_repetitions_end_after_two_decades(outcome, scripted):
    """Rule: where numbers move by more at every tolerance, the finest run is reported with its last difference."""
    scripted.update({1e-2: 1.05, 1e-4: 1.05, 1e-5: 1.1})
    said = []
    for tolerance in (1e-4, 1e-5):  # as floating-point division leaves them
        scripted[tolerance * 1.0000000000000002] = scripted[tolerance]
    found, settings = with_estimates(smooth_scene(), outcome, ASKED, UNTIL, note=said.append)
    assert settings.tolerance == pytest.approx(1e-5)
    assert [code_of(one) for one in said] == ["N-repeated"] * 2
    assert "W-error" in [code_of(one) for one in found.headline.warnings]


def test_what_only_one_run_has_is_repeated_for(outcome, finished):
    """Rule: a latch time that the coarser run does not have has an infinite error."""
    bare = replace(finished[1e-2].headline, latch_times={})
    found = error_estimate._compared(outcome, replace(finished[1e-2], headline=bare))
    times = [error for (what, _), error in found.headline.estimated_errors.items() if what == "latch time"]
    assert times == [inf] * len(outcome.headline.latch_times)


def test_given_steps_and_no_refinement_stay(outcome, scripted):
    scripted[1e-2] = 2.0
    given = replace(ASKED, step_plan=outcome.segments)
    assert with_estimates(smooth_scene(), outcome, given, UNTIL) == (outcome, given)
    found, settings = with_estimates(smooth_scene(), outcome, ASKED, UNTIL, refine=False)
    assert (found.segments, settings) == (outcome.segments, ASKED)
    assert found.headline.estimated_errors


def test_a_constant_step_is_compared_with_twice_as_long_ones():
    """Rule: errors are differences from a run with steps twice as long, and nothing is repeated."""
    settings = Settings(1e-4, fixed_step=2e-3)
    runs = [run(smooth_scene(), None, replace(settings, fixed_step=h), UNTIL) for h in (2e-3, 4e-3)]
    found, same = with_estimates(smooth_scene(), runs[0], settings, UNTIL)
    assert same == settings
    coarser = numbers(runs[1])
    for key, value in numbers(runs[0], "latch time", "latch torque peak").items():
        assert found.headline.estimated_errors[key] == pytest.approx(abs(value - coarser[key]), rel=1e-9)


def test_a_repetition_of_too_many_steps_is_given_up(outcome, scripted, monkeypatch):
    """Rule: it leaves the run as it was, and a note says so."""
    scripted[1e-2], said = 1.05, []
    monkeypatch.setattr(error_estimate, "_MOST_TIMES", 0.5)
    monkeypatch.setattr(error_estimate, "run", lambda a, out, s, u, **o: run(a, out, s, u, **o))
    found, settings = with_estimates(smooth_scene(), outcome, replace(ASKED, tolerance=1e-3), UNTIL)
    assert found.segments == outcome.segments
    error = replace(outcome.headline, estimated_errors={next(iter(numbers(outcome, "latch time"))): inf})
    monkeypatch.setattr(error_estimate, "_compared", lambda one, _: replace(one, headline=error))
    found, settings = with_estimates(smooth_scene(), outcome, ASKED, UNTIL, note=said.append)
    assert settings == ASKED
    assert found.segments == outcome.segments
    assert code_of(said[-1]) == "N-repetition-failed"


def test_a_repetition_that_fails_leaves_the_run(outcome, scripted, tmp_path):
    """Bad input: failing on its way, it leaves the result as it was, no file next to it, and says why."""
    scripted[1e-2], said = 1.05, []
    other = tmp_path / "run.refined.h5"
    other.write_text("a file of the user's")

    @contextmanager
    def failing(name, _):
        def watch(time, h):
            if ": at " in name and time > 1.0:
                raise RunError("run: it fails at t = 1", reason="it fails at t = 1")

        yield watch

    def fails(assembly, output, settings, *arguments, **others):
        if output is None:
            return coarse(assembly, output, settings, *arguments, **others)
        return run(assembly, output, settings, *arguments, **others)

    coarse = error_estimate.run
    error_estimate.run = fails
    found, settings = with_estimates(
        smooth_scene(), outcome, ASKED, UNTIL, progress=failing, note=said.append
    )
    assert (found.segments, settings) == (outcome.segments, ASKED)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.h5", "run.refined.h5"]
    assert other.read_text() == "a file of the user's"
    assert code_of(said[-1]) == "N-repetition-failed"
    assert "it fails at t = 1" in said[-1]


def test_a_torque_that_comes_at_once_with_a_latch_up():
    """Closed form: a latch of damping ratio z > 1/2 meets the rate sqrt(2 T a / J) with 2 z sqrt(2 k T a), its peak."""
    found = fanfold.simulate(flap(damping_ratio=2.0))
    peak = next(one for one in found.headline.numbers() if one.quantity == "latch torque peak")
    exact = 4.0 * (2.0 * STIFFNESS * ANGLE) ** 0.5
    assert peak.value == pytest.approx(exact, rel=1e-5)
    assert abs(peak.value - exact) <= peak.error + 1e-9 * exact


def test_the_error_of_a_stop_that_steps_lead_over():
    """Random wing 1905: 15,647 N.m of a damped stop with steps of 1e-3, where finer ones give 14,968 N.m."""
    settings = Settings(4e-4, largest_step=0.02)
    from orchestrator.assembly.assemble import assemble

    assembly = assemble(load_wing(1905, stops=True))
    settings = replace(settings, largest_step=assembly.largest_step)
    outcome = run(assembly, None, settings, until=1.4)
    found, _ = with_estimates(assembly, outcome, settings, 1.4)
    key = ("stop torque peak", "h3_0_stop")
    assert abs(numbers(found)[key] - 14968.0) <= found.headline.estimated_errors[key] + 15.0
