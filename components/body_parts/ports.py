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
    vector (rad) per unit of a modal coordinate. orientation: (K, 4), of the undeformed port. second_order:
    (K, 6, S, S), of displacement and rotation vector, by pairs of the S lowest modes: Phi eta + 1/2 eta^T Psi eta.
    The shapes at eta are then Phi + Psi eta, and those at the mean of two eta times their difference is exactly the
    difference of displacements, which keeps the work of forces that of the motion.
    """

    def __init__(self, data: ModalData, ports: Sequence[Mapping[str, Any]]) -> None:
        count, self._modes = len(ports), data.frequency.size
        self.arms = np.zeros((count, 3))
        self.translation = np.zeros((count, 3, self._modes))
        self.rotation = np.zeros((count, 3, self._modes))
        self._pairs = s = data.second_order_modes
        self.second_order = np.zeros((count, 6, s, s))
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
        if self._pairs:
            self.second_order[k] = data.second_order_points[i]
            self.second_order[k, :3] += _of_offset(
                offset, self.rotation[k][:, : self._pairs], self.second_order[k, 3:]
            )
        turn = port.get("orientation", (1.0, 0.0, 0.0, 0.0))
        self.orientation[k] = normalized((turn[0], turn[1], turn[2], turn[3]))

    def displacements(self, eta: Vector) -> Vector:
        """Displacements (K, 3) of modal coordinates, body axes."""
        return self.velocities(0.5 * eta, eta)

    def velocities(self, eta: Vector, rate: Vector) -> Vector:
        """Velocities (K, 3) of modal coordinates eta and their rates, body axes."""
        found: Vector = (self._phi @ rate).reshape(-1, 3)
        return found + self._pairs_at(eta)[:, :3] @ rate[: self._pairs] if self._pairs else found

    def turns(self, eta: Vector) -> Vector:
        """Rotation vectors (K, 3) of modal coordinates, body axes."""
        return self._turning(0.5 * eta, eta)

    def _turning(self, eta: Vector, rate: Vector) -> Vector:
        """Rates (K, 3) of the rotation vectors, body axes."""
        found: Vector = (self._psi @ rate).reshape(-1, 3)
        return found + self._pairs_at(eta)[:, 3:] @ rate[: self._pairs] if self._pairs else found

    def _pairs_at(self, eta: Vector) -> Vector:
        """What eta adds to the shapes of the S lowest modes (K, 6, S)."""
        found: Vector = self.second_order @ eta[: self._pairs]
        return found

    def twists(self, eta: Vector, rate: Vector) -> Vector:
        """Angular velocities (K, 3) of modal coordinates eta and their rates, body axes: Jl(turn) times its rate."""
        twist, turn = self._turning(eta, rate), skew(self.turns(eta))
        once = (turn @ twist[:, :, None])[:, :, 0]
        result: Vector = twist + 0.5 * once + (turn @ once[:, :, None])[:, :, 0] / 6.0
        return result

    def wrenches(
        self, a_start: Vector, a_mid: Vector, a_end: Vector, eta: Vector, load: Load
    ) -> tuple[Vector, Vector]:
        """Means and slopes (K, 6) over a step of what does work on the modes, eta and rotations as it makes them.

        A changing wrench on a shape that turns on has a mean as well.
        """
        mean, turned = 0.5 * (a_start + a_end), (a_end - a_start) / 6.0
        wrench = self.conjugate(mean, a_mid, eta, load.force, load.torque)
        slope, changing = (
            self.conjugate(along, about, eta, load.force_slope, load.torque_slope)
            for along, about in ((mean, a_mid), (turned, turned))
        )
        return wrench + changing, slope

    def conjugate(
        self, a_force: Vector, a_torque: Vector, eta: Vector, force: Vector, torque: Vector
    ) -> Vector:
        """World wrenches as they do work on displacements and turns, (K, 6): A^T f and Jl(turn)^T A^T tau."""
        body_torque = torque @ a_torque
        turn = skew(self.turns(eta))
        once = (turn @ body_torque[:, :, None])[:, :, 0]
        twice = (turn @ once[:, :, None])[:, :, 0]
        return np.hstack((force @ a_force, body_torque - 0.5 * once + twice / 6.0))

    def modal_force(self, wrench: Vector, eta: Vector) -> Vector:
        """Generalised forces (M,) of conjugate wrenches (K, 6) on the shapes at eta."""
        found: Vector = wrench[:, :3].ravel() @ self._phi + wrench[:, 3:].ravel() @ self._psi
        if self._pairs:
            found[: self._pairs] += wrench.ravel() @ self._pairs_at(eta).reshape(wrench.size, -1)
        return found

    def tension(self, wrench: Vector) -> Vector:
        """By what modal coordinates change these forces, (S, S): pulled ends stiffen what bends, others soften it."""
        return np.tensordot(wrench, self.second_order, axes=2)

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


def _of_offset(offset: Vector, rotation: Vector, second: Vector) -> Vector:
    """What a rigid arm (3,) adds to the displacement by pairs of modes, (3, S, S); rotation (3, S), second (3, S, S).

    A rotation vector t turns the arm r to r + t x r + t x (t x r) / 2, up to the third order.
    """
    along = np.einsum("ij,k->ijk", rotation, offset @ rotation)
    both = 0.5 * (along + along.transpose(0, 2, 1)) - np.multiply.outer(offset, rotation.T @ rotation)
    result: Vector = np.cross(second, offset, axisa=0, axisc=0) + both
    return result
