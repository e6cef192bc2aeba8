"""What became of a deployment: which lines did not open and what holds them, and the verdict in a few sentences."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import degrees

import numpy as np

from ..assembly import HingeLine
from .result import Result

_LATE = 0.9
"""Part of a run after which a line that moves no more is stuck."""
_STILL = 1e-4
"""Rotation (rad) over the rest of the run up to which a line stands still."""
_MOST_LINES = 3
"""Lines described one by one."""


@dataclass(frozen=True, slots=True)
class NotOpened:
    """A line that should have latched, or come to its stop or deployed angle, and has not.

    angle: at the end, rad. rate: at the end, rad/s. is_stuck: it stands still. driving: torque of motor and harness at
    the end, N.m, positive opening. friction: torque up to which its own friction holds it, N.m.
    """

    angle: float
    rate: float
    is_stuck: bool
    driving: float
    friction: float

    @property
    def state(self) -> str:
        """Where the line stands, and what holds it."""
        where = f"{degrees(self.angle):.4g} deg"
        if not self.is_stuck:
            return f"at {where} it still turns at {degrees(self.rate):.3g} deg/s"
        if self.friction <= 0.0:
            return f"stuck at {where}: no friction of its own holds it, but what it is coupled to"
        if self.driving < self.friction:
            motor, friction = _apart(self.driving, self.friction)
            return f"stuck at {where}: motor {motor} N.m below friction {friction} N.m"
        motor, friction = _apart(self.driving, self.friction)
        return f"stuck at {where}: held by what it is coupled to, motor {motor} N.m above friction {friction} N.m"


def not_opened(result: Result, names: Collection[str]) -> dict[str, NotOpened]:
    """The lines of these names, as they stand at the end of a result."""
    return {line.name: _standing(result, line) for line in result.hinge_lines if line.name in names}


def _standing(result: Result, line: HingeLine) -> NotOpened:
    angle = result.signal(line.sensor, "angle")
    late = angle[result.time >= _LATE * result.time[-1]]
    rate = result.signal(line.sensor, "angular_rate") if result.has(line.sensor, "angular_rate") else np.zeros(1)
    return NotOpened(
        angle=float(angle[-1]),
        rate=float(rate[-1]),
        is_stuck=late.size > 1 and float(np.ptp(late)) <= _STILL,
        driving=_at_end(result, line, "motor_torque") + _at_end(result, line, "harness_torque"),
        friction=_at_end(result, line, "friction_limit"),
    )


def _at_end(result: Result, line: HingeLine, variable: str) -> float:
    """Sum over the hinges of a line at the end."""
    return float(
        sum(result.signal(hinge, variable)[-1] for hinge in line.hinges if result.has(hinge, variable))
    )


def _apart(one: float, other: float) -> tuple[str, str]:
    """Both numbers with as few digits as tell them apart."""
    texts = ((f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(3, 16))
    return next((pair for pair in texts if pair[0] != pair[1]), (f"{one:g}", f"{other:g}"))


def lines_sentence(
    latch_times: Mapping[str, float], standing: Mapping[str, NotOpened], complete: bool, end_time: float
) -> str:
    """Which lines latched, and which did not open and why."""
    sentences = [] if complete else [f"The run was interrupted at {end_time:.4g} s."]
    named = [f"{line} has not opened: {one.state}." for line, one in list(standing.items())[:_MOST_LINES]]
    sentences += named
    if len(standing) > len(named):
        others = ", ".join(list(standing)[len(named) :])
        sentences.append(f"Nor have {others}.")
    if latch_times:
        last = max(latch_times, key=lambda line: latch_times[line])
        when = f"at {latch_times[last]:.4g} s"
        if len(latch_times) == 1:
            sentences.append(f"{last} latched {when}.")
        elif standing:
            sentences.append(f"{len(latch_times)} lines latched, the last ({last}) {when}.")
        else:
            sentences.append(f"All {len(latch_times)} lines latched, the last ({last}) {when}.")
    if not sentences:
        sentences.append(f"The run reached its end at {end_time:.4g} s.")
    return " ".join(sentences)
