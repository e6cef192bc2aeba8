r"""Fixed base: the spacecraft as ground. A free spacecraft is a rigid `body` with the same ports.

$$ \mathbf F = \sum_k \mathbf F_k,\qquad \mathbf T = \sum_k \left(\mathbf T_k + (\mathbf r_k - \mathbf r_0)
\times \mathbf F_k\right) $$

are the interface loads of the wrenches $\mathbf F_k, \mathbf T_k$ at its ports, about the reference $\mathbf r_0$.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .body_parts.carried import Carried
from .contract.component import Component, ContinuousStates, Port, Vector
from .contract.frames import normalized
from .contract.ports import WRENCH_SIZE
from .contract.roles import IMPULSE
from .numerics.port_loads import PortLoads

_UPRIGHT = np.eye(3)


class FixedBase(Component):
    """Fixed spacecraft: ports that do not move, and the loads that they carry.

    ports: one mapping per port with `name`, `position` (3, m, world axes) and optional `orientation`
    (quaternion), `outside` where what acts there is no interface load. Interface loads are recorded in sum about
    `reference` (3, m) and by port, see `PortLoads`. carried: fields of `Carried`, of bodies joined to it, whose weight
    by gravity (3, m/s2) is part of the sum.
    """

    kind = "fixed_base"
    noun = "interface"
    ports_vary = True
    constant_mobility = True
    prescribed_motion = True
    starts_from_inputs = False

    def __init__(
        self,
        ports: Sequence[Mapping[str, Any]],
        reference: Sequence[float] = (0.0, 0.0, 0.0),
        carried: Mapping[str, Any] | None = None,
        gravity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        self._positions = np.array([port["position"] for port in ports], dtype=float).reshape(-1, 3)
        self._arms = self._positions - np.asarray(reference, dtype=float)
        self._loads = PortLoads(ports, self._arms)
        structure: dict[str, Any] = {"ports": [dict(port) for port in ports], "reference": tuple(reference)}
        self.carried: Carried | None = None
        self.weight = np.zeros(WRENCH_SIZE)
        if carried is not None:
            structure |= {"carried": dict(carried), "gravity": tuple(gravity)}
            self.carried = Carried.of(carried)
            self.weight = self.carried.weight(*np.array([gravity, reference], dtype=float))
        self._declare(
            structure,
            ports=[Port(port["name"], "body", 4) for port in ports],
            inputs=[IMPULSE],
            observations=self._loads.observations,
            states=self._loads.states,
        )
        self._impulse = self.input_layout[IMPULSE.name].start
        self.continuous = ContinuousStates((), (), (), ())
        turns = [port.get("orientation", (1.0, 0.0, 0.0, 0.0)) for port in ports]
        self._orientations = np.array([normalized((w, x, y, z)) for w, x, y, z in turns]).reshape(-1, 4)
        at_rest = np.zeros((len(ports), 6))
        poses = np.concatenate((self._positions, self._orientations, at_rest), axis=1)
        self._y = np.concatenate((poses.ravel(), np.zeros(WRENCH_SIZE * len(ports))))

    def reference(self) -> Vector:
        """Point (3, m, world) that loads are about."""
        return np.array(self.structure["reference"], dtype=float)

    def prepare(self, p: Vector) -> None:
        """Nothing to prepare."""

    def initial(self, c: None, u: Vector) -> Vector:
        """No step yet."""
        return np.zeros(self._loads.size)

    def step(self, c: None, x: Vector, u: Vector, h: float) -> Vector:
        """Remember the wrenches of the step."""
        wrenches, slopes = u[: self._impulse], u[self._impulse + 1 :]
        return self._loads.after(x, wrenches, slopes, h, bool(u[self._impulse] > 0.5))

    def outputs(self, c: None, x: Vector, u: Vector) -> Vector:
        """Constant poses, first moments of no motion."""
        return self._y.copy()

    def observe(self, c: None, x: Vector, u: Vector) -> Vector:
        """Loads now and one step earlier, see `PortLoads.observe`."""
        loads = self._loads.observe(x, u[: self._impulse], _UPRIGHT, _UPRIGHT)
        for whole in self._loads.known_sums(loads, x):
            whole += self.weight
        self._loads.leave_outside(loads)
        return loads

    def rates(self, c: None, x: Vector, u: Vector) -> Vector:
        """There are no continuous states."""
        return np.zeros(0)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/fixed_base.c` reads."""
        return {
            "base_positions": self._positions,
            "base_arms": self._arms,
            "base_orientations": self._orientations,
            "base_outside": self._loads.outside,
            "base_carried_weight": self.weight,
        }

    @classmethod
    def example(cls) -> FixedBase:
        """Three ports, one of them turned, and one for what acts from outside."""
        pulley = {"name": "pulley", "position": (0.0, 0.6, 0.0), "orientation": (0.6, 0.0, 0.8, 0.0)}
        drag = {"name": "drag", "position": (0.3, -0.2, 0.1), "outside": True}
        return cls([{"name": "hinge", "position": (0.0, 0.0, 0.0)}, pulley, drag])
