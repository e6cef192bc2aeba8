"""The structure as a picture in space: deformed bodies where they are at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]
from numpy.typing import NDArray

from .assembly import Geometry
from .plot_style import COLOURS, WIDTH
from .result import Result
from .summary import is_latch_up

Vector = NDArray[np.float64]

_INSTANTS = 6
_ELEVATION, _AZIMUTH = 20.0, -60.0
_MAGNIFIED = 1.08
_HIGHEST = 0.66  # height of a box in the picture over its diagonal, beyond which titles would be covered


class Structure:
    """Bodies of a result that have faces, and where their nodes are at the given rows.

    Empty (`names` is) where no body has any. Bodies without a recorded pose stand where their geometry says.
    """

    def __init__(self, result: Result, rows: NDArray[np.int64]) -> None:
        bodies = {name: body for name, body in result.geometry.items() if np.size(body.faces)}
        self.names = tuple(bodies)
        self._faces = {name: body.faces for name, body in bodies.items()}
        self._nodes = {name: placed(result, name, body, rows) for name, body in bodies.items()}
        self._colours = dict(zip(bodies, cycle(COLOURS), strict=False))
        self._corners = _corners([nodes.reshape(-1, 3) for nodes in self._nodes.values()])

    def draw(self, axes: Any, k: int) -> None:  # noqa: ANN401 - matplotlib does not type its axes in space
        """Draw the k-th of the rows; all rows are to one scale."""
        faces = {name: nodes[k][self._faces[name]] for name, nodes in self._nodes.items()}
        _draw_bodies(axes, faces, self._colours)
        _set_view(axes, *self._corners)

    def legend(self, figure: Figure) -> None:
        """Names of the bodies below all axes."""
        handles = [Patch(facecolor=colour, label=name) for name, colour in self._colours.items()]
        figure.legend(handles=handles, loc="lower center", ncols=6, frameon=False)


def shapes(result: Result) -> Figure | None:
    """The structure from folded to deployed, deformation to scale, all instants to one scale."""
    rows = instants(result)
    structure = Structure(result, rows)
    if not structure.names:
        return None
    figure = Figure(figsize=(WIDTH, 7.6))
    FigureCanvasAgg(figure)
    figure.suptitle("Deployment, axes in m", y=0.985)
    figure.subplots_adjust(left=0.0, right=0.97, bottom=0.05, top=0.95, wspace=0.0, hspace=0.0)
    for k, row in enumerate(rows):
        axes: Any = figure.add_subplot(_INSTANTS // 2, 2, k + 1, projection="3d", proj_type="ortho")
        structure.draw(axes, k)
        axes.set_title(f"{result.time[row]:.2f} s", y=0.97)
    structure.legend(figure)
    return figure


def _draw_bodies(axes: Any, faces: Mapping[str, Vector], colours: Mapping[str, str]) -> None:  # noqa: ANN401
    """Faces (F, 4, 3) of all bodies as one collection, so that they hide each other; beams as lines."""
    plates, fill = [], []
    for name, corners in faces.items():
        is_line = np.all(corners[:, 1] == corners[:, 2], axis=1)
        plates += list(corners[~is_line])
        fill += [colours[name]] * int(np.sum(~is_line))
        if np.any(is_line):
            axes.add_collection3d(
                Line3DCollection(corners[is_line, :2], colors=colours[name], linewidths=1.6)
            )
    if plates:
        axes.add_collection3d(Poly3DCollection(plates, facecolors=fill, edgecolors="black", linewidths=0.2))


def _corners(points: Sequence[Vector]) -> tuple[Vector, Vector]:
    """Lowest and highest x, y, z (3,) of several sets of points; the origin where there are none."""
    together = np.concatenate(points) if points else np.zeros((1, 3))
    return together.min(0), together.max(0)


def _set_view(axes: Any, low: Vector, high: Vector) -> None:  # noqa: ANN401
    """One scale for all three axes, room for all points, few ticks."""
    margin = 0.03 * float(np.max(high - low))
    low, high = low - margin, high + margin
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=_zoom(high - low))
    axes.view_init(elev=_ELEVATION, azim=_AZIMUTH)
    ticks = 1.0 + 5.0 * (high - low) / np.max(high - low)
    for axis, name, count in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", ticks, strict=True):
        axis.set_major_locator(MaxNLocator(int(count)))
        axis.set_label_text(name)
        axis.labelpad = -8
        axis.set_tick_params(labelsize=6, pad=-3)


def _zoom(extent: Vector) -> float:
    """Magnification of a box (3,): matplotlib fits its diagonal, a flat box has room left, a high one needs some."""
    rise, turn = np.deg2rad((_ELEVATION, _AZIMUTH))
    depth = abs(np.cos(turn)) * extent[0] + abs(np.sin(turn)) * extent[1]
    height = np.cos(rise) * extent[2] + np.sin(rise) * depth
    return float(_MAGNIFIED * min(1.0, _HIGHEST * np.linalg.norm(extent) / height))


def instants(result: Result) -> NDArray[np.int64]:
    """Rows of the pictures: equal parts of the way all hinges turn until the last latch-up."""
    latched = [time for time, _, text in result.events if is_latch_up(text)]
    end = int(np.searchsorted(result.time, max(latched, default=result.time[-1]), side="right"))
    way = np.zeros(end)
    for name in result.recording("angle"):
        way[1:] += np.abs(np.diff(result.signal(name, "angle")[:end]))
    way = np.cumsum(way) if np.any(way) else result.time[:end]
    levels = np.linspace(way[0], way[-1], _INSTANTS)
    return np.unique(np.minimum(np.searchsorted(way, levels), end - 1))


def placed(result: Result, name: str, body: Geometry, rows: NDArray[np.int64]) -> Vector:
    """Nodes of a body in world axes at the given rows, shape (rows, nodes, 3)."""
    nodes = np.repeat(np.asarray(body.positions)[None], rows.size, axis=0)
    if not result.has(name, "frame_position"):
        return nodes
    if result.has(name, "modal_coordinate"):
        coordinates = result.signal(name, "modal_coordinate").reshape(result.time.size, -1)[rows]
        nodes = nodes + np.einsum("dam,rm->rda", np.asarray(body.shapes), coordinates)
    w, vector = np.split(result.signal(name, "frame_orientation")[rows][:, None, :], [1], axis=2)
    twice = 2.0 * np.cross(vector, nodes)
    turned: Vector = nodes + w * twice + np.cross(vector, twice)
    return turned + result.signal(name, "frame_position")[rows][:, None, :]
