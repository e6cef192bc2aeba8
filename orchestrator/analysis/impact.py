"""Impacts of a run: every touch of every contact, how hard, how long, and what it took away.

Bagnoli (2007), sections 2.3.1 and 6.1.2: with a raised holding torque of the SADM the latching outboard panel
throws the inboard one against the spacecraft.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from components.contract.component import Vector

from ..results.key_figures import extremes
from ..results.result import Result, ResultError

_SHORTEST_GAP = 1e-3
"""Touches of one contact that are less than this apart (s) are one impact that chatters."""


@dataclass(frozen=True)
class Impact:
    """One touch of one contact."""

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


def impacts(result: Result) -> list[Impact]:
    """All touches that a result holds, in order of time; ResultError where it has no contact."""
    names = result.recording("contact_force")
    if not names:
        raise ResultError(f"{result.name}: the scene has no contact, so there is no impact to look for")
    found = [impact for name in names for impact in _impacts_of(result, name)]
    return sorted(found, key=lambda impact: impact.start)


def _impacts_of(result: Result, name: str) -> Iterator[Impact]:
    time = result.time
    depth = result.signal(name, "penetration")
    force = result.signal(name, "contact_force")
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
