"""Error of a load peak where friction reverses between two rows.

A line reverses in its latch or end stop at the largest compression, and its friction with it, within less than a step.
So the load has a jump next to its peak, which the rows of a run and of its companion both miss. Extrapolation of the
rows on either side bounds it.
"""

from __future__ import annotations

import numpy as np

from ..estimated_errors import Key
from ..result import Result, Vector
from .between_events import rows_between_events
from .sampling_error import INTERFACE_PEAKS, Peaks

_SIDE = 3
"""Rows on either side of a reversal, with a parabola through them."""
_PLACES = np.linspace(0.0, 1.0, 17)[1:-1]
"""Between two rows, where both parabolas are compared."""


def beyond_reversals(result: Result, peaks: Peaks) -> dict[Key, float]:
    """By how much promised interface peaks (N, N.m) would be passed between rows where friction reverses.

    By no more than the part that friction is of the largest torque on the spacecraft. 0 or less, or no key: nowhere.
    """
    frictions = [result.signal(name, "friction_torque") for name in result.recording("friction_torque")]
    loads = {key: np.abs(values) for key, values in peaks if key[0] in INTERFACE_PEAKS.values()}
    torque = max(
        (load.max() for (what, _), load in loads.items() if what == INTERFACE_PEAKS["N.m"]), default=0.0
    )
    if not torque or not any(friction.any() for friction in frictions):
        return {}
    found: dict[Key, float] = {}
    for rows in rows_between_events(result):
        share = _reversing(np.array([friction[rows] for friction in frictions])) / torque
        for key, load in loads.items():
            top = float(load.max())
            beyond = _beyond(result.time[rows], load[rows], share * top, top)
            found[key] = max(found.get(key, 0.0), beyond)
    return found


def _reversing(frictions: Vector) -> Vector:
    """What frictions (hinges, rows) together change by around each interval (rows - 1,) in which they reverse (N.m)."""
    if frictions.shape[1] < 2:
        return np.zeros(0)
    before, after = frictions[:, :-1], frictions[:, 1:]
    changes: Vector = np.where(before * after < 0.0, np.abs(after - before), 0.0).sum(axis=0)
    return changes


def _beyond(time: Vector, load: Vector, most: Vector, top: float) -> float:
    """Excess of a load over a height inside intervals, by extrapolation from both sides, limited by the friction."""
    places = np.flatnonzero((most > 0.0) & (np.maximum(load[:-1], load[1:]) + most > top))
    found = 0.0
    for i in places[(places >= _SIDE - 1) & (places + _SIDE < time.size)].tolist():
        inside = time[i] + _PLACES * (time[i + 1] - time[i])
        left, right = slice(i + 1 - _SIDE, i + 1), slice(i + 1, i + 1 + _SIDE)
        before, after = (_parabola(time[side], load[side], inside) for side in (left, right))
        # on one of both sides the load has the friction that it lacks on the other
        meets = np.maximum(np.minimum(before, after + most[i]), np.minimum(before + most[i], after))
        found = max(found, min(float(meets.max()) - top, float(most[i])))
    return found


def _parabola(time: Vector, values: Vector, at: Vector) -> Vector:
    """Through three values, at other times."""
    powers = np.linalg.solve(np.vander(time - time[0]), values)
    found: Vector = np.polyval(powers, at - time[0])
    return found
