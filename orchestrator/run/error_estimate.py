"""Errors of headline numbers from two runs whose tolerances are a decade apart; the finer one is reported.

The errors of two different sequences of steps do not repeat each other, so the difference of both runs bounds that of
the finer one without a model of the error. Where the finer run is likely to miss ten tolerances in a number that the
tolerance is meant for, the run is repeated a decade finer, and its difference from the run before is the error. This
ends after `_DECADES` repetitions, or where a repetition takes too many steps: motion may be chaotic. With a constant
step, the coarser run has steps twice as long, and nothing is repeated.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from math import inf, isfinite
from pathlib import Path
from tempfile import TemporaryDirectory

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..messages import message
from ..results.earlier import SETTINGS
from ..results.estimated_errors import JUDGED, MOST_TOLERANCES, TORQUE_PEAKS, Key, largest_error
from ..results.key_figures import UNLATCHED
from ..results.result_file import with_errors
from ..scene.schema import TOLERANCES
from .errors import InterruptedRunError, whole_if_interrupted
from .progress import Progress, followed, silent
from .run import Loader, Outcome, RunError, as_fmus, run

_DECADE = 0.1
_LIKELY = 1.0 / 3.0
"""Likely error of the finer run over the difference, as errors fall by a factor of four in a decade."""
_DECADES = 2
"""Repetitions at most."""
_MOST_TIMES = 6.0
"""Steps of a further run over those of the first, at most; two decades take 10^(2/4) = 3.2 times as many."""
_NOT_ESTIMATED = ("end time", "energy residual", UNLATCHED, "lock torque peak")
"""A lock between rigid bodies rings with its own stiffness, which no step is meant to follow."""


def with_estimates(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    until: float | None = None,
    *,
    refine: bool = True,
    progress: Progress = silent,
    note: Callable[[str], None] = lambda sentence: None,
    load: Loader = as_fmus,
) -> tuple[Outcome, Settings]:
    """The outcome with estimated errors, or that of a repetition in its place; and the settings that led to it.

    refine: repeat where errors are too large. note: called about repetitions. A run with an explicit master or with
    given steps stays as it is. A repetition that does not reach its end leaves the earlier outcome, and so does one
    that is interrupted, by an InterruptedRunError.
    """
    if outcome.master != "implicit" or settings.step_plan is not None:
        return outcome, settings
    name, end = assembly.name, until or assembly.until
    most_steps = _MOST_TIMES * outcome.costs.steps
    with (
        whole_if_interrupted(name, outcome.result, "its errors were estimated", "these"),
        followed(progress, f"{name}: errors", end) as watch,
    ):
        try:
            limited = replace(_coarser(settings), most_steps=most_steps)
            coarser = run(assembly, None, limited, until, watch=watch, load=load)
            outcome = _compared(outcome, coarser)
        except InterruptedRunError:
            raise
        except RunError:
            outcome = _with(outcome, {})
    if not refine or settings.fixed_step is not None:
        return outcome, settings
    asked = settings.tolerance
    for _ in range(_DECADES):
        subject, error = _largest(outcome)
        finer = replace(
            settings,
            tolerance=max(TOLERANCES[0], _DECADE * settings.tolerance),
            asked_tolerance=asked,
        )
        if _LIKELY * error <= MOST_TOLERANCES * asked or finer.tolerance >= settings.tolerance:
            break
        said = f"{subject} differs by {100 * error:.2g} %" if isfinite(error) else f"{subject} is unsure"
        try:
            with whole_if_interrupted(name, outcome.result, f"it was repeated at {finer.tolerance:.2g}"):
                outcome = _repeated(assembly, outcome, finer, most_steps, until, progress, load)
        except InterruptedRunError:
            raise
        except RunError as failure:
            note(
                message(
                    "N-repetition-failed",
                    f"{name}: {said}; the repetition at {finer.tolerance:.2g} failed, {failure.reason}.",
                )
            )
            break
        settings = finer
        note(message("N-repeated", f"{name}: {said}; the run was repeated at {settings.tolerance:.2g}."))
    return outcome, settings


def _coarser(settings: Settings) -> Settings:
    """Settings of the run that errors are estimated from."""
    if settings.fixed_step is not None:
        return replace(settings, fixed_step=2.0 * settings.fixed_step)
    return replace(settings, tolerance=settings.tolerance / _DECADE)


def _largest(outcome: Outcome) -> tuple[str, float]:
    """The promised number with the largest relative error, and that; infinite where no error is known."""
    if not outcome.headline.estimated_errors:
        return "every number", inf
    numbers = [(number.key, number.value) for number in outcome.headline.numbers()]
    return largest_error(numbers, outcome.headline.estimated_errors)


def _compared(outcome: Outcome, coarser: Outcome) -> Outcome:
    """The outcome, whose errors are its differences from another run; infinite ones of what only one of both has."""
    ours, theirs = (
        {n.key: n.value for n in one.headline.numbers() if n.quantity not in _NOT_ESTIMATED}
        for one in (outcome, coarser)
    )
    locked = outcome.headline.latch_impulses
    in_locks = {hinge for line in outcome.result.hinge_lines if line.name in locked for hinge in line.hinges}
    both = ours.keys() & theirs.keys()
    errors = {
        key: abs(ours[key] - theirs[key]) if key in both else inf
        for key in {**ours, **theirs}
        if key in both or key[0] in JUDGED
        if key[0] not in TORQUE_PEAKS or key[1] not in in_locks
    }
    return _with(outcome, errors)


def _with(outcome: Outcome, errors: dict[Key, float]) -> Outcome:
    result = with_errors(outcome.result, errors)
    return replace(outcome, result=result, headline=replace(outcome.headline, estimated_errors=errors))


def _repeated(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    most_steps: float,
    until: float | None,
    progress: Progress,
    load: Loader,
) -> Outcome:
    """A finer run with its errors in a temporary file, which replaces that of the earlier outcome in the end."""
    path = outcome.result.path
    asked = {key: text for key, text in outcome.result.provenance.items() if key == SETTINGS}
    with ExitStack() as stack:
        temporary = path and Path(stack.enter_context(TemporaryDirectory(dir=path.parent)), path.name)
        name = f"{assembly.name}: at {settings.tolerance:.2g}"
        with followed(progress, name, until or assembly.until) as watch:
            limited = replace(settings, most_steps=most_steps)
            finer = run(assembly, temporary, limited, until, watch=watch, load=load, asked=asked)
        finer = _compared(finer, outcome)
        if path and temporary:
            os.replace(temporary, path)
            finer = replace(finer, result=replace(finer.result, path=path))
        return finer
