"""Means over a step belong to its middle; this brings them to the communication point at its end.

A port velocity at the end of a step is no substitute: under a held wrench the stiffest modes of a flexible
body come to rest within the step, and their share of a slowly changing motion is missing at its end.
"""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

import numpy as np

from ..contract.component import Vector
from .scheme import INSTANT, ROUGH

T = TypeVar("T", float, Vector)


class StepMean(NamedTuple, Generic[T]):
    """Mean over a step, its slope, half the change over the step as far as it is known, and the size of the step."""

    mean: T
    slope: T
    h: float


def extrapolated(last: StepMean[T], previous: StepMean[T]) -> T:
    """Value at the end of the last of two steps; the mean with its slope where there is but one.

    What slopes tell goes on as a parabola, and what they do not know of the change of means, such as the part of
    friction that sticks, along a line. Without slopes that is the line through both means. Behind a jump, rates of
    a short step say nothing of the long one before: after a longer one, that part is no more than the gap between
    the lines of both. In an instant nothing but a jump can have changed a load, and its own step tells it.
    """
    if last.h <= INSTANT or previous.h <= 0.0:
        return last.mean + last.slope
    between = 0.5 * (last.h + previous.h)
    rate, rate_before = last.slope * (2.0 / last.h), previous.slope * (2.0 / previous.h)
    bend = (rate - rate_before) / between
    known = 0.5 * between * (rate + rate_before) + bend * (last.h**2 - previous.h**2) / 24.0
    unknown = last.mean - previous.mean - known
    if last.h < previous.h:
        gap = abs((last.mean - last.slope) - (previous.mean + previous.slope))
        unknown = np.minimum(np.maximum(unknown, -gap), gap)
    return last.mean + last.slope + bend * (last.h**2 / 12.0) + unknown * (0.5 * last.h / between)


def between(before: StepMean[T], after: StepMean[T]) -> T:
    """Value at the communication point between two steps, exact for a cubic; sizes must be above 0.

    Four numbers, two means and two slopes, make the cubic. With steps of one size its error is h^4 / 360 times the
    fourth derivative, and slopes count by a third, where an extrapolation takes them whole.
    """
    a, b = before.h, after.h
    means = (b * b * (b + 3.0 * a)) * before.mean + (a * a * (a + 3.0 * b)) * after.mean
    slopes = (b * b * (5.0 * a + 3.0 * b)) * before.slope - (a * a * (3.0 * a + 5.0 * b)) * after.slope
    return (means + slopes * (1.0 / 3.0)) * (1.0 / (a + b) ** 3)


class MidStep(NamedTuple):
    """Means of a rate or a load over the last two steps and the sizes of these; size 0 where there is none."""

    last: float
    previous: float
    h: float
    previous_h: float

    @classmethod
    def starting(cls, value: float) -> MidStep:
        """Before the first step, or after an impulse: only an instant's value is known."""
        return cls(value, value, 0.0, 0.0)

    def after(self, mean: float, h: float) -> MidStep:
        """With one step more."""
        return MidStep(mean, self.last, h, self.h)

    def now(self) -> float:
        """Value at the communication point."""
        return extrapolated(StepMean(self.last, 0.0, self.h), StepMean(self.previous, 0.0, self.previous_h))

    def load_now(self, at_end: float, roughness: float) -> float:
        """Load of a stiff coordinate at the communication point, from that of its law at the end of the last step.

        Where steps resolve the motion, the law is right. Where they do not, the coordinate goes out and comes back
        within steps, and the law takes the end of such a motion for its load; slopes have their share of it, so
        what tells the load there are its means.
        """
        if self.h <= 0.0:
            return at_end
        square = roughness * roughness
        return at_end + square / (square + ROUGH * ROUGH) * (self.now() - at_end)


class MidStepSlope(NamedTuple):
    """Means and slopes of a rate or a load over the last two steps and their sizes; size 0 where there is none."""

    last: float
    slope: float
    h: float
    previous: float
    previous_slope: float
    previous_h: float

    @classmethod
    def starting(cls, value: float) -> MidStepSlope:
        """Before the first step, or after an impulse: only an instant's value is known."""
        return cls(value, 0.0, 0.0, value, 0.0, 0.0)

    def after(self, mean: float, slope: float, h: float) -> MidStepSlope:
        """With one step more."""
        return MidStepSlope(mean, slope, h, self.last, self.slope, self.h)

    def now(self) -> float:
        """Value at the communication point."""
        return extrapolated(StepMean(*self[:3]), StepMean(*self[3:]))

    def before(self) -> float:
        """Value at the communication point before the last step; zero without two steps."""
        if self.h <= 0.0 or self.previous_h <= 0.0:
            return 0.0
        return between(StepMean(*self[3:]), StepMean(*self[:3]))

    def load_now(self, at_end: float, roughness: float) -> float:
        """See `MidStep.load_now`."""
        return MidStep(self.last, self.previous, self.h, self.previous_h).load_now(at_end, roughness)
