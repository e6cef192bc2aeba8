"""How far hinge lines travelled: whether they reached their latch, stop or deployed angle, or passed it."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from components.end_stop import OF_HINGE

from ..assembly import HingeLine
from .result import Result
from .signal import EVENT_WIDTH

Vector = NDArray[np.float64]

_GIVES_WAY = radians(1.0)
"""Beyond its deployed angle a line is where nothing stopped it; a stop or a drive gives way by less, either way."""


@dataclass(frozen=True, slots=True)
class Overrun:
    """A line that nothing kept at its deployed angle: that one, the largest and the last (rad), when it passed (s)."""

    deployed_angle: float
    passed_at: float
    largest: float
    last: float


@dataclass(frozen=True, slots=True)
class ShortOf:
    """A line without a latch that is not at its stop or deployed angle: this angle, the largest, the last (rad)."""

    angle: float
    largest: float
    last: float


def rows_joined(result: Result, line: HingeLine) -> slice:
    """Rows at which a line still joins its bodies: those before the event that released the last of its hinges."""
    times = [
        max((t for t, _, text in result.events if f"{hinge} released" in text.split(", ")), default=np.inf)
        for hinge in line.hinges
    ]
    last = float(max(times, default=np.inf))
    return slice(0, max(1, int(np.searchsorted(result.time, last - EVENT_WIDTH))))


def is_released(result: Result, line: HingeLine) -> bool:
    """Whether no hinge of a line is left at the end."""
    return bool(rows_joined(result, line).stop < result.time.size)


def unlatched_angles(result: Result, latched: Collection[str]) -> dict[str, float]:
    """Where lines that have a latch and are not among those that have latched stand at the end (rad), by name."""
    return {
        line.name: float(result.signal(line.sensor, "angle")[-1])
        for line in result.hinge_lines
        if line.latches and line.name not in latched and result.has(line.sensor, "angle")
        if not is_released(result, line)
    }


def _open_ended(result: Result, *, taped: bool = False) -> Iterator[tuple[HingeLine, float, Vector]]:
    """Lines that nothing, or tapes, keep at their deployed angle, not released later: that angle, all angles (rad)."""
    for line in result.hinge_lines:
        if line.deployed_angle is None or bool(line.tapes) != taped or not result.has(line.sensor, "angle"):
            continue
        if not is_released(result, line):
            yield line, line.deployed_angle, result.signal(line.sensor, "angle")


def overruns(result: Result) -> dict[str, Overrun]:
    """Lines, by name, that passed the deployed angle at which nothing keeps them, but for those released later."""
    found = {}
    for line, deployed, angle in _open_ended(result):
        passed = np.flatnonzero(angle > deployed + _GIVES_WAY)
        if passed.size:
            at = float(result.time[passed[0]])
            found[line.name] = Overrun(deployed, at, float(angle.max()), float(angle[-1]))
    return found


def short_of_deployed(result: Result) -> dict[str, ShortOf]:
    """Lines, by name, that nothing keeps at their deployed angle and that never came to it, likewise."""
    return {
        line.name: ShortOf(deployed, float(angle.max()), float(angle[-1]))
        for line, deployed, angle in _open_ended(result)
        if angle.max() < deployed - _GIVES_WAY
    }


def folded(result: Result) -> dict[str, ShortOf]:
    """Lines, by name, that tape springs would keep at their deployed angle and that end with one folded."""
    return {
        line.name: ShortOf(deployed, float(angle.max()), float(angle[-1]))
        for line, deployed, angle in _open_ended(result, taped=True)
        if not all(result.signal(tape, "straight")[-1] for tape in line.tapes if result.has(tape, "straight"))
    }


def has_motor(result: Result, line: HingeLine) -> bool:
    """Whether a motor is there to open a line."""
    return any(
        result.has(hinge, "motor_torque") and result.signal(hinge, "motor_torque").any()
        for hinge in line.hinges
    )


def _ended_by_stops(result: Result) -> Iterator[tuple[str, Vector, Vector]]:
    """Lines that an end stop alone ends, but for those released: name, angle and depth in the stop (rad)."""
    for line in result.hinge_lines:
        stop = line.sensor + OF_HINGE
        if line.latches or is_released(result, line):
            continue
        if result.has(stop, "penetration") and result.has(line.sensor, "angle"):
            yield line.name, result.signal(line.sensor, "angle"), result.signal(stop, "penetration")


def short_of_stops(result: Result) -> dict[str, ShortOf]:
    """Lines, by name, that an end stop alone ends and that never came to it, but for those released."""
    return {
        name: ShortOf(float(angle[0] - depth[0]), float(angle.max()), float(angle[-1]))
        for name, angle, depth in _ended_by_stops(result)
        if depth.max() < 0.0
    }


def reached_stops(result: Result) -> dict[str, float]:
    """When (s) lines that an end stop alone ends first came to it, by name."""
    return {
        name: float(result.time[np.flatnonzero(depth >= 0.0)[0]])
        for name, _, depth in _ended_by_stops(result)
        if depth.max() >= 0.0
    }
