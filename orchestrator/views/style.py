"""How figures look, for screen and print: colour-blind-safe colours, each with a line style of its own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..results.result import Result

Vector = NDArray[np.float64]

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
_EVENT_LABELS = 12
_LABEL_WIDTH = 0.024  # of the axes, upright


def new_figure(title: str, heights: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """A figure with one column of axes of the given relative heights."""
    figure = Figure(figsize=(WIDTH, 0.9 + 2.2 * sum(heights)), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title)
    grid = figure.subplots(len(heights), 1, squeeze=False, height_ratios=list(heights))
    return figure, list(grid[:, 0])


def draw(axes: Axes, time: Vector, curves: Iterable[tuple[str, Vector]], first: int = 0) -> None:
    """Labelled curves, each with its own colour and line style."""
    for k, (label, values) in enumerate(curves, first):
        style = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        axes.plot(time, values, label=label, **style)


def finish(axes: Axes, result: Result, label: str) -> None:
    """Axis labels, event marks and legend."""
    left, right = axes.get_xlim()
    inside = [(time, name) for time, name in _event_places(result) if left <= time <= right]
    for time, _ in inside:
        axes.axvline(time, color="0.4", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
    labels_of_events = _merged(inside, _LABEL_WIDTH * (right - left))
    if len(labels_of_events) <= _EVENT_LABELS:
        for time, names in labels_of_events:
            _label_event(axes, time, ", ".join(dict.fromkeys(names)))
    axes.set_xlabel("time, s")
    axes.set_ylabel(label)
    labels = axes.get_legend_handles_labels()[1]
    if labels:
        columns = max(1, min(5, _LEGEND_WIDTH // (max(map(len, labels)) + 7)))
        axes.legend(
            loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=columns, frameon=False
        )


def tell_of_interruption(figure: Figure, result: Result) -> None:
    """Say in the title of a figure that its run did not come to its end."""
    if not result.complete:
        figure.suptitle(f"{figure.get_suptitle()}; interrupted at t = {result.time[-1]:.6g} s")


def _event_places(result: Result) -> list[tuple[float, str]]:
    """Times of the events, in order, and the hinge line or component each belongs to."""
    line_of = {hinge: line.name for line in result.hinge_lines for hinge in line.hinges}
    return sorted((time, line_of.get(name, name)) for time, name, _ in result.events)


def _merged(events: Sequence[tuple[float, str]], width: float) -> list[tuple[float, list[str]]]:
    """Events in order of time; those whose labels, as wide as given (s), would cover each other as one."""
    found: list[tuple[float, list[str]]] = []
    for time, name in events:
        if found and time - found[-1][0] < width:
            found[-1][1].append(name)
        else:
            found.append((time, [name]))
    return found


def _label_event(axes: Axes, time: float, names: str) -> None:
    axes.annotate(
        names,
        (time, 0.985),
        xycoords=("data", "axes fraction"),
        rotation=90,
        ha="right",
        va="top",
        fontsize=6.5,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.6},
    )
