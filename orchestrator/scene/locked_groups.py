"""Bodies that held hinge lines join: one rigid group each, so that what does not move costs nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from components.contract.frames import (
    Quaternion,
    conjugate,
    multiply,
    rotate,
    rotate_back,
    rotation_matrix,
    subtract,
)
from components.flexible.modal import ModalData

from .bodies import Attachment, StartPose
from .placed_scene import PlacedScene

_UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PortSite:
    """A port of a group: its connection and that one's port, the point, an arm (m) and axes in the group's frame.

    outside: whether what acts there joins nothing, and acts on the root itself.
    """

    name: str
    connection: tuple[str, str]
    point: str
    offset: tuple[float, float, float]
    orientation: Quaternion
    outside: bool = False


@dataclass(frozen=True, slots=True)
class RigidGroup:
    """A body, or several that held lines join; `root` gives its name and frame."""

    root: str
    bodies: tuple[str, ...]
    poses: Mapping[str, StartPose]
    """of every body in the root's frame"""
    sites: tuple[PortSite, ...]

    @property
    def is_joined(self) -> bool:
        """Whether it holds more than one body."""
        return len(self.bodies) > 1


def rigid_groups(
    scene: PlacedScene, found: Sequence[Attachment], poses: Mapping[str, StartPose]
) -> dict[str, RigidGroup]:
    """Every group by its root, with the ports of the connections that do not stay within it."""
    roots = scene.group_roots
    acting = _acting(found, roots)
    joining = Counter(port.connection for port in acting)
    lonely = {name for name, count in joining.items() if count == 1}
    result = {}
    for root in dict.fromkeys(roots.values()):
        bodies = tuple(body for body, r in roots.items() if r == root)
        relative = {body: _relative(poses[root], poses[body]) for body in bodies}
        own = [port for port in acting if roots[port.body] == root]
        outside = {port.connection for port in own if port.body == root} & lonely
        sites = _sites(own, scene.written_poses[root], relative, outside)
        result[root] = RigidGroup(root, bodies, relative, sites)
    return result


def _acting(found: Sequence[Attachment], roots: Mapping[str, str]) -> list[Attachment]:
    """Ports of connections between at least two groups, and of those that have one port only."""
    touched: dict[str, list[str]] = {}
    for port in found:
        touched.setdefault(port.connection, []).append(roots[port.body])
    return [
        port for port in found if len(touched[port.connection]) == 1 or len(set(touched[port.connection])) > 1
    ]


def _relative(frame: StartPose, pose: StartPose) -> StartPose:
    position = rotate_back(frame.orientation, subtract(pose.position, frame.position))
    return StartPose(position, multiply(conjugate(frame.orientation), pose.orientation))


def _sites(
    ports: Iterable[Attachment], root: StartPose, poses: Mapping[str, StartPose], outside: Collection[str]
) -> tuple[PortSite, ...]:
    """Ports of a group: `root` is where it was written, which axes go by, the other poses are in the root's frame.

    outside: connections that are, see `PortSite`.
    """
    listed, is_joined = list(ports), len(poses) > 1
    counts = [port.connection for port in listed]
    sites = []
    for port in listed:
        pose = poses[port.body]
        name = port.connection if counts.count(port.connection) == 1 else f"{port.connection}_{port.port}"
        point = joined_point(port.body, port.point) if is_joined else port.point
        turn = pose.orientation if is_joined else _UPRIGHT
        axes = turn if port.axes is None else multiply(conjugate(root.orientation), port.axes)
        own, arm = (port.connection, port.port), rotate(turn, port.offset)
        sites.append(PortSite(name, own, point, arm, axes, port.connection in outside))
    return tuple(sites)


def joined_point(body: str, point: str) -> str:
    """Name of a body's point in a group of several bodies."""
    return f"{body}.{point}"


def joined_model(group: RigidGroup, models: Mapping[str, ModalData]) -> ModalData:
    """One rigid body of all that have a model (a fixed base has none), in the root's frame.

    Mass, centre of mass and inertia add up by the parallel-axis theorem; every body's points keep their place.
    """
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    points: dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]] = {}
    for body, data in models.items():
        turn, shift = rotation_matrix(group.poses[body].orientation), np.array(group.poses[body].position)
        center = shift + turn @ data.center_of_mass
        mass += data.mass
        first += data.mass * center
        second += turn @ data.inertia @ turn.T + data.mass * _around(center)
        for name, position in zip(data.point_names, data.point_positions, strict=True):
            points[joined_point(body, name)] = shift + turn @ position
    center = first / mass
    display, faces = joined_geometry(group, models)
    return ModalData.rigid(mass, center, second - mass * _around(center), points, display, faces)


def joined_geometry(
    group: RigidGroup, models: Mapping[str, ModalData]
) -> tuple[
    np.ndarray[tuple[int, ...], np.dtype[np.float64]], np.ndarray[tuple[int, ...], np.dtype[np.int64]]
]:
    """Display nodes (D, 3) and faces (F, 4) of all bodies that have a model, in the root's frame."""
    positions, faces, count = [np.zeros((0, 3))], [np.zeros((0, 4), dtype=np.int64)], 0
    for body, data in models.items():
        if not len(data.display_positions):
            continue
        turn, shift = rotation_matrix(group.poses[body].orientation), np.array(group.poses[body].position)
        positions.append(shift + data.display_positions @ turn.T)
        faces.append(np.asarray(data.display_faces, dtype=np.int64) + count)
        count += len(data.display_positions)
    return np.concatenate(positions), np.concatenate(faces)


def _around(
    center: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Inertia (3, 3) of a unit mass at a point about the origin."""
    result: np.ndarray[tuple[int, int], np.dtype[np.float64]] = center @ center * np.eye(3) - np.outer(
        center, center
    )
    return result
