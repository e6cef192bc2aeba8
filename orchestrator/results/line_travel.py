"""How hinge lines strayed in a run: past their deployed angle, behind their start, about other axes than their own."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from components.contract.frames import rotated
from components.end_stop import OF_HINGE

from ..assembly import HingeLine
from .crests import Peak
from .result import Result
from .signal import EVENT_WIDTH

Vector = NDArray[np.float64]

_FOLDED_BACK = radians(5.0)
"""Further behind where a line started is where a folded stack has no room."""

_GIVES_WAY = radians(1.0)
"""Beyond its deployed angle a line is where nothing stopped it; a stop or a drive gives way by less, either way."""

_PRESSED = radians(30.0)
"""Further into an end stop is where it stops nothing."""

_UNKNOWN = 0.2
"""rad, further beyond the tables of a motor or a harness, and the line's way, is where what they go on by matters."""

_BENT = radians(30.0)
"""Rotations across a line that are no longer small: their sine is 5 % less."""


@dataclass(frozen=True, slots=True)
class Overrun:
    """A line that nothing kept at its deployed angle: that one, the largest and the last (rad), when it passed (s)."""

    deployed_angle: float
    passed_at: float
    largest: float
    last: float


@dataclass(frozen=True, slots=True)
class ShortOf:
    """A line without a latch that never came to an angle: that of its stop or the deployed one, largest, last (rad)."""

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


def _open_ended(result: Result) -> Iterator[tuple[str, float, Vector]]:
    """Lines that nothing keeps at their deployed angle, but those released later: name, that angle, angles (rad)."""
    for line in result.hinge_lines:
        if line.deployed_angle is None or not result.has(line.sensor, "angle"):
            continue
        if not is_released(result, line):
            yield line.name, line.deployed_angle, result.signal(line.sensor, "angle")


def overruns(result: Result) -> dict[str, Overrun]:
    """Lines, by name, that passed the deployed angle at which nothing keeps them, but for those released later."""
    found = {}
    for name, deployed, angle in _open_ended(result):
        passed = np.flatnonzero(angle > deployed + _GIVES_WAY)
        if passed.size:
            at = float(result.time[passed[0]])
            found[name] = Overrun(deployed, at, float(angle.max()), float(angle[-1]))
    return found


def short_of_deployed(result: Result) -> dict[str, ShortOf]:
    """Lines, by name, that nothing keeps at their deployed angle and that never came to it, likewise."""
    return {
        name: ShortOf(deployed, float(angle.max()), float(angle[-1]))
        for name, deployed, angle in _open_ended(result)
        if angle.max() < deployed - _GIVES_WAY
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


def pressed_stops(result: Result) -> dict[str, Peak]:
    """How far (rad) lines, by name, went beyond an end stop that gave way like none."""
    found = {}
    for line in result.hinge_lines:
        stop = line.sensor + OF_HINGE
        if result.has(stop, "penetration") and result.has(stop, "in_contact"):
            depth = result.signal(stop, "penetration") * result.signal(stop, "in_contact")
            deepest = int(np.argmax(depth[rows_joined(result, line)]))
            if depth[deepest] > _PRESSED:
                found[line.name] = Peak(float(result.time[deepest]), float(depth[deepest]))
    return found


def folded_back(result: Result) -> dict[str, Peak]:
    """How far (rad) lines with a latch or an end stop, by name, went behind their first angle, beyond play."""
    found = {}
    for line in result.hinge_lines:
        ends = line.latches or result.has(line.sensor + OF_HINGE, "stop_torque")
        if ends and result.has(line.sensor, "angle"):
            angle = result.signal(line.sensor, "angle")[rows_joined(result, line)]
            lowest = int(np.argmin(angle))
            behind = float(angle[0] - angle[lowest])
            if behind > _FOLDED_BACK:
                found[line.name] = Peak(float(result.time[lowest]), behind)
    return found


def beyond_tables(result: Result) -> dict[str, Peak]:
    """Angles (rad) furthest beyond what tables of their motors and harnesses tell, by line, where that is far."""
    found = {}
    for line in result.hinge_lines:
        if line.known and result.has(line.sensor, "angle"):
            low, high = line.known
            angle = result.signal(line.sensor, "angle")[rows_joined(result, line)]
            beyond = np.maximum(low - angle, angle - high)
            furthest = int(np.argmax(beyond))
            if beyond[furthest] > _UNKNOWN:
                found[line.name] = Peak(float(result.time[furthest]), float(angle[furthest]))
    return found


def bent(result: Result) -> dict[str, Peak]:
    """How far (rad) the axes of a line in both its bodies, by name, parted, where that is more than a hinge does.

    Beams carry no one direction, so their lines are left out.
    """
    found = {}
    for line in result.hinge_lines:
        is_beam = any(result.has(part, "node_position") for part in line.parts)
        if len(line.axis) == 3 and len(line.parts) == 2 and not is_beam:
            inboard, outboard = (_carried(result, part, np.array(line.axis)) for part in line.parts)
            apart = np.linalg.norm(inboard - outboard, axis=1)[rows_joined(result, line)]
            largest = int(np.argmax(apart))
            bend = 2.0 * float(np.arcsin(min(1.0, 0.5 * apart[largest])))
            if bend > _BENT:
                found[line.name] = Peak(float(result.time[largest]), bend)
    return found


def _carried(result: Result, part: str, direction: Vector) -> Vector:
    """A direction (3,) that a part carries with it from the start on, shape (N, 3); a fixed base keeps it."""
    if not result.has(part, "frame_orientation"):
        return np.broadcast_to(direction, (result.time.size, 3))
    turns = result.signal(part, "frame_orientation")
    return rotated(turns, rotated(turns[0] * (1.0, -1.0, -1.0, -1.0), direction))
