"""Fixed base: the spacecraft as ground. A free spacecraft is a rigid `body` with the same ports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ContinuousStates, Port, Vector
from .contract.frames import normalized, sum_of_moments
from .contract.ports import WRENCH_SIZE
from .contract.record import Record, kept, observed
from .contract.roles import IMPULSE, INTERFACE_LOAD, lagged
from .numerics.mid_step import StepMean, between, extrapolated

_STOPPED = -1.0


class _State(NamedTuple):
    """Mean loads (N, N.m) and their slopes over the last two steps; size 0: none, below 0: an impulse."""

    load: Annotated[tuple[float, ...], kept("N", "Mean load of the last step").sized(WRENCH_SIZE)]
    slope: Annotated[tuple[float, ...], kept("N", "Its slope").sized(WRENCH_SIZE)]
    h: Annotated[float, kept("s", "Size of the last step")]
    previous_load: Annotated[tuple[float, ...], kept("N", "The same of the step before").sized(WRENCH_SIZE)]
    previous_slope: Annotated[tuple[float, ...], kept("N", "Its slope").sized(WRENCH_SIZE)]
    previous_h: Annotated[float, kept("s", "Its size")]


_STATES = Record(_State)
_NONE = (0.0,) * WRENCH_SIZE
_LOADS = (
    observed("N", "Force on the base, world axes", INTERFACE_LOAD).called("interface_force", 3),
    observed("N.m", "Torque on the base about the reference point", INTERFACE_LOAD).called(
        "interface_torque", 3
    ),
)


class FixedBase(Component):
    """Ports that never move, whatever slopes their wrenches have, and the loads they carry.

    ports: one mapping per port with `name`, `position` (3, m, world axes) and optional `orientation`
    (quaternion). The interface load is the sum of all wrenches about `reference` (3, m).
    """

    kind = "fixed_base"
    noun = "interface"
    ports_vary = True
    constant_mobility = True
    scheme: ClassVar = {"STOPPED": _STOPPED}

    def __init__(
        self, ports: Sequence[Mapping[str, Any]], reference: Sequence[float] = (0.0, 0.0, 0.0)
    ) -> None:
        self._positions = np.array([port["position"] for port in ports], dtype=float).reshape(-1, 3)
        self._arms = self._positions - np.asarray(reference, dtype=float)
        self._declare(
            {"ports": [dict(port) for port in ports], "reference": tuple(reference)},
            ports=[Port(port["name"], "body", 4) for port in ports],
            inputs=[IMPULSE],
            observations=[*_LOADS, *map(lagged, _LOADS)],
            states=_STATES.quantities,
        )
        self._impulse = self.input_layout[IMPULSE.name].start
        self.continuous = ContinuousStates((), (), (), ())
        turns = [port.get("orientation", (1.0, 0.0, 0.0, 0.0)) for port in ports]
        self._orientations = np.array([normalized((w, x, y, z)) for w, x, y, z in turns]).reshape(-1, 4)
        at_rest = np.zeros((len(ports), 6))
        poses = np.concatenate((self._positions, self._orientations, at_rest), axis=1)
        self._y = np.concatenate((poses.ravel(), np.zeros(WRENCH_SIZE * len(ports))))

    def prepare(self, p: Vector) -> None:
        """Nothing to prepare."""

    def initial(self, c: None, u: Vector) -> Vector:
        """No step yet."""
        return np.zeros(_STATES.size)

    def step(self, c: None, x: Vector, u: Vector, h: float) -> Vector:
        """Remember the mean load of the step; an impulse is no load that lasts, and starts the record anew."""
        if u[self._impulse] > 0.5:
            return _STATES.write(_State(_NONE, _NONE, _STOPPED, _NONE, _NONE, 0.0))
        slope = self._sum(u[self._impulse + 1 :])
        last = x[: _STATES.size // 2]
        return np.concatenate((self._sum(u[: self._impulse]), slope, (h,), last))

    def _sum(self, wrenches: Vector) -> Vector:
        """Sum of the wrenches of all ports about the reference, shape (6,)."""
        wrench = wrenches.reshape(-1, WRENCH_SIZE)
        force, torque = wrench[:, :3], wrench[:, 3:]
        return np.concatenate((force.sum(0), torque.sum(0) + sum_of_moments(self._arms, force)))

    def outputs(self, c: None, x: Vector, u: Vector) -> Vector:
        """Constant poses, first moments of no motion."""
        return self._y.copy()

    def observe(self, c: None, x: Vector, u: Vector) -> Vector:
        """Loads at the communication point, extrapolated from the last two steps, whose means belong to mid-step.

        Without a step before, as at the start and in model exchange, those of the present inputs. Then those one step
        earlier, zero without two steps.
        """
        s = _STATES.read(x)
        last = StepMean(np.array(s.load), np.array(s.slope), s.h)
        previous = StepMean(np.array(s.previous_load), np.array(s.previous_slope), s.previous_h)
        now = self._sum(u[: self._impulse]) if s.h == 0.0 else extrapolated(last, previous)
        earlier = between(previous, last) if min(s.h, s.previous_h) > 0.0 else np.zeros(WRENCH_SIZE)
        return np.concatenate((now, earlier))

    def rates(self, c: None, x: Vector, u: Vector) -> Vector:
        """There are no continuous states."""
        return np.zeros(0)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/fixed_base.c` reads."""
        return {"positions": self._positions, "arms": self._arms, "orientations": self._orientations}

    @classmethod
    def example(cls) -> FixedBase:
        """Two ports, one of them turned."""
        pulley = {"name": "pulley", "position": (0.0, 0.6, 0.0), "orientation": (0.6, 0.0, 0.8, 0.0)}
        return cls([{"name": "hinge", "position": (0.0, 0.0, 0.0)}, pulley])
