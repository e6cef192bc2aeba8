"""Step sizes that are known before a run, such as those of an earlier run."""

from __future__ import annotations

from collections.abc import Sequence

_LONGER = 1.1
_TAIL, _PARTS = 8, 4


class StepPlan:
    """Planned steps, a list (s) for each segment between events; further segments follow the last list."""

    def __init__(self, segments: Sequence[Sequence[float]]) -> None:
        # a run that ends at an event has begun a segment without steps
        self._segments = [list(segment) for segment in segments if segment]

    def __bool__(self) -> bool:
        return bool(self._segments)

    def now(self, made: Sequence[Sequence[float]]) -> tuple[list[float], int]:
        """The plan (s) of the present segment, and the index of the next step of a run that has made these steps."""
        segment, position = len(made) - 1, len(made[-1])
        plan = self._segments[min(segment, len(self._segments) - 1)]
        # beyond its end, not the last step's size: that one only ended at an event and may be tiny
        plan.extend([max(plan[-_TAIL:])] * (position + 1 - len(plan)))
        return plan, position

    def next(self, made: Sequence[Sequence[float]]) -> list[float]:
        """Sizes (s) of the steps to come in the present segment."""
        plan, position = self.now(made)
        return plan[position:]

    def first_after(self, made: Sequence[Sequence[float]]) -> float:
        """The first planned step (s) after an event that acts now."""
        return self.now([*made, []] if made[-1] else made)[0][0]

    def divide(self, made: Sequence[Sequence[float]], least: float) -> bool:
        """Divide the next step; False where its parts would be smaller than `least` (s)."""
        plan, position = self.now(made)
        part = plan[position] / _PARTS
        if part < least:
            return False
        plan[position : position + 1] = [part] * _PARTS
        return True


def to_own_events(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Steps of a run as a plan for one whose events come a little earlier or later: the last of each segment is longer.

    Otherwise an event that comes a little later leaves a tiny step, whose loads are wrong.
    """
    return [[*steps[:-1], _LONGER * steps[-1]] if steps else [] for steps in segments]
