"""Bodies and connections of an assembly at rest: poses, generalised forces, and their exact derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from components.beam import Beam
from components.contract.component import Vector
from components.contract.frames import skew
from components.driven_base import DrivenBase
from components.fixed_base import FixedBase
from components.moving_base import MovingBase

from .. import Link, Part
from .connection_at_rest import Connection, LedConnection
from .placed_beam import PlacedBeam
from .placed_body import Memory, PlacedBody
from .steady_spin import Spin

_OF_BODIES = ("body", FixedBase.kind, MovingBase.kind, DrivenBase.kind)


class Pose(NamedTuple):
    """Where a mechanism is: what bodies and connections remember."""

    bodies: Mapping[str, Memory]
    connections: Mapping[str, tuple[Vector, Vector]]


class Mechanism:
    """An assembly at rest in a configuration that can be moved, with its connections' states following it.

    is_led: whether connections rest as in a run that starts there, see `LedConnection`.
    """

    def __init__(
        self, parts: Sequence[Part], links: Iterable[Link], base: str = "", *, is_led: bool = False
    ) -> None:
        partner = {link.connection: link.body for link in links}
        holders = {name for name, _ in partner.values()}
        of_bodies = [part for part in parts if part.kind in _OF_BODIES or part.name in holders]
        self.bodies: dict[str, PlacedBody] = {
            part.name: PlacedBeam(part) if part.kind == Beam.kind else PlacedBody(part) for part in of_bodies
        }
        self.base = base
        """name of the body or ground that does not move, where there is one"""
        self.spin: Spin | None = None
        """in whose axes all is at rest"""
        self.connections: dict[str, Connection] = {}
        self._seats: dict[str, list[tuple[str, int]]] = {}
        motions = {name: body.motions() for name, body in self.bodies.items()}
        kind = LedConnection if is_led else Connection
        for part in parts:
            if part.name in self.bodies:
                continue
            names = [port.name for port in part.component().ports]
            seats = {port: partner[(part.name, port)] for port in names}
            numbers = {port: self.bodies[body].ports.index(name) for port, (body, name) in seats.items()}
            at = {port: motions[seats[port][0]][number] for port, number in numbers.items()}
            self.connections[part.name] = kind(part, at)
            self._seats[part.name] = [(seats[port][0], numbers[port]) for port in names]
        ends = np.cumsum([0, *(body.size for body in self.bodies.values())]).tolist()
        self.rows = {name: slice(a, b) for name, a, b in zip(self.bodies, ends[:-1], ends[1:], strict=True)}
        self.size: int = ends[-1]
        self._port_motions: dict[str, Vector] = {}
        """of the present pose, by connection"""

    def carry(self) -> None:
        """Move the connections' ports to where the bodies have them."""
        self._port_motions.clear()
        motions = {name: body.motions() for name, body in self.bodies.items()}
        for name, connection in self.connections.items():
            connection.put(np.array([motions[body][port] for body, port in self._seats[name]]))

    def follow(self) -> None:
        """The same, and remember the pose."""
        self.carry()
        for connection in self.connections.values():
            connection.follow()

    def pose(self) -> Pose:
        """Where everything is, to come back to."""
        bodies = {name: body.memory() for name, body in self.bodies.items()}
        return Pose(bodies, {name: connection.memory() for name, connection in self.connections.items()})

    def come_back(self, pose: Pose) -> None:
        """Come back to a pose."""
        for name, place in pose.bodies.items():
            self.bodies[name].remember(place)
        self.carry()
        for name, memory in pose.connections.items():
            self.connections[name].remember(*memory)

    def move(self, step: Vector) -> None:
        """Move all bodies by small coordinates (size,)."""
        for name, body in self.bodies.items():
            body.move(step[self.rows[name]])
        self.carry()

    def command(self, name: str, value: float, connections: Iterable[str]) -> None:
        """Give a command to the named connections that have it."""
        for connection in connections:
            self.connections[connection].command(name, value)

    def jacobian(self, connection: str, port: int) -> Vector:
        """Motion (6, size) of a connection's port under unit coordinates of all bodies."""
        return self.port_motions(connection)[6 * port : 6 * port + 6]

    def port_motions(self, connection: str) -> Vector:
        """The same (6 ports, size) of all its ports, computed once in a pose."""
        if connection not in self._port_motions:
            seats = self._seats[connection]
            found = np.zeros((6 * len(seats), self.size))
            for k, (body, number) in enumerate(seats):
                found[6 * k : 6 * k + 6, self.rows[body]] = self.bodies[body].port_jacobian(number)
            self._port_motions[connection] = found
        return self._port_motions[connection]

    def point_jacobian(self, body: str, point: str) -> Vector:
        """The same of a named point."""
        result = np.zeros((6, self.size))
        result[:, self.rows[body]] = self.bodies[body].point_jacobian(point)
        return result

    def rigid_motion(self, origin: Vector) -> Vector:
        """Coordinates (size, 6) of unit translations of everything and rotations about the origin (3,)."""
        result = np.zeros((self.size, 6))
        for name, body in self.bodies.items():
            for k, position in enumerate(body.points):
                first = self.rows[name].start + 6 * k
                result[first : first + 6] = np.eye(6)
                result[first : first + 3, 3:] = -skew(position - origin)
        return result

    def _wrenches_on_bodies(self) -> Mapping[str, Vector]:
        found = {name: np.zeros((len(body.ports), 6)) for name, body in self.bodies.items()}
        for name, connection in self.connections.items():
            for (body, port), wrench in zip(self._seats[name], connection.resting_wrenches(), strict=True):
                found[body][port] += wrench
        return found

    def forces(self) -> Vector:
        """Generalised forces (size,) in the present pose; zero at equilibrium."""
        wrenches = self._wrenches_on_bodies()
        found = np.concatenate([body.forces(wrenches[name]) for name, body in self.bodies.items()])
        if self.spin is not None:
            found += np.concatenate([self.spin.forces(body) for body in self.bodies.values()])
        return found

    def stiffness(self) -> Vector:
        """(size, size): minus the derivatives of the generalised forces by the coordinates."""
        wrenches = self._wrenches_on_bodies()
        result = np.zeros((self.size, self.size))
        for name, body in self.bodies.items():
            rows = self.rows[name]
            result[rows, rows] = body.stiffness(wrenches[name])
            if self.spin is not None:
                result[rows, rows] += self.spin.stiffness(body)
        for name, connection in self.connections.items():
            motion = self.port_motions(name)
            result += motion.T @ connection.stiffness() @ motion
        return result

    def damping(self) -> Vector:
        """(size, size): the same by the rates of the coordinates."""
        result = np.zeros((self.size, self.size))
        for name, body in self.bodies.items():
            result[self.rows[name], self.rows[name]] = body.modal_matrices()[0]
        for name, connection in self.connections.items():
            motion = self.port_motions(name)
            result += motion.T @ connection.damping() @ motion
        return result

    def damping_parts(self) -> Iterator[tuple[str, Vector, Vector]]:
        """Name, motion (m, size) and damping (m, m) in these motions of every body with modes and every connection."""
        for name, body in self.bodies.items():
            if body.modes:
                yield name, np.eye(self.size)[self.rows[name]], body.modal_matrices()[0]
        for name, connection in self.connections.items():
            yield name, self.port_motions(name), connection.damping()

    def mass(self) -> Vector:
        """Mass matrix (size, size)."""
        result = np.zeros((self.size, self.size))
        for name, body in self.bodies.items():
            result[self.rows[name], self.rows[name]] = body.mass()
        return result

    def gyroscopic(self) -> Vector:
        """What rates do in axes that turn (size, size), antisymmetric; zero at rest."""
        result = np.zeros((self.size, self.size))
        if self.spin is not None:
            for name, body in self.bodies.items():
                result[self.rows[name], self.rows[name]] = self.spin.gyroscopic(body)
        return result
