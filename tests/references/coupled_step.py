"""The coupling scheme in plain Python, slow and to be read: what the solver in C is tested against.

Unknown of a step: the mean wrenches at all ports, at order 4 with their slopes. Residual: what connections return for
the motions that such wrenches cause, minus the wrenches. Newton's method finds its root with a dense Jacobian by
differences, down to rounding, from the wrenches of the step before. See docs/theory.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from components import left_product
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Matrix, Participant, Vector

TIGHT, ROUNDED = 1e-13, 1e-6
"""Correction, over the largest force or torque, that is none; and the largest that may be one of rounding."""
SLOW = 0.1
"""Part of the correction before, above which the Jacobian is made anew, or what is left is rounding."""
MOST_CORRECTIONS = 30
PROBED, MOVED = 1e-8, 1e-7
"""Wrench (N, N.m) x h^2 that bodies are probed with, and the change of poses (m, 1) that connections are."""


class Step(NamedTuple):
    """A step: time (s) of its end, its size (s), the unknown (size,), outputs and observations by name."""

    time: float
    h: float
    wrenches: Vector
    outputs: Mapping[str, Vector]
    observations: Mapping[str, Vector]


class CoupledStep:
    """Steps the participants of a network; `wrenches` are those of the last sweep, `made` all steps made."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.time = 0.0
        self.wrenches = np.zeros(network.size)
        self.made: list[Step] = []

    def initialize(self) -> None:
        """Bring all participants to t = 0, connections as they were built."""
        network = self.network
        for participant in network.participants:
            if "order" in participant.parameter_layout:
                participant.set_parameter("order", network.order_of(participant.name))
        for body in network.bodies:
            body.write()
            body.read()
        network.carry_motion()
        for participant in network.participants:
            participant.initialize(0.0)
            participant.read()
            participant.save()

    def advance(self, h: float) -> Step:
        """Solve a step of a size h (s) and take it as made."""
        self.solve(h)
        return self.accept(h)

    def solve(self, h: float) -> None:
        """Find the wrenches of a step h (s), and leave participants at its end; ArithmeticError if there are none."""
        jacobian, last, slow = None, np.inf, False
        for _ in range(MOST_CORRECTIONS):
            if jacobian is None or slow:
                jacobian = self.jacobian(h)
            residual = self.sweep(h) - self.wrenches
            correction = np.linalg.solve(jacobian, -residual)
            size = self._size(correction)
            slow = size > SLOW * last
            if size <= TIGHT or (slow and size <= ROUNDED):
                return
            self.wrenches += correction
            last = size
        raise ArithmeticError(f"the step of {h:g} s from {self.time:g} s: the last correction is {last:.1e}")

    def accept(self, h: float) -> Step:
        """Take the step h (s) that participants stand at the end of as made."""
        self.time += h
        for participant in self.network.participants:
            participant.save()
        outputs = {p.name: p.outputs.copy() for p in self.network.participants}
        observations = {p.name: p.observe().copy() for p in self.network.participants}
        self.made.append(Step(self.time, h, self.wrenches.copy(), outputs, observations))
        return self.made[-1]

    def sweep(self, h: float) -> Vector:
        """What connections return for the motions that the wrenches cause over a step h (s)."""
        network = self.network
        network.set_wrenches(self.wrenches)
        for body in network.bodies:
            self._make(body, h)
        return self._returned(network.connections, h)

    def jacobian(self, h: float) -> Matrix:
        """Derivatives of the residual of a step h (s) by the wrenches; participants end somewhere beside it."""
        network, result = self.network, -np.eye(self.network.size)
        for number, (body, rows) in enumerate(zip(network.bodies, network.rows, strict=True)):
            response, motion = self.sweep(h), body.outputs.copy()
            joined = {m.connection for m in network.meetings if m.body == number}
            connections = [network.connections[i] for i in joined]
            for column, change in enumerate(self._mobility(number, h).T, start=rows.start):
                moved = np.abs(self._motions(number, change)[:, :7]).max()
                if moved > 0.0:
                    body.outputs[:] = motion + MOVED / moved * change
                    result[:, column] += (self._returned(connections, h) - response) * moved / MOVED
        return result

    def error_square(self, h: float, energy: float) -> float:
        """Square of the relative error in velocity of a step h (s) just solved, with two made before.

        Work of what bends the wrenches on the motion that it causes, over an energy (J).
        """
        network, ports = self.network, len(self.network.port_names)
        bent = np.zeros((ports, network.width.wrench))
        bent[:, :6] = bend((*self.made[-3:], Step(self.time + h, h, self.wrenches, {}, {})), ports)
        work = 0.0
        for number, (body, rows) in enumerate(zip(network.bodies, network.rows, strict=True)):
            wrench, motions = bent.ravel()[rows], self._motions(number, body.outputs).copy()
            changes = self._motions(number, self._mobility(number, h) @ wrench)
            loads = wrench.reshape(-1, network.width.wrench)
            for (w, x, y, z), change, load in zip(motions[:, 3:7], changes, loads, strict=True):
                turn = 2.0 * left_product(tuple(change[3:7])) @ (w, -x, -y, -z)
                work += float(load[:3] @ change[:3] + load[3:6] @ turn[1:])
        self.sweep(h)
        return work / energy

    def _mobility(self, number: int, h: float) -> Matrix:
        """Derivatives of a body's outputs, as they are, by its wrenches over a step h (s); it ends beside it."""
        network, body, probe = self.network, self.network.bodies[number], PROBED / h**2
        motion, columns = body.outputs.copy(), []
        for unit in np.eye(network.size)[network.rows[number]]:
            network.set_wrenches(self.wrenches + probe * unit)
            self._make(body, h)
            columns.append((body.outputs - motion) / probe)
        return np.array(columns).T

    def _motions(self, number: int, outputs: Vector) -> Matrix:
        """Of a body's ports (ports, 13) in its outputs."""
        ports = len(self.network.body_ports[number])
        return outputs[: 13 * ports].reshape(ports, 13)

    def _make(self, participant: Participant, h: float) -> None:
        """A step h (s) from the saved state with the inputs as they are."""
        participant.restore()
        participant.write()
        participant.do_step(self.time, h)
        participant.read()

    def _returned(self, connections: Sequence[Participant], h: float) -> Vector:
        """Wrenches of all connections, some of which make a step h (s) over the present motions of bodies."""
        self.network.carry_motion()
        for connection in connections:
            self._make(connection, h)
        found = np.zeros(self.network.size)
        self.network.collect_wrenches(found)
        return found

    def _size(self, correction: Vector) -> float:
        """Of a correction, over 1 N or N.m and the largest force or torque there is."""
        loads, changes = (np.abs(a).reshape(-1, 2, 3).max((0, 2)) for a in (self.wrenches, correction))
        return float((changes / (1.0 + loads)).max())


