"""Which bodies of a picture hide which: the order in which to draw plates that may lie close together."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from components.contract.component import Vector

_FLAT = 1e-2
"""A body as thin as this part of its width has a plane, one as narrow as that of its length has none."""


def back_to_front(points: Mapping[str, Vector], right: Vector, up: Vector) -> list[str]:
    """Names of bodies, those that are hidden first, as seen with these directions (3,) to the right and upwards.

    points: (N, 3) of each body. Depths of single faces do not tell which of two stacked plates is in front, as
    they vary more over a plate than between the two; sides of planes do (Newell, Newell and Sancha 1972).
    """
    towards = np.cross(right, up)
    screens = {name: nodes @ np.array([right, up]).T for name, nodes in points.items()}
    depths = {name: float(np.mean(nodes @ towards)) for name, nodes in points.items()}
    behind: dict[str, set[str]] = {name: set() for name in points}
    names = list(points)
    for k, one in enumerate(names):
        for other in names[k + 1 :]:
            if _overlap(screens[one], screens[other]):
                front = _in_front(points[one], points[other], towards)
                behind[one if front > 0.0 else other].add(other if front > 0.0 else one)
    order: list[str] = []
    while left := [name for name in names if name not in order]:
        free = [name for name in left if not behind[name].intersection(left)]
        order.append(min(free or left, key=lambda name: depths[name]))
    return order


def _overlap(one: Vector, other: Vector) -> bool:
    """Whether the rectangles around two sets of points on the screen overlap."""
    return bool(np.all(one.min(0) < other.max(0)) and np.all(other.min(0) < one.max(0)))


def _in_front(one: Vector, other: Vector, towards: Vector) -> float:
    """Above zero where the first body is in front, by the plane that parts the two better; else by mean depth."""
    sides = [_side(one, other, towards), -_side(other, one, towards)]
    clearer = max(sides, key=abs)
    return clearer or float(np.mean(one @ towards) - np.mean(other @ towards))


def _side(points: Vector, plane_of: Vector, towards: Vector) -> float:
    """How clearly points lie on the viewer's side (1) or the far side (-1) of the plane of others; 0 without one."""
    if len(plane_of) < 3:
        return 0.0
    center = plane_of.mean(axis=0)
    _, (_, width, thickness), axes = np.linalg.svd(plane_of - center, full_matrices=False)
    length = float(np.ptp(plane_of, axis=0).max())
    normal = axes[2] * np.sign(axes[2] @ towards)
    distances = (points - center) @ normal
    total = float(np.abs(distances).sum())
    if width <= _FLAT * length or thickness > 0.5 * width or total == 0.0:
        return 0.0
    return float(distances.sum()) / total
