"""Bodies that joints compress with a large part of the Euler load of their first-order modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from components.contract.frames import rotated
from components.hinge import Hinge
from components.moving_base import MovingBase

from ..assembly import Assembly, Part
from ..assembly.second_order import joint_places, low_second_order, second_order_modes, ways_through
from ..results.result import Result
from ..scene import PlacedScene
from ..scene.body_tables import Body
from .holding_points import holding_points

_TOLD = 0.02
"""Of Euler's load: it takes so much of the stiffness against bending, which modes of first order keep, and half of that
of latch torques."""
Rows = NDArray[np.float64]


def axial_load_warnings(scene: PlacedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each body that a joint compresses with 2 % of Euler's load of its first-order modes or more."""
    parts = {part.name: part for part in assembly.parts}
    for body in scene.bodies:
        if body.name not in assembly.flexible:
            continue
        part = parts[body.name]
        held, places = dict(holding_points(part, assembly)), _places(part)
        points = np.array([places[point] for point in sorted(held.values())])
        pressed = {
            joint: _pressed(assembly, parts, joint, body.name, places[point], points.mean(0), result)
            for joint, point in held.items()
            if parts[joint].kind == Hinge.kind and result.has(joint, "hinge_force")
        }
        joint = max(pressed, key=lambda name: float(pressed[name].max(initial=0.0)), default="")
        if not joint or not pressed[joint].max() > 0.0:
            continue
        row = int(pressed[joint].argmax())
        most, second = float(pressed[joint][row]), second_order_modes(part)
        ways = ways_through(low_second_order(body, second), joint_places(scene, body))
        critical = min((way.euler(second) for way in ways), default=np.inf)
        if most > _TOLD * critical:
            yield (
                f"{body.name}: {joint} compresses it with {most:.4g} N at {result.time[row]:.4g} s, "
                f"{100.0 * most / critical:.2g} % of Euler's load of its first-order modes ({critical:.4g} N), which "
                f"keep their full stiffness. {_remedy(body)}"
            )


def _remedy(body: Body) -> str:
    if body.inertia_coupling != "full":
        return "Set inertia_coupling to full."
    return f"Set second_order_modes above {body.second_order_modes or 0}."


def _places(part: Part) -> dict[str, Rows]:
    """Points (3,) of a modal body by name, its construction frame."""
    modal = part.structure["modal"]
    return dict(zip(modal["point_names"], np.asarray(modal["point_positions"]), strict=True))


def _pressed(
    assembly: Assembly,
    parts: dict[str, Part],
    joint: str,
    body: str,
    place: Rows,
    middle: Rows,
    result: Result,
) -> Rows:
    """Forces (rows,) of a joint on a body, from its position (3,) towards the middle (3,) of the points that hold it.

    Zeros on a moving ground, whose attitude results do not contain.
    """
    sides = {link.connection[1]: link.body for link in assembly.links if link.connection[0] == joint}
    inboard, force = parts[sides["inboard"][0]], np.asarray(result.signal(joint, "hinge_force"))
    if inboard.kind == MovingBase.kind:
        return np.zeros(len(force))
    port = next(one for one in inboard.structure["ports"] if one["name"] == sides["inboard"][1])
    turn = np.broadcast_to(
        np.array(port.get("orientation", (1.0, 0.0, 0.0, 0.0)), dtype=float), (len(force), 4)
    )
    in_world = rotated(_orientation(inboard.name, result), rotated(turn, force))
    along = (middle - place) / max(float(np.linalg.norm(middle - place)), 1e-9)
    axis = rotated(_orientation(body, result), np.broadcast_to(along, force.shape))
    on_body: Rows = np.sum(in_world * axis, axis=1) * (1.0 if sides["outboard"][0] == body else -1.0)
    return on_body


def _orientation(body: str, result: Result) -> Rows:
    """Quaternions (rows, 4) of a body; those of no turn for a ground."""
    if result.has(body, "frame_orientation"):
        return np.asarray(result.signal(body, "frame_orientation")).reshape(-1, 4)
    return np.tile((1.0, 0.0, 0.0, 0.0), (result.time.size, 1))
