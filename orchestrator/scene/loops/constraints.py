"""Constraints of joints between placed bodies, with their derivatives by small displacements of the bodies.

A displacement of a body is (translation of its origin, rotation vector), world axes, m and rad.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from components.contract.frames import (
    Quaternion,
    Vector3,
    add,
    conjugate,
    frame_with_x_along,
    multiply,
    rotate,
    rotate_back,
    rotation_matrix,
    rotation_vector,
    skew,
    subtract,
    swing_twist,
)
from components.numerics.motion_law import MotionLaw
from components.point_motion import PointMotion

from ..bodies import StartPose
from ..component_connections import component_values, first_number
from ..connection_tables import Connection
from ..hinge_line_tables import HingeLine
from ..joint_presets import CONSTRAINED, DISTANCE

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]
_AXES = ("x", "y", "z")
_NO_TURN: Quaternion = (1.0, 0.0, 0.0, 0.0)
_SAMPLES = 257  # times where a law is looked at beside its breaks


class Seated(NamedTuple):
    """A port: its body, its place and its axes on that body (m, quaternion)."""

    body: str
    arm: Vector3
    axes: Quaternion


class Constraint(NamedTuple):
    """What a connection holds: along and about the axes of its inboard port (each 0 or 1); a distance (m) it commands.

    driven: it is a motion, not a joint. travel: the farthest (m) that its law leads from there during the scene. rate:
    (m/s) that it commands at the start. between: `along` x alone, which has the direction from port to port.
    """

    connection: str
    inboard: Seated
    outboard: Seated
    along: Vector3
    about: Vector3
    distance: float
    driven: bool
    travel: float = 0.0
    rate: float = 0.0
    between: bool = False

    def names(self) -> list[str]:
        """One a row."""
        if self.between:
            return [f"{self.connection}: distance"]
        held = [(f"along {axis}", is_held) for axis, is_held in zip(_AXES, self.along, strict=True)]
        held += [(f"about {axis}", is_held) for axis, is_held in zip(_AXES, self.about, strict=True)]
        return [f"{self.connection}: {text}" for text, is_held in held if is_held]

    def rows(self, poses: Mapping[str, StartPose]) -> tuple[Vector, dict[str, Matrix]]:
        """How far it is open (rows,), and the derivatives (rows, 6) by the displacements of both bodies."""
        a, b = poses[self.inboard.body], poses[self.outboard.body]
        arm_a, arm_b = rotate(a.orientation, self.inboard.arm), rotate(b.orientation, self.outboard.arm)
        gap = subtract(add(b.position, arm_b), add(a.position, arm_a))
        frame = multiply(a.orientation, self.inboard.axes)
        if self.between and any(gap):
            frame = frame_with_x_along(gap)
        offset = np.array(rotate_back(frame, gap)) - (self.distance, 0.0, 0.0)
        relative = multiply(conjugate(frame), multiply(b.orientation, self.outboard.axes))
        back = rotation_matrix(frame).T
        # the second body as it moves, and the first as it carries the frame along
        moved_b = np.hstack((back, -back @ skew(np.array(arm_b))))
        moved_a = np.hstack((-back, back @ skew(np.array(arm_a) + np.array(gap))))
        turned_b = np.hstack((np.zeros((3, 3)), self._turning(relative) @ back))
        kept = np.array((*self.along, *self.about)) > 0.5
        open_by = np.concatenate((offset, self._turn(relative)))[kept]
        return open_by, {
            self.inboard.body: np.vstack((moved_a, -turned_b))[kept],
            self.outboard.body: np.vstack((moved_b, turned_b))[kept],
        }

    def _turn(self, relative: Quaternion) -> Vector:
        """Rotation of the outboard port that a joint may hold: all of it, or that of its line."""
        if self.about[0]:
            return np.array(rotation_vector(relative))
        _, y, z = swing_twist(relative)
        return np.array((0.0, y, z))

    def _turning(self, relative: Quaternion) -> Matrix:
        """Directions (rows, inboard axes) about which `_turn` changes with a small rotation.

        A line that may tilt about one axis across it is held about the normal of both, as in a universal joint.
        """
        directions = np.eye(3)
        if self.about in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
            line = np.array(rotate(relative, (1.0, 0.0, 0.0)))
            _, y, z = np.eye(3)
            directions[1:] = np.cross(z, line), np.cross(line, y)
        return directions


def constraints(
    connections: Iterable[Connection],
    points: Mapping[str, Mapping[str, Vector3]],
    written: Mapping[str, StartPose],
    until: float,
) -> Iterator[Constraint]:
    """Of joints with a preset, and of point motions at the start; axes count in poses as written.

    until: end (s) of the laws of motions.
    """
    for connection in connections:
        is_motion = connection.kind == PointMotion.kind
        if connection.preset == DISTANCE:
            yield _rod(connection, points)
            continue
        if not (is_motion or connection.preset in CONSTRAINED):
            continue
        line = _line(connection)
        inboard, outboard = (
            _seated(connection, port, points, written, line) for port in ("inboard", "outboard")
        )
        if is_motion:
            along, about = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
            commanded = _commanded(connection, until)
        else:
            (along, about), commanded = _held(connection), (0.0, 0.0, 0.0)
        if any((*along, *about)):
            distance, travel, rate = commanded
            yield Constraint(
                connection.name, inboard, outboard, along, about, distance, is_motion, travel, rate
            )


def hinge_constraints(
    lines: Iterable[HingeLine], points: Mapping[str, Mapping[str, Vector3]]
) -> Iterator[Constraint]:
    """Of the hinges of hinge lines, by their kinds; a held line holds all."""
    for line in lines:
        turn = frame_with_x_along(line.axis)
        for hinge in line.hinges:
            along, about = CONSTRAINED["fixed" if line.held else hinge.kind]
            inboard = Seated(line.inboard, points[line.inboard][hinge.inboard], turn)
            outboard = Seated(line.outboard, points[line.outboard][hinge.outboard], turn)
            if any((*along, *about)):
                yield Constraint(hinge.name, inboard, outboard, along, about, 0.0, False)


def _rod(connection: Connection, points: Mapping[str, Mapping[str, Vector3]]) -> Constraint:
    """Of a connection that holds the distance of its ports."""
    inboard, outboard = (
        Seated(seat.body, add(points[seat.body][seat.point], seat.offset), _NO_TURN)
        for seat in (connection.ports["inboard"], connection.ports["outboard"])
    )
    length = first_number(connection, "preload_length")
    along, about = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    return Constraint(connection.name, inboard, outboard, along, about, length, False, between=True)


def _held(connection: Connection) -> tuple[Vector3, Vector3]:
    """What a joint with a preset holds along and about its axes, but for those that the scene gives no stiffness."""
    along, about = CONSTRAINED[str(connection.preset)]
    start = component_values(connection, "mean")[1]
    stiff = (np.broadcast_to(start[f"{kind}_stiffness"], 3) > 0.0 for kind in ("translational", "rotational"))
    (x, y, z), (a, b, c) = (
        np.multiply(held, has).tolist() for held, has in zip((along, about), stiff, strict=True)
    )
    return (x, y, z), (a, b, c)


def _line(connection: Connection) -> Quaternion:
    """Frame whose x axis is the connection's, in the axes of its ports."""
    axis = component_values(connection, "mean")[0]["axis"]
    return frame_with_x_along(axis)


def _seated(
    connection: Connection,
    port: str,
    points: Mapping[str, Mapping[str, Vector3]],
    written: Mapping[str, StartPose],
    line: Quaternion,
) -> Seated:
    seat = connection.ports[port]
    turn = _NO_TURN
    if connection.axes is not None:
        turn = multiply(conjugate(written[seat.body].orientation), connection.axes.quaternion)
    return Seated(seat.body, add(points[seat.body][seat.point], seat.offset), multiply(turn, line))


def _commanded(connection: Connection, until: float) -> tuple[float, float, float]:
    """Distance (m) that a motion commands at the start, how far from it the law leads until a time (s), its rate."""
    structure, start = component_values(connection, "mean")
    law = MotionLaw(structure["law"])
    offset = float(np.ravel(start.get("offset", 0.0))[0])
    return law.value(0.0) + offset, farthest(law, until), law.rate(0.0)


def farthest(law: MotionLaw, until: float) -> float:
    """How far from its start a law leads until a time (s), with its sign."""
    first = law.value(0.0)
    times = [*np.linspace(0.0, until, _SAMPLES).tolist(), *(t for t in law.breaks if 0.0 <= t <= until)]
    return max((law.value(time) - first for time in times), key=abs)
