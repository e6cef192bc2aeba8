"""What falls through zero within a step: which comes first, what comes with it, and where in the step that is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from components.numerics.scheme import INSTANT

from ...assembly import Event, HingeLine

EVENT_TOLERANCE = 1e-11
"""Of the distance of an event, relative: where it is taken for met."""
_EVENT_SEARCH = 40


class Fall(NamedTuple):
    """How far a line was from its latch, or a condition from holding, before a step and is after it."""

    one: HingeLine | Event
    before: float
    after: float

    def time(self, h: float) -> float:
        """Time (s) after the start of the step h at which it is zero, by a straight line."""
        return h * self.before / (self.before - self.after)


def first_met(falls: Sequence[Fall], h: float) -> Fall | None:
    """The function that first falls through zero in a step h (s); the first one of simultaneous ones."""
    within = [fall for fall in falls if fall.after <= 0.0 < fall.before and fall.time(h) <= h]
    return min(within, key=lambda fall: fall.time(h), default=None)


def met_with(crossed: Fall, falls: Sequence[Fall], h: float) -> list[HingeLine | Event]:
    """What a step h (s) was ended for, and then all else that falls through zero at that instant."""
    others = [fall for fall in falls if fall.one is not crossed.one and fall.before > 0.0]
    return [
        crossed.one,
        *(fall.one for fall in others if fall.after <= (fall.before - fall.after) / h * INSTANT),
    ]


def still_to_latch(
    line: HingeLine, reached: Sequence[HingeLine | Event], pending: Sequence[HingeLine]
) -> list[HingeLine]:
    """The line as it is pending, and those kinematic ones reached with it that lock with it; none if it is not."""
    own = [one for one in pending if one.name == line.name]
    met = {one.name for one in reached} - {line.name}
    return own and own + [one for one in pending if one.name in met and one.kinematic and line.kinematic]


def find_event(distance: Callable[[float], float], before: float, after: float, h: float) -> float:
    """Step size at which a distance that falls from before (> 0) through zero in h reaches zero.

    `distance(h)` restores, steps by h and returns the distance; it is called last with the result, so the
    participants end there. Illinois variant of the false position, safe and without derivatives.
    """
    low, high, f_low, f_high = 0.0, h, before, after
    side = 0
    for _ in range(_EVENT_SEARCH):
        trial = (f_low * high - f_high * low) / (f_low - f_high)
        trial = min(max(trial, low + 1e-3 * (high - low)), high)
        value = distance(trial)
        if abs(value) < EVENT_TOLERANCE or high - low < 1e-12:
            return trial
        if value > 0.0:
            low, f_low = trial, value
            f_high *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, f_high = trial, value
            f_low *= 0.5 if side == -1 else 1.0
            side = -1
    return trial
