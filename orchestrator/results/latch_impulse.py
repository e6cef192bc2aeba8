"""The impulse of a lock between rigid bodies: what it takes away in no time, where it has no torque of its own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..assembly import HingeLine
from .result import Result


def latch_impulses(result: Result, times: Mapping[str, float]) -> dict[str, float]:
    """Impulses (N.m.s) of all lines that have one, by the times (s) at which lines latched."""
    found = {
        line.name: latch_impulse(result, line, times[line.name])
        for line in result.hinge_lines
        if line.name in times
    }
    return {name: impulse for name, impulse in found.items() if impulse is not None}


def latch_impulse(result: Result, line: HingeLine, latched: float) -> float | None:
    """Magnitude of the angular impulse about the hinge line (N.m.s) at its latch-up (s), the sum over its hinges.

    None if the line is no lock between rigid bodies, or its result has no record of it. Next to a flexible body it
    would be that of the small mass that moves with the hinges at first.
    """
    after = int(np.searchsorted(result.time, latched, side="right"))
    if not line.locks_rigid or not 0 < after < result.time.size:
        return None
    sums = (
        result.signal(hinge, "latch_impulse") for hinge in line.hinges if result.has(hinge, "latch_impulse")
    )
    return abs(sum(float(one[after] - one[after - 1]) for one in sums))
