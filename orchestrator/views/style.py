"""How figures look, for screen and print: colour-blind-safe colours, each with a line style of its own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from io import BytesIO
from math import ceil
from pathlib import Path
from typing import Any, Final, Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import offset_copy

from components.cache.disk import replace_file
from components.contract.component import Vector

from ..results.result import Result

COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
DASHES: Final[tuple[Any, ...]] = ("-", "--", "-.", ":", (0, (8, 2)))
STYLE: Final[Any] = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.grid": True,
    "axes.xmargin": 0.0,
    "axes.ymargin": 0.13,
    "grid.alpha": 0.35,
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.3,
    "legend.fontsize": 8,
    "figure.dpi": 130,
    "savefig.dpi": 160,
}
WIDTH = 7.2
_LEGEND_WIDTH = 100  # characters, a handle counting as seven
_LEGEND_ROW = 0.17  # inch
_LEGEND_ROWS = 2
"""That a figure has room for above its axes."""
_EVENT_LABELS = 12
_LABEL_SIZE = 6.5
_LETTER = 0.0095
"""Width of a letter of an event's label, of that of axes as wide as the figure."""


def empty_figure(width: float, height: float, layout: Literal["constrained"] | None = None) -> Figure:
    """A figure of this size in inches, to be drawn without a display."""
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def new_figure(title: str, heights: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """A figure with one column of axes of the given relative heights."""
    figure = empty_figure(WIDTH, 0.9 + 2.2 * sum(heights), "constrained")
    figure.suptitle(title)
    grid = figure.subplots(len(heights), 1, squeeze=False, height_ratios=list(heights))
    return figure, list(grid[:, 0])


def new_columns(title: str, rows: Sequence[int]) -> tuple[Figure, list[list[Axes]]]:
    """A figure with columns of axes side by side, of so many rows each, on one axis of time."""
    figure = empty_figure(WIDTH, 1.1 + 1.9 * max(rows), "constrained")
    figure.suptitle(title)
    grid = figure.subplots(max(rows), len(rows), squeeze=False)
    for number, column in zip(rows, grid.T, strict=True):
        for axes in column[number:]:
            axes.remove()
    return figure, [list(column[:number]) for number, column in zip(rows, grid.T, strict=True)]


def draw(axes: Axes, time: Vector, curves: Iterable[tuple[str, Vector]], first: int = 0) -> None:
    """Labelled curves, each with its own colour and line style."""
    for k, (label, values) in enumerate(curves, first):
        style = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        axes.plot(time, values, label=label, **style)


def finish(axes: Axes, result: Result, label: str, legend: bool = True) -> None:
    """Axis labels, event marks and, unless that of the figure tells, a legend."""
    left, right = axes.get_xlim()
    inside = [(time, name) for time, name in _event_places(result) if left <= time <= right]
    for time, _ in inside:
        axes.axvline(time, color="0.4", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
    labelled = list(dict.fromkeys(inside)) if len(set(inside)) * _columns(axes) <= _EVENT_LABELS else []
    label_events(axes, [((time - left) / (right - left), name) for time, name in labelled])
    axes.set_xlabel("time, s")
    axes.set_ylabel(label)
    labels = axes.get_legend_handles_labels()[1]
    if labels and legend:
        columns = _legend_columns(labels)
        above = 1.6 if labelled else 0.1
        if (figure := axes.get_figure(root=True)) is not None:
            more = legend_height(len(labels), columns, _LEGEND_ROWS)  # not to be taken from the curves
            figure.set_figheight(figure.get_figheight() + more)
        axes.legend(
            loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=above, ncols=columns, frameon=False
        )


def share_legend(figure: Figure) -> None:
    """One legend below all axes, for curves that are the same in each."""
    handles, labels = figure.axes[0].get_legend_handles_labels()
    columns = _legend_columns(labels)
    figure.set_figheight(figure.get_figheight() + legend_height(len(labels), columns))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)


def legend_height(names: int, columns: int, rows: int = 0) -> float:
    """What a legend of so many names takes beyond so many rows, inch."""
    return _LEGEND_ROW * max(0, ceil(names / columns) - rows)


def _legend_columns(labels: Sequence[str]) -> int:
    return max(1, min(5, _LEGEND_WIDTH // (max(map(len, labels)) + 7)))


def _columns(axes: Axes) -> int:
    """How many axes stand side by side in the figure."""
    place = axes.get_subplotspec()
    return 1 if place is None else int(place.get_gridspec().ncols)


def as_written(figure: Figure) -> Figure:
    """The figure with all names as they are: a dollar sign in one begins no formula."""
    texts = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        texts += [*axes.texts, axes.title, axes.xaxis.label, axes.yaxis.label]
        legend = axes.get_legend()
        texts += legend.get_texts() if legend is not None else []
    for text in texts:
        text.set_parse_math(False)
    return figure


def tell_of_interruption(figure: Figure, result: Result) -> None:
    """Say in the title of a figure that its run did not come to its end."""
    if not result.complete:
        figure.suptitle(f"{figure.get_suptitle()}; interrupted at t = {result.time[-1]:.6g} s")


def _event_places(result: Result) -> list[tuple[float, str]]:
    """Times of the events, in order, and the hinge line or component each belongs to."""
    line_of = {hinge: line.name for line in result.hinge_lines for hinge in line.hinges}
    return sorted((time, line_of.get(name, name)) for time, name, _ in result.events)


def spread(places: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Centres of labels of these widths near to their places, in order, side by side between 0 and 1."""
    found: list[float] = []
    right = 0.0
    for place, width in zip(places, widths, strict=True):
        found.append(max(place, right + 0.5 * width))
        right = found[-1] + 0.5 * width
    left = 1.0
    for k in reversed(range(len(found))):
        found[k] = min(found[k], left - 0.5 * widths[k])
        left = found[k] - 0.5 * widths[k]
    return found


def label_events(axes: Axes, events: Sequence[tuple[float, str]]) -> None:
    """Names of events, at parts of the width, side by side above the axes and joined to their marks."""
    letter = _LETTER * _columns(axes)
    centres = spread([place for place, _ in events], [letter * (len(name) + 1) for _, name in events])
    for (place, name), centre in zip(events, centres, strict=True):
        axes.annotate(
            name,
            (place, 1.0),
            (centre, 1.0),
            xycoords="axes fraction",
            textcoords=offset_copy(axes.transAxes, axes.get_figure(root=True), y=8.0, units="points"),
            ha="center",
            va="bottom",
            fontsize=_LABEL_SIZE,
            arrowprops={
                "arrowstyle": "-", "color": "0.4", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0,
                "patchA": None, "relpos": (0.5, 0.0),  # from below the name, sooner than cut off at its box
            },
        )  # fmt: skip


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the path's ending, whole or not at all."""
    content = BytesIO()
    figure.savefig(content, format=path.suffix[1:] or None)
    try:
        replace_file(path, content.getvalue())
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None
