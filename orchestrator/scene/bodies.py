"""Bodies of a scene: their modal data, what is attached where, and where they stand when stowed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from components.contract.frames import (
    Quaternion,
    Vector3,
    add,
    exponential,
    multiply,
    norm,
    rotate,
    scaled,
    subtract,
)
from components.flexible.modal import ModalData
from components.flexible.point_shapes import span

from .body_tables import Base, Body, Motion
from .connection_tables import Ccl, Connection, Damper
from .damping import StructuralDamping
from .data_sheets import check_entry
from .hinge_line_tables import HingeLine
from .schema import SceneTables
from .table import Seat

if TYPE_CHECKING:
    from components.catalogue import BodyDefinition


class Attachment(NamedTuple):
    """One port of a connection and the place on a body where it sits; `key` locates it in the file.

    axes: of the port in the world, at the start; None for those of the body.
    """

    key: str
    connection: str
    port: str
    body: str
    point: str
    offset: Vector3
    axes: Quaternion | None = None


class StartPose(NamedTuple):
    """Position of a body's construction frame (m) and its quaternion."""

    position: Vector3
    orientation: Quaternion

    def place(self, point: Vector3) -> Vector3:
        """World position of a point of the body."""
        return add(self.position, rotate(self.orientation, point))


def base_model(base: Base) -> ModalData | None:
    """Modal data of a free base, None if it is fixed."""
    if base.free is None:
        return None
    free = base.free
    shape = span([*base.points.values(), free.center_of_mass])
    return ModalData.rigid(free.mass, free.center_of_mass, free.inertia, base.points, *shape)


def body_model(body: Body, flexible: bool, structural: StructuralDamping | None = None) -> ModalData:
    """Modal data of a body at the given fidelity, without the modes that are switched off.

    structural: the scene's damping of bodies that say nothing else. Modes are of first order unless the body says
    how many are of second.
    """
    if body.rigid is not None:
        rigid = body.rigid
        shape = span([*rigid.points.values(), rigid.center_of_mass])
        return ModalData.rigid(rigid.mass, rigid.center_of_mass, rigid.inertia, rigid.points, *shape)
    if not flexible:
        return _model(_written(body), None, body.masses)
    data = _model(_written(body), body.fixed_interface_modes, body.masses, body.second_order_modes or 0)
    data = data.switch_off(body.modes_off, body.frequencies_off)
    if body.damping_ratio is not None:
        return data.with_damping(body.damping_ratio)
    own = body.structural_damping or structural
    return data if own is None else data.with_structural_damping(own.time)


def body_definition(body: Body) -> BodyDefinition:
    """What a body that is not rigid was written down as; ComponentError with everything that is wrong with it."""
    return _definition(_written(body))


@dataclass(frozen=True)
class _Written:
    """How a scene says that a body is built, and when its files were written; found by the text of both."""

    text: str
    body: Body = field(compare=False)


def _written(body: Body) -> _Written:
    """Key of a body; BodyError where the catalogue lacks its entry."""
    if body.catalogue is not None:
        check_entry(body.catalogue)
    parts = body.model_dump_json(include={"panel", "frame", "beam", "imported", "rigid_twin"})
    return _Written(f"{parts} {[_stamp(path) for path in body_files(body)]}", body)


def body_files(body: Body) -> list[Path]:
    """Files of finite elements that a body is read from, also those that are read with one that it names."""
    if body.imported is None:
        return []
    from components.imported.reading import beside  # takes its time

    return [part for path in body.imported.files.values() for part in beside(Path(path))]


def _stamp(path: Path) -> tuple[int, int] | None:
    """When a file was written, and its size; None where it cannot be seen."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


@lru_cache(maxsize=32)
def _definition(written: _Written) -> BodyDefinition:
    from .body_definitions import definition  # takes its time, which no command needs that builds nothing

    return definition(written.body)


@lru_cache(maxsize=32)
def _model(
    written: _Written,
    fixed_interface_modes: int | None,
    masses: tuple[tuple[str, float], ...],
    second_order_modes: int = 0,
) -> ModalData:
    """Model of a body, its rigid twin where no number of modes is given."""
    definition = _definition(written)
    if fixed_interface_modes is None:
        return definition.rigid(masses)
    return definition.flexible(fixed_interface_modes, masses, second_order_modes)


def body_points(body: Body) -> Mapping[str, Vector3]:
    """Undeformed positions of a body's points (m) in its construction frame."""
    return point_positions(body_model(body, flexible=False))


