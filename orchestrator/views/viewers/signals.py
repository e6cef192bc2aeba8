"""Which signals of a result are exported, and at which times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from components.contract.component import Vector

from ...results.result import Result, ResultError
from ...results.signal import Place, matches, places, values_at

_MOST_ROWS = 10_000_000
"""Rows at equal spacing that anybody means: seven hours of a kilohertz."""
_ROUND_OFF = 1e-9
"""Of a spacing, by which the end of a run may miss its last multiple."""


@dataclass(frozen=True)
class Chosen:
    """Signals (components and variables) of a result at times (N,) in s."""

    result: Result
    keys: tuple[tuple[str, str], ...]
    time: Vector
    _places: Sequence[Place] | None

    def values(self, key: tuple[str, str]) -> Vector:
        """Values (N,) or (N, size) of a signal, linear between its rows."""
        recorded = self.result.signal(*key)
        return recorded if self._places is None else values_at(recorded, self._places)


def chosen(result: Result, patterns: Sequence[str] = (), every: float | None = None) -> Chosen:
    """Signals that match one of the patterns, all where there is none, in recorded order.

    every: s from row to row; None for the recorded rows. ResultError for a pattern that matches nothing.
    """
    known = [(name, variable) for name in result.components for variable in result.variables(name)]
    for pattern in patterns:
        if not any(matches(key, pattern) for key in known):
            raise ResultError(
                f"{result.name}: no signal matches {pattern!r}; patterns are of COMPONENT or COMPONENT.VARIABLE, and "
                f"components are {', '.join(result.components) or 'none'}"
            )
    keys = tuple(key for key in known if not patterns or any(matches(key, one) for one in patterns))
    if every is None:
        return Chosen(result, keys, result.time, None)
    time = _spaced(result, every)
    return Chosen(result, keys, time, places(result, time))


def _spaced(result: Result, every: float) -> Vector:
    first, last = float(result.time[0]), float(result.time[-1])
    if not 0.0 < every < np.inf:
        raise ResultError(f"rows every {every} s are asked for; it must be a time above 0")
    if (last - first) / every > _MOST_ROWS:
        raise ResultError(
            f"rows every {every:g} s up to {last:g} s are more than {_MOST_ROWS}; take them farther apart"
        )
    count = int((last - first) / every + _ROUND_OFF) + 1
    time: Vector = np.minimum(first + every * np.arange(count), last)
    return time
