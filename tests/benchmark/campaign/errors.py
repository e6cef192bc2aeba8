"""How far a run is off a reference: every headline number that a tolerance is meant for, in groups with a scale."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from math import inf
from typing import NamedTuple

from orchestrator.results.energy_ledger import tolerance_asked
from orchestrator.results.estimated_errors import (
    MOST_TOLERANCES,
    Key,
    relative_errors,
    round_off_of_loads,
)
from orchestrator.results.key_figures import Headline
from orchestrator.results.round_off import noise_floor
from orchestrator.run.run import Outcome

LATCH_TIME, IMPULSE, LATCH_TORQUE = "latch time", "latch impulse", "latch torque peak"
LARGEST, LOCK = "largest latch torque peak", "lock torque peak"
LOADS = ("interface force peak", "interface torque peak", "stop torque peak")
GROUPS = (LATCH_TIME, IMPULSE, LATCH_TORQUE, LARGEST, *LOADS)
"""What a run promises. Torques of locks between rigid bodies, which are the lock's own, are told beside them."""
ESTIMATE_FACTOR = 2.0
_RESOLVED = 0.1
"""Of the tolerance: errors below it are those of the reference as well, and count as this much."""


class Deviation(NamedTuple):
    """Error of a headline number over the scale of its group, and the error that the run itself estimated, if any.

    estimate: over the same scale. value, reference: of both runs, in the number's unit, None if a run does not have it.
    told: whether the run warns or notes that the error may exceed ten tolerances. settled: whether runs at the
    reference's tolerance and at three times it agree far better than run and reference do.
    """

    group: str
    of: str
    error: float
    estimate: float | None
    value: float | None
    reference: float | None
    told: bool = False
    settled: bool = True


def _estimates(found: Outcome) -> Mapping[Key, float]:
    """Errors that a run estimated for its headline numbers; infinite ones for a run that says that it knows none."""
    return found.headline.estimated_errors or {number.key: inf for number in found.headline.numbers()}


def deviations(found: Outcome, reference: Outcome) -> list[Deviation]:
    """Every number of either run against that of the reference; inf where only one of the two has it.

    Latch times, impulses and torques are taken relative to their own values, components of a load and torques of stops
    relative to the largest of them; those that are round-off beside it are left out.
    """
    ours, true = _numbers(found.headline), _numbers(reference.headline)
    estimates = _estimates(found)
    single = [
        _deviation((quantity, of), ours, true, estimates)
        for quantity, of in sorted({*ours, *true})
        if not _is_round_off((quantity, of), true)
    ]
    told = _doubtful(found, estimates)
    return [
        d._replace(told=(LATCH_TORQUE if d.group == LARGEST else d.group, d.of) in told)
        for d in (*single, *_largest(ours, true, estimates))
    ]


def _doubtful(found: Outcome, estimates: Mapping[Key, float]) -> Collection[Key]:
    """Numbers whose estimated error exceeds ten tolerances."""
    numbers = [(number.key, number.value) for number in found.headline.numbers()]
    most = MOST_TOLERANCES * (tolerance_asked(found.result) or inf)
    return {key for key, error in relative_errors(numbers, estimates).items() if error > most}


def _numbers(found: Headline) -> dict[Key, float]:
    wanted = {LATCH_TIME, IMPULSE, LATCH_TORQUE, LOCK, *LOADS}
    return {(n.quantity, n.of): n.value for n in found.numbers() if n.quantity in wanted}


def _deviation(
    key: Key, ours: Mapping[Key, float], true: Mapping[Key, float], estimates: Mapping[Key, float]
) -> Deviation:
    if key not in ours or key not in true:
        return Deviation(*key, inf, None, ours.get(key), true.get(key))
    return _compared(key, ours[key], true[key], _scale(key, true), estimates.get(key))


def _compared(of: Key, value: float, reference: float, scale: float, estimate: float | None) -> Deviation:
    relative = None if estimate is None else estimate / scale
    return Deviation(*of, abs(value - reference) / scale, relative, value, reference)


def _load(key: Key, numbers: Mapping[Key, float]) -> list[float]:
    return [value for (quantity, _), value in numbers.items() if quantity == key[0]]


def _scale(key: Key, true: Mapping[Key, float]) -> float:
    return max(_load(key, true)) if key[0] in LOADS else abs(true[key])


def _is_round_off(key: Key, true: Mapping[Key, float]) -> bool:
    if key[0] not in LOADS or key not in true:
        return False
    group = _load(key, true)
    return true[key] <= noise_floor(group) or max(group) <= round_off_of_loads(true.items())


def _largest(
    ours: Mapping[Key, float], true: Mapping[Key, float], estimates: Mapping[Key, float]
) -> Iterator[Deviation]:
    """The largest latch torque of all lines but locks, which one sizes the structure by."""
    peaks = [
        {key: value for key, value in numbers.items() if key[0] == LATCH_TORQUE} for numbers in (ours, true)
    ]
    if not any(peaks):
        return
    if not all(peaks):
        yield Deviation(LARGEST, "", inf, None, None, None)
        return
    high, reference = (max(numbers, key=lambda key: numbers[key]) for numbers in peaks)
    scale = true[reference]
    yield _compared((LARGEST, high[1]), ours[high], scale, scale, estimates.get(high))


def worst(found: Collection[Deviation], group: str) -> Deviation | None:
    """The largest deviation of a group, None where a wing has none of it."""
    return max((d for d in found if d.group == group), key=lambda d: d.error, default=None)


def with_settled(
    found: Collection[Deviation], references: Collection[Deviation], tolerance: float
) -> list[Deviation]:
    """The deviations, those marked as not settled of which the references themselves differ by ten tolerances.

    references: deviations of a run at three times the reference's tolerance.
    """
    restless = {(d.group, d.of) for d in misses(references, tolerance, 10.0)}
    return [d._replace(settled=(d.group, d.of) not in restless) for d in found]


def misses(found: Collection[Deviation], tolerance: float, factor: float) -> list[Deviation]:
    """What is off by more than so many tolerances."""
    return [d for d in found if d.group in GROUPS and d.error > factor * tolerance]


def is_covered(deviation: Deviation, tolerance: float) -> bool | None:
    """Whether the error is within a factor of the estimate; None where there is nothing to compare."""
    if deviation.estimate is None or max(deviation.estimate, deviation.error) < _RESOLVED * tolerance:
        return None
    return deviation.error <= ESTIMATE_FACTOR * max(deviation.estimate, _RESOLVED * tolerance)
