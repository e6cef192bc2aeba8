"""Figures of a result, for screen and print: colour-blind-safe colours, each with a line style of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]
from numpy.typing import NDArray

from .assembly import Geometry
from .result import Result
from .summary import is_latch_up, latch_times, line_latch_torque, peak

Vector = NDArray[np.float64]

_COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
_DASHES: Final[tuple[Any, ...]] = ("-", "--", "-.", ":", (0, (8, 2)))
_STYLE: Final[Any] = {
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
_WIDTH = 7.2
_INSTANTS = 6
_CLOSE_UP_CROSSINGS = 8
_LEGEND_WIDTH = 100  # characters, a handle counting as seven
_EVENT_LABELS = 12

_CAUSES: Final = {
    "friction_energy": "hinge friction",
    "latch_energy": "latches",
    "damping_energy": "hinge damping",
}
_MARKS: Final = {
    "frame_position": "modal damping",
    "tension_a": "cable loops",
    "damper_torque": "dampers",
}


def plot_all(result: Result, directory: str | Path, format: str = "png") -> list[Path]:
    """Write every figure that the signals of the result allow; the paths written."""
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    written = []
    with mpl.rc_context(_STYLE):
        for name, draw in _FIGURES.items():
            figure = draw(result)
            if figure is not None:
                path = directory / f"{name}.{format}"
                figure.savefig(path)
                written.append(path)
    return written


def deployment_angles(result: Result) -> Figure | None:
    """Angle of every hinge over time; hinges of a line that coincide share a curve."""
    names = result.recording("angle")
    if not names:
        return None
    figure, (axes,) = _figure("Deployment angles", [1.0])
    curves = [(name, np.rad2deg(result.signal(name, "angle"))) for name in _one_a_line(result, names)]
    _draw(axes, result.time, curves)
    _finish(axes, result, "hinge angle, deg")
    return figure


def latch_torques(result: Result) -> Figure | None:
    """Latch torque of every hinge line, and a close-up after each latch-up."""
    times = latch_times(result)
    lines = [line for line in result.hinge_lines if line.name in times]
    if not lines:
        return None
    figure, axes = _figure("Latch torque, sum over the hinges of a line", [1.4] + [1.0] * len(lines))
    torques = [(line.name, line_latch_torque(result, line)) for line in lines]
    _draw(axes[0], result.time, torques)
    _finish(axes[0], result, "latch torque, N.m")
    for k, (close_up, (name, torque)) in enumerate(zip(axes[1:], torques, strict=True)):
        start, end = times[name], _ringing_end(result.time, torque, times[name])
        top = peak(result, torque)
        shown = (result.time >= start - 0.08 * (end - start)) & (result.time <= end)
        _draw(close_up, result.time[shown], [(name, torque[shown])], first=k)
        label = f"{name} peak {top.value:.4g} N.m at {top.time:.4f} s"
        close_up.plot(top.time, top.value, "ko", markerfacecolor="none", label=label)
        close_up.set_xlim(start - 0.08 * (end - start), end)
        _finish(close_up, result, "latch torque, N.m")
    return figure


def cable_forces(result: Result) -> Figure | None:
    """Strand tensions and pulley forces of every closed cable loop."""
    names = result.recording("tension_a")
    if not names:
        return None
    figure, axes = _figure("Closed cable loops", [1.0, 1.0])
    kinds = {"tension, N": ("tension_a", "tension_b"), "pulley force, N": ("axial_force", "lateral_force")}
    for panel, (label, variables) in zip(axes, kinds.items(), strict=True):
        _draw(panel, result.time, _curves(result, names, variables))
        _finish(panel, result, label)
    return figure


def damper_torques(result: Result) -> Figure | None:
    """Torque of every damper."""
    names = result.recording("damper_torque")
    if not names:
        return None
    figure, (axes,) = _figure("Damper torque", [1.0])
    _draw(axes, result.time, [(name, result.signal(name, "damper_torque")) for name in names])
    _finish(axes, result, "damper torque, N.m")
    return figure


def interface_loads(result: Result) -> Figure | None:
    """Force and torque on the base, component by component."""
    names = result.recording("interface_force")
    if not names:
        return None
    figure, axes = _figure("Loads at the interface with the spacecraft", [1.0, 1.0])
    for panel, variable, unit in zip(
        axes, ("interface_force", "interface_torque"), ("N", "N.m"), strict=True
    ):
        kind = variable.split("_")[1]
        curves = [
            (f"{name} {kind} {axis}" if len(names) > 1 else f"{kind} {axis}", load)
            for name in names
            for axis, load in zip("xyz", result.signal(name, variable).T, strict=True)
        ]
        _draw(panel, result.time, curves)
        _finish(panel, result, f"interface {kind}, {unit}")
    return figure


def energy_balance(result: Result) -> Figure | None:
    """Energy stored and dissipated, by cause, and the residual of the balance on its own axis."""
    if not result.has("scene", "stored_energy"):
        return None
    channels = [("stored_energy", "stored"), ("dissipated_energy", "dissipated")]
    totals = [(label, result.signal("scene", v)) for v, label in channels if result.has("scene", v)]
    figure, axes = _figure("Energy balance", [1.0, 1.0, 0.8])
    _draw(axes[0], result.time, totals)
    _draw(axes[1], result.time, _dissipated_by_cause(result))
    if result.has("scene", "energy_residual"):
        axes[2].plot(result.time, result.signal("scene", "energy_residual"), color=_COLOURS[0])
    for panel, label in zip(axes, ("energy, J", "dissipated, J", "residual, J"), strict=True):
        _finish(panel, result, label)
    return figure


def steps(result: Result) -> Figure | None:
    """Communication step size and iterations."""
    channels = (("step_size", "step size, s"), ("iterations", "iterations"))
    if not all(result.has("scene", variable) for variable, _ in channels):
        return None
    figure, axes = _figure("Communication steps", [1.0, 1.0])
    for panel, (variable, label) in zip(axes, channels, strict=True):
        values = result.signal("scene", variable)
        shown = values > 0.0
        panel.plot(
            result.time[shown], values[shown], color=_COLOURS[0], marker=".", markersize=3, linestyle=""
        )
        panel.set_xlim(result.time[0], result.time[-1])
        _finish(panel, result, label)
    axes[0].set_yscale("log")
    axes[1].yaxis.set_major_locator(MaxNLocator(integer=True))
    return figure


def shapes(result: Result) -> Figure | None:
    """The structure from folded to deployed, deformation to scale, all instants to one scale."""
    bodies = {name: body for name, body in result.geometry.items() if np.size(body.faces)}
    if not bodies:
        return None
    rows = _instants(result)
    placed = {name: _placed(result, name, body, rows) for name, body in bodies.items()}
    points = np.concatenate([nodes.reshape(-1, 3) for nodes in placed.values()])
    colours = dict(zip(bodies, cycle(_COLOURS), strict=False))
    figure = Figure(figsize=(_WIDTH, 7.6))
    FigureCanvasAgg(figure)
    figure.suptitle("Deployment, axes in m", y=0.985)
    figure.subplots_adjust(left=0.0, right=0.97, bottom=0.05, top=0.95, wspace=0.0, hspace=0.0)
    for k, row in enumerate(rows):
        axes: Any = figure.add_subplot(_INSTANTS // 2, 2, k + 1, projection="3d", proj_type="ortho")
        _draw_bodies(axes, {name: nodes[k][bodies[name].faces] for name, nodes in placed.items()}, colours)
        _set_view(axes, points)
        axes.set_title(f"{result.time[row]:.2f} s", y=0.93)
    handles = [Patch(facecolor=colour, label=name) for name, colour in colours.items()]
    figure.legend(handles=handles, loc="lower center", ncols=6, frameon=False)
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


def _set_view(axes: Any, points: Vector) -> None:  # noqa: ANN401
    """One scale for all three axes, room for all points, few ticks."""
    low, high = points.min(0), points.max(0)
    margin = 0.03 * float(np.max(high - low))
    low, high = low - margin, high + margin
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.2)
    axes.view_init(elev=20, azim=-60)
    ticks = 1.0 + 5.0 * (high - low) / np.max(high - low)
    for axis, name, count in zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", ticks, strict=True):
        axis.set_major_locator(MaxNLocator(int(count)))
        axis.set_label_text(name)
        axis.labelpad = -8
        axis.set_tick_params(labelsize=6, pad=-3)


_FIGURES: Final[dict[str, Callable[[Result], Figure | None]]] = {
    "deployment_angles": deployment_angles,
    "latch_torques": latch_torques,
    "cable_forces": cable_forces,
    "damper_torques": damper_torques,
    "interface_loads": interface_loads,
    "energy_balance": energy_balance,
    "steps": steps,
    "shapes": shapes,
}


def _figure(title: str, heights: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """A figure with one column of axes of the given relative heights."""
    figure = Figure(figsize=(_WIDTH, 0.9 + 2.2 * sum(heights)), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title)
    grid = figure.subplots(len(heights), 1, squeeze=False, height_ratios=list(heights))
    return figure, list(grid[:, 0])


def _draw(axes: Axes, time: Vector, curves: Iterable[tuple[str, Vector]], first: int = 0) -> None:
    """Labelled curves, each with its own colour and line style."""
    for k, (label, values) in enumerate(curves, first):
        style = {"color": _COLOURS[k % len(_COLOURS)], "linestyle": _DASHES[k % len(_DASHES)]}
        axes.plot(time, values, label=label, **style)


def _finish(axes: Axes, result: Result, label: str) -> None:
    """Axis labels, event marks and legend."""
    left, right = axes.get_xlim()
    line_of = {hinge: line.name for line in result.hinge_lines for hinge in line.hinges}
    marks: dict[float, str] = {}
    for time, name, _ in result.events:
        place = line_of.get(name, name)
        marks[time] = f"{marks[time]}, {place}" if time in marks else place
    for time, names in marks.items():
        if left <= time <= right:
            axes.axvline(time, color="0.4", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
            if len(marks) <= _EVENT_LABELS:
                _label_event(axes, time, names)
    axes.set_xlabel("time, s")
    axes.set_ylabel(label)
    labels = axes.get_legend_handles_labels()[1]
    if labels:
        columns = max(1, min(5, _LEGEND_WIDTH // (max(map(len, labels)) + 7)))
        axes.legend(
            loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, ncols=columns, frameon=False
        )


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


def _curves(result: Result, names: Sequence[str], variables: Sequence[str]) -> list[tuple[str, Vector]]:
    """Labelled signals of components, those that were recorded."""
    return [
        (f"{name} {variable.replace('_', ' ')}", result.signal(name, variable))
        for name in names
        for variable in variables
        if result.has(name, variable)
    ]


def _one_a_line(result: Result, names: Sequence[str]) -> list[str]:
    """The sensor hinge of every line, and hinges that belong to no line."""
    others = {hinge for line in result.hinge_lines for hinge in line.hinges if hinge != line.sensor}
    return [name for name in names if name not in others]


def _ringing_end(time: Vector, torque: Vector, start: float) -> float:
    """End of the close-up: a few changes of sign after the latch-up."""
    after = time > start
    t, v = time[after], torque[after]
    crossings = t[1:][np.diff(np.sign(v)) != 0.0]
    return float(crossings[_CLOSE_UP_CROSSINGS] if crossings.size > _CLOSE_UP_CROSSINGS else time[-1])


def _dissipated_by_cause(result: Result) -> list[tuple[str, Vector]]:
    """Dissipated energy by cause; components that tell no causes count by what they are."""
    found: dict[str, Vector] = {}
    for name in result.recording("dissipated_energy"):
        if name == "scene":
            continue
        causes = [(c, text) for c, text in _CAUSES.items() if result.has(name, c)]
        if not causes:
            what = next((text for mark, text in _MARKS.items() if result.has(name, mark)), "other")
            causes = [("dissipated_energy", what)]
        for variable, cause in causes:
            found[cause] = found.get(cause, 0.0) + result.signal(name, variable)
    return list(found.items())


def _instants(result: Result) -> NDArray[np.int64]:
    """Rows of the pictures: equal parts of the way all hinges turn until the last latch-up."""
    latched = [time for time, _, text in result.events if is_latch_up(text)]
    end = int(np.searchsorted(result.time, max(latched, default=result.time[-1]), side="right"))
    way = np.zeros(end)
    for name in result.recording("angle"):
        way[1:] += np.abs(np.diff(result.signal(name, "angle")[:end]))
    way = np.cumsum(way) if np.any(way) else result.time[:end]
    levels = np.linspace(way[0], way[-1], _INSTANTS)
    return np.unique(np.minimum(np.searchsorted(way, levels), end - 1))


def _placed(result: Result, name: str, body: Geometry, rows: NDArray[np.int64]) -> Vector:
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
