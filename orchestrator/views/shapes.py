"""The structure as a picture in space: deformed bodies where they are at an instant."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from components.contract.component import Vector

from ..results.key_figures import latch_times
from ..results.result import Result
from .placement import placed
from .space import bounds, draw_bodies, scale, set_view, with_margin
from .style import COLOURS, WIDTH, empty_figure, legend_height

_INSTANTS = 6
_LEGEND_COLUMNS = 6


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
        self._corners = bounds([nodes.reshape(-1, 3) for nodes in self._nodes.values()])

    def draw(self, axes: Any, k: int) -> None:  # noqa: ANN401 - matplotlib does not type its axes in space
        """Draw the k-th of the rows; all rows are to one scale."""
        faces = {name: nodes[k][self._faces[name]] for name, nodes in self._nodes.items()}
        draw_bodies(axes, faces, self._colours)
        set_view(axes, *self._corners)

    @property
    def extent(self) -> Vector:
        """Size (3,) in m of the box around all rows."""
        low, high = with_margin(*self._corners)
        return high - low

    def legend(self, figure: Figure) -> None:
        """Names of the bodies below all axes."""
        handles = [Patch(facecolor=colour, label=name) for name, colour in self._colours.items()]
        figure.legend(handles=handles, loc="lower center", ncols=_LEGEND_COLUMNS, frameon=False)


def shapes(result: Result) -> Figure | None:
    """The structure from folded to deployed, deformation to scale, all instants to one scale."""
    rows = instants(result)
    structure = Structure(result, rows)
    if not structure.names:
        return None
    more = legend_height(len(structure.names), _LEGEND_COLUMNS, 1)
    below, above, height = 0.38 + more, 0.38, 7.6 + more
    figure = empty_figure(WIDTH, height)
    figure.suptitle("Deployment, axes in m", y=1.0 - 0.114 / height)
    figure.subplots_adjust(
        left=0.0, right=0.97, bottom=below / height, top=1.0 - above / height, wspace=0.0, hspace=0.0
    )
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
    return max((2, 3), key=lambda count: scale(page / (count, _INSTANTS // count), extent))


def instants(result: Result) -> NDArray[np.int64]:
    """Rows of the pictures: equal parts of the way all hinges turn until the last latch-up, and the end of the run."""
    last = result.time.size - 1
    last_latch_up = max(latch_times(result).values(), default=result.time[-1])
    end = int(np.searchsorted(result.time, last_latch_up, side="right"))
    way = np.zeros(end)
    for name in result.recording("angle"):
        way[1:] += np.abs(np.diff(result.signal(name, "angle")[:end]))
    way = np.cumsum(way) if np.any(way) else result.time[:end]
    levels = np.linspace(way[0], way[-1], _INSTANTS - (end <= last))
    on_the_way = np.minimum(np.searchsorted(way, levels), end - 1)
    return np.unique([*on_the_way, last]).astype(np.int64)
