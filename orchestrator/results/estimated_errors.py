"""Estimated errors of headline numbers, as a result keeps them, and numbers that cannot be vouched for."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from .result import Result, ResultError

Key = tuple[str, str]
"""Quantity and what it is of, which tell a headline number from all others of a run."""
ESTIMATED_ERRORS = "estimated_errors"
"""Name of the statistic that holds them."""
_MOST_TOLERANCES = 10.0
_LOADS = ("interface force peak", "interface torque peak")
_VOUCHED_FOR = ("latch time", "latch impulse", "latch torque peak", *_LOADS)


def errors_text(errors: Mapping[Key, float]) -> str:
    """Estimated errors as the text that a result keeps in its statistics."""
    return json.dumps([[quantity, of, error] for (quantity, of), error in errors.items()])


def estimated_errors(result: Result) -> dict[Key, float]:
    """Estimated errors that a result keeps, in the units of the numbers; empty where none were estimated."""
    text = str(result.statistics.get(ESTIMATED_ERRORS, "[]"))
    try:
        return {(str(quantity), str(of)): float(error) for quantity, of, error in json.loads(text)}
    except (ValueError, TypeError, RecursionError):
        raise ResultError(f"{result.name}: the estimated errors of the result are damaged") from None


def unknown_errors(result: Result) -> list[str]:
    """A sentence where errors were to be estimated and could not be."""
    if ESTIMATED_ERRORS not in result.statistics or estimated_errors(result):
        return []
    return [
        "no headline number can be vouched for: a run with steps twice as long, which tells their errors, does not "
        "reach the end; a smaller tolerance makes them surer"
    ]


def doubts(numbers: Sequence[tuple[Key, float, float | None]], tolerance: float | None) -> list[str]:
    """A sentence for every headline number (key, value, error) that cannot be vouched for to ten tolerances.

    Latch times, impulses and torques are judged beside their own values, components of a load beside its largest.
    """
    if tolerance is None:
        return []
    largest = {
        load: max((abs(value) for key, value, _ in numbers if key[0] == load), default=0.0) for load in _LOADS
    }
    return [
        f"the {quantity} of {of} may be off by {error / size:.1g} of its size, more than ten times the tolerance of "
        f"{tolerance:g}; a smaller tolerance makes it surer"
        for (quantity, of), value, error in numbers
        if quantity in _VOUCHED_FOR
        and error is not None
        and error > _MOST_TOLERANCES * tolerance * (size := largest.get(quantity, abs(value)))
    ]
