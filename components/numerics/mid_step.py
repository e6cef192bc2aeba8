"""Means over a step belong to its middle; this brings them to the communication point at its end.

A port velocity at the end of a step is no substitute: under a held wrench the stiffest modes of a flexible
body come to rest within the step, and their share of a slowly changing motion is missing at its end.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

from ..contract.component import Vector

T = TypeVar("T", float, Vector)


def extrapolated(last: T, previous: T, h: float, previous_h: float) -> T:
    """Line through the last two steps' means at the end of the last; the last mean where a size is not above 0."""
    if h <= 0.0 or previous_h <= 0.0:
        return last
    return last + (last - previous) * (h / (h + previous_h))


class MidStepRate(NamedTuple):
    """Mean rates of the last two steps and their sizes; size 0 where there is none."""

    last: float
    previous: float
    h: float
    previous_h: float

    @classmethod
    def starting(cls, rate: float) -> MidStepRate:
        """Before the first step, or after an impulse: only an instant's rate is known."""
        return cls(rate, rate, 0.0, 0.0)

    def after(self, rate: float, h: float) -> MidStepRate:
        """With one step more."""
        return MidStepRate(rate, self.last, h, self.h)

    def now(self) -> float:
        """Rate at the communication point."""
        return extrapolated(*self)
