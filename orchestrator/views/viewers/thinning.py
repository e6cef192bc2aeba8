"""Few rows of a history that suffice: between them straight lines are near enough to every row."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from components.contract.component import Vector

from .surface import Indices


def sufficient(count: int, worst: Callable[[int, int], tuple[int, float]], tolerance: float) -> Indices:
    """Rows, the first and the last of `count` among them, between which no row is off by more than a tolerance.

    worst: the row between two that is farthest off, and by how much. It is taken as a further one until none is off
    (Ramer 1972; Douglas and Peucker 1973).
    """
    chosen, open_ends = {0, count - 1}, [(0, count - 1)]
    while open_ends:
        left, right = open_ends.pop()
        row, error = worst(left, right)
        if error > tolerance:
            chosen.add(row)
            open_ends += [(left, row), (row, right)]
    return np.array(sorted(chosen), dtype=np.int64)


def straight(time: Vector, values: Vector, tolerance: float) -> Indices:
    """Rows of values (N, C) at rising times (N,) in s, between which the sum of all columns' errors is no larger."""

    def worst(left: int, right: int) -> tuple[int, float]:
        if right - left < 2:
            return left, 0.0
        inside = slice(left + 1, right)
        share = ((time[inside] - time[left]) / (time[right] - time[left]))[:, None]
        off = np.abs(values[left] + share * (values[right] - values[left]) - values[inside]).sum(axis=1)
        row = int(np.argmax(off))
        return left + 1 + row, float(off[row])

    return sufficient(time.size, worst, tolerance)
