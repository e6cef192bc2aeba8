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

from ..assembly import Geometry
from ..results.key_figures import is_latch_up
from ..results.result import Result
from .depth import back_to_front
from .style import COLOURS, WIDTH

Vector = NDArray[np.float64]

_INSTANTS = 6
_ELEVATION, _AZIMUTH = 20.0, -60.0
_DIAGONAL = 1.0302
"""Diagonal of a box over the side of the square that matplotlib gives axes in space, at zoom 1, in parallel view."""
_MARGINS = np.array([0.95, 0.75])
"""inch of axes, width and height, for tick labels and a title"""


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

    @property
    def extent(self) -> Vector:
        """Size (3,) in m of the box around all rows."""
        low, high = _with_margin(*self._corners)
        return high - low

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
    columns = _columns(structure.extent)
    for k, row in enumerate(rows):
        axes: Any = figure.add_subplot(
            _INSTANTS // columns, columns, k + 1, projection="3d", proj_type="ortho"
        )
        structure.draw(axes, k)
        cell = axes.get_position(original=True)
        middle = 0.5 * (cell.x0 + cell.x1)
        figure.text(middle, cell.y1, f"{result.time[row]:.2f} s", ha="center", va="top", fontsize=10)
    structure.legend(figure)
    return figure


def _columns(extent: Vector) -> int:
    """Columns of pictures that show a box (3,) largest on the page."""
    page = np.array([WIDTH, 7.6])
    return max((2, 3), key=lambda count: _scale(page / (count, _INSTANTS // count), extent))


def _draw_bodies(axes: Any, faces: Mapping[str, Vector], colours: Mapping[str, str]) -> None:  # noqa: ANN401
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


def _corners(points: Sequence[Vector]) -> tuple[Vector, Vector]:
    """Lowest and highest x, y, z (3,) of several sets of points; the origin where there are none."""
    together = np.concatenate(points) if points else np.zeros((1, 3))
    return together.min(0), together.max(0)


def _set_view(axes: Any, low: Vector, high: Vector) -> None:  # noqa: ANN401
    """One scale for all three axes, as large as the axes allow; few ticks."""
    low, high = _with_margin(low, high)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    size = axes.get_position(original=True).size * axes.figure.get_size_inches()
    zoom = _scale(size, high - low) * float(np.linalg.norm(high - low)) / (_DIAGONAL * float(size.min()))
    axes.set_box_aspect(high - low, zoom=zoom)
    axes.view_init(elev=_ELEVATION, azim=_AZIMUTH)
    ticks = 1.0 + 5.0 * (high - low) / np.max(high - low)
    for axis, name, count in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", ticks, strict=True):
        axis.set_major_locator(MaxNLocator(int(count)))
        axis.set_label_text(name)
        axis.labelpad = -8
        axis.set_tick_params(labelsize=6, pad=-3)


def _with_margin(low: Vector, high: Vector) -> tuple[Vector, Vector]:
    margin = 0.03 * float(np.max(high - low))
    return low - margin, high + margin


def _screen() -> tuple[Vector, Vector]:
    """Directions (3,) to the right and upwards in a picture."""
    rise, turn = np.deg2rad((_ELEVATION, _AZIMUTH))
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    up = np.array([-np.sin(rise) * np.cos(turn), -np.sin(rise) * np.sin(turn), np.cos(rise)])
    return right, up


def _scale(size: Vector, extent: Vector) -> float:
    """Inches per metre at which a box (3,) just fits into axes of a size (2,) in inches, with their labels."""
    shown = np.array([np.abs(direction) @ extent for direction in _screen()])
    return float(np.min(np.maximum(size - _MARGINS, 0.3 * size) / shown))


def instants(result: Result) -> NDArray[np.int64]:
    """Rows of the pictures: equal parts of the way all hinges turn until the last latch-up, and the end of the run."""
    last = result.time.size - 1
    latched = [time for time, _, text in result.events if is_latch_up(text)]
    end = int(np.searchsorted(result.time, max(latched, default=result.time[-1]), side="right"))
    way = np.zeros(end)
    for name in result.recording("angle"):
        way[1:] += np.abs(np.diff(result.signal(name, "angle")[:end]))
    way = np.cumsum(way) if np.any(way) else result.time[:end]
    levels = np.linspace(way[0], way[-1], _INSTANTS - (end <= last))
    on_the_way = np.minimum(np.searchsorted(way, levels), end - 1)
    return np.unique([*on_the_way, last]).astype(np.int64)


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
