"""What a rigid body tells besides where it is the spacecraft: attitude, rate, and the loads that its ports bring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import atan2
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..contract.component import Quantity, Vector
from ..contract.frames import normalized, rotation_matrix
from ..contract.ports import WRENCH_SIZE
from ..contract.record import kept, observed
from ..contract.roles import ATTITUDE, IMPULSE
from ..flexible.modal import ModalData
from ..numerics.port_loads import PortLoads
from .carried import Carried, products

_TURN, _MOTION = 4, 7


class Interface:
    """Declarations and functions of a base with ports, see `PortLoads`; arms (ports, 3) from its origin, body axes.

    Its state, behind all else of the body: quaternion and rate one step earlier, and the record of `PortLoads`.
    carried: bodies that are part of the whole, but count in the sum of the loads. shares: see `Carried`, (6, 12), or
    empty. outside: that of `PortLoads`.
    """

    noun: ClassVar[str] = "interface"

    def __init__(
        self, ports: Sequence[Mapping[str, Any]], arms: Vector, carried: Carried | None, whole: ModalData
    ) -> None:
        self._impulse = WRENCH_SIZE * len(ports)
        self.shares = np.zeros(0) if carried is None else carried.shares(whole)
        self._loads = PortLoads(ports, arms)
        self.outside = self._loads.outside
        before = replace(kept("1", "Quaternion of the body one step earlier"), name="orientation_before")
        self.inputs = [replace(IMPULSE, resized=True)]
        rate = replace(kept("rad/s", "Angular velocity one step earlier, body axes"), name="rate_before")
        earlier = [replace(before, size=_TURN, resized=True), replace(rate, size=3, resized=True)]
        self.states = [*earlier, *self._loads.states]
        self.observations = [*_motion(), *self._loads.observations]

    def without_own(self, u: Vector) -> Vector:
        """Wrenches and slopes of the ports alone, as any body takes them."""
        return np.concatenate((u[: self._impulse], u[self._impulse + 1 :]))

    def after(self, orientation: Vector, rate: Vector, state: Vector, u: Vector, h: float) -> Vector:
        """Its state after a step that began at an orientation (4,) with a rate (3,), which is given in body axes."""
        wrenches, slopes = u[: self._impulse], u[self._impulse + 1 :]
        record = self._loads.after(state[_MOTION:], wrenches, slopes, h, bool(u[self._impulse] > 0.5))
        return np.concatenate((orientation, rate, record))

    def observe(self, orientation: Vector, rate: Vector, state: Vector, u: Vector) -> Vector:
        """Attitude, rate (3,), which is given in body axes, and loads."""
        before, rate_before, record = state[:_TURN], state[_TURN:_MOTION], state[_MOTION:]
        axes = rotation_matrix(tuple(orientation.tolist()))
        earlier = rotation_matrix(normalized(tuple(before.tolist()))) if before.any() else axes
        loads = self._loads.observe(record, u[: self._impulse], axes, earlier)
        if self.shares.size:
            for whole, turning in zip(
                self._loads.known_sums(loads, record), (rate, rate_before), strict=False
            ):
                whole[:] = self.shares @ np.concatenate((whole, products(turning)))
        self._loads.leave_outside(loads)
        return np.concatenate((_attitude(orientation), rate, loads))


def interface_data(interface: Interface | None, ports: int) -> dict[str, ArrayLike]:
    """What `fmus/native/kernels/body` reads of it; of a body that is no base, that there is none."""
    if interface is None:
        return {"is_base": False, "carried": np.zeros(0), "base_outside": np.zeros(ports)}
    return {"is_base": True, "carried": interface.shares, "base_outside": interface.outside}


def _motion() -> list[Quantity]:
    attitude = observed("rad", "Rotation vector of the base, continuous over a full turn", ATTITUDE)
    rate = observed("rad/s", "Angular velocity of the base, its axes", ATTITUDE)
    found = (attitude.called("attitude", 3), rate.called("attitude_rate", 3))
    return [replace(quantity, resized=True) for quantity in found]


def _attitude(orientation: Vector) -> Vector:
    """Rotation vector (3,), rad, of a quaternion, which is itself continuous, so that only a full turn starts anew."""
    half = float(np.linalg.norm(orientation[1:]))
    factor = 2.0 if half < 1e-8 else 2.0 * atan2(half, float(orientation[0])) / half
    result: Vector = factor * orientation[1:]
    return result
