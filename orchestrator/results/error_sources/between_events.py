"""Rows of a run between its events, at which loads jump."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..key_figures import jumps
from ..result import Result
from ..signal import EVENT_WIDTH


def rows_between_events(result: Result) -> Sequence[slice]:
    """Rows of each segment, in order; the first begins with the run."""
    of = np.searchsorted(sorted(jumps(result)), result.time + EVENT_WIDTH, side="right")
    starts = [*np.flatnonzero(np.diff(of, prepend=-1)).tolist(), result.time.size]
    return [slice(a, b) for a, b in pairwise(starts)]
