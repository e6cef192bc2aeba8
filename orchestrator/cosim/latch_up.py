"""What a latch-up makes of a hinge line: the frequency of the rotation it stiffens, its inertia and its energy.

Found from the derivatives of the coupled step. With S the stiffness that the event adds at its hinges and g how far
they turn under torques of 1 N.m held over a step h, all joints in place, the rotations obey theta'' = -(2 g/h^2) S
theta. At a small h more of a flexible body's inertia stays behind: the frequency is that of the step's own time scale.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from .implicit.convergence import CREDIBLE
from .implicit.differences import stepped
from .implicit.interface_jacobian import first_port_axes, jacobian_block
from .implicit.local_error import WeightedLoad
from .implicit.snapshot import Numbers
from .implicit.solver import Solver
from .network import Network
from .participant import Matrix, Participant, ParticipantError, Vector
from .ports import PortPlaces, Width

_LONG_STEP = 100.0
"""Step (s) over which damping and friction add nothing to a connection's stiffness."""
_LEAST_STIFFENING = 1e-12
_FREQUENCY_SEARCH = 6
_LONGEST_SWING = 0.02
"""Time (s) over which a latched wing swings as a whole; in steps many swings long, derivatives tell no inertia."""


class Stiffening(NamedTuple):
    """The rotation at one hinge that an event made stiff; where nothing turns against a torque, a motion along an axis.

    connection: its number; first: component of its last port's wrench that its load starts at, 3 of a torque, 0 of a
    force; axis (3,): unit vector, axes of that port; stiffness (N.m/rad or N/m), with the inertial terms that damp
    unresolved coordinates; damping (N.m.s/rad or N.s/m); wrench (6 ports,): of the hinge on its bodies for a load of
    1 N.m or N about the axis; rotation (6 ports,): by motions of its ports.
    """

    connection: int
    first: int
    axis: Vector
    stiffness: float
    damping: float
    wrench: Vector
    rotation: Vector


class StiffenedLine(NamedTuple):
    """A hinge line just latched: angular frequency (rad/s), rate of decay (1/s), energy (J), and its hinges.

    rate of decay: damping over inertia; energy: of the rate that the line latches with.
    """

    frequency: float
    decay: float
    energy: float
    hinges: tuple[Stiffening, ...]

    @property
    def fastest(self) -> float:
        """How fast it starts (1/s): by its frequency or its decay; 0 where nothing turns."""
        return max(self.frequency, self.decay)


def stiffened_line_of(numbers: Numbers) -> StiffenedLine:
    """The line that was made plain numbers."""
    hinges = (Stiffening(**hinge) for hinge in numbers["hinges"])
    return StiffenedLine(
        **{
            **numbers,
            "hinges": tuple(
                h._replace(axis=np.array(h.axis), wrench=np.array(h.wrench), rotation=np.array(h.rotation))
                for h in hinges
            ),
        }
    )


def still_held(lines: Sequence[StiffenedLine], released: Collection[int]) -> list[StiffenedLine]:
    """The latched lines none of whose hinges, by the number of their connection, was released."""
    return [line for line in lines if not any(hinge.connection in released for hinge in line.hinges)]


class Slope(NamedTuple):
    """Mean wrenches (6 ports,) of a connection by the poses of its ports at the end of a step.

    Over the step asked for, and over one so long that damping adds nothing.
    """

    step: Matrix
    long: Matrix


def slopes(solver: Solver, names: Sequence[str], time: float, h: float) -> list[Slope]:
    """Stiffnesses of connections by name, at the motions and under the commands of now."""
    network = solver.network
    places = {c.name: p for c, p in zip(network.connections, network.connection_places, strict=True)}
    return [
        Slope(
            *(
                _stiffness(network.by_name[name], places[name], network.width, time, s)
                for s in (h, _LONG_STEP)
            )
        )
        for name in names
    ]


