"""Difference of two runs around a peak, because the difference of the peaks alone may be small by chance.

Two peaks of vibrations with different phases often agree by chance, and so do two rates at a latch-up. The rows around
them do not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from ..estimated_errors import Key
from ..key_figures import latch_times
from ..latch_impulse import latch_impulse
from ..peaks import jumps
from ..result import Result, Vector
from ..signal import EVENT_WIDTH
from .between_events import segments
from .sampling_error import Peaks

_ROWS = 16
"""That are compared, half of them on either side of a peak."""
_SHIFTED = 4
"""Of them, at least, where a shift is told from a difference."""


def differences_near(
    one: Result, peaks: Peaks, other: Result, theirs: Mapping[Key, Vector]
) -> dict[Key, float]:
    """Root mean square differences around the promised peaks, rates and impulses of one result, in the numbers' units.

    What comes a little earlier or later in the other one is as high there, and no difference of a peak. peaks: of one.
    other: a run along some of its steps, segment by segment between events; times count from each. theirs: its peaks.
    Numbers around which no rows of both belong together are left out.
    """
    rows = _pair(one.time, sorted(jumps(one)), other.time, sorted(jumps(other)))
    found = {
        key: rows.difference_in_height(one.time, values, theirs[key], int(np.argmax(np.abs(values))))
        for key, values in peaks
        if key in theirs
    }
    found.update(_of_latch_ups(one, other, rows))
    return {key: difference for key, difference in found.items() if difference is not None}


@dataclass(frozen=True)
class _Pairs:
    """Rows of one run and of another that belong together, shape (n,), and the segment of every row of one."""

    ours: NDArray[np.intp]
    theirs: NDArray[np.intp]
    segments: NDArray[np.intp]

    def difference(self, ours: Vector, theirs: Vector, row: int) -> float | None:
        """Root mean square difference of two signals (N,) around a row of the first, in its segment."""
        near = self._near(row)
        if not near.size:
            return None
        return sqrt(float(np.mean((ours[self.ours[near]] - theirs[self.theirs[near]]) ** 2)))

    def difference_in_height(self, time: Vector, ours: Vector, theirs: Vector, row: int) -> float | None:
        """The same, less what a shift of one against the other in time (s) takes away."""
        near = self._near(row)
        # of rows at one instant, before and after what happens then, the last
        near = near[np.diff(time[self.ours[near]], append=np.inf) > 0.0]
        if near.size < _SHIFTED:
            return self.difference(ours, theirs, row)
        here = self.ours[near]
        apart, slope = ours[here] - theirs[self.theirs[near]], np.gradient(ours[here], time[here])
        steepness = float(slope @ slope)
        if steepness > 0.0:
            apart -= slope * float(slope @ apart) / steepness
        return sqrt(float(np.mean(apart**2)))

    def _near(self, row: int) -> NDArray[np.intp]:
        """Numbers of the pairs around a row of the first run, in its segment."""
        inside = np.flatnonzero(self.segments[self.ours] == self.segments[row])
        place = int(np.searchsorted(self.ours[inside], row))
        return inside[max(0, place - _ROWS // 2) : place + _ROWS // 2]


def _pair(time: Vector, events: Sequence[float], other: Vector, other_events: Sequence[float]) -> _Pairs:
    """Rows (s) as long after the same event, the start being the first."""
    ours_in, theirs_in = segments(time, events), segments(other, other_events)
    # a gap between segments, so that no row is near one of another
    gap = max(float(time[-1]), float(other[-1])) + 1.0
    ours = time - np.take(events, ours_in) + gap * ours_in
    theirs = other - np.take(other_events, theirs_in) + gap * theirs_in
    after = np.clip(np.searchsorted(ours, theirs), 1, max(len(ours) - 1, 1))
    nearest = np.where(theirs - ours[after - 1] < ours[after] - theirs, after - 1, after)
    together = np.abs(ours[nearest] - theirs) < EVENT_WIDTH
    return _Pairs(nearest[together], np.flatnonzero(together), ours_in)


def _of_latch_ups(one: Result, other: Result, rows: _Pairs) -> Iterator[tuple[Key, float | None]]:
    """Rates at latch-up, and impulses of locks, which are off as the rates of their hinges are, before they latch."""
    times = latch_times(one)
    for line in (line for line in one.hinge_lines if line.name in times):
        latched = times[line.name]
        row = int(np.searchsorted(one.time, latched - EVENT_WIDTH)) - 1
        off = {
            hinge: difference
            for hinge in line.hinges
            if one.has(hinge, "angular_rate")
            and (difference := _of_rates(one, other, rows, hinge, row)) is not None
        }
        yield ("latch rate", line.name), off.get(line.sensor)
        impulse = latch_impulse(one, line, latched)
        if impulse is not None:
            sizes = {hinge: abs(float(one.signal(hinge, "angular_rate")[row])) for hinge in off}
            shares = [off[hinge] / size for hinge, size in sizes.items() if size]
            yield ("latch impulse", line.name), max(shares) * impulse if shares else None


def _of_rates(one: Result, other: Result, rows: _Pairs, hinge: str, row: int) -> float | None:
    """By how much the rates of a hinge differ around a row (rad/s)."""
    rates, others = (result.signal(hinge, "angular_rate") for result in (one, other))
    return rows.difference(rates, others, row)
