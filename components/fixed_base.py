"""Fixed base: the spacecraft as ground. A free spacecraft is a rigid `body` with the same ports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ContinuousStates, Port, Quantity, Vector, lagged
from .contract.frames import normalized, sum_of_moments
from .numerics.mid_step import StepMean, between, extrapolated

_STEP = 13  # load, slope and size of a step
_STOPPED = -1.0


def _step_mean(memory: Vector) -> StepMean[Vector]:
    return StepMean(memory[:6], memory[6:12], float(memory[12]))


class FixedBase(Component):
    """Ports that never move, whatever slopes their wrenches have, and the loads they carry.

    ports: one mapping per port with `name`, `position` (3, m, world axes) and optional `orientation`
    (quaternion). The interface load is the sum of all wrenches about `reference` (3, m).
    """

    kind = "fixed_base"
    constant_mobility = True

    def __init__(
        self, ports: Sequence[Mapping[str, Any]], reference: Sequence[float] = (0.0, 0.0, 0.0)
    ) -> None:
        self._positions = np.array([port["position"] for port in ports], dtype=float).reshape(-1, 3)
        self._arms = self._positions - np.asarray(reference, dtype=float)
        loads = (
            Quantity("interface_force", "N", "Force on the base, world axes", 3),
            Quantity("interface_torque", "N.m", "Torque on the base about the reference point", 3),
        )
        self._declare(
            {"ports": [dict(port) for port in ports], "reference": tuple(reference)},
            ports=[Port(port["name"], "body", 4) for port in ports],
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=[*loads, *map(lagged, loads)],
        )
        self._impulse = 6 * len(ports)
        self.continuous = ContinuousStates((), (), (), ())
        self._y = np.zeros((len(ports), 13))
        self._y[:, 0:3] = self._positions
        for pose, port in zip(self._y, ports, strict=True):
            turn = port.get("orientation", (1.0, 0.0, 0.0, 0.0))
            pose[3:7] = normalized((turn[0], turn[1], turn[2], turn[3]))

    def prepare(self, p: Vector) -> None:
        """Nothing to prepare."""

    def initial(self, c: None, u: Vector) -> Vector:
        """Mean load, slope, size of the last two steps; size 0 where there is none yet, _STOPPED after an impulse."""
        return np.zeros(2 * _STEP)

    def step(self, c: None, x: Vector, u: Vector, h: float) -> Vector:
        """Remember the mean load of the step; an impulse is no load that lasts, and starts the record anew."""
        if u[self._impulse] > 0.5:
            stopped = np.zeros(2 * _STEP)
            stopped[_STEP - 1] = _STOPPED
            return stopped
        slope = self._sum(u[self._impulse + 1 :])
        return np.concatenate((self._sum(u[: self._impulse]), slope, (h,), x[:_STEP]))

    def _sum(self, wrenches: Vector) -> Vector:
        """Sum of the wrenches of all ports about the reference, shape (6,)."""
        wrench = wrenches.reshape(-1, 6)
        force, torque = wrench[:, :3], wrench[:, 3:]
        return np.concatenate((force.sum(0), torque.sum(0) + sum_of_moments(self._arms, force)))

    def outputs(self, c: None, x: Vector, u: Vector) -> Vector:
        """Constant poses, first moments of no motion."""
        return np.concatenate((self._y.ravel(), np.zeros(self._impulse)))

    def observe(self, c: None, x: Vector, u: Vector) -> Vector:
        """Loads at the communication point, extrapolated from the last two steps, whose means belong to mid-step.

        Without a step before, as at the start and in model exchange, those of the present inputs. Then those one step
        earlier, zero without two steps.
        """
        last, previous = _step_mean(x[:_STEP]), _step_mean(x[_STEP:])
        now = self._sum(u[: self._impulse]) if last.h == 0.0 else extrapolated(last, previous)
        earlier = between(previous, last) if min(last.h, previous.h) > 0.0 else np.zeros(6)
        return np.concatenate((now, earlier))

    def rates(self, c: None, x: Vector, u: Vector) -> Vector:
        """There are no continuous states."""
        return np.zeros(0)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/fixed_base.c` reads."""
        return {"positions": self._positions, "arms": self._arms, "orientations": self._y[:, 3:7]}

    @classmethod
    def example(cls) -> FixedBase:
        """Two ports, one of them turned."""
        pulley = {"name": "pulley", "position": (0.0, 0.6, 0.0), "orientation": (0.6, 0.0, 0.8, 0.0)}
        return cls([{"name": "hinge", "position": (0.0, 0.0, 0.0)}, pulley])
