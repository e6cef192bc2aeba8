"""End stops of hinge lines as parts, one beside each hinge with its share; the hinge's own stiffness takes none."""

from __future__ import annotations

from collections.abc import Iterator

from components.end_stop import OF_HINGE, EndStop

from ..scene.bodies import Attachment
from ..scene.component_connections import WrenchMode
from ..scene.hinge_line_tables import HingeLine
from . import Part


def stop_attachments(line: HingeLine) -> Iterator[Attachment]:
    """Ports of the end stops of a line, where its hinges have theirs; none where it has no stop."""
    if line.end_stop is None:
        return
    key = f"hinge_line.{line.name}.end_stop"
    for hinge in line.hinges:
        name, nowhere = hinge.name + OF_HINGE, (0.0, 0.0, 0.0)
        yield Attachment(f"{key}.inboard", name, "inboard", line.inboard, hinge.inboard, nowhere)
        yield Attachment(f"{key}.outboard", name, "outboard", line.outboard, hinge.outboard, nowhere)


def stop_parts(line: HingeLine, mode: WrenchMode) -> Iterator[Part]:
    """The end stops of a line, each with its share of stiffness and damping."""
    if line.end_stop is None or line.stop_angle is None:
        return
    share = 1.0 / len(line.hinges)
    start = {
        "stop_angle": line.stop_angle,
        "stiffness": share * line.end_stop.stiffness,
        "damping": share * line.end_stop.damping,
        "aligned_angle": line.aligned_angle,
        "stowed_angle": line.initial_angle,
    }
    if line.end_stop.full_damping_penetration is not None:
        start["full_damping_penetration"] = line.end_stop.full_damping_penetration
    for hinge in line.hinges:
        yield Part(hinge.name + OF_HINGE, EndStop.kind, {"axis": line.axis, "wrench_mode": mode}, start)
