"""Error of a load peak where a run and its companion diverge.

Motion that is sensitive to small differences, such as a linkage that swings through its flat position, separates two
runs long after their peaks agree. Each of them then is one of many possible trajectories.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..estimated_errors import Key
from ..result import Result, Vector
from .between_events import rows_between_events
from .sampling_error import Peaks

_ROWS = 16
"""In half a stretch of time whose largest magnitudes are compared."""
_BESIDE = 2
"""Halves on either side of a stretch in which the other run may have them earlier or later."""
_APART = 0.25
"""Part of the larger magnitude, from which on runs differ by more than errors of steps that are resolved."""


def beyond_peaks(one: Result, peaks: Peaks, other: Result, theirs: Mapping[Key, Vector]) -> dict[Key, float]:
    """By how much promised peaks of one result (N.m, N) would be passed by what runs differ by elsewhere.

    peaks: of one. other: a run with other steps, theirs: its peaks; times count from each event. 0 or less, or no key:
    nowhere.
    """
    pairs = list(zip(rows_between_events(one), rows_between_events(other), strict=False))
    found = {}
    for key, values in peaks:
        if key in theirs:
            heights, others = np.abs(values), np.abs(theirs[key])
            tops = float(heights.max()), float(others.max())
            reaches = (_reach((one.time[a], other.time[b]), (heights[a], others[b]), tops) for a, b in pairs)
            found[key] = max(reaches, default=0.0) - tops[0]
    return found


def _reach(times: tuple[Vector, Vector], heights: tuple[Vector, Vector], tops: tuple[float, float]) -> float:
    """The larger of two heights and what they differ by, where that is most among stretches that came apart.

    Of two runs between the same events; tops: what both reach anywhere, there other errors tell.
    """
    since, other_since = (time - time[0] for time in times)
    end = min(since[-1], other_since[-1])
    edges = since[since <= end][::_ROWS]
    if edges.size < _BESIDE:
        return 0.0
    (mine, around), (its, around_its) = (
        _stretches(_largest(time, height, edges, end))
        for time, height in zip((since, other_since), heights, strict=True)
    )
    larger, apart = np.maximum(mine, its), np.maximum(its - around, mine - around_its)
    counts = (apart > _APART * larger) & (mine < tops[0]) & (its < tops[1])
    return float(np.max(np.where(counts, larger + apart, 0.0)))


def _largest(time: Vector, heights: Vector, edges: Vector, end: float) -> Vector:
    """Largest of heights (N,) from each edge (s) to the next, the last one up to an end."""
    compared = heights[time <= end]
    return np.maximum.reduceat(compared, np.minimum(np.searchsorted(time, edges), compared.size - 1))


def _stretches(halves: Vector) -> tuple[Vector, Vector]:
    """The larger of every two neighbours, and the largest of these and of adjacent ones."""
    wide = sliding_window_view(np.pad(halves, _BESIDE), 2 * _BESIDE + 2)
    return sliding_window_view(halves, 2).max(axis=1), wide.max(axis=1)
