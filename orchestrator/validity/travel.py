"""Warnings of lines that did not open, passed their end, went behind their start, or turned about other axes."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, radians

import numpy as np

from components.contract.frames import rotated
from components.end_stop import OF_HINGE

from ..assembly import HingeLine
from ..messages import message
from ..results.key_figures import Headline, line_latch_torque
from ..results.line_travel import rows_joined
from ..results.parts import MESSAGES
from ..results.peaks import peak
from ..results.result import Result, Vector

_FOLDED_BACK = radians(5.0)
"""Behind its start angle a line has no room in a folded stack."""
_PRESSED = radians(30.0)
"""Deeper in an end stop, the stop stops nothing."""
_UNKNOWN = 0.2
"""rad beyond the tables of a motor or a harness, from which on their extrapolation matters."""
_BENT = radians(30.0)
"""Rotations across a line that are no longer small: their sine is 5 % less."""


def messages(result: Result, found: Headline) -> tuple[str, ...]:
    """Messages that a run has stored, or of its lines where it was interrupted, and on the accuracy of numbers."""
    of_run = result.stored_messages if MESSAGES in result.provenance else travel_warnings(result, found)
    return tuple(dict.fromkeys((*of_run, *found.messages)))


def travel_warnings(result: Result, found: Headline) -> Iterator[str]:
    """Of lines that have not opened or went too far, and of peaks that may lie beyond the end of the run."""
    for name, standing in found.not_opened.items():
        largest = degrees(standing.largest)
        went = "" if name in found.unlatched_angles else f" (largest angle {largest:.2f} deg)"
        yield message(
            "W-not-opened",
            f"{name} {standing.missing}{went}. At {found.end_time:g} s it {standing.state}.",
        )
    for name, passed in found.overruns.items():
        yield message(
            "W-no-end",
            f"{name} has no latch and passed its deployed angle of {degrees(passed.deployed_angle):g} deg at "
            f"{passed.passed_at:.4g} s: largest angle {degrees(passed.largest):.2f} deg, at {found.end_time:g} s "
            f"{degrees(passed.last):.2f} deg. Add a latch or an end_stop.",
        )
    for line in result.hinge_lines:
        yield from _of_stop(result, line)
        yield from _of_angle(result, line)
        yield from _bent(result, line)
        if line.name in found.latch_times:
            top = peak(result, line_latch_torque(result, line))
            if top.time == result.time[-1]:
                yield message(
                    "W-peak-at-end",
                    f"the latch torque of {line.name} is largest at the end of the run, {found.end_time:g} s. Run "
                    "longer to include its peak.",
                )


def _of_stop(result: Result, line: HingeLine) -> Iterator[str]:
    """Of an end stop that gave way like none."""
    stop = line.sensor + OF_HINGE
    if not (result.has(stop, "penetration") and result.has(stop, "in_contact")):
        return
    depth = (result.signal(stop, "penetration") * result.signal(stop, "in_contact"))[
        rows_joined(result, line)
    ]
    deepest = int(np.argmax(depth))
    if depth[deepest] > _PRESSED:
        yield message(
            "W-stop-pressed",
            f"{line.name} moved {degrees(depth[deepest]):.0f} deg beyond its end stop at {result.time[deepest]:.4g} s. "
            "Check the stiffness of end_stop.",
        )


def _of_angle(result: Result, line: HingeLine) -> Iterator[str]:
    """Of a line with an end that went behind its first angle, and of one that left the tables of its laws."""
    if not result.has(line.sensor, "angle"):
        return
    angle = result.signal(line.sensor, "angle")[rows_joined(result, line)]
    lowest = int(np.argmin(angle))
    behind = float(angle[0] - angle[lowest])
    if behind > _FOLDED_BACK and (line.latches or result.has(line.sensor + OF_HINGE, "stop_torque")):
        yield message(
            "W-folded-back",
            f"{line.name} folded back {degrees(behind):.1f} deg behind its start angle at {result.time[lowest]:.4g} s. "
            "Add a contact or a hold_down where bodies would touch.",
        )
    if not line.known:
        return
    low, high = line.known
    beyond = np.maximum(low - angle, angle - high)
    furthest = int(np.argmax(beyond))
    if beyond[furthest] > _UNKNOWN:
        yield message(
            "W-table-range",
            f"{line.name} reached {degrees(angle[furthest]):.4g} deg at {result.time[furthest]:.4g} s, beyond the "
            "tables of its motor or harness, whose last slopes are extrapolated. Extend the tables, or limit the "
            "travel of the line.",
        )


def _bent(result: Result, line: HingeLine) -> Iterator[str]:
    """Of a line whose axes in both its bodies parted further than in any hinge; beams carry no one direction."""
    is_beam = any(result.has(part, "node_position") for part in line.parts)
    if len(line.axis) != 3 or len(line.parts) != 2 or is_beam:
        return
    inboard, outboard = (_carried(result, part, np.array(line.axis)) for part in line.parts)
    apart = np.linalg.norm(inboard - outboard, axis=1)[rows_joined(result, line)]
    largest = int(np.argmax(apart))
    bend = 2.0 * float(np.arcsin(min(1.0, 0.5 * apart[largest])))
    if bend > _BENT:
        yield message(
            "W-bent",
            f"the hinges of {line.name} bent across their line by {degrees(bend):.0f} deg at "
            f"{result.time[largest]:.4g} s, beyond the small angles of their springs. Check cross_stiffness and "
            "rotational_stiffness, and whether a line with one hinge can carry its load.",
        )


def _carried(result: Result, part: str, direction: Vector) -> Vector:
    """A direction (3,) that a part carries with it from the start on, shape (N, 3); a fixed base keeps it."""
    if not result.has(part, "frame_orientation"):
        return np.broadcast_to(direction, (result.time.size, 3))
    turns = result.signal(part, "frame_orientation")
    return rotated(turns, rotated(turns[0] * (1.0, -1.0, -1.0, -1.0), direction))
