"""Effective inertia of a hinge line as it latches: 1 / (b' M^-1 b), M the mass matrix, b the opening of the line.

Of the deployed array with rigid bodies; lines further out have latched before, lines nearer the base have not. For a
line between two free bodies it is J1 J2 / (J1 + J2).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from components.contract.component import Vector
from components.contract.frames import Vector3, rotate, rotation_matrix, skew
from components.flexible.modal import ModalData

from ..scene.bodies import StartPose, base_model, body_model, scene_points, with_angles
from ..scene.hinge_line_tables import HingeLine
from ..scene.loops.initial_assembly import start_poses
from ..scene.schema import CheckedScene
from ..scene.table import SceneError


def effective_inertia(scene: CheckedScene, line: HingeLine) -> float:
    """Effective inertia (kg.m2) of a line of the scene in the deployed configuration; SceneError where it has none."""
    poses = _deployed(scene)
    free = [one for one in scene.lines_inward(line.outboard) if not one.held or one.name == line.name]
    turns = {one.name: _turn(one, poses, scene_points(scene)) for one in free}
    mass = np.zeros((len(free) + 6, len(free) + 6))
    for name, data in _masses(scene).items():
        moved = {one.name for one in scene.lines_inward(name)}
        columns = [turns[one.name] * (one.name in moved) for one in free]
        mass += _kinetic(data, poses[name], np.array(columns))
    if scene.base.free is None:
        mass = mass[: len(free), : len(free)]
    try:
        return float(1.0 / np.linalg.inv(mass)[0, 0])
    except np.linalg.LinAlgError:
        raise SceneError(
            [
                f"{scene.file}: hinge_line.{line.name}.latch.effective_inertia: cannot be computed from masses and "
                "inertias of such different sizes; check these, or set it"
            ]
        ) from None


def _deployed(scene: CheckedScene) -> Mapping[str, StartPose]:
    angles = {one.name: one.initial_angle if one.held else one.deployed_angle for one in scene.hinge_lines}
    return start_poses(with_angles(scene, angles), scene_points(scene))


def _masses(scene: CheckedScene) -> dict[str, ModalData]:
    """Rigid models of all bodies that hinge lines carry, and of a free base."""
    found = {body.name: body_model(body, flexible=False) for body in scene.bodies if body.place is None}
    base = base_model(scene.base)
    return found if base is None else {scene.base.name: base, **found}


def _turn(
    line: HingeLine, poses: Mapping[str, StartPose], points: Mapping[str, Mapping[str, Vector3]]
) -> Vector:
    """Axis and a point of it (6,) in world axes."""
    inner = poses[line.inboard]
    axis = rotate(inner.orientation, line.axis)
    return np.array((*axis, *inner.place(points[line.inboard][line.hinges[0].inboard])))


def _kinetic(data: ModalData, pose: StartPose, turns: Vector) -> Vector:
    """Mass matrix (n + 6, n + 6) of a body by the rates of n lines (n, 6), see `_turn`, and the motion of the base."""
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
