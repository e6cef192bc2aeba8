"""Bodies and connections of an assembly at rest: poses, generalised forces, and their exact derivatives.

Coordinates of a body are six small rigid motions in world axes, the translation of its centre of mass and a
rotation vector about it, then its modal coordinates. A fixed base has the six about its reference point.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from components import REGISTRY, ComponentError, Instance, Layout, rotation_matrix
from components.body import Body
from components.contract.component import Vector
from components.contract.frames import Quaternion, Vector3, exponential, multiply, normalized, rotate, skew
from components.contract.ports import MOTION_SIZE
from components.fixed_base import FixedBase

from ...assembly import Link, Part
from ...scene.table import SceneError
from .connection_at_rest import Connection


class PlacedBody:
    """A body or fixed base at rest: origin `position` (3,) of its coordinates, quaternion, modal coordinates."""

    def __init__(self, part: Part) -> None:
        self.name = part.name
        component = REGISTRY[part.kind](**part.structure)
        start = {name: value for name, value in part.start.items() if name in component.parameter_layout}
        self._instance = Instance(component, start)
        try:
            self._instance.initialize()
        except ComponentError as error:
            raise SceneError([f"{self.name}: {error}"]) from None
        self.component = component
        self.ports = tuple(port.name for port in component.ports)
        state, at = self._instance.state, component.state_layout
        self.orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
        if isinstance(component, Body):
            self.body: Body | None = component
            self.modes = component.modes
            self.position = state[at["position"]].copy()
            self.orientation = tuple(state[at["orientation"]].tolist())
            self._arms, self._shapes, self._turns = component.arms, component.translation, component.rotation
        elif isinstance(component, FixedBase):
            self.body, self.modes = None, 0
            self.position = np.array(component.structure["reference"], dtype=float)
            motions = self.motions()
            self._arms = motions[:, :3] - self.position
            self._shapes = self._turns = np.zeros((len(motions), 3, 0))
        else:
            raise SceneError([f"{self.name}: a {part.kind} has no linear model; bodies and fixed bases have"])
        self.eta = np.zeros(self.modes)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 + self.modes

    @property
    def axes(self) -> Vector:
        """(3, 3) body to world."""
        return rotation_matrix(self.orientation)

    def place(self, position: Vector3, orientation: Quaternion) -> None:
        """Put the construction frame of a body there, undeformed."""
        assert self.body is not None
        center = self.body.data.center_of_mass
        self.orientation = normalized(orientation)
        self.position = np.array(position) + np.array(rotate(self.orientation, tuple(center.tolist())))
        self.eta = np.zeros(self.modes)

    def move(self, step: Vector) -> None:
        """Move by small coordinates (size,); the ports of a fixed base stay."""
        self.position = self.position + step[:3]
        turn = exponential((step[3], step[4], step[5]))
        self.orientation = normalized(multiply(turn, self.orientation))
        self.eta = self.eta + step[6:]

    def _rest(self) -> None:
        """Put the instance to rest where the body is."""
        if self.body is not None:
            state, at = self._instance.state, self.body.state_layout
            state[at["position"]], state[at["orientation"]] = self.position, self.orientation
            state[at["modal_amplitude"]] = self.eta

    def motions(self) -> Vector:
        """Poses of the ports with zero rates, (ports, 13)."""
        self._rest()
        size = MOTION_SIZE * len(self.ports)
        result: Vector = self._instance.outputs()[:size].reshape(-1, MOTION_SIZE)
        return result

    def forces(self, wrenches: Vector) -> Vector:
        """Generalised forces (size,) of wrenches (ports, 6), gravity and the modes' stiffness.

        The body's own equations of motion at rest: the rates of its momenta.
        """
        if self.body is None:
            reach = self._arms
            moments = np.cross(reach, wrenches[:, :3]) + wrenches[:, 3:]
            return np.concatenate((wrenches[:, :3].sum(0), moments.sum(0)))
        assert self.body.continuous is not None
        self._rest()
        self._instance.inputs[: wrenches.size] = wrenches.ravel()
        rates, at = self._instance.rates(), Layout(self.body.continuous.quantities)
        names = ("momentum", "spin", "modal_momentum")[: 3 if self.modes else 2]
        return np.concatenate([rates[at[name]] for name in names])

    def port_jacobian(self, port: int) -> Vector:
        """Motion (6, size) of a port under unit coordinates."""
        return self._jacobian(self._arms[port], self._shapes[port], self._turns[port])

    def point_jacobian(self, point: str) -> Vector:
        """Motion (6, size) of a named point of a body."""
        assert self.body is not None
        data = self.body.data
        i = data.point_names.index(point)
        arm = data.point_positions[i] - data.center_of_mass
        return self._jacobian(arm, data.translation[i], data.rotation[i])

    def _jacobian(self, arm: Vector, shape: Vector, turn: Vector) -> Vector:
        axes, angle = self.axes, turn @ self.eta
        rate = np.eye(3) + 0.5 * skew(angle) + skew(angle) @ skew(angle) / 6.0
        result = np.eye(6, self.size)
        result[:3, 3:6] = -skew(axes @ (arm + shape @ self.eta))
        result[:3, 6:] = axes @ shape
        result[3:, 6:] = axes @ rate @ turn
        return result

    def geometric_stiffness(self, wrenches: Vector) -> Vector:
        """Minus the derivative (size, size) of the generalised forces of wrenches (ports, 6) held in world axes."""
        axes = self.axes
        result = np.zeros((self.size, self.size))
        for k, wrench in enumerate(wrenches):
            shape, turn = self._shapes[k], self._turns[k]
            force, torque = skew(wrench[:3]), skew(wrench[3:])
            angle, local = skew(turn @ self.eta), axes.T @ wrench[3:]
            rate = np.eye(3) + 0.5 * angle + angle @ angle / 6.0
            reach = skew(axes @ (self._arms[k] + shape @ self.eta))
            result[3:6, 3:6] -= force @ reach
            result[3:6, 6:] += force @ axes @ shape
            result[6:, 3:6] -= shape.T @ axes.T @ force + turn.T @ rate.T @ axes.T @ torque
            bent = 0.5 * skew(local) - (skew(angle @ local) + angle @ skew(local)) / 6.0
            result[6:, 6:] -= turn.T @ bent @ turn
        return result

    def mass(self) -> Vector:
        """Mass matrix (size, size) of the undeformed body, zero for a fixed base."""
        result = np.zeros((self.size, self.size))
        if self.body is not None:
            data = self.body.data
            result[:3, :3] = data.mass * np.eye(3)
            result[3:6, 3:6] = self.axes @ data.inertia @ self.axes.T
            result[6:, 6:] = np.eye(self.modes)
        return result

    def modal_matrices(self) -> tuple[Vector, Vector]:
        """Damping and stiffness (size, size) of the modes."""
        damping, stiffness = np.zeros(self.size), np.zeros(self.size)
        if self.body is not None:
            frequency = self.body.data.frequency
            damping[6:] = 2.0 * self._instance.constants.damping_ratio * frequency
            stiffness[6:] = frequency**2
        return np.diag(damping), np.diag(stiffness)


class Pose(NamedTuple):
    """Where a mechanism is: position (3,), quaternion and modal coordinates of bodies, memories of connections."""

    bodies: Mapping[str, tuple[Vector, Quaternion, Vector]]
    connections: Mapping[str, tuple[Vector, Vector]]


class Mechanism:
    """An assembly at rest in a configuration that can be moved, with its connections' states following it."""

    def __init__(self, parts: Sequence[Part], links: Iterable[Link], base: str = "") -> None:
        partner = {link.connection: link.body for link in links}
        holders = {name for name, _ in partner.values()}
        of_bodies = [part for part in parts if part.kind in ("body", "fixed_base") or part.name in holders]
        self.bodies = {part.name: PlacedBody(part) for part in of_bodies}
        self.base = base
        """name of the body or ground that does not move, where there is one"""
        self.connections: dict[str, Connection] = {}
        self._seats: dict[str, list[tuple[str, int]]] = {}
        motions = {name: body.motions() for name, body in self.bodies.items()}
        for part in parts:
            if part.name in self.bodies:
                continue
            names = [port.name for port in REGISTRY[part.kind](**part.structure).ports]
            seats = {port: partner[(part.name, port)] for port in names}
            numbers = {port: self.bodies[body].ports.index(name) for port, (body, name) in seats.items()}
            at = {port: motions[seats[port][0]][number] for port, number in numbers.items()}
            self.connections[part.name] = Connection(part, at)
            self._seats[part.name] = [(seats[port][0], numbers[port]) for port in names]
        ends = np.cumsum([0, *(body.size for body in self.bodies.values())]).tolist()
        self.rows = {name: slice(a, b) for name, a, b in zip(self.bodies, ends[:-1], ends[1:], strict=True)}
        self.size: int = ends[-1]

    def carry(self) -> None:
        """Move the connections' ports to where the bodies have them."""
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
        bodies = {name: (b.position, b.orientation, b.eta) for name, b in self.bodies.items()}
        return Pose(bodies, {name: connection.memory() for name, connection in self.connections.items()})

    def come_back(self, pose: Pose) -> None:
        """Come back to a pose."""
        for name, (position, orientation, eta) in pose.bodies.items():
            body = self.bodies[name]
            body.position, body.orientation, body.eta = position, orientation, eta
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
        body, number = self._seats[connection][port]
        result = np.zeros((6, self.size))
        result[:, self.rows[body]] = self.bodies[body].port_jacobian(number)
        return result

    def point_jacobian(self, body: str, point: str) -> Vector:
        """The same of a named point."""
        result = np.zeros((6, self.size))
        result[:, self.rows[body]] = self.bodies[body].point_jacobian(point)
        return result

    def rigid_motion(self, origin: Vector) -> Vector:
        """Coordinates (size, 6) of unit translations of everything and rotations about the origin (3,)."""
        result = np.zeros((self.size, 6))
        for name, body in self.bodies.items():
            rows = slice(self.rows[name].start, self.rows[name].start + 6)
            result[rows] = np.eye(6)
            result[rows.start : rows.start + 3, 3:] = -skew(body.position - origin)
        return result

    def _wrenches_on_bodies(self) -> Mapping[str, Vector]:
        found = {name: np.zeros((len(body.ports), 6)) for name, body in self.bodies.items()}
        for name, connection in self.connections.items():
            for (body, port), wrench in zip(self._seats[name], connection.wrenches(), strict=True):
                found[body][port] += wrench
        return found

    def forces(self) -> Vector:
        """Generalised forces (size,) in the present pose; zero at equilibrium."""
        wrenches = self._wrenches_on_bodies()
        return np.concatenate([body.forces(wrenches[name]) for name, body in self.bodies.items()])

    def tangents(self) -> tuple[Vector, Vector]:
        """Stiffness and damping (size, size): minus the derivatives of the generalised forces."""
        wrenches = self._wrenches_on_bodies()
        stiffness, damping = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        for name, body in self.bodies.items():
            rows = self.rows[name]
            damping[rows, rows], stiffness[rows, rows] = body.modal_matrices()
            stiffness[rows, rows] += body.geometric_stiffness(wrenches[name])
        for name, connection in self.connections.items():
            motion = self._port_motions(name)
            elastic, viscous = connection.tangents()
            stiffness += motion.T @ elastic @ motion
            damping += motion.T @ viscous @ motion
        return stiffness, damping

    def damping_parts(self) -> Iterator[tuple[str, Vector, Vector]]:
        """Name, motion (m, size) and damping (m, m) in these motions of every body with modes and every connection."""
        for name, body in self.bodies.items():
            if body.modes:
                yield name, np.eye(self.size)[self.rows[name]], body.modal_matrices()[0]
        for name, connection in self.connections.items():
            yield name, self._port_motions(name), connection.tangents()[1]

    def _port_motions(self, connection: str) -> Vector:
        """Motion (6 ports, size) of all ports of a connection."""
        ports = range(len(self.connections[connection].ports))
        return np.concatenate([self.jacobian(connection, k) for k in ports])

    def mass(self) -> Vector:
        """Mass matrix (size, size)."""
        result = np.zeros((self.size, self.size))
        for name, body in self.bodies.items():
            result[self.rows[name], self.rows[name]] = body.mass()
        return result
