"""Figures of a study: distributions of headline numbers, what moves them, and signals of all samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import ceil
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from components.contract.component import Vector

from ..analysis.sampling.influence import Influence, influence
from ..analysis.sampling.study import Study
from .plots import Drawing, write_all
from .style import COLOURS, STYLE, WIDTH, empty_figure

_COLUMNS = 3
_MOST = 18
"""Numbers in one figure."""
_BINS = 40
_PROBABILITIES = (0.05, 0.5, 0.95)
_BARS = 8
"""Parameters that a tornado shows."""


def plot_study(study: Study, folder: Path, format: str = "png") -> list[Path]:
    """Every figure that there is something for, into a folder that is made if missing; the paths written."""
    return write_all(_drawings(study), folder, format)


def _drawings(study: Study) -> Iterator[Drawing]:
    """Each in the style that it is written in as well."""
    for name, draw in FIGURES.items():
        with mpl.rc_context(STYLE):
            figure = draw(study)
            if figure is not None:
                yield Drawing(name, "", figure)


def _distributions(study: Study) -> Figure | None:
    """Histograms with the 5 %, 50 % and 95 % quantiles, or the extremes of designs that have none."""
    varied = {name: _known(study.numbers[name]) for name in study.main_numbers}
    shown = {name: values for name, values in varied.items() if values.size > 1}
    if not shown:
        return None
    figure, places = _grid("Headline numbers of all samples", len(shown))
    for (name, values), axes in zip(shown.items(), places, strict=False):
        axes.hist(values, bins=min(_BINS, max(5, int(np.sqrt(values.size)))), color=COLOURS[6])
        if study.plan.is_random:
            low, middle, high = study.quantiles(name, _PROBABILITIES)
            lines, title = (low, middle, high), f"{middle:.4g}  (5 %: {low:.4g}, 95 %: {high:.4g})"
        else:
            lines = tuple(study.numbers[name][k] for k in study.extremes(name))
            title = "{:.4g} to {:.4g}".format(*lines)
        for line, style in zip(lines, (":", "-", ":"), strict=False):
            axes.axvline(line, color=COLOURS[0], linestyle=style)
        axes.set_title(title, fontsize=7)
        axes.set(xlabel=_label(study, name), ylabel="samples", ymargin=0.05)
    return figure


def _tornado(study: Study) -> Figure | None:
    """What each parameter changes, the largest first."""
    found = [one for name in study.main_numbers if (one := influence(study, name)) is not None]
    if not found:
        return None
    title = "Change by parameter, from its low (blue) to its high end (orange)"
    figure, places = _grid(title, len(found), columns=2)
    for one, axes in zip(found, places, strict=False):
        _bars(one, axes)
        axes.set_xlabel(f"change of {_label(study, one.number)}", fontsize=7)
    return figure


def _bars(one: Influence, axes: Axes) -> None:
    ranked = one.ranked[:_BARS][::-1]
    for side, colour in ((0, COLOURS[0]), (1, COLOURS[1])):
        axes.barh(range(len(ranked)), [one.changes[name][side] for name in ranked], color=colour, height=0.6)
    axes.set_yticks(range(len(ranked)), [_short(name) for name in ranked], fontsize=6)
    axes.axvline(0.0, color="black", linewidth=0.6)
    if one.explained is not None:
        axes.set_title(f"linear fit R2 = {one.explained:.2f}", fontsize=7)


def _scatter(study: Study) -> Figure | None:
    """Each number over the parameter that moves it most, coloured by the one that moves it second."""
    if study.plan.method == "one-at-a-time":
        return None
    found = [one for name in study.main_numbers if (one := influence(study, name)) is not None]
    if not found:
        return None
    figure, places = _grid("Numbers against the parameter that they are most sensitive to", len(found))
    for one, axes in zip(found, places, strict=False):
        first, *others = one.ranked
        colour = study.parameters[others[0]] if others else None
        points = axes.scatter(
            study.parameters[first], study.numbers[one.number], 6, colour, cmap="cividis" if others else None,
            color=None if others else COLOURS[0],
        )  # fmt: skip
        axes.set(xlabel=_label(study, first), ylabel=_label(study, one.number), xmargin=0.03)
        if others:
            figure.colorbar(points, ax=axes, shrink=0.8).set_label(_label(study, others[0]), fontsize=6)
    return figure


def _signals(study: Study) -> Figure | None:
    """Median, 5 % and 95 % of signals over time, and their envelope."""
    if not study.signals:
        return None
    figure, places = _grid("Signals: median, 5 % to 95 %, envelope", len(study.signals))
    for (name, values), axes in zip(study.signals.items(), places, strict=False):
        runs = values[np.isfinite(values).all(axis=1)]
        low, middle, high = np.quantile(runs, _PROBABILITIES, axis=0)
        axes.fill_between(study.times, runs.min(axis=0), runs.max(axis=0), color=COLOURS[6], alpha=0.3)
        axes.fill_between(study.times, low, high, color=COLOURS[6], alpha=0.7)
        axes.plot(study.times, middle, color=COLOURS[0])
        axes.set(xlabel="time, s", ylabel=_label(study, name))
    return figure


FIGURES: Mapping[str, Callable[[Study], Figure | None]] = {
    "distributions": _distributions,
    "tornado": _tornado,
    "scatter": _scatter,
    "signals": _signals,
}


def _grid(title: str, count: int, columns: int = _COLUMNS) -> tuple[Figure, Iterator[Axes]]:
    """A figure with places for so many numbers, or as many as one figure has, so many side by side at the most."""
    count = min(count, _MOST)
    columns = min(count, columns)
    rows = ceil(count / columns)
    figure = empty_figure(WIDTH * max(columns, 2) / 2.0, 0.6 + 2.3 * rows, "constrained")
    figure.suptitle(title)
    places = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in places[count:]:
        axes.remove()
    return figure, iter(places[:count])


def _known(values: Vector) -> Vector:
    found: Vector = values[np.isfinite(values)]
    return found


def _label(study: Study, name: str) -> str:
    unit = study.units.get(name, "")
    return f"{_short(name)}, {unit}" if unit and unit != "1" else _short(name)


def _short(name: str) -> str:
    """Of several keys the first."""
    first, *others = name.split(",")
    return f"{first}, ..." if others else first
