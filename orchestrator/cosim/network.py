"""Which port meets which: checks of the connections, and the index arrays that carry values across them.

Bodies return motions and receive wrenches; connections do the reverse. The unknown of a coupled step is
the vector of all wrenches on bodies, in the order of the bodies and their ports. In a network of order 4 every
wrench is followed by its slope, and every pose by first moments of the velocities; see `components.slope_layout`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from components import FanfoldError

from ..assembly import Link
from .participant import Matrix, Participant, Vector
from .ports import MOTION, UNITS, WIDTHS, WRENCH, Order, Side, port_places


class PortConnection(NamedTuple):
    """A body's port and the connection's port it meets, all by number: in the network, and in its participant."""

    body: int
    body_port: int
    connection: int
    connection_port: int


class NetworkError(FanfoldError):
    """Everything wrong with a set of connections, one sentence each, in `problems`."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = list(problems)


def port_sides(participant: Participant) -> dict[str, Side]:
    """Ports of a participant by name, found from its variables, with the side each is on."""
    sides: dict[str, Side] = {}
    for layout, side in ((participant.input_layout, "body"), (participant.output_layout, "connection")):
        for quantity in layout.quantities:
            port, _, variable = quantity.name.rpartition(".")
            if port and variable == "force":
                sides[port] = "body" if side == "body" else "connection"
    return sides


class Network:
    """Participants joined port to port.

    participants: all, bodies before connections. wrenches: the unknown, shape (width.wrench x body ports,), of
    which each body's inputs hold a copy. `port_names[i]` is the (body, port) of the i-th wrench in it, `meetings[i]`
    what meets there. order: 4 where slopes are carried as well, between ports that have them. coarse: names of those
    connections of a network of order 4 that are of order 2, as a body there is.
    """

    def __init__(self, participants: Sequence[Participant], links: Iterable[Link], order: Order = 2) -> None:
        links = tuple(links)
        problems = _problems(participants, links)
        if problems:
            raise NetworkError(problems)
        sides = {p.name: port_sides(p) for p in participants}
        self.bodies = [p for p in participants if "body" in sides[p.name].values()]
        self.connections = [p for p in participants if "connection" in sides[p.name].values()]
        self.participants = [*self.bodies, *self.connections]
        self.by_name = {p.name: p for p in participants}
        self.port_names = [(b.name, port) for b in self.bodies for port in sides[b.name]]
        self.body_ports = [list(sides[b.name]) for b in self.bodies]
        self.connection_ports = [list(sides[c.name]) for c in self.connections]
        partner = {link.body: link.connection for link in links}
        self.partner = [partner[port] for port in self.port_names]
        self.order = order
        self.width = width = WIDTHS[order]
        self.body_places = [
            port_places("body", p.input_layout, p.output_layout, ports, order)
            for p, ports in zip(self.bodies, self.body_ports, strict=True)
        ]
        self.connection_places = [
            port_places("connection", p.input_layout, p.output_layout, ports, order)
            for p, ports in zip(self.connections, self.connection_ports, strict=True)
        ]
        self.size = width.wrench * len(self.port_names)
        self.rows = _consecutive([width.wrench * len(ports) for ports in self.body_ports])
        place = {port: i for i, port in enumerate(self.port_names)}
        reverse = {link.connection: link.body for link in links}
        self.connection_rows = [
            np.concatenate(
                [np.arange(width.wrench) + width.wrench * place[reverse[(c.name, port)]] for port in ports]
            )
            for c, ports in zip(self.connections, self.connection_ports, strict=True)
        ]
        meets = {
            reverse[(c.name, port)]: (number, side)
            for number, (c, ports) in enumerate(zip(self.connections, self.connection_ports, strict=True))
            for side, port in enumerate(ports)
        }
        self.meetings = [
            PortConnection(number, side, *meets[(b.name, port)])
            for number, (b, ports) in enumerate(zip(self.bodies, self.body_ports, strict=True))
            for side, port in enumerate(ports)
        ]
        self.coarse = self._of_order_2() if order == 4 else frozenset()
        count = len(self.port_names)
        self._shape = (count, width.wrench)
        self._motion, self._moments = np.zeros((count, 13)), np.zeros((count, 6))
        self._body_links = _consecutive([len(ports) for ports in self.body_ports])
        self.connection_links = [
            np.array([place[reverse[(c.name, port)]] for port in ports])
            for c, ports in zip(self.connections, self.connection_ports, strict=True)
        ]

    @classmethod
    def ordered(
        cls, participants: Sequence[Participant], links: Iterable[Link], order: Order | None
    ) -> Network:
        """A network of an order; without one of order 4, or of 2 where no connection can be of order 4."""
        links = tuple(links)
        network = cls(participants, links, order or 4)
        if order is None and network.connections and len(network.coarse) == len(network.connections):
            return cls(participants, links)
        return network

    def _of_order_2(self) -> frozenset[str]:
        """Names of connections with a body that has no slopes."""
        return frozenset(
            self.connections[met.connection].name
            for met in self.meetings
            if self.body_places[met.body].moments is None
        )

    def order_of(self, name: str) -> Order:
        """Order of a participant by name: a connection with a body of order 2 is of that as well.

        Slopes on one side only would turn the whole structure, as the moment balance contains those of both sides.
        """
        return 2 if name in self.coarse else self.order

    def set_wrenches(self, wrenches: Vector) -> None:
        """Put the unknown into the bodies' inputs."""
        table = wrenches.reshape(self._shape)
        for body, places, links in zip(self.bodies, self.body_places, self._body_links, strict=True):
            _port_table(body.inputs, 0, 6, places.ports)[:] = table[links, :6]
            if places.slopes is not None:
                _port_table(body.inputs, places.slopes, 6, places.ports)[:] = table[links, 6:]

    def carry_motion(self) -> None:
        """Bodies' outputs to connections' inputs."""
        for body, places, links in zip(self.bodies, self.body_places, self._body_links, strict=True):
            self._motion[links] = _port_table(body.outputs, 0, 13, places.ports)
            if places.moments is not None:
                self._moments[links] = _port_table(body.outputs, places.moments, 6, places.ports)
        for connection, places, index in zip(
            self.connections, self.connection_places, self.connection_links, strict=True
        ):
            _port_table(connection.inputs, 0, 13, places.ports)[:] = self._motion[index]
            if places.moments is not None:
                _port_table(connection.inputs, places.moments, 6, places.ports)[:] = self._moments[index]

    def collect_wrenches(self, out: Vector) -> None:
        """Connections' outputs, in the order of the unknown."""
        table = out.reshape(self._shape)
        for connection, places, index in zip(
            self.connections, self.connection_places, self.connection_links, strict=True
        ):
            table[index, :6] = _port_table(connection.outputs, 0, 6, places.ports)
            if places.slopes is not None:
                table[index, 6:] = _port_table(connection.outputs, places.slopes, 6, places.ports)

    def port_of_row(self, row: int) -> str:
        """The connection a row of the unknown belongs to, for messages: "hl3_left (port outboard on panel2)"."""
        number = row // self.width.wrench
        (body, port), (connection, side) = self.port_names[number], self.partner[number]
        return f"{connection}.{side} on {body}.{port}"


