"""Lines whose latches let go again: when, and what became of them."""

from __future__ import annotations

from dataclasses import dataclass

from ..assembly import HingeLine
from .result import Result


@dataclass(frozen=True, slots=True)
class Unlatching:
    """When (s) the latch of a line let go last, and engaged again, None if not; angle of the line at the end (rad)."""

    time: float
    again: float | None
    angle: float


def unlatchings(result: Result) -> dict[str, Unlatching]:
    """Of all lines whose latches let go, by name."""
    found = {}
    for line in result.hinge_lines:
        if gone := _times(result, line.unlatch_event):
            again = [time for time in _times(result, line.latch_event) if time >= gone[-1]]
            angle = float(result.signal(line.sensor, "angle")[-1])
            found[line.name] = Unlatching(gone[-1], again[-1] if again else None, angle)
    return found


def latched_since(result: Result, line: HingeLine, time: float) -> float | None:
    """When (s) a line latched that is latched just before a time (s); None where it is not."""
    last = max((one for one in _times(result, line.latch_event) if one < time), default=None)
    if last is None or any(last <= one < time for one in _times(result, line.unlatch_event)):
        return None
    return last


def _times(result: Result, text: str) -> list[float]:
    """Times (s) of events of a text."""
    return sorted(time for time, _, event in result.events if event == text)
