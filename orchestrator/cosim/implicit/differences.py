"""The interface Jacobian of a participant that cannot tell its own, by differences of steps from its saved state."""

from __future__ import annotations

import numpy as np

from components import left_product

from ..participant import Matrix, Participant, Vector
from ..ports import PortPlaces, Width

_POSE_CHANGE, _RATE_CHANGE = 1e-7, 1e-6
_DISPLACEMENT = 1e-5
_VELOCITY = 1e-3
"""Largest motion (m, rad) and rate that a changed wrench causes."""


def jacobian_by_differences(
    participant: Participant, places: PortPlaces, width: Width, time: float, h: float
) -> Matrix:
    """See `Participant.interface_jacobian`: about the present inputs; the participant ends stepped as before."""
    differences = _mobility if places.side == "body" else _stiffness
    matrix = differences(participant, places, width, time, h)
    stepped(participant, time, h)
    return matrix


def _mobility(body: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Matrix:
    held = body.inputs.copy()
    reference = stepped(body, time, h).copy()
    amplitude = min(_DISPLACEMENT / h**2, _VELOCITY / h)
    matrix: Matrix = np.zeros(width.jacobian(places))
    for column in range(matrix.shape[1]):
        port, k = divmod(column, width.wrench)
        first = 0 if k < 6 else places.slopes
        if first is None:
            continue
        place = first + 6 * port + k % 6
        body.inputs[place] = held[place] + amplitude
        changed = stepped(body, time, h)
        matrix[:, column] = _difference(changed, reference, places, width) / amplitude
        body.inputs[place] = held[place]
    return matrix


def _stiffness(connection: Participant, places: PortPlaces, width: Width, time: float, h: float) -> Matrix:
    held = connection.inputs.copy()
    reference = _wrenches(stepped(connection, time, h), places, width)
    matrix: Matrix = np.zeros(width.jacobian(places))
    for column in range(matrix.shape[1]):
        amount = _displaced(connection.inputs, column, places, width)
        if amount:
            changed = _wrenches(stepped(connection, time, h), places, width)
            matrix[:, column] = (changed - reference) / amount
            connection.inputs[:] = held
    return matrix


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
        motion[coordinate] += _POSE_CHANGE
    elif coordinate < 6:
        half = [0.0, 0.0, 0.0]
        half[coordinate - 3] = 0.5 * _POSE_CHANGE
        turn = (np.sqrt(1.0 - 0.25 * _POSE_CHANGE * _POSE_CHANGE), half[0], half[1], half[2])
        motion[3:7] = left_product(turn) @ motion[3:7]
    elif coordinate >= rates:
        motion[7 + coordinate - rates] += _RATE_CHANGE
        return _RATE_CHANGE
    elif places.moments is None:
        return 0.0
    else:
        inputs[places.moments + 6 * port + coordinate - 6] += _POSE_CHANGE
    return _POSE_CHANGE


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
