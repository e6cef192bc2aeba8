"""Error of a load peak due to numerical damping of a vibration.

Joints without damping vibrate to the end of a run once a motor or a latch has excited them. Steps of a fraction of a
period damp them within hundreds of periods, a companion with doubled steps within far fewer. Once the vibration has
decayed, both take long steps and record the same peak without it. Physical damping decays alike in both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..estimated_errors import Key
from ..result import Result, Vector
from ..signal import EVENT_WIDTH
from .between_events import rows_between_events
from .sampling_error import INTERFACE_PEAKS, Peaks

_FADED, _LASTING = 0.5, 8
"""Part of a ringing that is left when its fading is told apart, and swings at least that it has lasted until then."""
_ALIKE = 0.5
"""Part of what a run has left of it then, of which a companion has less where steps are what damps it."""
_PERIODS = 2.0
"""Times, either way, by which half periods of one ringing differ as rows tell them; twice that for a companion."""
_AXES = "xyz"
_AROUND = 4.0
"""Half periods on either side of an instant in which a ringing has a swing."""


class _Swings(NamedTuple):
    """From one extreme of a signal to the next (n,): when and in which row it ends, half a period (s), amplitude."""

    time: Vector
    row: NDArray[np.intp]
    half_period: Vector
    amplitude: Vector

    @classmethod
    def of(cls, time: Vector, values: Vector) -> _Swings:
        """Those of a signal (N,) that is smooth; times count from its first row."""
        change = np.sign(np.diff(values))
        moving = np.flatnonzero(change)
        turns = moving[1:][np.diff(change[moving]) != 0.0]
        at = time[turns] - time[0]
        return cls(at[1:], turns[1:], np.diff(at), 0.5 * np.abs(np.diff(values[turns])))

    def among(self, chosen: NDArray[np.bool_]) -> _Swings:
        """Some of them."""
        return _Swings(self.time[chosen], self.row[chosen], self.half_period[chosen], self.amplitude[chosen])

    def like(self, half_period: float, times: float) -> _Swings:
        """Those of a ringing with a half period, within so many times of it."""
        return self.among((self.half_period > half_period / times) & (self.half_period < half_period * times))


def lost_ringing(one: Result, peaks: Peaks, other: Result, theirs: Mapping[Key, Vector]) -> dict[Key, float]:
    """By how much promised interface peaks of one result (N, N.m) would be passed by ringing that its steps damped.

    peaks: of one. other: a run with every two of its steps as one, theirs: its peaks. Ringing counts from where it is
    strongest; where it is lost, later steps are longer than half of its period. By then lines may have turned it into
    other components.
    """
    found: dict[Key, float] = {}
    turned = _turned(one)
    for quantity in INTERFACE_PEAKS.values():
        loads = {key: values for key, values in peaks if key[0] == quantity and key in theirs}
        for key, values in loads.items():
            for row, half_period, lost in _damped_by_steps(one, values, other, theirs[key]):
                later = row + np.flatnonzero(_steps(one.time)[row:] > half_period)
                for beside, load in loads.items():
                    part = 1.0 if beside == key else turned[_AXES.index(key[1]), _AXES.index(beside[1])]
                    beyond = float(np.abs(load[later]).max() + part * lost - np.abs(load).max())
                    found[beside] = max(found.get(beside, 0.0), beyond)
    return found


def _damped_by_steps(
    one: Result, ours: Vector, other: Result, theirs: Vector
) -> Iterator[tuple[int, float, float]]:
    """What rings strongest after each event where steps alone damp it: row, half a period (s), amplitude lost."""
    longest = np.maximum.accumulate(_steps(one.time)[::-1])[::-1]
    for mine, its in zip(rows_between_events(one), rows_between_events(other), strict=False):
        swings = _Swings.of(one.time[mine], ours[mine])
        longer = longest[mine][swings.row] > swings.half_period
        lost = swings.among(longer & (swings.half_period > EVENT_WIDTH))
        if not lost.time.size:
            continue
        top = int(np.argmax(lost.amplitude))
        start, half_period, amplitude = (
            float(column[top]) for column in (lost.time, lost.half_period, lost.amplitude)
        )
        alike = swings.like(half_period, _PERIODS)
        lasting = alike.among((alike.time >= start) & (alike.amplitude >= _FADED * amplitude))
        faded = float(lasting.time[-1])
        if faded - start < _LASTING * half_period:
            continue
        companion = _Swings.of(other.time[its], theirs[its]).like(half_period, 2.0 * _PERIODS)
        near = companion.among(np.abs(companion.time - faded) <= _AROUND * half_period)
        if near.amplitude.max(initial=0.0) < _ALIKE * lasting.amplitude[-1]:
            yield mine.start + int(lost.row[top]), half_period, amplitude - alike.amplitude[-_LASTING:].max()


def _turned(result: Result) -> Vector:
    """Parts (3, 3) of a component's ringing that the turn of some hinge line may make ringing of another one."""
    parts = np.zeros((3, 3))
    for line in result.hinge_lines:
        if line.axis:
            across = np.sqrt(np.maximum(1.0 - np.square(line.axis), 0.0))
            parts = np.maximum(parts, np.outer(across, across))
    return parts


def _steps(time: Vector) -> Vector:
    """The longer one of the two steps adjacent to each row."""
    steps = np.diff(time, prepend=time[0], append=time[-1])
    return np.maximum(steps[:-1], steps[1:])
