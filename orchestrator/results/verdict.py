"""Verdict of a deployment: lines that did not open, with the reason, and a few summary sentences."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import degrees

import numpy as np

from ..assembly import HingeLine
from .result import Result
from .unlatching import Unlatching

_LATE = 0.9
"""Part of a run after which a line that moves no more is stuck."""
_STILL, _ROUND_OFF = 1e-2, 1e-7
"""Rotation over the rest of the run up to which a line stands still: over all that it moved, and rad."""
_GIVES = 1e-4
"""rad, that a line gives way by while its friction exceeds what drives it."""
_MOST_LINES = 3
"""Lines described one by one."""


@dataclass(frozen=True, slots=True)
class NotOpened:
    """A line that should have latched, or come to its stop or deployed angle, and has not.

    missing: what it has not done. angle, largest: at the end and the largest, rad. rate: at the end, rad/s. is_stuck:
    it stands still. coupled: lines that cable loops or gears couple to it. driving: torque of motor and harness at the
    end, N.m, positive opening. friction: torque up to which friction holds, N.m. Both are sums over it and the lines
    coupled to it, at its rate.
    """

    missing: str
    angle: float
    largest: float
    rate: float
    is_stuck: bool
    coupled: tuple[str, ...]
    driving: float
    friction: float

    @property
    def state(self) -> str:
        """Where the line stands, and what holds it."""
        where = f"{round(degrees(self.angle), 2) + 0.0:.2f} deg"  # no negative zero
        if not self.is_stuck:
            return f"stands at {where} and turns at {degrees(self.rate):.3g} deg/s"
        order = "below" if self.driving < self.friction else "above"
        motor, friction = _apart(self.driving, self.friction)
        coupled = f" (coupled to {', '.join(self.coupled)})" if self.coupled else ""
        motors = "motors" if self.coupled else "motor"
        held = f"is stuck at {where}{coupled}: {motors} {motor} N.m {order} friction {friction} N.m"
        return held if order == "below" else f"{held}, so something else holds it"


def not_opened(result: Result, missing: Mapping[str, str]) -> dict[str, NotOpened]:
    """How lines stand at the end of a result, by name; missing: what each of them has not done."""
    return {
        line.name: _standing(result, line, missing[line.name])
        for line in result.hinge_lines
        if line.name in missing
    }


def _standing(result: Result, line: HingeLine, missing: str) -> NotOpened:
    angle = result.signal(line.sensor, "angle")
    rates = dict(line.coupled) or {line.name: 1.0}
    together = [(one, rates[one.name]) for one in result.hinge_lines if one.name in rates]
    driving = sum(rate * _driving(result, one) for one, rate in together)
    friction = sum(abs(rate) * _at_end(result, one.hinges, "friction_limit") for one, rate in together)
    since = _LATE * result.time[-1]
    late = [np.interp(since, result.time, angle), *angle[result.time > since]]
    still = max(_GIVES if driving < friction else _ROUND_OFF, _STILL * float(np.ptp(angle)))
    return NotOpened(
        missing=missing,
        angle=float(angle[-1]),
        largest=float(angle.max()),
        rate=_at_end(result, (line.sensor,), "angular_rate"),
        is_stuck=result.time.size > 1 and float(np.ptp(late)) <= still,
        coupled=tuple(name for name in rates if name != line.name),
        driving=driving,
        friction=friction,
    )


def _driving(result: Result, line: HingeLine) -> float:
    """Torque of motor and harness at the end."""
    return sum(_at_end(result, line.hinges, variable) for variable in ("motor_torque", "harness_torque"))


def _at_end(result: Result, hinges: Iterable[str], variable: str) -> float:
    """Sum over hinges at the end."""
    return float(sum(result.signal(name, variable)[-1] for name in hinges if result.has(name, variable)))


def _apart(one: float, other: float) -> tuple[str, str]:
    """Both numbers with the fewest digits that differ."""
    texts = ((f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(3, 16))
    return next((pair for pair in texts if pair[0] != pair[1]), (f"{one:g}", f"{other:g}"))


def lines_sentence(
    latch_times: Mapping[str, float],
    stop_times: Mapping[str, float],
    standing: Mapping[str, NotOpened],
    complete: bool,
    end_time: float,
) -> str:
    """Which lines did not open and why, and which latched or came to their stops."""
    sentences = [] if complete else [f"The run was interrupted at {end_time:.4g} s."]
    named = [f"{line} {one.missing}: it {one.state}." for line, one in list(standing.items())[:_MOST_LINES]]
    sentences += named
    if len(standing) > len(named):
        sentences.append(f"Not opened either: {', '.join(list(standing)[len(named) :])}.")
    of_all = not standing and complete
    sentences += _reached(latch_times, "latched", of_all and not stop_times)
    sentences += _reached(stop_times, "came to their end stops", of_all and not latch_times)
    return " ".join(sentences) or f"The run reached its end at {end_time:.4g} s."


def unlatched_sentences(found: Mapping[str, Unlatching]) -> list[str]:
    """What became of lines whose latches let go."""
    sentences = []
    for line, one in list(found.items())[:_MOST_LINES]:
        then = (
            f"stands at {round(degrees(one.angle), 2) + 0.0:.2f} deg at the end"
            if one.again is None
            else f"latched again at {one.again:.4g} s"
        )
        sentences.append(f"{line} unlatched at {one.time:.4g} s and {then}.")
    if rest := list(found)[_MOST_LINES:]:
        sentences.append(f"Unlatched as well: {', '.join(rest)}.")
    return sentences


def _reached(times: Mapping[str, float], did: str, are_all: bool) -> list[str]:
    """A sentence on lines that did something, by the times (s) of each; none where there is no such line."""
    if not times:
        return []
    last = max(times, key=lambda line: times[line])
    when = f"at {times[last]:.4g} s"
    if len(times) == 1:
        return [f"{last} {did.replace('their end stops', 'its end stop')} {when}."]
    count = f"{len(times)}" if not are_all else "Both" if len(times) == 2 else f"All {len(times)}"
    return [f"{count} lines {did}, the last ({last}) {when}."]
