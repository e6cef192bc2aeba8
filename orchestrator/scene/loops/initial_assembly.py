"""Where bodies start: as written, and moved as little as it takes where joints between placed bodies close loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from typing import NamedTuple

import numpy as np

from components.contract.frames import (
    Vector3,
    exponential,
    multiply,
    norm,
    normalized,
    rotate,
    rotation_between,
    skew,
)
from components.flexible.modal import ModalData

from ..bodies import StartPose
from .constraints import Constraint, Matrix, Vector

_CLOSED = 1e-12
_OPEN = 1e-9
"""m, rad; what stays open by more than this is told."""
_ROUNDS = 60
RANK = 1e-10
"""Singular values against the largest below which constraints count as implied by others."""
_LONGEST = 0.5
"""m, rad; no body moves by more in one round."""


class Weight(NamedTuple):
    """What a body's displacements are weighed with: mass (kg), mean moment of inertia (kg m2), centre of mass (m)."""

    mass: float = 1.0
    inertia: float = 1.0
    center: Vector3 = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, model: ModalData) -> Weight:
        """That of a rigid body."""
        x, y, z = model.center_of_mass.tolist()
        return cls(model.mass, float(np.trace(model.inertia)) / 3.0, (x, y, z))


class Closed(NamedTuple):
    """Poses with the loops closed as far as they go, what stays open (m or rad) by connection, turns (rad) by body."""

    poses: Mapping[str, StartPose]
    open_by: dict[str, float]
    turned: dict[str, float]


def closed(
    start: Mapping[str, StartPose],
    held: Sequence[Constraint],
    weights: Mapping[str, Weight],
    stages: Sequence[tuple[float, Mapping[str, StartPose]]],
) -> Closed:
    """Poses with all loops closed by the least displacements of the weighted bodies.

    stages: shares of the travel of motions, one after the other, and the bodies that these lead there.
    """
    if not held:
        return Closed(start, {}, {})
    poses = start
    for share, led in stages:
        now = [c._replace(distance=c.distance + share * c.travel) for c in held]
        poses = close(now, {**poses, **led}, weights)
    left = {c.connection: float(np.abs(c.rows(poses)[0]).max()) for c in now}
    turned = {n: norm(rotation_between(start[n].orientation, poses[n].orientation)) for n in weights}
    return Closed(poses, {name: size for name, size in left.items() if not size < _OPEN}, turned)


def close(
    held: Sequence[Constraint], poses: Mapping[str, StartPose], weights: Mapping[str, Weight]
) -> Mapping[str, StartPose]:
    """Poses that fulfil the constraints as far as possible, by the least displacements of the weighted bodies."""
    names = list(weights)
    for _ in range(_ROUNDS):
        open_by, slopes = jacobian(held, poses, names)
        if np.abs(open_by).max() < _CLOSED:
            break
        step = -least(slopes, open_by, units([poses[name] for name in names], list(weights.values())))
        longest = float(np.abs(step).max())
        poses = displaced(poses, names, step * min(1.0, _LONGEST / max(longest, 1e-300)))
    return poses


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


def acts(constraint: Constraint, placed: Set[str]) -> bool:
    """Whether a constraint holds one of these bodies."""
    return bool({constraint.inboard.body, constraint.outboard.body} & placed)


def units(poses: Sequence[StartPose], weights: Sequence[Weight]) -> Matrix:
    """Displacements of the bodies' origins and turns (6 a body) that weigh the same, as columns.

    Displacements of centres of mass are weighed by mass and turns by the mean moment of inertia, so that what is least
    is the same wherever bodies have their origins.
    """
    unit = np.zeros((6 * len(weights), 6 * len(weights)))
    for k, (pose, weight) in enumerate(zip(poses, weights, strict=True)):
        arm = skew(np.array(rotate(pose.orientation, weight.center)))
        moving = np.block([[np.eye(3), arm], [np.zeros((3, 3)), np.eye(3)]])
        unit[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = moving / np.repeat(np.sqrt(weight[:2]), 3)
    return unit


def least(slopes: Matrix, sought: Vector, unit: Matrix) -> Vector:
    """The least of what makes a sought change (rows,); slopes: (rows, n); unit: what weighs the same, as columns."""
    found: Vector = unit @ np.linalg.lstsq(slopes @ unit, sought, rcond=RANK)[0]
    return found
