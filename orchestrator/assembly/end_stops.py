"""End stops of hinge lines as contacts: pads on the outboard body beside the axis, planes on the inboard one.

Every hinge has two, on opposite sides of its axis, so that they push back with a torque and no force, and the hinge's
own stiffness is not in series with the stop's.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin

from components.contract.frames import Vector3, add, cross, dot, norm, scaled, subtract

from ..scene.bodies import Attachment
from ..scene.component_connections import WrenchMode
from ..scene.hinge_line_tables import LONGEST_TO_STOP, HingeLine
from . import STOPS, Part

_HALF_ZONE = pi - 0.5 * LONGEST_TO_STOP
"""rad; half of the turn that the pad, seen along the axis, is behind the plane."""
_SOFT = 1e-3
"""rad over which the damping of the stop rises from nothing at touch."""


def stop_attachments(line: HingeLine) -> Iterator[Attachment]:
    """Ports of the end stops of a line; none where it has no stop."""
    if line.end_stop is None or line.stop_angle is None:
        return
    along, across = _in_plane(line.axis)
    angle = line.aligned_angle - line.stop_angle - _HALF_ZONE
    radius, key = line.end_stop.arm / sin(_HALF_ZONE), f"hinge_line.{line.name}.end_stop"
    pad = add(scaled(radius * cos(angle), along), scaled(radius * sin(angle), across))
    for hinge in line.hinges:
        for name, side in _pads(hinge.name):
            yield Attachment(f"{key}.inboard", name, "inboard", line.inboard, hinge.inboard, (0.0, 0.0, 0.0))
            yield Attachment(
                f"{key}.outboard", name, "outboard", line.outboard, hinge.outboard, scaled(side, pad)
            )


def share_of_stiffness(angle: float) -> float:
    """Torque of an end stop over its stiffness times the angle (rad) by which a line is in it: flat pads give way.

    Their depth grows less than the angle, and their lever shortens; they let go where they are past the plane.
    """
    slant = cos(_HALF_ZONE) / sin(_HALF_ZONE)
    depth, lever = sin(angle) + slant * (cos(angle) - 1.0), cos(angle) - slant * sin(angle)
    return max(0.0, depth * lever / angle)


def stop_parts(line: HingeLine, mode: WrenchMode) -> Iterator[Part]:
    """The end stops of a line, each with its share of stiffness and damping."""
    if line.end_stop is None:
        return
    along, _ = _in_plane(line.axis)
    lever = line.end_stop.arm
    share = 0.5 / (len(line.hinges) * lever * lever)
    start = {
        "gap": -lever * cos(_HALF_ZONE) / sin(_HALF_ZONE),
        "exponent": 1.0,
        "reference_penetration": lever * _SOFT,
        "reference_force": share * line.end_stop.stiffness * lever * _SOFT,
        "damping": share * line.end_stop.damping,
        "full_damping_penetration": lever * _SOFT,
    }
    for hinge in line.hinges:
        for name, side in _pads(hinge.name):
            yield Part(name, "contact", {"normal": scaled(-side, along), "wrench_mode": mode}, start)


def _pads(hinge: str) -> tuple[tuple[str, float], ...]:
    """Names of the two pads of a hinge, and on which side of the axis they are."""
    first, second = (f"{hinge}{stop}" for stop in STOPS)
    return (first, 1.0), (second, -1.0)


def _in_plane(axis: Vector3) -> tuple[Vector3, Vector3]:
    """Two directions normal to an axis, such that the line turns the first into the second."""
    largest = max(range(3), key=lambda i: abs(axis[i]))
    x, y, z = (float(i == (largest + 1) % 3) for i in range(3))
    normal = subtract((x, y, z), scaled(dot(axis, (x, y, z)), axis))
    along = scaled(1.0 / norm(normal), normal)
    return along, cross(axis, along)
