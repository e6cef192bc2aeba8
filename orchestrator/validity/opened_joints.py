"""Joints that opened so far that bodies no longer moved as their joints allow."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from components.contract.frames import norm, subtract

from ..assembly import Assembly
from ..results.result import Result
from ..scene import PlacedScene

_FAR = 1e-3
"""Of the largest distance of two points of a body that a joint holds: motion is wrong by as much."""
_LEADING = ("point_motion", "drive")


class _Opened(NamedTuple):
    joint: str
    share: float
    distance: float
    time: float
    force: float


def opened_joint_warnings(scene: PlacedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for the joint that opened farthest relative to its bodies, if beyond the limit."""
    sizes, beside = _sizes(scene), dict[str, float]()
    for link in assembly.links:
        joint = link.connection[0]
        beside[joint] = max(beside.get(joint, 0.0), sizes.get(link.body[0], 0.0))
    found = []
    for part in assembly.parts:
        stiffness = part.start.get("translational_stiffness")
        if part.kind == "hinge" and isinstance(stiffness, tuple) and beside.get(part.name):
            opened = _opened(result, part.name, stiffness)
            found.append(opened._replace(share=opened.distance / beside[part.name]))
    farthest = max(found, key=lambda opened: opened.share, default=None)
    if farthest is None or farthest.share <= _FAR:
        return
    leading = [*scene.motions, *(c.name for c in scene.connections if c.kind in _LEADING)]
    yield (
        f"{farthest.joint} opened by {1e3 * farthest.distance:.3g} mm under {farthest.force:.3g} N at "
        f"{farthest.time:.4g} s, more than a joint may. "
        + (_led(leading) if leading else "Check its stiffness.")
    )


def _led(leading: list[str]) -> str:
    return (
        f"Check how far {' and '.join(leading)} leads, which joints are locked, and whether the motion passes a "
        "singular position."
    )


def _sizes(scene: PlacedScene) -> dict[str, float]:
    """Largest distance (m) between two points of every body."""
    return {
        name: max((norm(subtract(a, b)) for a, b in combinations(points.values(), 2)), default=0.0)
        for name, points in scene.points.items()
    }


def _opened(result: Result, name: str, stiffness: tuple[float, ...]) -> _Opened:
    """The farthest (m) that a joint opened, along its line and across; a direction without stiffness holds nothing."""
    forces = np.abs([result.signal(name, f"{way}_force") for way in ("axial", "radial")])
    held = np.array((stiffness[0], min(stiffness[1:])))[:, None]
    parts = np.divide(forces, held, out=np.zeros_like(forces), where=held > 0.0)
    distances = np.hypot(*parts)
    row = int(distances.argmax())
    force = float(np.hypot(*forces[:, row]))
    return _Opened(name, 0.0, float(distances[row]), float(result.time[row]), force)