def bend(steps: Sequence[Step], ports: int) -> Matrix:
    """What bends mean wrenches (ports, 6) over the last of three or four steps: the mean of now and of a step before.

    At order 2 it is h^2 u''. At order 4 it is the part of it that slopes do not cover: -2 h^4 times the fourth divided
    difference over three steps, the outer ones doubled as they have slopes. With four steps, a component with a slope
    bends by at most a twelfth of h^3 u'''.
    """
    h, tables = steps[-1].h, [step.wrenches.reshape(ports, -1) for step in steps]
    points = [
        (step.time - 0.5 * step.h, table[:, :6], table[:, 6:] * 2.0 / step.h)
        for step, table in zip(steps, tables, strict=True)
    ]
    slopes, triples = tables[-1][:, 6:], [points[k : k + 3] for k in range(len(points) - 2)]
    if not slopes.size:
        bends = [2.0 * h**2 * divided(triple) for triple in triples]
    else:
        bends = [-2.0 * h**4 * divided((a, a, b, c, c)) for a, b, c in triples]
    change = 0.5 * (bends[0] + bends[-1])
    if slopes.size and len(points) > 3:
        most = 0.5 * h**3 * divided(points)
        change = np.where((slopes != 0.0) & (np.abs(most) < np.abs(change)), most, change)
    return change


def divided(points: Sequence[tuple[float, Matrix, Matrix]]) -> Matrix:
    """Newton's divided difference of values at times in order; a point that comes twice counts with its rate."""
    (first, value, rate), (last, _, _) = points[0], points[-1]
    if first == last:
        return value if len(points) == 1 else rate
    return (divided(points[1:]) - divided(points[:-1])) / (last - first)
