"""Figures of a stress recovery: the peak von Mises field over the plate, and histories of the hottest nodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.tri import Triangulation

from components.contract.component import Vector
from components.flexible.finite_elements import PlateNodes
from components.flexible.stress import Indices

from ..analysis.stress.hot_spots import PanelStress
from ..results.key_figures import latch_times
from .style import COLOURS, DASHES, STYLE, WIDTH, empty_figure, label_events, save_figure

_LEVELS = 16
_MEGA = 1e-6
MOST_HISTORIES = len(DASHES)


def plot_stress(found: PanelStress, folder: Path) -> list[Path]:
    """Pictures of the peak field and of the hottest nodes' histories; the paths written."""
    paths = [folder / f"{found.body}_stress_{what}.png" for what in ("field", "histories")]
    with mpl.rc_context(STYLE):
        save_figure(field_figure(found), paths[0])
        save_figure(hottest_figure(found), paths[1])
    return paths


def hottest_figure(found: PanelStress) -> Figure:
    """Von Mises stress of the hottest nodes over time."""
    hottest = found.stress.recovery.at(found.places[:MOST_HISTORIES])
    histories = hottest.von_mises(found.stress.coordinates)
    title = f"{found.body}: von Mises stress of the hottest nodes"
    return _histories(title, found.result.time, histories, hottest.nodes, latch_times(found.result))


def field_figure(found: PanelStress) -> Figure:
    """Contours of the peak stress where whole elements were asked for, points elsewhere; hot spots numbered."""
    plate, recovery, peak, hot = found.stress.plate, found.stress.recovery, found.peak, found.places
    title = f"{found.body}: peak of the larger face over time"
    with mpl.rc_context({**STYLE, "axes.grid": False}):
        x, y = recovery.positions[:, 0], recovery.positions[:, 1]
        length, width = np.ptp(plate.positions[:, :2], axis=0)
        height = min(max(1.0 + 5.2 * width / length, 2.5), 9.0)
        figure = empty_figure(WIDTH, height, "constrained")
        axes = figure.subplots()
        shown = _field(axes, x, y, _MEGA * peak.value, _triangles(plate, recovery.nodes))
        label = "peak von Mises stress, MPa"
        if isinstance(shown.norm, PowerNorm):
            label += ", square-root scale"
        figure.colorbar(shown, ax=axes, label=label, format="%.3g")
        for (x0, x1), (y0, y1) in plate.inserts:
            insert = Rectangle((x0, y0), x1 - x0, y1 - y0, facecolor="0.85", edgecolor="k", hatch="////")
            axes.add_patch(insert)
        axes.plot(x[hot], y[hot], "o", color="none", markeredgecolor="w", markersize=6, clip_on=False)
        axes.plot(x[hot], y[hot], "o", color="none", markeredgecolor="k", markersize=7, clip_on=False)
        for rank, place in enumerate(hot, 1):
            box = {"boxstyle": "round,pad=0.15", "facecolor": "w", "alpha": 0.8, "linewidth": 0.0}
            axes.annotate(
                f"{rank}", (x[place], y[place]), (4, 4), textcoords="offset points", fontsize=7, bbox=box
            )
        low, high = plate.positions.min(axis=0), plate.positions.max(axis=0)
        axes.set(title=title, xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return figure


def _field(axes: Axes, x: Vector, y: Vector, value: Vector, triangles: Indices) -> Any:  # noqa: ANN401
    """What a colour bar can be made for."""
    if not len(triangles):
        return axes.scatter(x, y, c=value, cmap="cividis", clip_on=False)
    mesh = Triangulation(x, y, triangles)
    if np.ptp(value) == 0.0:  # a field without contours
        return axes.tripcolor(mesh, value, cmap="cividis")
    # narrower at the low end: a few corners hold the largest values
    levels = value.min() + np.ptp(value) * np.linspace(0.0, 1.0, _LEVELS + 1) ** 2
    norm = PowerNorm(0.5, value.min(), value.max())
    return axes.tricontourf(mesh, value, levels, norm=norm, cmap="cividis")


def _triangles(plate: PlateNodes, nodes: Indices) -> Indices:
    """Triangles (T, 3) of the deforming elements with all corners among the nodes, as places in `nodes`."""
    place = np.full(len(plate.positions), -1)
    place[nodes] = np.arange(nodes.size)
    faces = place[plate.faces]
    faces = faces[np.all(faces >= 0, axis=1)]
    return np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])


def _histories(title: str, time: Vector, stress: Vector, nodes: Indices, marks: dict[str, float]) -> Figure:
    """Von Mises stress (N, k) in Pa of at most `MOST_HISTORIES` nodes; marks: instants by name."""
    figure = empty_figure(WIDTH, 3.6, "constrained")
    axes = figure.subplots()
    for history, node, colour, dash in zip(stress.T, nodes, COLOURS, DASHES, strict=False):
        axes.plot(time, _MEGA * history, color=colour, linestyle=dash, linewidth=1.1, label=f"node {node}")
    for instant in marks.values():
        axes.axvline(instant, color="0.5", linewidth=0.8, linestyle=":")
    left, right = axes.get_xlim()
    places = sorted(((instant - left) / (right - left), name) for name, instant in marks.items())
    label_events(axes, places)
    figure.suptitle(title)
    axes.set(xlabel="time, s", ylabel="von Mises stress, MPa")
    axes.legend(fontsize=8)
    return figure
