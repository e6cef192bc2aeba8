"""Effective inertia of a hinge line as it latches: 1 / (b' M^-1 b), M the mass matrix, b the opening of the line.

Of the deployed array with rigid bodies; lines further out have latched before, lines nearer the base have not. For a
line between two free bodies it is J1 J2 / (J1 + J2).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from components.contract.component import Vector
from components.contract.frames import Vector3, rotate, rotation_matrix, skew
from components.flexible.modal import ModalData

from .bodies import StartPose
from .hinge_line_tables import HingeLine


def line_inertia(
    lines: Sequence[HingeLine],
    carrying: Mapping[str, Collection[str]],
    models: Mapping[str, ModalData],
    poses: Mapping[str, StartPose],
    points: Mapping[str, Mapping[str, Vector3]],
    has_free_base: bool,
) -> float:
    """Effective inertia (kg.m2) of the first of the lines that move; LinAlgError where the mass matrix is singular.

    carrying: names of the lines that carry a body, for every body with a model. poses: of the deployed array.
    """
    axes = [_axis(line, poses, points) for line in lines]
    mass = np.zeros((len(lines) + 6, len(lines) + 6))
    for name, data in models.items():
        columns = [axis * (line.name in carrying[name]) for line, axis in zip(lines, axes, strict=True)]
        mass += _kinetic(data, poses[name], np.array(columns))
    if not has_free_base:
        mass = mass[: len(lines), : len(lines)]
    return float(1.0 / np.linalg.inv(mass)[0, 0])


def _axis(
    line: HingeLine, poses: Mapping[str, StartPose], points: Mapping[str, Mapping[str, Vector3]]
) -> Vector:
    """Axis and a point of it (6,) in world axes."""
    inner = poses[line.inboard]
    axis = rotate(inner.orientation, line.axis)
    return np.array((*axis, *inner.place(points[line.inboard][line.hinges[0].inboard])))


def _kinetic(data: ModalData, pose: StartPose, turns: Vector) -> Vector:
    """Mass matrix (n + 6, n + 6) of a body by the rates of n lines (n, 6), see `_axis`, and the motion of the base."""
    axes = rotation_matrix(pose.orientation)
    center = np.array(pose.position) + axes @ data.center_of_mass
    jacobian = np.zeros((6, len(turns) + 6))
    jacobian[:3, : len(turns)] = np.cross(turns[:, :3], center - turns[:, 3:]).T
    jacobian[3:, : len(turns)] = turns[:, :3].T
    jacobian[:, len(turns) :] = np.eye(6)
    jacobian[:3, len(turns) + 3 :] = -skew(center)
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = data.mass * np.eye(3)
    inertia[3:, 3:] = axes @ data.inertia @ axes.T
    result: Vector = jacobian.T @ inertia @ jacobian
    return result
