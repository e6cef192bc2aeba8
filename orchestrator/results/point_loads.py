"""Loads at single points as vectors: at the ports of the spacecraft, and at hinges, also before and after events."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.roles import HINGE_LOAD, PORT_LOAD

from .estimated_errors import POINT_PEAKS, Key
from .result import Result
from .signal import EVENT_WIDTH

Vector = NDArray[np.float64]
_SPAN = 1.0
"""s, before and after an event; less where another event is nearer."""


def port_loads(result: Result, unit: str) -> dict[str, Vector]:
    """Force ("N") or torque ("N.m", about the port) on the spacecraft in its axes, (N, 3), by port."""
    return {
        variable.rpartition(".")[0]: result.signal(name, variable)
        for name, variable in result.in_role(PORT_LOAD)
        if result.unit(name, variable) == unit
    }


def hinge_loads(result: Result, unit: str) -> dict[str, Vector]:
    """The same on the outboard body of every hinge of a line, in the axes of its inboard port, (N, 3), by hinge.

    Hinges on the spacecraft are left out: their loads are those of its ports.
    """
    of_lines = {hinge for line in result.hinge_lines for hinge in line.hinges}
    inner = of_lines - set(port_loads(result, unit))
    return {
        name: result.signal(name, variable)
        for name, variable in result.in_role(HINGE_LOAD)
        if name in inner and result.unit(name, variable) == unit
    }


def point_loads(result: Result) -> Iterator[tuple[Key, Vector]]:
    """Magnitudes (N,) of force (N) and torque (N.m) at every such port and hinge, by headline number."""
    of = (port_loads, port_loads, hinge_loads, hinge_loads)
    for quantity, loads, unit in zip(POINT_PEAKS, of, ("N", "N.m", "N", "N.m"), strict=True):
        yield from (((quantity, name), np.linalg.norm(v, axis=1)) for name, v in loads(result, unit).items())


class EventLoad(NamedTuple):
    """Largest magnitudes of a load of a joint, N or N.m, before and after the events of an instant (s)."""

    time: float
    joint: str
    unit: str
    before: float
    after: float

    @property
    def ratio(self) -> float | None:
        """After over before; None where there was nothing."""
        return self.after / self.before if self.before > 0.0 else None


def event_loads(result: Result) -> Iterator[EventLoad]:
    """By instant, joint and unit, in this order; loads that are zero on both sides are left out."""
    events = sorted(time for time, _, _ in result.events)
    instants = [next(near) for _, near in groupby(events, key=lambda time: round(time / EVENT_WIDTH))]
    time = np.asarray(result.time)
    for number, instant in enumerate(instants):
        first = max([instant - _SPAN, *instants[max(number - 1, 0) : number]])
        last = min([instant + _SPAN, *instants[number + 1 : number + 2]])
        before = (time > first + EVENT_WIDTH) & (time < instant - EVENT_WIDTH)
        after = (time > instant + EVENT_WIDTH) & (time < last - EVENT_WIDTH)
        for joint, variable in result.in_role(HINGE_LOAD):
            sizes = np.linalg.norm(result.signal(joint, variable), axis=-1)
            loads = (float(sizes[rows].max(initial=0.0)) for rows in (before, after))
            found = EventLoad(instant, joint, result.unit(joint, variable), *loads)
            if found.before or found.after:
                yield found
