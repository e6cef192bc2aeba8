"""Overlays of two results: A drawn through, B dashed, one colour per hinge line or component."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any, Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from components.contract.component import Vector

from ..results.compare import in_either, labels
from ..results.differences import distinctions
from ..results.key_figures import latch_times, line_latch_torque
from ..results.result import Result
from ..results.round_off import noise_floor
from .plots import Drawing, loads_by_kind, loads_title, write_all
from .style import COLOURS, STYLE, WIDTH, as_written, empty_figure

Both = tuple[Result, Result]

_RUNS: Final[tuple[dict[str, Any], ...]] = (
    {"color": COLOURS[0], "linestyle": "-", "linewidth": 1.5},
    {"color": COLOURS[1], "linestyle": (0, (4, 1.5)), "linewidth": 1.2},
)
_LEGEND_WIDTH = 52
"""Characters of a line of the legend."""
_AFTER_LATCH = 1.5
_BEFORE_LATCH = 0.05


class Panel(NamedTuple):
    """Axes with one quantity of both results: curves are (time, values), None where a result has none."""

    title: str
    label: str
    curves: tuple[tuple[Vector, Vector] | None, ...]
    xlabel: str = "time, s"


Overlay = tuple[str, Callable[[Both], list[Panel]], int]


def plot_comparison(a: Result, b: Result, directory: Path, format: str = "png") -> list[Path]:
    """Write every overlay that the signals allow; the paths written."""
    drawn = (one._replace(name=f"compare_{one.name}") for one in draw_comparison(a, b))
    return write_all(drawn, directory, format)


def draw_comparison(a: Result, b: Result) -> Iterator[Drawing]:
    """Every overlay that the signals of at least one result allow."""
    with mpl.rc_context(STYLE):
        for name, (title, panels_of, columns) in (_OVERLAYS | _overlays_of_loads(a, b)).items():
            panels = _with_values(panels_of((a, b)))
            if panels:
                names = labels(a, b)
                caption = f"{title}: {names[0]} solid, {names[1]} dashed."
                told = zip(names, distinctions(a, b), (a, b), strict=True)
                curves = tuple(_curve_name(*one) for one in told)
                yield Drawing(
                    name, caption, as_written(_overlay(title, panels, columns, (curves[0], curves[1])))
                )


def _overlays_of_loads(a: Result, b: Result) -> dict[str, Overlay]:
    """Title, panels and number of columns of the loads of every kind of component."""
    by_kind = [loads_by_kind(result) for result in (a, b)]
    found = {}
    for name in in_either(tuple(by_kind[0]), tuple(by_kind[1])):
        shown = in_either(*(kinds.get(name, ()) for kinds in by_kind))
        result = a if shown[0][0] in a.components else b
        found[name] = (loads_title(result, shown), _loads(shown), 2)
    return found


def _curve_name(name: str, different: str, result: Result) -> str:
    """For the legend: a name, and what is different."""
    whole = f"{name}: {different}" if different else name
    lines = "\n".join(wrap(whole, _LEGEND_WIDTH))
    return lines if result.complete else f"{lines}, interrupted at t = {result.time[-1]:.6g} s"


def _overlay(title: str, panels: Sequence[Panel], columns: int, names: tuple[str, str]) -> Figure:
    rows = -(-len(panels) // columns)
    figure = empty_figure(WIDTH, 0.9 + 2.0 * rows, "constrained")
    figure.suptitle(title)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, panel in zip(grid.flat, panels, strict=False):
        _draw_panel(axes, panel, names)
    for axes in list(grid.flat)[len(panels) :]:
        axes.set_visible(False)
    handles: dict[str, Any] = {}
    for axes in grid.flat:
        handles |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=2, frameon=False)
    return figure


def _draw_panel(axes: Axes, panel: Panel, names: tuple[str, str]) -> None:
    for name, curve, style in zip(names, panel.curves, _RUNS, strict=True):
        if curve is not None:
            axes.plot(*curve, label=name, **style)
    axes.set_title(panel.title, fontsize=9)
    axes.set(xlabel=panel.xlabel, ylabel=panel.label)


def _signal(result: Result, name: str, variable: str, column: int = 0) -> tuple[Vector, Vector] | None:
    if not result.has(name, variable):
        return None
    return result.time, result.signal(name, variable).reshape(result.time.size, -1)[:, column]


def _with_values(panels: Sequence[Panel]) -> list[Panel]:
    """Panels that show more than zero or round-off beside others of their unit."""
    largest: dict[str, float] = {}
    for panel in panels:
        unit = panel.label.rpartition(",")[2]
        largest[unit] = max(largest.get(unit, 0.0), _largest(panel))
    floors = {unit: noise_floor([value]) for unit, value in largest.items()}
    return [panel for panel in panels if _largest(panel) > floors[panel.label.rpartition(",")[2]]]


def _largest(panel: Panel) -> float:
    """Largest magnitude of its curves."""
    return max(
        (float(np.abs(curve[1]).max()) for curve in panel.curves if curve is not None and curve[1].size),
        default=0.0,
    )


def _angles(both: Both) -> list[Panel]:
    """Angle of every hinge line's sensor."""
    sensors = {line.name: line.sensor for result in both for line in result.hinge_lines}
    panels = []
    for line, sensor in sensors.items():
        curves = [_signal(result, sensor, "angle") for result in both]
        if any(curves):
            in_degrees = tuple(curve and (curve[0], np.rad2deg(curve[1])) for curve in curves)
            panels.append(Panel(line, "hinge angle, deg", in_degrees))
    return panels


def _latch_torques(both: Both) -> list[Panel]:
    """Latch torque of every line over the run, and beside it over the time since its own latch-up."""
    times = [latch_times(result) for result in both]
    panels = []
    for name in in_either(tuple(times[0]), tuple(times[1])):
        whole, close = [], []
        for result, latched in zip(both, times, strict=True):
            line = next((line for line in result.hinge_lines if line.name == name), None)
            torque = None if line is None or name not in latched else line_latch_torque(result, line)
            whole.append(None if torque is None else (result.time, torque))
            close.append(None if torque is None else _since(result.time, torque, latched[name]))
        panels.append(Panel(name, "latch torque, N.m", tuple(whole)))
        panels.append(
            Panel(f"{name}, from latch-up", "latch torque, N.m", tuple(close), "time since latch-up, s")
        )
    return panels


def _since(time: Vector, values: Vector, start: float) -> tuple[Vector, Vector]:
    shown = (time >= start - _BEFORE_LATCH) & (time <= start + _AFTER_LATCH)
    return time[shown] - start, values[shown]


def _loads(found: Sequence[tuple[str, str]]) -> Callable[[Both], list[Panel]]:
    """Panels of loads, one an axis of a vector."""

    def panels(both: Both) -> list[Panel]:
        drawn = []
        for name, variable in found:
            known = next(result for result in both if result.has(name, variable))
            size, words = known.signal(name, variable)[:1].size, variable.replace("_", " ")
            for k in range(size):
                label = f"{words} {'xyz'[k]}" if size == 3 else words
                curves = tuple(_signal(result, name, variable, k) for result in both)
                drawn.append(Panel(f"{name}: {label}", f"{label}, {known.unit(name, variable)}", curves))
        return drawn

    return panels


_OVERLAYS: Final[dict[str, Overlay]] = {
    "angles": ("Deployment angles", _angles, 1),
    "latch_torques": ("Latch torque, sum over the hinges of a line", _latch_torques, 2),
}
