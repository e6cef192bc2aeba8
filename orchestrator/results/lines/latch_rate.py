"""Rates at which hinge lines meet their latches, and the kinetic energy that a latch takes up."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..result import Result


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
    result: Result, rates: Mapping[str, float], impulses: Mapping[str, float]
) -> dict[str, float]:
    """Kinetic energies (J) of the relative motion at a line that its latch takes up, by rates (rad/s) just before.

    Of a lock between rigid bodies half of its impulse (N.m.s) times the rate, which is what it takes away. Of all other
    latches J rate^2 / 2, J the effective inertia of the line (kg.m2) by which its latch is damped: of the deployed wing
    with rigid bodies, lines further out latched, lines nearer the base free, without closed loops, or what the scene
    gives for it. It is defined for every line; of a flexible wing it is that of its rigid motion. Lines of results that
    have no record of J are left out.
    """
    found = {}
    for line in result.hinge_lines:
        if line.name not in rates:
            continue
        rate = rates[line.name]
        if line.name in impulses:
            found[line.name] = 0.5 * impulses[line.name] * rate
        elif line.inertia is not None:
            found[line.name] = 0.5 * line.inertia * rate**2
    return found


def row_before(result: Result, latched: float) -> int:
    """The row just before a latch-up (s): the first one of its instant."""
    return min(int(np.searchsorted(result.time, latched)), result.time.size - 1)
