"""Error of a peak due to the instants at which communication steps end, from the rows of a run alone.

A companion with longer steps detects three errors only by chance. The peak of an unresolved vibration is the row
nearest to it; without every other row it is another one. A transient after an event may end within two steps, and its
peak between rows may exceed the recorded one; so with a damped stop at contact. And a line latches with the rates of
its hinges at one instant: if bodies vibrate within a step, these rates differ from the mean rates over the last steps,
and the damping of the latch turns the difference into a torque at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from components.contract.roles import INTERFACE_LOAD

from ...assembly import HingeLine
from ..estimated_errors import OF_CONTACTS, OF_STOPS, EstimatedError, Key
from ..key_figures import latch_times, line_latch_torque, loads, max_of, peak_of
from ..latch_impulse import latch_impulse
from ..peaks import extremes, jumps
from ..point_loads import point_loads
from ..result import Result, Vector
from ..signal import EVENT_WIDTH

INTERFACE_PEAKS = {"N": "interface force peak", "N.m": "interface torque peak"}
"""Promised quantities of loads on the spacecraft, by unit."""
_OF_SAMPLING, _OF_RATES = 1.0 / 15.0, 0.25
"""Likely shares of what half the samples change, as a cubic through all errs by a sixteenth of what theirs does, and of
what a rate changes: between that of second order and, where it rings, all of it."""
_AROUND = 8
"""Rows on either side of a top that tell how unsure it is."""
_STEPS = 2
"""Steps before a latch-up that tell its rates; more would ring themselves."""


Peaks = Sequence[tuple[Key, Vector]]
"""What `judged_peaks` gives."""


def errors_of_step_ends(result: Result, peaks: Peaks) -> dict[Key, EstimatedError]:
    """By how much promised peaks of torques and loads (N.m, N) are off, each by what it is off most."""
    found: dict[Key, EstimatedError] = {}
    events = jumps(result)
    for key, values in peaks:
        moves = sampling_error(result.time, values, events)
        hidden = hidden_excess(result.time, values, events)
        found[key] = larger(found.get(key), EstimatedError(_OF_SAMPLING * moves, max(moves, hidden)))
    for line in result.hinge_lines:
        key = "latch torque peak", line.name
        if key in found:
            moves = latching_rate_error(result, line)
            found[key] = larger(found[key], EstimatedError(_OF_RATES * moves, moves))
    return found


def larger(*errors: EstimatedError | None) -> EstimatedError:
    """What is largest of several errors of one number, of which all but one may be unknown."""
    known = [error for error in errors if error is not None]
    return EstimatedError(max(e.likely for e in known), max(e.most for e in known))


def sampling_error(time: Vector, values: Vector, events: list[float]) -> float:
    """How far the largest magnitude of a signal (N,) moves when every other sample between events is left out."""
    whole = _largest(time, values, events)
    place = _place_after_event(time, events)
    parts = ((place == 0) | (place % 2 == odd) for odd in (0, 1))
    return max(abs(_largest(time[part], values[part], events) - whole) for part in parts)


def hidden_excess(time: Vector, values: Vector, events: list[float]) -> float:
    """How far beyond the largest magnitude of a signal (N,) a lower top may reach by what is unsure of itself.

    A top is unsure by what the largest magnitude around it moves when every other row is left out.
    """
    height = np.abs(values)
    whole = _largest(time, values, events)
    tops = np.flatnonzero((height[1:-1] >= height[:-2]) & (height[1:-1] > height[2:])) + 1
    # without a top its neighbours remain, so that it is unsure by no more than it rises above them
    reach = 2.0 * height[tops] - np.maximum(height[tops - 1], height[tops + 1])
    most = whole
    for number in np.argsort(-reach):
        if reach[number] <= most:
            break
        top = tops[number]
        near = slice(max(0, top - _AROUND), top + _AROUND + 1)
        most = max(most, height[top] + sampling_error(time[near], values[near], events))
    return most - whole


def latching_rate_error(result: Result, line: HingeLine) -> float:
    """Change of a line's torque peak (N.m) with the mean rates of its hinges over the last steps before latch-up.

    Without vibrations these equal the rates, to the second order of the last steps. The change counts only if a hinge
    still rotates at its peak: a damper torque follows the rate, a spring torque peaks at zero rate. 0 if other events
    leave fewer than two steps.
    """
    rows = _steps_before(result, latch_times(result)[line.name])
    torque = np.abs(line_latch_torque(result, line))
    top = int(np.argmax(torque))
    if len(rows) <= _STEPS:
        return 0.0
    return float(torque[top]) * max(_rate_share(result, hinge, rows, top) for hinge in line.hinges)


def _rate_share(result: Result, hinge: str, rows: list[int], top: int) -> float:
    """Part of a torque at a row that goes with the rate by which the parabola through the angles of rows is off."""
    time, angles = result.time[rows], result.signal(hinge, "angle")[rows]
    length = time[-1] - time[0]
    arriving = np.linalg.solve(np.vander((time - time[-1]) / length), angles)[-2] / length
    rate = result.signal(hinge, "angular_rate")
    present, around = abs(float(rate[rows[-1]])), rate[max(top - 1, rows[-1]) : top + 2]
    # a swing has gone between rows, however far from its top the nearest row happens to be
    still = abs(float(rate[top])) if around.min() * around.max() > 0.0 else 0.0
    return abs(abs(float(arriving)) - present) * min(still, present) / present**2 if present else 0.0


def _steps_before(result: Result, at: float) -> list[int]:
    """Rows that two steps up to an event begin and end with, fewer where another event comes between them."""
    others = [time for time in jumps(result) if time < at - EVENT_WIDTH]
    since = max(others, default=float(result.time[0]))
    row = int(np.searchsorted(result.time, at, side="right")) - 1
    rows = [row]
    while len(rows) <= _STEPS and row > 0 and result.time[row - 1] >= since - EVENT_WIDTH:
        row -= 1
        if result.time[rows[0]] - result.time[row] > EVENT_WIDTH:
            rows.insert(0, row)
    return rows


def judged_peaks(result: Result) -> Iterator[tuple[Key, Vector]]:
    """Signals (N,) whose peaks are headline numbers with errors, by headline number."""
    times = latch_times(result)
    for line in result.hinge_lines:
        if line.name in times and latch_impulse(result, line, times[line.name]) is None:
            yield ("latch torque peak", line.name), line_latch_torque(result, line)
    for load in result.in_role(INTERFACE_LOAD):
        if quantity := INTERFACE_PEAKS.get(result.unit(*load)):
            yield from (((quantity, axis), v) for axis, v in zip("xyz", result.signal(*load).T, strict=True))
    for component, label, torque in loads(result, "N.m"):
        if peak_of(label) == OF_STOPS:
            yield (OF_STOPS, component), torque
    for component, label, force in loads(result, "N"):
        if max_of(label) == OF_CONTACTS:
            yield (OF_CONTACTS, component), force
    yield from point_loads(result)


def _largest(time: Vector, values: Vector, events: list[float]) -> float:
    low, high = extremes(time, values, events)
    return max(abs(low.value), abs(high.value))


def _place_after_event(time: Vector, events: list[float]) -> NDArray[np.int64]:
    """How many rows after the last event's each row is; 0 of those of an event and of the end."""
    of_event = np.zeros(time.size, bool)
    for event in events:
        of_event |= np.abs(time - event) <= EVENT_WIDTH
    of_event[-1] = True
    rows = np.arange(time.size, dtype=np.int64)
    return rows - np.maximum.accumulate(np.where(of_event, rows, 0))
