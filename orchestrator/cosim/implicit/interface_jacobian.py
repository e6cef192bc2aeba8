"""The interface Jacobian of a coupled step: derivatives that an FMU returns, or else differences of steps.

A body's mobility is d(motion at the end of the step) / d(wrench); a connection's stiffness is
d(wrench) / d(motion at the end of the step), wrenches and motions counted per port as `network.Width` says. What a
participant of order 2 does not have in a network of order 4 are zeros. Both are nearly constant in axes that turn
with the first port, for a given step size: a probed matrix is turned along until the iteration stops contracting.

Derivatives of an FMU are those of the discrete step it has just made, by the inputs it was made with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from components import left_product, rotation_matrix

from ..fmu import FmuParticipant
from ..network import Matrix, PortPlaces, Width
from ..participant import Participant, Vector
from . import engine

_POSE_PROBE, _RATE_PROBE = 1e-7, 1e-6
_DISPLACEMENT_PROBE = 1e-5
_VELOCITY_PROBE = 1e-3


@dataclass(frozen=True, slots=True)
class Probe:
    """A probed matrix and the orientation (3, 3) of the participant's first port at that instant."""

    matrix: Matrix
    axes: Matrix

    def turned(self, axes: Matrix) -> Matrix:
        """The matrix, turned with the first port from `self.axes` to `axes`; all its vectors are 3-vectors."""
        turn = axes @ self.axes.T
        rows, columns = self.matrix.shape
        rows_turned = turn @ self.matrix.reshape(rows // 3, 3, columns)
        result: Matrix = (rows_turned.reshape(rows, columns // 3, 3) @ turn.T).reshape(rows, columns)
        return result


def first_port_axes(motion: Vector) -> Matrix:
    """Rotation matrix of the first port of a flat array of port motions."""
    w, x, y, z = motion[3:7].tolist()
    axes: Matrix = rotation_matrix((w, x, y, z))
    return axes


def mobility_of(body: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Probe:
    """Mobility of a body (coordinates, wrenches) about the step from its saved state, which it has just made."""
    if _is_differentiable(body):
        return Probe(engine.mobility(body, places, width), first_port_axes(body.outputs))
    return probe_mobility(body, places, width, time, h)


def stiffness_of(connection: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Probe:
    """Stiffness of a connection (wrenches, coordinates) about the step from its saved state that it has just made."""
    if _is_differentiable(connection):
        return Probe(engine.stiffness(connection, places, width), first_port_axes(connection.inputs))
    return probe_stiffness(connection, places, width, time, h)


def _is_differentiable(participant: Participant) -> TypeGuard[FmuParticipant]:
    return (
        isinstance(participant, FmuParticipant)
        and participant.directional_derivatives
        and engine.library() is not None
    )


def probe_mobility(body: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Probe:
    """Mobility of a body (coordinates, wrenches) about its present inputs; it ends stepped as before."""
    held = body.inputs.copy()
    reference = stepped(body, time, h).copy()
    axes = first_port_axes(reference)
    amplitude = min(_DISPLACEMENT_PROBE / h**2, _VELOCITY_PROBE / h)
    matrix = np.zeros((width.coordinates * places.ports, width.wrench * places.ports))
    for column in range(width.wrench * places.ports):
        port, k = divmod(column, width.wrench)
        first = 0 if k < 6 else places.slopes
        if first is None:
            continue
        place = first + 6 * port + k % 6
        body.inputs[place] = held[place] + amplitude
        changed = stepped(body, time, h)
        matrix[:, column] = _difference(changed, reference, places, width) / amplitude
        body.inputs[place] = held[place]
    stepped(body, time, h)
    return Probe(matrix, axes)


def probe_stiffness(
    connection: Participant, places: PortPlaces, width: Width, time: float, h: float
) -> Probe:
    """Stiffness of a connection (wrenches, coordinates) about its present inputs; it ends stepped as before."""
    held = connection.inputs.copy()
    axes = first_port_axes(held)
    reference = _wrenches(stepped(connection, time, h), places, width)
    matrix = np.zeros((width.wrench * places.ports, width.coordinates * places.ports))
    for column in range(width.coordinates * places.ports):
        amount = _displaced(connection.inputs, column, places, width)
        if amount:
            changed = _wrenches(stepped(connection, time, h), places, width)
            matrix[:, column] = (changed - reference) / amount
            connection.inputs[:] = held
    stepped(connection, time, h)
    return Probe(matrix, axes)


def stepped(participant: Participant, time: float, h: float) -> Vector:
    """Outputs after a step from the saved state with the inputs as they are."""
    participant.restore()
    participant.write()
    participant.do_step(time, h)
    participant.read()
    return participant.outputs


def _displaced(inputs: Vector, column: int, places: PortPlaces, width: Width) -> float:
    """Change one coordinate of the motions in a connection's inputs; by how much, 0 for one it does not have."""
    port, coordinate = divmod(column, width.coordinates)
    motion, rates = inputs[13 * port : 13 * port + 13], width.coordinates - 6
    if coordinate < 3:
        motion[coordinate] += _POSE_PROBE
    elif coordinate < 6:
        half = [0.0, 0.0, 0.0]
        half[coordinate - 3] = 0.5 * _POSE_PROBE
        turn = (np.sqrt(1.0 - 0.25 * _POSE_PROBE * _POSE_PROBE), half[0], half[1], half[2])
        motion[3:7] = left_product(turn) @ motion[3:7]
    elif coordinate >= rates:
        motion[7 + coordinate - rates] += _RATE_PROBE
        return _RATE_PROBE
    elif places.moments is None:
        return 0.0
    else:
        inputs[places.moments + 6 * port + coordinate - 6] += _POSE_PROBE
    return _POSE_PROBE


def _wrenches(outputs: Vector, places: PortPlaces, width: Width) -> Vector:
    """Wrenches, with their slopes, of a connection's outputs."""
    result = np.zeros((places.ports, width.wrench))
    result[:, :6] = outputs[: 6 * places.ports].reshape(-1, 6)
    if places.slopes is not None:
        result[:, 6:] = outputs[places.slopes : places.slopes + 6 * places.ports].reshape(-1, 6)
    return result.ravel()


def _difference(outputs: Vector, reference: Vector, places: PortPlaces, width: Width) -> Vector:
    """Difference of two outputs of a body in the coordinates of its ports."""
    a, b = (values[: 13 * places.ports].reshape(-1, 13) for values in (outputs, reference))
    result = np.zeros((places.ports, width.coordinates))
    result[:, 0:3] = a[:, 0:3] - b[:, 0:3]
    for k in range(places.ports):
        w, x, y, z = b[k, 3:7].tolist()
        turn = left_product((a[k, 3], a[k, 4], a[k, 5], a[k, 6])) @ np.array((w, -x, -y, -z))
        result[k, 3:6] = 2.0 * turn[1:] * np.sign(turn[0])
    result[:, -6:] = a[:, 7:13] - b[:, 7:13]
    if places.moments is not None:
        of_moments = slice(places.moments, places.moments + 6 * places.ports)
        result[:, 6:12] = (outputs[of_moments] - reference[of_moments]).reshape(-1, 6)
    return result.ravel()