def point_positions(data: ModalData) -> Mapping[str, Vector3]:
    """Positions (m) of the points of a model by name."""
    return dict(zip(data.point_names, map(tuple, data.point_positions.tolist()), strict=True))


def attachments(
    lines: Iterable[HingeLine],
    loops: Iterable[Ccl],
    dampers: Iterable[Damper],
    connections: Iterable[Connection],
) -> Iterator[Attachment]:
    """Every port of every connection; a damper sits where its hinge does, if there is that hinge."""
    at_hinge: dict[str, tuple[Seat, Seat]] = {}
    for line in lines:
        for hinge in line.hinges:
            inboard = Seat(body=line.inboard, point=hinge.inboard)
            outboard = Seat(body=line.outboard, point=hinge.outboard)
            at_hinge[hinge.name] = (inboard, outboard)
            key = f"hinge_line.{line.name}.hinges.{hinge.name}"
            yield _attachment(key, hinge.name, "inboard", inboard)
            yield _attachment(key, hinge.name, "outboard", outboard)
    for loop in loops:
        seats = {"pulley_1": loop.pulley_1, "pulley_2": loop.pulley_2, "guide": loop.guide}
        for port, seat in seats.items():
            if seat is not None:
                yield _attachment(f"ccl.{loop.name}", loop.name, port, seat)
    for damper in dampers:
        for port, seat in zip(("inboard", "outboard"), at_hinge.get(damper.hinge, ()), strict=False):
            yield _attachment(f"damper.{damper.name}", damper.name, port, seat)
    for connection in connections:
        for port, seat in connection.ports.items():
            key, axes = f"connection.{connection.name}.ports", connection.axes
            yield _attachment(key, connection.name, port, seat, None if axes is None else axes.quaternion)


def _attachment(
    key: str, connection: str, port: str, seat: Seat, axes: Quaternion | None = None
) -> Attachment:
    return Attachment(f"{key}.{port}", connection, port, seat.body, seat.point, seat.offset, axes)


def moved(pose: StartPose, motion: Motion, shift: float, turn: float) -> StartPose:
    """A pose after a shift (m) and a turn (rad) of a motion."""
    rotation = exponential(scaled(turn / norm(motion.rotation_axis), motion.rotation_axis))
    along = scaled(shift / norm(motion.translation_axis), motion.translation_axis)
    orientation = multiply(rotation, pose.orientation)
    pivot = add(pose.place(motion.pivot), along)
    return StartPose(subtract(pivot, rotate(orientation, motion.pivot)), orientation)


def _started(pose: StartPose, motion: Motion | None) -> StartPose:
    """Where the laws of a motion begin."""
    if motion is None:
        return pose
    shift, turn = (law.value(0.0) for law in motion.laws)
    return moved(pose, motion, shift, turn)


def written_poses(scene: SceneTables, points: Mapping[str, Mapping[str, Vector3]]) -> dict[str, StartPose]:
    """Poses along the tree of hinge lines from the base, whose frame is the world's, then of placed bodies as written.

    What follows a motion is where that begins. All frames are parallel where every hinge angle is its aligned angle.
    """
    upright = StartPose((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    poses = {scene.base.name: _started(upright, scene.base.motion)}
    waiting = list(scene.hinge_lines)
    while ready := [line for line in waiting if line.inboard in poses]:
        waiting = [line for line in waiting if line not in ready]
        for line in ready:
            inner, hinge = poses[line.inboard], line.hinges[0]
            turn = exponential(scaled(line.initial_angle - line.aligned_angle, line.axis))
            orientation = multiply(inner.orientation, turn)
            arm = rotate(orientation, points[line.outboard][hinge.outboard])
            hinge_position = inner.place(points[line.inboard][hinge.inboard])
            poses[line.outboard] = StartPose(subtract(hinge_position, arm), orientation)
    for body in scene.bodies:
        if body.place is not None:
            origin = poses[body.place.body].place(points[body.place.body][body.place.point])
            written = StartPose(add(origin, body.place.offset), body.place.orientation.quaternion)
            poses[body.name] = _started(written, body.motion)
    return poses
