"""Rows of a run between its events, at which loads jump."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..peaks import jumps
from ..result import Result, Vector
from ..signal import EVENT_WIDTH


def segments(time: Vector, events: Sequence[float]) -> NDArray[np.intp]:
    """Number (N,) of the segment of each row (s) between events in order (s), of which the start is the first."""
    return np.searchsorted(events, time + EVENT_WIDTH, side="right") - 1


def rows_between_events(result: Result) -> Sequence[slice]:
    """Rows of each segment, in order; the first begins with the run."""
    of = segments(result.time, sorted(jumps(result)))
    starts = [*np.flatnonzero(np.diff(of, prepend=-1)).tolist(), result.time.size]
    return [slice(a, b) for a, b in pairwise(starts)]
