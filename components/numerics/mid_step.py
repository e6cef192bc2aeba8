"""Means over a step belong to its middle; this brings them to the communication point at its end.

A port velocity at the end of a step is no substitute: under a held wrench the stiffest modes of a flexible
body come to rest within the step, and their share of a slowly changing motion is missing at its end.
"""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

from ..contract.component import Vector

T = TypeVar("T", float, Vector)


class StepMean(NamedTuple, Generic[T]):
    """Mean over a step, its slope, half the change over the step as far as it is known, and the size of the step."""

    mean: T
    slope: T
    h: float


def extrapolated(last: StepMean[T], previous: StepMean[T]) -> T:
    """Value at the end of the last of two steps; the mean with its slope where a size is not above 0.

    What slopes tell goes on as a parabola, and what they do not know of the change of means, such as the part of
    friction, along a line. Without slopes that is the line through both means.
    """
    if last.h <= 0.0 or previous.h <= 0.0:
        return last.mean + last.slope
    between = 0.5 * (last.h + previous.h)
    rate, rate_before = last.slope * (2.0 / last.h), previous.slope * (2.0 / previous.h)
    bend = (rate - rate_before) / between
    known = 0.5 * between * (rate + rate_before) + bend * (last.h**2 - previous.h**2) / 24.0
    unknown = last.mean - previous.mean - known
    return last.mean + last.slope + bend * (last.h**2 / 12.0) + unknown * (0.5 * last.h / between)


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
        return extrapolated(StepMean(self.last, 0.0, self.h), StepMean(self.previous, 0.0, self.previous_h))
