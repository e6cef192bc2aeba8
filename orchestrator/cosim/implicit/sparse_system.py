"""The linear system of a coupled step in Python: I - stiffness x mobility over the connection graph, sparse.

What fmus/native/coupling/blocks.h does for a network of FMUs, for networks of anything else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from ..network import Network
from ..participant import Matrix, Vector

# a chain fills in as little as in its natural order, and a tree of chains does not depend on that order
_PERMUTATION: Literal["MMD_AT_PLUS_A"] = "MMD_AT_PLUS_A"


class SparseSystem:
    """LU factors of I - stiffness x mobility; the identity until `factorize`."""

    def __init__(self, network: Network) -> None:
        self._shape = (network.size, network.size)
        bodies = {
            (meeting.connection, meeting.connection_port): (meeting.body, meeting.body_port)
            for meeting in network.meetings
        }
        self._products = [
            (connection, port, *bodies[(connection, port)])
            for connection, ports in enumerate(network.connection_ports)
            for port in range(len(ports))
        ]
        self._network = network
        self._diagonal = np.arange(network.size)
        self._ones = np.ones(network.size)
        self._factors = splu(self._identity())

    def _identity(self) -> csc_array:
        return csc_array((self._ones, (self._diagonal, self._diagonal)), self._shape)

    def factorize(self, mobilities: Sequence[Matrix], stiffnesses: Sequence[Matrix]) -> None:
        """Take matrices of all bodies (coordinates, wrenches) and connections (wrenches, coordinates)."""
        network, values = self._network, [self._ones]
        n = network.width.coordinates
        rows, columns = [self._diagonal], [self._diagonal]
        for connection, port, body, body_port in self._products:
            if not mobilities[body].any():  # a body that never moves
                continue
            other = network.rows[body]
            place = np.meshgrid(
                network.connection_rows[connection], np.arange(other.start, other.stop), indexing="ij"
            )
            rows.append(place[0].ravel())
            columns.append(place[1].ravel())
            stiffness = stiffnesses[connection][:, n * port : n * (port + 1)]
            mobility = mobilities[body][n * body_port : n * (body_port + 1)]
            values.append(-(stiffness @ mobility).ravel())
        places = (np.concatenate(rows), np.concatenate(columns))
        matrix = csc_array((np.concatenate(values), places), self._shape)
        try:
            self._factors = splu(matrix, permc_spec=_PERMUTATION)
        except (RuntimeError, ValueError):  # no pivot: the residual itself is as good a correction as any
            self._factors = splu(self._identity())

    def solve(self, residual: Vector) -> Vector:
        """Chord Newton correction for a residual (size,)."""
        result: Vector = self._factors.solve(residual)
        return result
