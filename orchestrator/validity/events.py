"""Events of a scene that did not happen in a run, or had no effect."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

import numpy as np

from ..assembly import Assembly, Event
from ..results.key_figures import latch_times, shown
from ..results.result import Result
from ..results.signal import EVENT_WIDTH
from ..results.unlatching import latched_since

_LATCH_ANGLE = "latch_angle"


def event_warnings(assembly: Assembly, result: Result, until: float) -> Iterator[str]:
    """A sentence for each event that did not happen, or whose target had latched or was released before.

    Those after the end of the run, `until` (s), are known before it.
    """
    happened = {name: time for time, name, _ in result.events}
    for event in assembly.events:
        if event.name in happened:
            yield from _without_effect(assembly, event, happened[event.name], result)
            yield from _latches_left_behind(assembly, event, happened[event.name], result)
        elif event.time is None or event.time <= until:
            yield _absent(event, result)


def _absent(event: Event, result: Result) -> str:
    """Why it did not happen, and how far its condition was from being met."""
    if (condition := event.condition) is None:
        return (
            f"event {event.name} did not happen: its time is {event.time:g} s, and the run ended at "
            f"{result.time[-1]:g} s."
        )
    values = result.signal(condition.part, condition.variable).reshape(result.time.size, -1)
    variable = f"{condition.part}.{condition.variable}"
    unit, size = shown(result.unit(condition.part, condition.variable))
    seen = size * values[:, condition.index]
    return (
        f"event {event.name} did not happen: its condition is {variable} "
        f"{'above' if condition.rising else 'below'} {size * condition.value:.6g} {unit}, and the run has "
        f"{seen.min():.6g} to {seen.max():.6g} {unit}."
    )


def _without_effect(assembly: Assembly, event: Event, at: float, result: Result) -> Iterator[str]:
    """Lines that an event at a time (s) should latch or unlatch and could not."""
    for line in assembly.hinge_lines:
        since = latched_since(result, line, at - EVENT_WIDTH)
        if line.name in event.unlatches and since is None:
            yield f"event {event.name} did not unlatch {line.name}: it was not latched. Its latch stays open."
        if line.name not in event.latches:
            continue
        if since is not None:
            yield f"event {event.name} did not latch {line.name}: it had latched before, at {since:.6g} s."
        elif latched_since(result, line, at + EVENT_WIDTH) is None:
            yield (
                f"event {event.name} did not latch {line.name}: its hinges were released before, or its latch is "
                "held open by an unlatch_command."
            )


def _latches_left_behind(assembly: Assembly, event: Event, at: float, result: Result) -> Iterator[str]:
    """Lines whose latch angle an event at a time (s) set when they had latched (s), or to where they had been."""
    angles = {
        one.part: one.value
        for one in event.settings
        if one.parameter == _LATCH_ANGLE and isinstance(one.value, float)
    }
    latched = latch_times(result)
    for line in assembly.hinge_lines:
        angle = angles.get(line.sensor)
        if angle is None:
            continue
        if (since := latched_since(result, line, at - EVENT_WIDTH)) is not None:
            yield (
                f"event {event.name}: a new {_LATCH_ANGLE} has no effect on {line.name}, which had latched at "
                f"{since:.6g} s."
            )
        elif line.name not in latched and angle < (now := _angle_at(result, line.sensor, at)):
            yield (
                f"event {event.name}: {line.name} was at {degrees(now):.2f} deg, already beyond its new "
                f"{_LATCH_ANGLE} of {degrees(angle):.2f} deg, so it did not latch. Set latch_command = 1 to latch "
                "it at its angle."
            )


def _angle_at(result: Result, hinge: str, at: float) -> float:
    """Angle (rad) of a hinge at a time (s)."""
    return float(np.interp(at, result.time, result.signal(hinge, "angle")))
