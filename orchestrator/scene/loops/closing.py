"""Where bodies start: as written, and moved as little as it takes where joints between placed bodies close loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from components.contract.frames import Vector3, exponential, multiply, normalized
from components.flexible.modal import ModalData

from ..bodies import StartPose, body_model, written_poses
from ..schema import CheckedScene
from .constraints import Constraint, Matrix, Vector, constraints

_CLOSED = 1e-12
_OPEN = 1e-9
"""m, rad; what stays open by more than this is told."""
_ROUNDS = 60
_RANK = 1e-10
_LONGEST = 0.5
"""m, rad; no body moves by more in one round."""
_STAGES = 16
"""Positions on the way to where motions lead, so that loops stay on the side where they start."""


class Closed(NamedTuple):
    """Poses with the loops closed as far as they go, what stays open by connection (m or rad), how far bodies moved."""

    poses: dict[str, StartPose]
    open_by: dict[str, float]
    moved: float


def start_poses(scene: CheckedScene, points: Mapping[str, Mapping[str, Vector3]]) -> dict[str, StartPose]:
    """Poses of all bodies at the start."""
    return closed(scene, points).poses


def closed(scene: CheckedScene, points: Mapping[str, Mapping[str, Vector3]]) -> Closed:
    """Poses with all loops closed by the least displacements of placed bodies, weighted by mass and inertia."""
    return _closed(scene, points, (0.0,))


def extended(scene: CheckedScene, points: Mapping[str, Mapping[str, Vector3]]) -> Closed:
    """The same with all motions at once as far from the start as their laws lead during the scene."""
    return _closed(scene, points, np.linspace(0.0, 1.0, _STAGES + 1).tolist())


def _closed(
    scene: CheckedScene, points: Mapping[str, Mapping[str, Vector3]], shares: Sequence[float]
) -> Closed:
    """Closed with motions at these shares of their travel, one after the other."""
    start = poses = written_poses(scene, points)
    placed = [body for body in scene.bodies if body.place is not None and body.name in poses]
    held = [c for c in constraints(scene, points, poses) if _acts(c, {body.name for body in placed})]
    if not held:
        return Closed(poses, {}, 0.0)
    names = [body.name for body in placed]
    weights = np.concatenate([_weights(body_model(body, flexible=False)) for body in placed])
    for share in shares:
        now = [c._replace(distance=c.distance + share * c.travel) for c in held]
        poses = close(now, poses, names, weights)
    left = {c.connection: float(np.abs(c.rows(poses)[0]).max()) for c in now}
    moved = max(float(np.abs(np.subtract(poses[n].position, start[n].position)).max()) for n in names)
    return Closed(poses, {name: size for name, size in left.items() if not size < _OPEN}, moved)


def close(
    held: Sequence[Constraint], poses: Mapping[str, StartPose], names: Sequence[str], weights: Vector
) -> dict[str, StartPose]:
    """Poses where the constraints are fulfilled as far as they can be, by the least displacements of the named bodies.

    weights: roots of the masses and inertias that displacements are weighed with (6 a body).
    """
    found = dict(poses)
    for _ in range(_ROUNDS):
        open_by, slopes = jacobian(held, found, names)
        if np.abs(open_by).max() < _CLOSED:
            break
        step = -np.linalg.lstsq(slopes / weights, open_by, rcond=_RANK)[0] / weights
        longest = float(np.abs(step).max())
        found = displaced(found, names, step * min(1.0, _LONGEST / max(longest, 1e-300)))
    return found


def open_loops(found: Closed) -> list[str]:
    """A sentence for each connection that cannot be closed."""
    return [
        f"connection.{name}: the loop that it closes stays open by {1e3 * size:.4g} mm (or mrad) where all joints are "
        "nearest to closed; check the places of its bodies, the lengths between their points, and the start of motions"
        for name, size in found.open_by.items()
    ]


def jacobian(
    held: Sequence[Constraint], poses: Mapping[str, StartPose], names: Sequence[str]
) -> tuple[Vector, Matrix]:
    """How far all are open (rows,), and the derivatives (rows, 6 a body) by displacements of the named bodies."""
    place = {name: 6 * i for i, name in enumerate(names)}
    rows, blocks = [], []
    for one in held:
        open_by, slopes = one.rows(poses)
        block = np.zeros((open_by.size, 6 * len(names)))
        for body, slope in slopes.items():
            if body in place:
                block[:, place[body] : place[body] + 6] = slope
        rows.append(open_by)
        blocks.append(block)
    return np.concatenate(rows), np.vstack(blocks)


def displaced(poses: Mapping[str, StartPose], names: Sequence[str], step: Vector) -> dict[str, StartPose]:
    """Poses after displacements (6 a body) of the named bodies, in order."""
    result = dict(poses)
    for name, (x, y, z, turn_x, turn_y, turn_z) in zip(names, step.reshape(-1, 6).tolist(), strict=True):
        before = poses[name]
        position = (before.position[0] + x, before.position[1] + y, before.position[2] + z)
        turn = exponential((turn_x, turn_y, turn_z))
        result[name] = StartPose(position, normalized(multiply(turn, before.orientation)))
    return result


def _acts(constraint: Constraint, placed: set[str]) -> bool:
    return bool({constraint.inboard.body, constraint.outboard.body} & placed)


def _weights(model: ModalData) -> Vector:
    """Roots of mass and of the mean moment of inertia about the origin of a body, for its six displacements."""
    mass, center = model.mass, model.center_of_mass
    inertia = float(np.trace(model.inertia)) / 3.0 + mass * float(center @ center)
    weights: Vector = np.sqrt(np.array((mass,) * 3 + (inertia,) * 3))
    return weights
