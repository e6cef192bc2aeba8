"""A flexible body without inertia invariants: point masses whose motion is differentiated node by node.

Coordinates: position r of the undeformed centre of mass, a quaternion, modal coordinates eta. Velocities:
v = (r' world, omega body, eta'). Every node is at x = r + A (s + phi eta), so its velocity is J v and its
acceleration J v' + g, g = A (omega x (omega x (s + phi eta)) + 2 omega x phi eta'). Jourdain's principle over
the nodes gives M(q) v' = Q - sum m J^T g with M(q) = sum m J^T J, built anew from the nodes at every
evaluation. Nothing here knows about momenta as states, mean axes or inertia invariants.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class PortLoad:
    """A force and a torque, held in world axes, at a rigid arm `offset` (body axes) from a node."""

    node: int
    offset: tuple[float, float, float]
    force: tuple[float, float, float]
    torque: tuple[float, float, float]


@dataclass(frozen=True)
class NodalBody:
    """Point masses (Q,) at arms (Q, 3) from their centre, shapes (Q, 3, M) and their rotations (Q, 3, M)."""

    masses: Vector
    arms: Vector
    shapes: Vector
    turns: Vector
    frequency: Vector
    damping_ratio: Vector

    @property
    def modes(self) -> int:
        """Number of modes M."""
        return self.frequency.size


@dataclass(frozen=True)
class Motion:
    """Coordinates and velocities of one instant."""

    position: Vector
    orientation: Vector
    eta: Vector
    velocity: Vector
    spin: Vector
    rate: Vector

    def pack(self) -> Vector:
        """As one array, the order of `unpack`."""
        return np.concatenate(
            (self.position, self.orientation, self.eta, self.velocity, self.spin, self.rate)
        )


def unpack(y: Vector, modes: int) -> Motion:
    """From the array."""
    parts = np.split(y, np.cumsum((3, 4, modes, 3, 3)))
    return Motion(*parts)


def cross_matrix(v: Vector) -> Vector:
    """Matrices (..., 3, 3) with cross_matrix(v) w = v x w."""
    zero = np.zeros(v.shape[:-1])
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    rows = (np.stack((zero, -z, y), -1), np.stack((z, zero, -x), -1), np.stack((-y, x, zero), -1))
    return np.stack(rows, -2)


def attitude(orientation: Vector) -> Vector:
    """Rotation matrix of a scalar-first quaternion of any length."""
    return Rotation.from_quat(np.roll(orientation, -1)).as_matrix()


def left_jacobian(v: Vector) -> Vector:
    """The matrix that takes the rate of a rotation vector to angular velocity in the outer axes, closed form."""
    angle = np.linalg.norm(v)
    k = cross_matrix(v)
    if angle < 1e-4:
        return np.eye(3) + k / 2 + k @ k / 6 + k @ k @ k / 24
    return np.eye(3) + (1 - np.cos(angle)) / angle**2 * k + (angle - np.sin(angle)) / angle**3 * (k @ k)


def node_jacobians(body: NodalBody, motion: Motion) -> Vector:
    """J (Q, 3, 6 + M): velocity of every node from (r', omega, eta')."""
    a = attitude(motion.orientation)
    arms = body.arms + body.shapes @ motion.eta
    still = np.broadcast_to(np.eye(3), (len(arms), 3, 3))
    return np.concatenate((still, -a @ cross_matrix(arms), a @ body.shapes), axis=2)


def mass_matrix(body: NodalBody, motion: Motion) -> Vector:
    """M(q) (6 + M, 6 + M) = sum m J^T J."""
    jacobian = node_jacobians(body, motion)
    columns = jacobian.shape[2]
    return (body.masses[:, None, None] * jacobian).reshape(-1, columns).T @ jacobian.reshape(-1, columns)


def generalised_load(body: NodalBody, motion: Motion, load: PortLoad) -> Vector:
    """Generalised force (6 + M,) of a port load: the power it has at unit velocities."""
    a = attitude(motion.orientation)
    force, torque = np.array(load.force) @ a, np.array(load.torque) @ a
    shape = body.shapes[load.node] - cross_matrix(np.array(load.offset)) @ body.turns[load.node]
    arm = body.arms[load.node] + np.array(load.offset) + shape @ motion.eta
    turn = left_jacobian(body.turns[load.node] @ motion.eta) @ body.turns[load.node]
    return np.concatenate((load.force, np.cross(arm, force) + torque, force @ shape + torque @ turn))


def derivative(body: NodalBody, loads: Sequence[PortLoad], y: Vector) -> Vector:
    """Time derivative of a packed motion."""
    motion = unpack(y, body.modes)
    a = attitude(motion.orientation)
    arms, relative = body.arms + body.shapes @ motion.eta, body.shapes @ motion.rate
    w = motion.spin
    centripetal = (np.cross(w, np.cross(w, arms)) + 2.0 * np.cross(w, relative)) @ a.T
    flat = node_jacobians(body, motion).reshape(centripetal.size, -1)
    weighted = np.repeat(body.masses, 3)[:, None] * flat
    right = -weighted.T @ centripetal.ravel()
    right[6:] -= body.frequency**2 * motion.eta + 2.0 * body.damping_ratio * body.frequency * motion.rate
    for load in loads:
        right += generalised_load(body, motion, load)
    acceleration = np.linalg.solve(weighted.T @ flat, right)
    s, x = motion.orientation[0], motion.orientation[1:]
    turn = 0.5 * np.concatenate(((-x @ w,), s * w + np.cross(x, w)))
    return np.concatenate((motion.velocity, turn, motion.rate, acceleration))


def integrate(
    body: NodalBody, loads: Sequence[PortLoad], start: Motion, until: float, tolerance: float = 1e-11
) -> Motion:
    """The motion at `until` (s), loads held; explicit Runge-Kutta of order 8 that resolves every mode."""
    solution = solve_ivp(
        lambda t, y: derivative(body, loads, y),
        (0.0, until),
        start.pack(),
        method="DOP853",
        rtol=tolerance,
        atol=1e-2 * tolerance,
    )
    if not solution.success:
        raise RuntimeError(solution.message)
    end = unpack(solution.y[:, -1], body.modes)
    unit = end.orientation / np.linalg.norm(end.orientation)
    return Motion(end.position, unit, end.eta, end.velocity, end.spin, end.rate)


def momenta_and_energy(body: NodalBody, motion: Motion) -> tuple[Vector, Vector, float]:
    """Linear momentum, angular momentum about the world origin, kinetic and strain energy, summed over nodes."""
    a = attitude(motion.orientation)
    arms = (body.arms + body.shapes @ motion.eta) @ a.T
    velocities = node_jacobians(body, motion) @ np.concatenate((motion.velocity, motion.spin, motion.rate))
    momentum = body.masses[:, None] * velocities
    kinetic = 0.5 * float(np.sum(momentum * velocities))
    strain = 0.5 * float(np.sum((body.frequency * motion.eta) ** 2))
    return momentum.sum(0), np.cross(motion.position + arms, momentum).sum(0), kinetic + strain
