"""Pictures in space: bodies by their faces, axes to one scale, and a view from which all pictures are seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]

from components.contract.component import Vector

from .depth import back_to_front

_ELEVATION, _AZIMUTH = 20.0, -60.0
_DIAGONAL = 1.0302
"""Diagonal of a box over the side of the square that matplotlib gives axes in space, at zoom 1, in parallel view."""
_MARGINS = np.array([0.95, 0.75])
"""inch of axes, width and height, for tick labels and a title"""
_CORNER = 0.06
"""of the longest axis, at the ends of all axes, where there is no tick"""
_SHORT_CORNER = 0.4
"""of its own length at the most, so that a short axis has a round number between"""
_AROUND_A_POINT = 0.5
"""m, of what is shown around what is all in one place"""


def draw_bodies(axes: Any, faces: Mapping[str, Vector], colours: Mapping[str, str]) -> None:  # noqa: ANN401
    """Faces (F, 4, 3) of all bodies, those behind first; beams as lines. Nothing is cut at the edge of the axes."""
    axes.computed_zorder = False
    right, up = _screen()
    order = back_to_front({name: corners.reshape(-1, 3) for name, corners in faces.items()}, right, up)
    for depth, name in enumerate(order):
        corners, look = faces[name], {"zorder": 2.0 + depth, "clip_on": False}
        is_line = np.all(corners[:, 1] == corners[:, 2], axis=1)
        if np.any(is_line):
            lines = Line3DCollection(corners[is_line, :2], colors=colours[name], linewidths=1.6, **look)
            axes.add_collection3d(lines)
        if not np.all(is_line):
            plates = Poly3DCollection(
                corners[~is_line], facecolors=colours[name], edgecolors="black", linewidths=0.2, **look
            )
            axes.add_collection3d(plates)


def bounds(points: Sequence[Vector]) -> tuple[Vector, Vector]:
    """Lowest and highest x, y, z (3,) of several sets of points; the origin where there are none."""
    together = np.concatenate(points) if points else np.zeros((1, 3))
    return together.min(0), together.max(0)


def set_view(axes: Any, low: Vector, high: Vector) -> None:  # noqa: ANN401
    """One scale for all three axes, as large as the axes allow; few ticks."""
    low, high = with_margin(low, high)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    size = axes.get_position(original=True).size * axes.figure.get_size_inches()
    zoom = scale(size, high - low) * float(np.linalg.norm(high - low)) / (_DIAGONAL * float(size.min()))
    axes.set_box_aspect(high - low, zoom=zoom)
    axes.view_init(elev=_ELEVATION, azim=_AZIMUTH)
    for axis, name, ends in zip(
        (axes.xaxis, axes.yaxis, axes.zaxis), "xyz", np.array([low, high]).T, strict=True
    ):
        places = _ticks(float(ends[0]), float(ends[1]), float(np.max(high - low)))
        axis.set_ticks(places, [f"{place:g}" for place in places[:-1]] + [f"{name} = {places[-1]:g}"])
        axis.set_tick_params(labelsize=6, pad=-3)


def _ticks(low: float, high: float, longest: float) -> list[float]:
    """Round places on an axis, few on a short one, away from its ends, where those of other axes begin."""
    clear = min(_CORNER * longest, _SHORT_CORNER * (high - low))
    if not longest:
        return [low]
    number, inside = int(5.0 * (high - low) / longest), list[float]()
    while not inside:
        number += 1
        places = MaxNLocator(number, steps=[1, 2, 5, 10]).tick_values(low, high)
        inside = [float(place) + 0.0 for place in places if low + clear <= place <= high - clear]
    return inside if clear == _CORNER * longest else inside[:1]


def with_margin(low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """The same corners a little farther out; a box around what is all in one place."""
    margin = 0.03 * float(np.max(high - low)) or _AROUND_A_POINT
    return low - margin, high + margin


def _screen() -> tuple[Vector, Vector]:
    """Directions (3,) to the right and upwards in a picture."""
    rise, turn = np.deg2rad((_ELEVATION, _AZIMUTH))
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    up = np.array([-np.sin(rise) * np.cos(turn), -np.sin(rise) * np.sin(turn), np.cos(rise)])
    return right, up


def scale(size: Vector, extent: Vector) -> float:
    """Inches per metre at which a box (3,) just fits into axes of a size (2,) in inches, with their labels."""
    shown = np.array([np.abs(direction) @ extent for direction in _screen()])
    return float(np.min(np.maximum(size - _MARGINS, 0.3 * size) / shown))
