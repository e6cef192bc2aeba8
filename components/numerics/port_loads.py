"""Loads that the ports of a base carry, each and in sum, from what the ports had over the last two steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..contract.component import Quantity, Vector
from ..contract.frames import sum_of_moments
from ..contract.ports import WRENCH_SIZE
from ..contract.record import kept, observed
from ..contract.roles import INTERFACE_LOAD, LOAD, PORT_LOAD, lagged
from .interval_mean import StepMean, between, extrapolated
from .scheme import STOPPED

_SIZES = 2


class PortLoads:
    """The record of a base, a part of its state: sizes of two steps, means and slopes of all wrenches over each.

    The load on a base is what its ports bring: its own inertia and weight are no part of it, which of what it carries
    rigidly its component adds. Forces and torques are in the axes of the base; torques of a port are about its origin,
    the sum's about the point that the arms, (ports, 3) in the axes of the base, start from. What moves by a law and is
    not the spacecraft (`is_base`) tells reactions. ports: mappings with `name`, and `outside` where something from
    outside acts on the base itself, such as a thruster, which is no part of the sum; `outside` (ports,) is 1 for these.
    """

    def __init__(self, ports: Sequence[Mapping[str, Any]], arms: Vector, is_base: bool = True) -> None:
        self._arms = arms
        self.outside = np.array([float(port.get("outside", False)) for port in ports])
        self._from_outside = np.flatnonzero(self.outside).tolist()
        self._numbers = WRENCH_SIZE * len(ports)
        self.size = _SIZES + 4 * self._numbers
        word, whole, part = ("interface", INTERFACE_LOAD, PORT_LOAD) if is_base else ("reaction", LOAD, "")
        told = [*_load(word, whole, "on the base, its axes", "its reference point")]
        for port in ports:
            where = f"on the base at port {port['name']}, axes of the base"
            told += _load(f"{port['name']}.{word}", part, where, "the port")
        self.observations = [*told, *map(lagged, told)]
        sizes = kept("s", "Sizes of the last two steps; 0: none, below 0: an impulse")
        loads = kept("N", "Means and slopes of the ports' wrenches over the last step and the one before")
        self.states = [
            replace(quantity, name=name, size=size, resized=True)
            for name, quantity, size in (
                ("step_sizes", sizes, _SIZES),
                ("port_loads", loads, 4 * self._numbers),
            )
        ]

    def after(self, record: Vector, wrenches: Vector, slopes: Vector, h: float, impulse: bool) -> Vector:
        """The record after a step; an impulse is no load that lasts: it starts anew from what was there before."""
        if impulse:
            (h, h_before), parts = record[:_SIZES].tolist(), record[_SIZES:].reshape(4, self._numbers)
            now = extrapolated(StepMean(parts[0], parts[1], h), StepMean(parts[2], parts[3], h_before))
            return np.concatenate(((STOPPED, 0.0), now, np.zeros(3 * self._numbers)))
        last = record[_SIZES : _SIZES + 2 * self._numbers]
        return np.concatenate(((h, record[0]), wrenches, slopes, last))

    def observe(self, record: Vector, wrenches: Vector, axes: Vector, axes_before: Vector) -> Vector:
        """Loads at the communication point, extrapolated from the last two steps, whose means belong to mid-step.

        Without a step before, as at the start and in model exchange, those of the present inputs. Then those one step
        earlier, zero without two steps. axes: (3, 3) of the base, now and one step earlier, into the world.
        """
        h, h_before = record[:_SIZES].tolist()
        parts = record[_SIZES:].reshape(4, self._numbers)
        mean, slope, mean_before, slope_before = (self._loads(part, axes) for part in parts)
        if h == 0.0:
            now = self._loads(wrenches, axes)
        else:
            now = extrapolated(StepMean(mean, slope, h), StepMean(mean_before, slope_before, h_before))
        earlier = np.zeros_like(now)
        if self._tells_earlier(record):
            mean, slope, mean_before, slope_before = (self._loads(part, axes_before) for part in parts)
            earlier = between(StepMean(mean_before, slope_before, h_before), StepMean(mean, slope, h))
        return np.concatenate((now, earlier))

    def known_sums(self, loads: Vector, record: Vector) -> list[Vector]:
        """Parts (6,) of what `observe` gives: the sum now and, where there are two steps, that one step earlier."""
        now, earlier = loads.reshape(2, -1)[:, :WRENCH_SIZE]
        return [now, earlier] if self._tells_earlier(record) else [now]

    def leave_outside(self, loads: Vector) -> None:
        """Take off both sums that `observe` gives what acts on the base from outside."""
        for told in loads.reshape(2, -1):
            for k in self._from_outside:
                force, torque = told[WRENCH_SIZE * (k + 1) : WRENCH_SIZE * (k + 2)].reshape(2, 3)
                told[:3] -= force
                told[3:WRENCH_SIZE] -= torque + np.cross(self._arms[k], force)

    def _tells_earlier(self, record: Vector) -> bool:
        return bool(record[:_SIZES].min() > 0.0)

    def sums(self, wrenches: Vector, axes: Vector) -> Vector:
        """Force and torque (6,) of all ports, those from outside too, of wrenches in world axes."""
        found: Vector = self._loads(wrenches, axes)[:WRENCH_SIZE]
        return found

    def _loads(self, wrenches: Vector, axes: Vector) -> Vector:
        """Sum about the reference point, then every port's own: wrenches in world axes, told in those of the base."""
        table = (wrenches.reshape(-1, 3) @ axes).reshape(-1, WRENCH_SIZE)
        force, torque = table[:, :3], table[:, 3:]
        moment = torque.sum(0) + sum_of_moments(self._arms, force)
        return np.concatenate((force.sum(0), moment, table.ravel()))


def _load(name: str, role: str, where: str, about: str) -> list[Quantity]:
    """Force and torque of one port or of all."""
    found = (
        observed("N", f"Force {where}", role).called(f"{name}_force", 3),
        observed("N.m", f"Torque {where}, about {about}", role).called(f"{name}_torque", 3),
    )
    return [replace(quantity, resized=True) for quantity in found]
