"""Ports of a body: where they stand, how the modes move and turn them, and what loads on them do to the modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..contract.component import ComponentError, Vector
from ..contract.frames import Quaternion, left_product, multiply, normalized, skew
from ..flexible.modal import ModalData
from .load import Load


class BodyPorts:
    """K ports of a body with M modes, in its construction axes.

    arms: (K, 3), m, from the centre of mass. translation, rotation: (K, 3, M), displacement (m) and rotation
    vector (rad) per unit of a modal coordinate. orientation: (K, 4), of the undeformed port.
    """

    def __init__(self, data: ModalData, ports: Sequence[Mapping[str, Any]]) -> None:
        count, self._modes = len(ports), data.frequency.size
        self.arms = np.zeros((count, 3))
        self.translation = np.zeros((count, 3, self._modes))
        self.rotation = np.zeros((count, 3, self._modes))
        self.orientation = np.tile(np.array([1.0, 0.0, 0.0, 0.0]), (count, 1))
        for k, port in enumerate(ports):
            self._place(k, data, port)
        self._turned = bool(np.any(self.orientation[:, 1:] != 0.0))
        self._phi = self.translation.reshape(3 * count, self._modes)
        self._psi = self.rotation.reshape(3 * count, self._modes)

    def _place(self, k: int, data: ModalData, port: Mapping[str, Any]) -> None:
        if port["point"] not in data.point_names:
            known = ", ".join(data.point_names)
            raise ComponentError(
                f"port {port['name']}: there is no point {port['point']!r}; points are {known}"
            )
        i = data.point_names.index(port["point"])
        offset = np.asarray(port.get("offset", (0.0, 0.0, 0.0)), dtype=float)
        self.arms[k] = data.point_positions[i] - data.center_of_mass + offset
        self.translation[k] = data.translation[i] - skew(offset) @ data.rotation[i]
        self.rotation[k] = data.rotation[i]
        turn = port.get("orientation", (1.0, 0.0, 0.0, 0.0))
        self.orientation[k] = normalized((turn[0], turn[1], turn[2], turn[3]))

    def displacements(self, eta: Vector) -> Vector:
        """Displacements (K, 3) of modal coordinates, or velocities of their rates, body axes."""
        return (self._phi @ eta).reshape(-1, 3)

    def turns(self, eta: Vector) -> Vector:
        """Rotation vectors (K, 3) of modal coordinates, or their rates, body axes."""
        return (self._psi @ eta).reshape(-1, 3)

    def twists(self, eta: Vector, rate: Vector) -> Vector:
        """Angular velocities (K, 3) of modal coordinates eta and their rates, body axes: Jl(Psi eta) Psi rate."""
        twist, turn = self.turns(rate), skew(self.turns(eta))
        once = (turn @ twist[:, :, None])[:, :, 0]
        result: Vector = twist + 0.5 * once + (turn @ once[:, :, None])[:, :, 0] / 6.0
        return result

    def modal_forces(
        self, a_start: Vector, a_mid: Vector, a_end: Vector, eta: Vector, load: Load
    ) -> tuple[Vector, Vector]:
        """Means and slopes (M,) of the generalised forces of a load over a step, eta and rotations as it makes them.

        A changing wrench on a shape that turns on has a mean as well.
        """
        mean, turned = 0.5 * (a_start + a_end), (a_end - a_start) / 6.0
        force = self.modal_force(mean, a_mid, eta, load.force, load.torque)
        slope, changing = (
            self.modal_force(along, about, eta, load.force_slope, load.torque_slope)
            for along, about in ((mean, a_mid), (turned, turned))
        )
        return force + changing, slope

    def modal_force(
        self, a_force: Vector, a_torque: Vector, eta: Vector, force: Vector, torque: Vector
    ) -> Vector:
        """Generalised forces (M,) of world wrenches: Phi^T A^T f + Psi^T Jl(Psi eta)^T A^T tau."""
        body_torque = torque @ a_torque
        turn = skew(self.turns(eta))
        once = (turn @ body_torque[:, :, None])[:, :, 0]
        twice = (turn @ once[:, :, None])[:, :, 0]
        conjugate_torque = body_torque - 0.5 * once + twice / 6.0
        return (force @ a_force).ravel() @ self._phi + conjugate_torque.ravel() @ self._psi

    def quaternions(self, q: Quaternion, turns: Vector) -> Vector:
        """Q * exp(turn) * orientation for every port, shape (K, 4)."""
        if not self._modes:
            local = self.orientation
        else:
            angle = np.sqrt((turns * turns).sum(1))
            local = np.empty((len(turns), 4))
            local[:, 0] = np.cos(0.5 * angle)
            local[:, 1:] = turns * (0.5 * np.sinc(angle / (2.0 * np.pi)))[:, None]
            if self._turned:
                local = np.array(
                    [
                        multiply(tuple(a), tuple(b))
                        for a, b in zip(local.tolist(), self.orientation.tolist(), strict=True)
                    ]
                )
        quaternions: Vector = local @ left_product(q).T
        return quaternions
