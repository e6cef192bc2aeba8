"""The interface Jacobian of a coupled step: derivatives that an FMU returns, or else differences of steps.

A body's mobility is d(motion at the end of the step) / d(held wrench); a connection's stiffness is
d(mean wrench) / d(motion at the end of the step). Motions are counted per port as 12 numbers: translation,
rotation vector, velocity, angular velocity, world axes. Both are nearly constant in axes that turn with
the first port, for a given step size: a probed matrix is turned along until the iteration stops
contracting.

Derivatives of an FMU are those of the discrete step it has just made, by the inputs it was made with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from components import left_product, rotation_matrix

from ..fmu import FmuParticipant
from ..participant import Participant, Vector
from . import engine

Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]

_MOTION_PROBE = np.array([1e-7] * 6 + [1e-6] * 6)
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


def mobility_of(body: Participant, ports: int, time: float, h: float) -> Probe:
    """Mobility of a body (12 ports, 6 ports) about the step from its saved state, which it has just made."""
    if _is_differentiable(body):
        return Probe(engine.mobility(body, ports), first_port_axes(body.outputs))
    return probe_mobility(body, ports, time, h)


def stiffness_of(connection: Participant, ports: int, time: float, h: float) -> Probe:
    """Stiffness of a connection (6 ports, 12 ports) about the step from its saved state that it has just made."""
    if _is_differentiable(connection):
        return Probe(engine.stiffness(connection, ports), first_port_axes(connection.inputs))
    return probe_stiffness(connection, ports, time, h)


def _is_differentiable(participant: Participant) -> TypeGuard[FmuParticipant]:
    return (
        isinstance(participant, FmuParticipant)
        and participant.directional_derivatives
        and engine.library() is not None
    )


def probe_mobility(body: Participant, ports: int, time: float, h: float) -> Probe:
    """Mobility of a body (12 ports, 6 ports) about its present inputs; it ends stepped as before."""
    wrenches = body.inputs[: 6 * ports]
    held = wrenches.copy()
    reference = stepped(body, time, h)[: 13 * ports].copy()
    axes = first_port_axes(reference)
    amplitude = min(_DISPLACEMENT_PROBE / h**2, _VELOCITY_PROBE / h)
    matrix = np.empty((12 * ports, 6 * ports))
    for column in range(6 * ports):
        wrenches[column] = held[column] + amplitude
        matrix[:, column] = _difference(stepped(body, time, h)[: 13 * ports], reference) / amplitude
        wrenches[column] = held[column]
    stepped(body, time, h)
    return Probe(matrix, axes)


def probe_stiffness(connection: Participant, ports: int, time: float, h: float) -> Probe:
    """Stiffness of a connection (6 ports, 12 ports) about its present inputs; it ends stepped as before."""
    motion = connection.inputs[: 13 * ports]
    held = motion.copy()
    axes = first_port_axes(held)
    reference = stepped(connection, time, h)[: 6 * ports].copy()
    matrix = np.empty((6 * ports, 12 * ports))
    for column in range(12 * ports):
        port, coordinate = divmod(column, 12)
        _displace(motion[13 * port : 13 * port + 13], coordinate, _MOTION_PROBE[coordinate])
        changed = stepped(connection, time, h)[: 6 * ports]
        matrix[:, column] = (changed - reference) / _MOTION_PROBE[coordinate]
        motion[:] = held
    stepped(connection, time, h)
    return Probe(matrix, axes)


def stepped(participant: Participant, time: float, h: float) -> Vector:
    """Outputs after a step from the saved state with the inputs as they are."""
    participant.restore()
    participant.write()
    participant.do_step(time, h)
    participant.read()
    return participant.outputs


def _displace(motion: Vector, coordinate: int, amount: float) -> None:
    """Change one of the 12 coordinates of a port's motion (13 numbers) in place."""
    if coordinate < 3:
        motion[coordinate] += amount
    elif coordinate < 6:
        half = [0.0, 0.0, 0.0]
        half[coordinate - 3] = 0.5 * amount
        turn = (np.sqrt(1.0 - 0.25 * amount * amount), half[0], half[1], half[2])
        motion[3:7] = left_product(turn) @ motion[3:7]
    else:
        motion[coordinate + 1] += amount


def _difference(motion: Vector, reference: Vector) -> Vector:
    """Difference of two flat arrays of port motions in the 12 coordinates of each port."""
    a, b = motion.reshape(-1, 13), reference.reshape(-1, 13)
    result = np.empty((len(a), 12))
    result[:, 0:3] = a[:, 0:3] - b[:, 0:3]
    for k in range(len(a)):
        w, x, y, z = b[k, 3:7].tolist()
        turn = left_product((a[k, 3], a[k, 4], a[k, 5], a[k, 6])) @ np.array((w, -x, -y, -z))
        result[k, 3:6] = 2.0 * turn[1:] * np.sign(turn[0])
    result[:, 6:12] = a[:, 7:13] - b[:, 7:13]
    return result.ravel()
