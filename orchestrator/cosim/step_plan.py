"""Steps given before a run, a list for every segment between two events."""

from __future__ import annotations

from collections.abc import Sequence

_TAIL = 8
_PARTS = 4


class StepPlan:
    """What a run is to step by; segments beyond the last planned one go by that."""

    def __init__(self, segments: Sequence[Sequence[float]]) -> None:
        self._segments = [list(segment) for segment in segments]

    def __bool__(self) -> bool:
        return bool(self._segments)

    def now(self, made: Sequence[Sequence[float]]) -> tuple[list[float], int]:
        """The plan (s) of the present segment, and where in it a run stands that has made these steps."""
        segment, position = len(made) - 1, len(made[-1])
        plan = self._segments[min(segment, len(self._segments) - 1)]
        # beyond its end, not the last step's size: that one only ended at an event and may be tiny
        plan.extend([max(plan[-_TAIL:])] * (position + 1 - len(plan)))
        return plan, position

    def divide(self, made: Sequence[Sequence[float]]) -> None:
        """Make several steps of the next one."""
        plan, position = self.now(made)
        plan[position : position + 1] = [plan[position] / _PARTS] * _PARTS
