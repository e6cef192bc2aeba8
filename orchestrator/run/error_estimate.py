"""Estimated errors of headline numbers, from a companion run that takes every two steps as one.

The companion costs half of the run. It repeats the accepted steps, segment by segment between events. If the error
goes with the power n of the step size, its difference from the run is 2^n - 1 times the error. Here n is the order of
the coupling if vibrations are resolved; unresolved vibrations, friction and the number of swings follow no power. So
the estimate divides the difference by a number between 2^n - 1 and 1, and the largest possible error is the whole
difference, 1.75 times that at order 4.

Further sources: the rows around both peaks differ by more where peaks agree by chance (`near_peaks`); the rows of the
run show errors of unresolved vibrations (`step_ends`), of friction reversals near a peak (`friction_reversals`), of
numerical damping (`lost_ringing`), and of diverging trajectories (`coming_apart`), which both runs share. If doubled
steps do not reach the end, or many are divided, a companion with halved steps replaces it, at twice the cost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import sqrt

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..cosim.stepping import to_own_events
from ..results.error_sources.friction_reversals import beyond_reversals
from ..results.error_sources.numerical_damping import lost_ringing
from ..results.error_sources.peak_neighbourhood import differences_near
from ..results.error_sources.sampling_error import errors_of_step_ends, judged_peaks, larger
from ..results.error_sources.trajectory_divergence import beyond_peaks
from ..results.estimated_errors import (
    ESTIMATED_ERRORS,
    TORQUE_PEAKS,
    EstimatedError,
    Key,
    beside_their_vector,
    errors_text,
)
from ..results.key_figures import UNLATCHED, headline
from ..results.result_file import with_statistics
from .errors import InterruptedRunError
from .run import Loader, Outcome, RunError, as_fmus, run

_SHARES = {2: EstimatedError(1.0 / sqrt(3.0), 1.0), 4: EstimatedError(0.35, 1.75)}
"""Of the difference, by order: likely ones between 1 / (2^n - 1) and 1, in the middle of order 2, and where most random
wings lie; of 37 of their numbers that order 4 had off by more than a tolerance, 35 were off by less than 1.7 of it."""
_FINER = EstimatedError(1.0, 2.0)
"""Of the difference from half the steps: all of it where steps resolve what happens, and two of its kind elsewhere."""
_DIVIDED = 0.01
"""Part of the steps between two events that a companion may divide."""
_ASTRAY = 1e3
"""Times the largest load of the run that no companion has unless its steps blew up."""
_LOADS = ("N", "N.m")
_BY_CHANCE = 3.0
"""Times which two numbers may differ by less than the rows around them; beyond, a swing came later in one of both."""
_NOT_ESTIMATED = ("end time", "energy residual", UNLATCHED, "lock torque peak")
"""That of a lock between rigid bodies rings as its own stiffness lets it, which no step is meant to follow."""


def doubled(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Every two steps as one, as a plan for a run that meets its own events; the last of an odd number alone."""
    return to_own_events(
        [[sum(segment[i : i + 2]) for i in range(0, len(segment), 2)] for segment in segments]
    )


def halved(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Every step as two, likewise."""
    return to_own_events([[0.5 * h for h in segment for _ in range(2)] for segment in segments])


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
    no companion reaches the end, the result says that none are known.
    """
    if outcome.master != "implicit":
        return outcome
    errors: Mapping[Key, EstimatedError] = {}
    for steps, share in ((doubled, _SHARES[outcome.order]), (halved, _FINER)):
        planned = steps(outcome.segments)
        plan = replace(settings, fixed_step=None, step_plan=planned)
        try:
            other = run(assembly, None, plan, until, watch=watch, load=load)
        except InterruptedRunError:
            raise
        except RunError:
            continue
        if not _is_astray(outcome, other):
            errors = _errors(outcome, other, share, at_least or {})
            if not _is_divided(planned, other):
                break
    result = with_statistics(outcome.result, {ESTIMATED_ERRORS: errors_text(errors)})
    return replace(outcome, result=result, headline=headline(result))


def _is_divided(plan: Sequence[Sequence[float]], companion: Outcome) -> bool:
    """Whether a companion divided steps of its plan, which then are hardly other ones than those of the run."""
    return any(
        len(made) > (1.0 + _DIVIDED) * len(planned) + 1.0
        for planned, made in zip(plan, companion.segments, strict=False)
    )


def _is_astray(told: Outcome, companion: Outcome) -> bool:
    """Whether the loads of a companion are unbounded relative to those of the run."""
    ours, theirs = (
        max((abs(n.value) for n in one.headline.numbers() if n.unit in _LOADS), default=0.0)
        for one in (told, companion)
    )
    return not theirs <= _ASTRAY * max(ours, 1.0)


def _errors(
    told: Outcome, companion: Outcome, share: EstimatedError, at_least: Mapping[Key, EstimatedError]
) -> dict[Key, EstimatedError]:
    """Differences and shares of them by key, or what is known to be larger; what only one run has is left out."""
    others = {number.key: number.value for number in companion.headline.numbers()}
    peaks, theirs = list(judged_peaks(told.result)), dict(judged_peaks(companion.result))
    by_rows = errors_of_step_ends(told.result, peaks)
    near, lost, apart = (
        of(told.result, peaks, companion.result, theirs)
        for of in (differences_near, lost_ringing, beyond_peaks)
    )
    kinks = beyond_reversals(told.result, peaks)
    locked = told.headline.latch_impulses
    in_locks = {hinge for line in told.result.hinge_lines if line.name in locked for hinge in line.hinges}
    found = {
        number.key: abs(number.value - others[number.key])
        for number in told.headline.numbers()
        if number.key in others
        and number.quantity not in _NOT_ESTIMATED
        and (number.quantity not in TORQUE_PEAKS or number.of not in in_locks)
    }
    widest = {key: max(d, min(near.get(key, 0.0), _BY_CHANCE * d)) for key, d in found.items()}
    return beside_their_vector(
        {
            key: larger(
                EstimatedError(
                    share.likely * d, max(share.most * d, *(of.get(key, 0.0) for of in (lost, apart, kinks)))
                ),
                by_rows.get(key),
                at_least.get(key),
            )
            for key, d in widest.items()
        }
    )