def _stiffness(connection: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Matrix:
    held = connection.inputs.copy()
    if places.moments is not None:  # without motion, as those of the last step are no part of another one
        connection.inputs[places.moments : places.moments + 6 * places.ports] = 0.0
    stepped(connection, time, h)
    matrix = jacobian_block(connection, places, width, time, h).matrix
    connection.inputs[:] = held
    table = matrix.reshape(places.ports, width.wrench, places.ports, width.coordinates)[:, :6, :, :6]
    return table.reshape(6 * places.ports, 6 * places.ports)


def stiffenings(
    solver: Solver, names: Sequence[str], before: Sequence[Slope], after: Sequence[Slope], h: float
) -> tuple[Stiffening, ...]:
    """What an event changed at hinges, from their slopes before and after; those that it made no stiffer left out."""
    numbers = {c.name: i for i, c in enumerate(solver.network.connections)}
    found = []
    for name, old, new in zip(names, before, after, strict=True):
        change = old.long - new.long
        # load on the last port by its motion: torques where there are any
        own = slice(-3, None) if change[-3:, -3:].any() else slice(-6, -3)
        values, vectors = np.linalg.eigh(0.5 * (change[own, own] + change[own, own].T))
        if values[-1] <= _LEAST_STIFFENING * float(np.abs(new.long).max()):
            continue
        axis, last_port = vectors[:, -1], solver.network.by_name[name].inputs[13 * (len(change) // 6 - 1) :]
        viscous = (old.step - new.step - change)[own, own]
        found.append(
            Stiffening(
                numbers[name],
                6 + own.start,
                first_port_axes(last_port).T @ axis,
                2.0 * float(values[-1]),  # a mean load is half of that at the end
                max(0.0, h * float(axis @ viscous @ axis)),
                change[:, own] @ axis / values[-1],
                axis @ change[own] / values[-1],
            )
        )
    return tuple(found)


def stiffened_line(solver: Solver, hinges: tuple[Stiffening, ...], h: float) -> StiffenedLine:
    """Frequency and energy of a line on the time scale of a step h, whose matrices the solver has in use.

    Nothing turns where a hinge would turn against its torque, or so far that the matrices are as good as singular:
    locks and fast rotations can make that of a long step.
    """
    stiffness = np.array([hinge.stiffness for hinge in hinges])
    compliance = np.array([_turned(solver, hinge, hinges) for hinge in hinges]).T
    root = np.sqrt(stiffness)
    largest = float(np.linalg.eigvals(root[:, None] * compliance * root).real.max(initial=0.0))
    least = float(compliance.diagonal().min(initial=1.0))
    if not (0.0 < largest < CREDIBLE and least > 0.0):
        return StiffenedLine(0.0, 0.0, 0.0, hinges)
    square = 2.0 * largest / h**2
    rates = np.array([_rate(solver, hinge) for hinge in hinges])
    damping = max(hinge.damping / hinge.stiffness for hinge in hinges)
    energy = 0.5 * float(stiffness @ rates**2) / square
    return StiffenedLine(float(np.sqrt(square)), damping * square, energy, hinges)


def swinging(
    solver: Solver, time: float, hinges: tuple[Stiffening, ...], largest: float
) -> tuple[StiffenedLine, float]:
    """Vibration of a latched line as a whole, and the longest step size (s), up to `largest`, that resolves it."""
    line, size = StiffenedLine(0.0, 0.0, 0.0, hinges), min(largest, _LONGEST_SWING)
    for _ in range(_FREQUENCY_SEARCH):
        if _can_be_made(solver, time, size):
            line = stiffened_line(solver, hinges, size)
        if line.fastest:
            break
        size *= 0.5
    return line, size


def _can_be_made(solver: Solver, time: float, size: float) -> bool:
    """Have the matrices of a step (s) in use; False where it takes a participant out of its range."""
    try:
        solver.linearize(time, size)
    except ParticipantError:
        return False
    return True


def resolving(solver: Solver, time: float, line: StiffenedLine, size: float, h: float, angle: float) -> float:
    """A step (s), up to h, in which the fastest initial vibration advances by a phase (rad).

    size (s): of the step that identified the vibration of the line. The inertia that moves at first may be much less
    than that of later vibrations, so the vibration is followed to shorter times.
    """
    found = line
    for _ in range(_FREQUENCY_SEARCH):
        if found.fastest * size < 2.0:
            break
        size = max(1.0 / found.fastest, 0.1 * size)
        if not _can_be_made(solver, time, size):
            break
        found = stiffened_line(solver, found.hinges, size)
    return angle / found.fastest if found.fastest * h > angle else h


def _turned(solver: Solver, loaded: Stiffening, hinges: Sequence[Stiffening]) -> list[float]:
    """Rotations (rad) of all hinges under a torque of 1 N.m at one, held over the step, all joints in place."""
    network = solver.network
    wrenches = np.zeros((len(network.port_names), network.width.wrench))
    wrenches[network.connection_links[loaded.connection], :6] = loaded.wrench.reshape(-1, 6)
    motions = solver.displacements(wrenches.ravel())[:, :6]
    return [
        float(hinge.rotation @ motions[network.connection_links[hinge.connection]].ravel())
        for hinge in hinges
    ]


def _rate(solver: Solver, hinge: Stiffening) -> float:
    """Present rate (rad/s) of the rotation."""
    table = hinge.rotation.reshape(-1, 6)
    ports = solver.network.connections[hinge.connection].inputs[: 13 * len(table)]
    return float(table.ravel() @ ports.reshape(-1, 13)[:, 7:].ravel())


def watched_loads(network: Network, line: StiffenedLine, energy: float) -> list[WeightedLoad]:
    """The loads of a line's hinges, weighted by an energy (J) of the line."""
    found = []
    for hinge in line.hinges:
        links = network.connection_links[hinge.connection]
        port, row = len(links) - 1, network.width.wrench * int(links[-1]) + hinge.first
        x, y, z = hinge.axis.tolist()
        weight = len(line.hinges) * line.frequency**2 / (2.0 * hinge.stiffness * energy)
        found.append(WeightedLoad(hinge.connection, port, row, (x, y, z), weight))
    return found
