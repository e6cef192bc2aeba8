"""Motions of ports made up for tests, and the work wrenches do over a step between two of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Vector = NDArray[np.float64]


def port_motion(
    position: Sequence[float] = (0.0, 0.0, 0.0),
    turn: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: Sequence[float] = (0.0, 0.0, 0.0),
) -> Vector:
    """The 13 numbers of a port's motion; `turn` is a rotation vector."""
    quaternion = np.roll(Rotation.from_rotvec(turn).as_quat(), 1)
    return np.concatenate((position, quaternion, velocity, spin))


def inputs(component: object, *motions: Vector, **commands: float) -> Vector:
    """Input array of a connection from the motions of its ports and its discrete inputs."""
    layout = component.input_layout  # type: ignore[attr-defined]
    u: Vector = layout.start_values()
    joined = np.concatenate(motions)
    u[: joined.size] = joined
    for name, value in commands.items():
        u[layout[name]] = value
    return u


def wrenches(outputs: Vector, ports: int) -> tuple[Vector, Vector]:
    """Forces (ports, 3) and torques (ports, 3) from a connection's outputs."""
    table = outputs[: 6 * ports].reshape(ports, 6)
    return table[:, :3], table[:, 3:]


def resultant(outputs: Vector, before: Vector, after: Vector, ports: int, about: Sequence[float]) -> Vector:
    """Sum of force and of moment (6,) about a point, ports at the mean of their places at both ends."""
    force, torque = wrenches(outputs, ports)
    places = 0.5 * (before + after)[: 13 * ports].reshape(ports, 13)[:, :3] - np.asarray(about)
    return np.concatenate((force.sum(0), (torque + np.cross(places, force)).sum(0)))


def work(outputs: Vector, before: Vector, after: Vector, ports: int) -> float:
    """Work of mean wrenches on the bodies, see `works`."""
    return float(np.sum(works(outputs, before, after, ports)))


def works(outputs: Vector, before: Vector, after: Vector, ports: int) -> Vector:
    """Work at each port (ports, 2): force times change of place, and torque times rotation vector."""
    force, torque = wrenches(outputs, ports)
    a, b = (u[: 13 * ports].reshape(ports, 13) for u in (before, after))
    turns = [
        (Rotation.from_quat(np.roll(q, -1)) * Rotation.from_quat(np.roll(p, -1)).inv()).as_rotvec()
        for p, q in zip(a[:, 3:7], b[:, 3:7], strict=True)
    ]
    return np.stack(
        [np.sum(force * (b - a)[:, :3], axis=1), np.sum(torque * np.array(turns), axis=1)], axis=1
    )


def slopes(component: object, outputs: Vector, ports: int) -> tuple[Vector, Vector]:
    """Slopes of forces (ports, 3) and of torques (ports, 3), the last of a connection's outputs."""
    size = component.output_layout.size  # type: ignore[attr-defined]
    table = outputs[size - 6 * ports :].reshape(ports, 6)
    return table[:, :3], table[:, 3:]


def slope_work(component: object, outputs: Vector, u: Vector, ports: int) -> float:
    """Work of the slopes of wrenches on the first moments of the ports' velocities, the last inputs."""
    force, torque = slopes(component, outputs, ports)
    moments = u[u.size - 6 * ports :].reshape(ports, 6)
    return float(np.sum(force * moments[:, :3]) + np.sum(torque * moments[:, 3:]))


def angular_momentum(
    component: object, outputs: Vector, before: Vector, after: Vector, ports: int, about: Sequence[float]
) -> Vector:
    """Resultant (6,) about a point over a step, with what slopes of forces do as the ports move."""
    force, _ = slopes(component, outputs, ports)
    moved = (after - before)[: 13 * ports].reshape(ports, 13)[:, :3]
    result = resultant(outputs, before, after, ports, about)
    result[3:] += np.cross(moved / 6.0, force).sum(0)
    return result


def with_moments(component: object, u: Vector, moments: Vector) -> Vector:
    """The inputs with first moments of velocity and angular velocity of the ports, (ports, 6)."""
    result = u.copy()
    result[result.size - moments.size :] = moments.ravel()
    return result
