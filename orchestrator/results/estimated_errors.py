"""Estimated errors of headline numbers, as a result keeps them, and numbers that cannot be vouched for."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from .result import Result, ResultError

Key = tuple[str, str]
"""Quantity and what it is of, which tell a headline number from all others of a run."""
ESTIMATED_ERRORS = "estimated_errors"
"""Name of the statistic that holds them."""
_MOST_TOLERANCES = 10.0
_LOADS = ("interface force peak", "interface torque peak")
_VOUCHED_FOR = ("latch time", "latch impulse", "latch torque peak", *_LOADS)


class EstimatedError(NamedTuple):
    """Error of a headline number in its unit: what is likely, and what it may be at the most."""

    likely: float
    most: float


def errors_text(errors: Mapping[Key, EstimatedError]) -> str:
    """Estimated errors as the text that a result keeps in its statistics."""
    return json.dumps([[quantity, of, *error] for (quantity, of), error in errors.items()])


def estimated_errors(result: Result) -> dict[Key, EstimatedError]:
    """Estimated errors that a result keeps; empty where none were estimated."""
    text = str(result.statistics.get(ESTIMATED_ERRORS, "[]"))
    try:
        rows = json.loads(text)
        return {
            (str(name), str(of)): EstimatedError(float(error), float(most)) for name, of, error, most in rows
        }
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


def doubts(
    numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, EstimatedError], tolerance: float | None
) -> list[str]:
    """A sentence for every headline number (key and value) that cannot be vouched for to ten tolerances.

    Latch times, impulses and torques are judged beside their own values, components of a load beside its largest;
    by what the error may be at the most.
    """
    if tolerance is None:
        return []
    largest = {
        load: max((abs(value) for key, value in numbers if key[0] == load), default=0.0) for load in _LOADS
    }
    return [
        f"the {quantity} of {of} may be off by {errors[quantity, of].most / size:.1g} of its size, more than ten "
        f"times the tolerance of {tolerance:g}; a smaller tolerance makes it surer"
        for (quantity, of), value in numbers
        if quantity in _VOUCHED_FOR
        and (quantity, of) in errors
        and errors[quantity, of].most
        > _MOST_TOLERANCES * tolerance * (size := largest.get(quantity, abs(value)))
    ]
