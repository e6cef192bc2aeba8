"""How far off are the headline numbers of a run? A companion takes every two of its steps as one.

The companion is a run of half the cost along the steps that the run accepted, segment by segment between events. What
it differs by is 2^n - 1 times the error of the run where the error goes with the power n of the step size: the order of
the coupling where vibrations are resolved, and no power at all where errors are those of ringing that no step resolves,
of friction or of a count of swings. The estimate is the middle of both, 2^n - 1 and 1, in the logarithm; at the most
the error is the whole difference. What the companion meets by chance only, as where ringing is not resolved, the rows
of the run itself tell (`results/step_ends.py`); the larger of both errors counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import sqrt

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..cosim.stepping import to_own_events
from ..results.estimated_errors import ESTIMATED_ERRORS, EstimatedError, Key, errors_text
from ..results.key_figures import Headline, headline
from ..results.result_file import with_statistics
from ..results.step_ends import errors_of_step_ends, larger
from .run import Loader, Outcome, RunError, as_fmus, run

_SHARES = {2: 1.0 / sqrt(3.0), 4: 1.0 / sqrt(15.0)}
_NOT_ESTIMATED = ("end time", "energy residual", "angle, not latched")


def doubled(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Every two steps as one, as a plan for a run that meets its own events; the last of an odd number alone."""
    return to_own_events(
        [[sum(segment[i : i + 2]) for i in range(0, len(segment), 2)] for segment in segments]
    )


def with_estimates(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    until: float | None = None,
    watch: Callable[[float, float], None] = lambda time, h: None,
    load: Loader = as_fmus,
    at_least: Mapping[Key, EstimatedError] | None = None,
) -> Outcome:
    """The outcome whose headline numbers, and those of its file, carry estimated errors.

    at_least: errors that are known otherwise, which none is estimated to be below. Explicit masters have none; where
    steps twice as long do not reach the end, the result says that none are known.
    """
    if outcome.master != "implicit":
        return outcome
    errors: Mapping[Key, EstimatedError] = {}
    plan = replace(settings, fixed_step=None, step_plan=doubled(outcome.segments))
    with suppress(RunError):
        coarse = run(assembly, None, plan, until, watch=watch, load=load)
        known = (errors_of_step_ends(outcome.result), at_least or {})
        errors = _errors(outcome.headline, coarse.headline, known, _SHARES[outcome.order])
    result = with_statistics(outcome.result, {ESTIMATED_ERRORS: errors_text(errors)})
    return replace(outcome, result=result, headline=headline(result))


def _errors(
    fine: Headline, coarse: Headline, known: Sequence[Mapping[Key, EstimatedError]], share: float
) -> dict[Key, EstimatedError]:
    """Differences and shares of them by key, or what is known to be larger; what only one run has is left out."""
    others = {number.key: number.value for number in coarse.numbers()}
    found = {
        number.key: abs(number.value - others[number.key])
        for number in fine.numbers()
        if number.key in others and number.quantity not in _NOT_ESTIMATED
    }
    return {
        key: larger(EstimatedError(share * d, d), *(errors.get(key) for errors in known))
        for key, d in found.items()
    }
