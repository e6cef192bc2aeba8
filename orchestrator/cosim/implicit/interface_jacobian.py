"""The interface Jacobian of a coupled step: how motions follow from wrenches, and wrenches from motions.

A body's mobility is d(motion at the end of the step) / d(wrench); a connection's stiffness is
d(wrench) / d(motion at the end of the step), wrenches and motions counted per port as `ports.Width` says. What a
participant of order 2 does not have in a network of order 4 are zeros. Both are nearly constant in axes that turn
with the first port, for a given step size: a matrix is turned along until the iteration stops contracting.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from components import rotation_matrix

from ..network import Network
from ..participant import Matrix, Participant, Vector
from ..ports import PortPlaces, Width
from .differences import jacobian_by_differences


@dataclass(frozen=True, slots=True)
class JacobianBlock:
    """One participant's matrix, the orientation (3, 3) of its first port at that instant, and its array of motions."""

    matrix: Matrix
    axes: Matrix
    motion: Vector

    def turned(self) -> Matrix:
        """The matrix in the axes that its first port has now; all its vectors are 3-vectors."""
        turn = first_port_axes(self.motion) @ self.axes.T
        rows, columns = self.matrix.shape
        rows_turned = turn @ self.matrix.reshape(rows // 3, 3, columns)
        result: Matrix = (rows_turned.reshape(rows, columns // 3, 3) @ turn.T).reshape(rows, columns)
        return result


def first_port_axes(motion: Vector) -> Matrix:
    """Rotation matrix of the first port of a flat array of port motions."""
    w, x, y, z = motion[3:7].tolist()
    axes: Matrix = rotation_matrix((w, x, y, z))
    return axes


def jacobian_block(
    participant: Participant, places: PortPlaces, width: Width, time: float, h: float
) -> JacobianBlock:
    """About the step from the saved state that a participant has just made: its own, or by differences."""
    motion = participant.outputs if places.side == "body" else participant.inputs
    axes = first_port_axes(motion)
    matrix = participant.interface_jacobian(places, width)
    if matrix is None:
        matrix = jacobian_by_differences(participant, places, width, time, h)
    return JacobianBlock(matrix, axes, motion)


class Matrices:
    """Blocks of all bodies or of all connections.

    addresses (participants, 2): of every matrix and its axes; zeros: numbers of zero matrices.
    """

    def __init__(self, blocks: Iterable[JacobianBlock]) -> None:
        self.blocks = list(blocks)
        self.addresses: np.ndarray[Any, np.dtype[np.uintp]] = np.array(
            [(block.matrix.ctypes.data, block.axes.ctypes.data) for block in self.blocks], dtype=np.uintp
        )
        self.zeros = frozenset(i for i, block in enumerate(self.blocks) if not block.matrix.any())

    def turned(self) -> list[Matrix]:
        """Every block in the axes of now."""
        return [block.turned() for block in self.blocks]


_ALIKE = 1e-2
"""Largest relative difference of step sizes that share mobilities; these go with its square: 2 % of an error stay."""


class InterfaceJacobian:
    """Matrices of a network's participants by step size (s), kept as long as they hold."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._mobilities: dict[float, Matrices] = {}
        self._stiffnesses: dict[float, Matrices] = {}
        self._outdated: set[float] = set()

    def matrices(self, h: float, time: float) -> tuple[Matrices, Matrices]:
        """Those of all bodies and of all connections, made about the step just made where they are not known."""
        network = self._network
        if h not in self._mobilities and (alike := self._alike(h)) is not None:
            self._mobilities[h] = alike
        if h not in self._mobilities or h in self._outdated:
            self._evaluate_bodies(h, time)
        if h not in self._stiffnesses:
            self._stiffnesses[h] = Matrices(
                jacobian_block(connection, places, network.width, time, h)
                for connection, places in zip(network.connections, network.connection_places, strict=True)
            )
        return self._mobilities[h], self._stiffnesses[h]

    def _alike(self, h: float) -> Matrices | None:
        """Mobilities of a step of nearly this size: an event is searched for by steps that differ little."""
        known = (found for size, found in self._mobilities.items() if abs(size - h) < _ALIKE * h)
        return next(known, None)

    def _evaluate_bodies(self, h: float, time: float) -> None:
        """Mobilities of all bodies but those that are known and constant, which are only turned along."""
        network, known = self._network, self._mobilities.get(h)
        self._outdated.discard(h)
        if known and all(body.constant_mobility for body in network.bodies):
            return
        self._mobilities[h] = Matrices(
            known.blocks[number]
            if known and body.constant_mobility
            else jacobian_block(body, places, network.width, time, h)
            for number, (body, places) in enumerate(zip(network.bodies, network.body_places, strict=True))
        )

    def mobilities(self, h: float) -> list[Matrix]:
        """Known mobilities of all bodies, in the axes of now."""
        return self._mobilities[h].turned()

    def nearest(self, h: float) -> float | None:
        """The known step size next to one, for what goes with a power of it."""
        return min(self._mobilities, key=lambda known: abs(np.log(known / h)), default=None)

    def outdate(self, h: float | None = None, *, bodies: bool = False) -> None:
        """Evaluate connections anew when they are next used, of one step size or of all; so are its varying bodies.

        A body's mobility costs tens of sweeps and changes little from step to step, a law may change at once.
        """
        if h is None:
            self._stiffnesses.clear()
            return
        self._stiffnesses.pop(h, None)
        if bodies:
            self._outdated.add(h)

    def forget(self, h: float | None = None) -> None:
        """Evaluate everything anew, of one step size or of all."""
        for known in (self._stiffnesses, self._mobilities):
            if h is None:
                known.clear()
            else:
                known.pop(h, None)
