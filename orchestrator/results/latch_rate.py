"""Rates at which hinge lines meet their latches, and the kinetic energy that a latch takes up."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from components import KINETIC_ENERGY

from .result import Result
from .signal import EVENT_WIDTH

_BEYOND = 1.01
"""Times the kinetic energy of all bodies, beyond which a line vibrates; below, both are the same up to rounding."""


def latch_rates(result: Result, times: Mapping[str, float]) -> dict[str, float]:
    """Sizes of the rates (rad/s) of lines just before they latch, at these times (s), of the hinge that senses it."""
    return {
        line.name: abs(
            float(result.signal(line.sensor, "angular_rate")[row_before(result, times[line.name])])
        )
        for line in result.hinge_lines
        if line.name in times and result.has(line.sensor, "angular_rate")
    }


def latch_energies(
    result: Result, times: Mapping[str, float], rates: Mapping[str, float], impulses: Mapping[str, float]
) -> dict[str, float]:
    """Kinetic energies (J) that latches take up, by latch times (s) and rates (rad/s) just before.

    Of a lock between rigid bodies: half of its impulse (N.m.s) times the rate, which it removes. Of other latches:
    J rate^2 / 2 with the effective inertia J (kg.m2) that damps the latch. It counts lines further out as latched and
    lines nearer the base as free. The energy is no more than all bodies have, as a line may vibrate.
    Lines of results without a record of J are left out.
    """
    found = {}
    for line in result.hinge_lines:
        if line.name not in rates:
            continue
        rate = rates[line.name]
        if line.name in impulses:
            found[line.name] = 0.5 * impulses[line.name] * rate
        elif line.inertia is not None:
            most = _kinetic_energy(result, row_before(result, times[line.name]))
            whole = 0.5 * line.inertia * rate**2
            found[line.name] = most if whole > _BEYOND * most else whole
    return found


def _kinetic_energy(result: Result, row: int) -> float:
    """Of all bodies in a row (J)."""
    bodies = result.recording(KINETIC_ENERGY.name)
    return sum(float(result.signal(name, KINETIC_ENERGY.name)[row]) for name in bodies)


def row_before(result: Result, latched: float) -> int:
    """The row just before a latch-up (s): the first one of its instant."""
    return min(int(np.searchsorted(result.time, latched - EVENT_WIDTH)), result.time.size - 1)
