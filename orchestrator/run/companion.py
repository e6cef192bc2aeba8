"""How far off are the headline numbers of a run? A companion takes every three of its steps as two.

The companion is a run of two thirds of the cost along the steps that the run accepted, segment by segment between
events. What it differs by is 1.5^n - 1 times the error of the run where the error goes with the power n of the step
size: the order of the coupling where vibrations are resolved, and no power at all where errors are those of ringing
that no step resolves, of friction or of a count of swings, which differ by about themselves. The likely error is the
middle of both, 1.5^n - 1 and 1, in the logarithm: of order 4 they are four times apart, of steps twice as long fifteen
times. At the most the error goes with the step size itself, and is twice the difference. What the companion meets by
chance only, as where ringing is not resolved, the rows of the run itself tell (`results/step_ends.py`); the larger of
both errors counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import sqrt

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..results.estimated_errors import ESTIMATED_ERRORS, EstimatedError, Key, errors_text
from ..results.key_figures import Headline, headline
from ..results.result_file import with_statistics
from ..results.step_ends import errors_of_step_ends, larger
from .run import Loader, Outcome, RunError, as_fmus, run

_LONGER = 1.5
"""Size of the companion's steps over those of the run."""
_OF_FIRST_ORDER = 1.0 / (_LONGER - 1.0)
"""Error over difference where it goes with the step size itself."""
_NOT_ESTIMATED = ("end time", "energy residual", "angle, not latched")


def two_for_three(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Every three steps as two of one size; the last one or two that are left as they are."""
    return [
        [step for i in range(0, len(segment), 3) for step in _merged(segment[i : i + 3])]
        for segment in segments
    ]


def _merged(steps: Sequence[float]) -> Sequence[float]:
    return [sum(steps) / 2.0] * 2 if len(steps) == 3 else steps


def with_estimates(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    until: float | None = None,
    watch: Callable[[float, float], None] = lambda time, h: None,
    load: Loader = as_fmus,
) -> Outcome:
    """The outcome whose headline numbers, and those of its file, carry estimated errors.

    Explicit masters have none; where longer steps do not reach the end, the result says that none are known.
    """
    if outcome.master != "implicit":
        return outcome
    errors: Mapping[Key, EstimatedError] = {}
    plan = replace(settings, fixed_step=None, step_plan=two_for_three(outcome.segments))
    with suppress(RunError):
        coarse = run(assembly, None, plan, until, watch=watch, load=load)
        by_rows = errors_of_step_ends(outcome.result)
        errors = _errors(outcome.headline, coarse.headline, by_rows, likely_share(outcome.order))
    result = with_statistics(outcome.result, {ESTIMATED_ERRORS: errors_text(errors)})
    return replace(outcome, result=result, headline=headline(result))


def likely_share(order: int) -> float:
    """Likely error over difference from the companion, by the order of the coupling."""
    return 1.0 / sqrt(_LONGER**order - 1.0)


def _errors(
    fine: Headline, coarse: Headline, by_rows: Mapping[Key, EstimatedError], share: float
) -> dict[Key, EstimatedError]:
    """What differences or rows tell by key, share of them likely; what only one of both runs has is left out."""
    others = {number.key: number.value for number in coarse.numbers()}
    found = {
        number.key: abs(number.value - others[number.key])
        for number in fine.numbers()
        if number.key in others and number.quantity not in _NOT_ESTIMATED
    }
    return {
        key: larger(EstimatedError(share * d, _OF_FIRST_ORDER * d), by_rows.get(key))
        for key, d in found.items()
    }
