"""Repeat a run with smaller tolerances until the estimated errors of its numbers meet the tolerance.

A tolerance bounds the error of each step. The scene may amplify it: a line that accelerates towards its latch, or a
beat long after latch-up. The estimated errors determine the smaller tolerance: errors fall by `_PER_DECADE` for each
decade of tolerance. If they do not, a last run takes a hundredth of the tolerance. If that does not help either, as in
chaotic motion, the result lists the numbers concerned. For latch-ups and stops, which size hinges, the largest
possible error counts, for loads the likely one.

Estimates near the limit may fall on either side of it on different processors. So a repetition is made only if it
costs a few times the run. If it needs more steps, it is not started, or is stopped; the result then states the
tolerance and the cost of the repetition.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from math import inf, isfinite, log, log10
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..cosim.stepping import share_of_steps
from ..messages import message
from ..results.earlier import SETTINGS
from ..results.estimated_errors import (
    MOST_TOLERANCES,
    PROMISED,
    SIZING,
    EstimatedError,
    Key,
    estimated_errors,
    largest_shares,
    least_sure,
    unknown_errors,
)
from ..scene.schema import TOLERANCES
from .error_estimate import with_estimates
from .errors import InterruptedRunError, whole_if_interrupted
from .progress import Progress, Watch, followed, silent
from .run import Loader, Outcome, RunError, as_fmus, run

_LIKELY = 0.6
"""Of the tolerances that a number may miss, what may be likely of loads: estimates are within a factor of two mostly.
Of 57 random wings three missed ten where ten were likely enough, two of them at 6.6 and 9; at a half ARABSAT's phase 2
takes ten times its steps, of which its peaks do not change."""
_AIM = 3.0
"""What an error may be at the most after a repetition, in tolerances."""
_PER_DECADE = 5.0
_LEAST, _LEAST_FALLING = 0.01, 0.001
"""Smallest parts of the tolerance asked for that a run is repeated at, so that no scene takes minutes for seconds: of
any, and of one whose errors have fallen as they should where those of latch-ups and stops are still too large."""
_MOST_TIMES = 6.0
"""Steps of a repetition over those of the first run; at order 4 a thousandth of the tolerance takes 5.6 = 1000^(1/4)
times as many."""
_UNTOLD = 1e4
"""Tolerances beyond which their number is not told: something has blown up."""
_FALLING = 1.0 / 3.0
_AT_THE_MOST = 2.0
"""Times what is left where errors fall as they should."""
_BEYOND = 1e9
"""In tolerances: an error that leads to the smallest part, where ringing that no step resolved may be resolved."""


def refined(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    until: float | None = None,
    progress: Progress = silent,
    warn: Callable[[str], None] = lambda sentence: None,
    load: Loader = as_fmus,
) -> tuple[Outcome, Settings]:
    """The outcome, or one with smaller errors in place of it, in its file as well; and the settings it was made with.

    outcome: with estimated errors; without, or with steps that were given, it stays. A repetition that does not reach
    its end leaves the earlier outcome, and so does one that is interrupted, by an InterruptedRunError.
    """
    asked, first = settings.tolerance, outcome
    error = error_in_tolerances(outcome, asked)
    given = settings.fixed_step is not None or settings.step_plan is not None
    repeat, target, least = not given and is_too_uncertain(outcome, asked), error.most, _LEAST * asked
    while repeat and (tolerance := smaller_tolerance(settings.tolerance, target, least)) < settings.tolerance:
        finer = replace(settings, tolerance=tolerance, asked_tolerance=asked, snapshot_every=None)
        times = _predicted_times(assembly, first, finer, tolerance / asked, until)
        if times > _MOST_TIMES:
            warn(_too_costly(assembly.name, outcome, asked, tolerance, times))
            break
        warn(_sentence(assembly.name, outcome, asked, tolerance))
        try:
            with whole_if_interrupted(assembly.name, outcome.result, f"it was repeated at {tolerance:.2g}"):
                part = tolerance / settings.tolerance
                better = _again(assembly, outcome, first, finer, part, until, progress, load)
        except InterruptedRunError:
            raise
        except CostlyError as costly:
            warn(_too_costly(assembly.name, outcome, asked, tolerance, costly.times))
            break
        except RunError as failure:
            note = f"the repetition failed, {failure.reason}; the result has the tolerance {settings.tolerance:.2g}."
            warn(message("N-repetition-failed", note))
            break
        before, error = error, error_in_tolerances(better, asked)
        outcome, settings = better, finer
        falls = error.most <= _FALLING * before.most
        repeat = is_too_uncertain(outcome, asked) or (falls and error.most > MOST_TOLERANCES)
        target = error.most if falls else _BEYOND
        further = falls and _of_hinges(outcome) > MOST_TOLERANCES * asked
        least = (_LEAST_FALLING if further else _LEAST) * asked
    return outcome, settings


def is_too_uncertain(outcome: Outcome, tolerance: float) -> bool:
    """Whether a likely error exceeds six tolerances, or the largest possible one of a sizing number ten."""
    likely = error_in_tolerances(outcome, tolerance).likely
    return max(likely / _LIKELY, _of_hinges(outcome) / tolerance) > MOST_TOLERANCES


def _of_hinges(outcome: Outcome) -> float:
    """Largest possible relative error of numbers that size hinges."""
    return largest_shares(_numbers(outcome), estimated_errors(outcome.result), SIZING).most


def error_in_tolerances(outcome: Outcome, tolerance: float) -> EstimatedError:
    """The largest error of a number that a run promises, over the tolerance; infinite where none is known."""
    if unknown_errors(outcome.result):
        return EstimatedError(inf, inf)
    found = largest_shares(_numbers(outcome), estimated_errors(outcome.result))
    return EstimatedError(*(share / tolerance for share in found))


def _numbers(outcome: Outcome) -> list[tuple[Key, float]]:
    return [(number.key, number.value) for number in outcome.headline.numbers()]


def smaller_tolerance(tolerance: float, error: float, least: float) -> float:
    """Where a run of a tolerance should be that may be off by so many of those asked for, not below the least."""
    part = 0.1 if not isfinite(error) else 10.0 ** -(log(error / _AIM) / log(_PER_DECADE))
    return max(TOLERANCES[0], least, tolerance * part)


def _predicted_times(
    assembly: Assembly, outcome: Outcome, finer: Settings, part: float, until: float | None
) -> float:
    """Steps of a run at a fraction of the tolerance over those of the run, if tolerances alone determine them."""
    by_error: float = part ** (-1.0 / outcome.order)
    longest = finer.largest_step * share_of_steps(finer.tolerance)
    return max(by_error, (until or assembly.until) / longest / outcome.costs.steps)


class CostlyError(RunError):
    """A repetition takes more steps than it may; times: over those of the run up to the same time."""

    def __init__(self, times: float) -> None:
        super().__init__(f"it takes {times:.0f} times the steps")
        self.times = times


class _Bounded:
    """A watch that ends a repetition of too many times the steps of the first run."""

    def __init__(self, watch: Watch, first: Outcome) -> None:
        self._watch = watch
        self._times = np.cumsum([h for segment in first.segments for h in segment])
        self._made, self._last = 0.0, 0.0

    def __call__(self, time: float, h: float) -> None:
        """Show a step, and count those since the last one shown."""
        self._watch(time, h)
        self._made += max(1.0, (time - self._last) / h)
        self._last = time
        if self._made > _MOST_TIMES * self._times.size:
            raise CostlyError(self._made / max(1, int(np.searchsorted(self._times, time))))


def _again(
    assembly: Assembly,
    outcome: Outcome,
    first: Outcome,
    settings: Settings,
    part: float,
    until: float | None,
    progress: Progress,
    load: Loader,
) -> Outcome:
    """A run with its estimates in a temporary file, which replaces that of the earlier outcome in the end."""
    path = outcome.result.path
    end, name = until or assembly.until, f"{assembly.name}: at {settings.tolerance:.2g}"
    asked = {key: text for key, text in outcome.result.provenance.items() if key == SETTINGS}
    with ExitStack() as stack:
        beside = path and Path(stack.enter_context(TemporaryDirectory(dir=path.parent)), path.name)
        with followed(progress, name, end) as watch:
            bounded = _Bounded(watch, first)
            found = run(assembly, beside, settings, until, watch=bounded, load=load, asked=asked)
        with followed(progress, f"{name}: errors", end) as watch:
            at_least = _left(outcome, found, part)
            found = with_estimates(assembly, found, settings, until, watch, load, at_least)
        return _moved(found, beside, path) if beside and path else found


def _left(before: Outcome, after: Outcome, part: float) -> dict[Key, EstimatedError]:
    """What is left of errors at a part of the tolerance, from what numbers moved by.

    A repetition is made for its estimates to be small, and some of these are so by chance. A number that moved by more
    than its error could be does not converge, and its error is all of that: no tolerance determines it.
    """
    left = _PER_DECADE ** log10(part)
    share = left / (1.0 - left)
    values, errors = dict(_numbers(before)), estimated_errors(before.result)
    remaining = {}
    for key, value in _numbers(after):
        moved = abs(value - values.get(key, value))
        converges = key not in errors or moved <= errors[key].most
        likely = (share if converges else 1.0) * moved
        remaining[key] = EstimatedError(likely, _AT_THE_MOST * likely)
    return remaining


def _moved(outcome: Outcome, source: Path, target: Path) -> Outcome:
    os.replace(source, target)
    return replace(outcome, result=replace(outcome.result, path=target))


def _sentence(name: str, outcome: Outcome, asked: float, tolerance: float) -> str:
    return message("N-repeated", f"{_reason(name, outcome, asked)}; the run was repeated at {tolerance:.2g}.")


def _too_costly(name: str, outcome: Outcome, asked: float, tolerance: float, times: float) -> str:
    return message(
        "N-repetition-costly",
        f"{_reason(name, outcome, asked)}; a run at --tolerance {tolerance:.2g} takes about {times:.0f} times the "
        f"{outcome.costs.steps} steps and was not made.",
    )


def _reason(name: str, outcome: Outcome, asked: float) -> str:
    numbers, errors = _numbers(outcome), estimated_errors(outcome.result)
    error = error_in_tolerances(outcome, asked)
    if not isfinite(error.likely):
        said = "no error could be estimated"
    elif error.likely > _LIKELY * MOST_TOLERANCES:
        number, share = least_sure(numbers, errors)
        said = f"the estimated error of {number} is {_times(share.likely / asked)} the tolerance of {asked:g}"
    else:
        among = SIZING if _of_hinges(outcome) > MOST_TOLERANCES * asked else PROMISED
        number, share = least_sure(numbers, errors, among, by="most")
        said = f"the largest possible error of {number} is {_times(share.most / asked)} the tolerance of {asked:g}"
    return f"{name}: {said}"


def _times(tolerances: float) -> str:
    """In words; beyond some it is that of a number that has blown up, and means nothing."""
    return f"{tolerances:.0f} times" if tolerances < _UNTOLD else f"more than {_UNTOLD:.0f} times"
