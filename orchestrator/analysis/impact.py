"""Impacts of a run: every touch of every contact and end stop, how hard, how long, and what it took away.

Bagnoli (2007), sections 2.3.1 and 6.1.2: with a raised holding torque of the SADM the latching outboard panel
throws the inboard one against the spacecraft.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from components.contract.component import Vector

from ..results.peaks import extremes
from ..results.result import Result, ResultError

CONTACT_FORCE, STOP_TORQUE = TOUCHING_LOADS = ("contact_force", "stop_torque")
"""What is recorded of contacts and of end stops, both beside a penetration."""
_SHORTEST_GAP = 1e-3
"""Touches of one contact that are less than this apart (s) are one impact that chatters."""


@dataclass(frozen=True)
class Impact:
    """One touch of one contact; of an end stop with rad for m, N.m for N."""

    contact: str
    start: float
    """s"""
    duration: float
    """s"""
    closing_speed: float
    """of penetration at first touch, m/s"""
    peak_force: float
    """N"""
    peak_time: float
    """s"""
    impulse: float
    """N.s"""
    deepest: float
    """penetration, m"""
    dissipated: float
    """J"""
    angular: bool = False
    """whether it is that of an end stop"""


def impacts(result: Result) -> list[Impact]:
    """All touches that a result holds, in order of time; ResultError where it has neither contact nor end stop."""
    loads = [(name, load) for load in TOUCHING_LOADS for name in result.recording(load)]
    if not loads:
        raise ResultError(
            f"{result.name}: the scene has neither a contact nor an end_stop, so there is no impact to look for"
        )
    found = [impact for name, load in loads for impact in _impacts_of(result, name, load)]
    return sorted(found, key=lambda impact: impact.start)


def _impacts_of(result: Result, name: str, load: str) -> Iterator[Impact]:
    time = result.time
    depth = result.signal(name, "penetration")
    if result.has(name, "in_contact"):  # not where a stop has failed
        depth = np.where(result.signal(name, "in_contact") > 0.5, depth, np.minimum(depth, 0.0))
    force = result.signal(name, load)
    heat = result.signal(name, "dissipated_energy")
    for first, last in _touches(time, depth):
        inside = slice(first, last + 1)
        start, end = _crossing(time, depth, first - 1), _crossing(time, depth, last)
        _, top = extremes(time[inside], force[inside])
        _, deepest = extremes(time[inside], depth[inside])
        yield Impact(
            name,
            start,
            end - start,
            closing_speed(time, depth, first, start),
            top.value,
            top.time,
            float(np.trapezoid(np.r_[0.0, force[inside], 0.0], np.r_[start, time[inside], end])),
            deepest.value,
            float(heat[min(last + 1, time.size - 1)] - heat[max(first - 1, 0)]),
            load == STOP_TORQUE,
        )


def _touches(time: Vector, depth: Vector) -> list[tuple[int, int]]:
    """First and last sample of every touch; a gap too short to be one does not part two."""
    touching = np.flatnonzero(depth > 0.0)
    found: list[tuple[int, int]] = []
    for sample in touching.tolist():
        if found and (sample == found[-1][1] + 1 or time[sample] - time[found[-1][1]] < _SHORTEST_GAP):
            found[-1] = (found[-1][0], sample)
        else:
            found.append((sample, sample))
    return found


def _crossing(time: Vector, depth: Vector, sample: int) -> float:
    """Time at which the penetration passes zero after a sample; the end of the record where it does not."""
    if sample < 0 or sample + 1 >= time.size:
        return float(time[0] if sample < 0 else time[-1])
    before, after = depth[sample], depth[sample + 1]
    return float(time[sample] + (time[sample + 1] - time[sample]) * before / (before - after))


def closing_speed(time: Vector, depth: Vector, sample: int, touch: float) -> float:
    """Rate of penetration at the touch, from the parabola through the three samples before it; 0 at the start.

    Of the two samples at an event only the second, from which the motion goes on.
    """
    before = np.flatnonzero(np.diff(time[: sample + 1]) > 0.0)[-3:]
    if before.size < 3:
        return 0.0
    return float(np.polyval(np.polyder(np.polyfit(time[before] - touch, depth[before], 2)), 0.0))