def _port_table(values: Vector, first: int, width: int, ports: int) -> Matrix:
    """A view (ports, width) of the numbers of the ports in an array."""
    return values[first : first + width * ports].reshape(ports, width)


def _consecutive(sizes: Sequence[int]) -> list[slice]:
    ends = np.cumsum([0, *sizes]).tolist()
    return [slice(a, b) for a, b in pairwise(ends)]


def _problems(participants: Sequence[Participant], links: Sequence[Link]) -> list[str]:
    """Everything wrong, as sentences."""
    problems = []
    names = [p.name for p in participants]
    problems += [
        f"{name}: two FMUs have this name; names must differ"
        for name in sorted(set(names))
        if names.count(name) > 1
    ]
    sides = {p.name: port_sides(p) for p in participants}
    by_name = {p.name: p for p in participants}
    used: dict[tuple[str, str], int] = {}
    for link in links:
        for (name, port), side in ((link.body, "body"), (link.connection, "connection")):
            found = sides.get(name, {}).get(port)
            if name not in sides:
                problems.append(f"{name}.{port}: there is no FMU {name!r}")
            elif found is None:
                known = ", ".join(sides[name]) or "none"
                problems.append(f"{name}.{port}: {name} has no such port; its ports are {known}")
            elif found != side:
                problems.append(
                    f"{name}.{port}: this port {'takes' if found == 'body' else 'gives'} wrenches, so it cannot be "
                    f"the {side} side of a connection"
                )
            else:
                problems += _unit_problems(by_name[name], port, side)
            used[(name, port)] = used.get((name, port), 0) + 1
    problems += [
        f"{n}.{port}: connected {k} times; a port takes one connection"
        for (n, port), k in used.items()
        if k > 1
    ]
    problems += [
        f"{name}.{port}: the port is not connected"
        for name, ports in sides.items()
        for port in ports
        if (name, port) not in used
    ]
    return problems


def _unit_problems(participant: Participant, port: str, side: str) -> list[str]:
    """Missing variables, wrong sizes and wrong units of a port."""
    motion, wrench = participant.output_layout, participant.input_layout
    if side == "connection":
        motion, wrench = wrench, motion
    problems = []
    for layout, variables in ((motion, MOTION), (wrench, WRENCH)):
        declared = {q.name: q for q in layout.quantities}
        for variable in variables:
            name = f"{port}.{variable}"
            quantity = declared.get(name)
            size = 4 if variable == "orientation" else 3
            if quantity is None:
                problems.append(
                    f"{participant.name}.{name}: the variable is missing or has the wrong causality"
                )
            elif quantity.size != size:
                problems.append(
                    f"{participant.name}.{name}: has {quantity.size} elements; a port needs {size}"
                )
            elif quantity.unit != UNITS[variable]:
                problems.append(
                    f"{participant.name}.{name}: is in {quantity.unit or 'no unit'}; a port needs {UNITS[variable]}"
                )
    return problems
