"""Where signals of a result are highest: peaks from local cubics instead of the largest sample.

Samples at an event belong to a discontinuity: they count as values, but no interpolant goes through them or
across the event.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .crests import Peak, highest_crest
from .result import Result, Vector
from .signal import EVENT_WIDTH

_NEAR_PEAK = 0.1
"""Samples within this part of a signal's range below its largest may hide the highest peak between them."""


def peak(result: Result, values: Vector) -> Peak:
    """Value of largest magnitude of a signal of the result, with its sign."""
    events, found = jumps(result), []
    for sign in sides(values):
        side = _highest(result.time, sign * values, events)
        found.append(Peak(side.time, sign * side.value))
    return max(found, key=lambda one: abs(one.value))


def sides(values: Vector) -> tuple[float, ...]:
    """Signs that the value of largest magnitude may have: no cubic makes half of the largest sample the larger one."""
    half = 0.5 * float(np.max(np.abs(values)))
    return tuple(sign for sign in (1.0, -1.0) if not np.max(sign * values) < half)  # NaN is on both


def jumps(result: Result) -> list[float]:
    """Times (s) at which loads jump: of events, of what FMUs with signals set, which two rows tell, and the start."""
    jumping = result.time[:-1][np.diff(result.time) <= EVENT_WIDTH]
    return [float(result.time[0]), *(time for time, _, _ in result.events), *jumping.tolist()]


def extremes(time: Vector, values: Vector, events: Sequence[float] = ()) -> tuple[Peak, Peak]:
    """Lowest and highest value of a sampled signal that is smooth between events."""
    low = _highest(time, -values, events)
    return Peak(low.time, -low.value), _highest(time, values, events)


def _highest(time: Vector, values: Vector, events: Sequence[float]) -> Peak:
    """The highest of all samples and of the cubics through the samples around every high one."""
    k = int(np.argmax(values))
    best = Peak(float(time[k]), float(values[k]))
    for stretch, among in tops(time, values, events):
        best = highest_crest(time[stretch], values[stretch], among, best.value) or best
    return best


def tops(time: Vector, values: Vector, events: Sequence[float]) -> Iterator[tuple[slice, NDArray[np.intp]]]:
    """Samples near which a signal may be highest: a smooth stretch, and which of its samples they are."""
    threshold = float(np.max(values)) - _NEAR_PEAK * float(np.ptp(values))
    for segment in _smooth_segments(time, events):
        found = _local_maxima(values[segment], threshold)
        if found.size:
            yield segment, found


def _smooth_segments(time: Vector, events: Sequence[float]) -> Iterator[slice]:
    """Samples strictly between events, where there are enough of them for a cubic and one that it is judged by."""
    start = 0
    for event in (*sorted(events), np.inf):
        end = int(np.searchsorted(time, event - EVENT_WIDTH))
        if end - start >= 5:
            yield slice(start, end)
        start = max(start, int(np.searchsorted(time, event + EVENT_WIDTH, side="right")))


def _local_maxima(values: Vector, threshold: float) -> NDArray[np.intp]:
    """Indices of samples above the threshold that no neighbour exceeds."""
    padded = np.concatenate(([-np.inf], values, [-np.inf]))
    return np.flatnonzero((values >= padded[:-2]) & (values > padded[2:]) & (values >= threshold))
