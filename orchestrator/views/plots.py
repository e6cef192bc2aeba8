"""Figures of a result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from components import FanfoldError
from components.contract.component import Vector
from components.contract.errors import unknown
from components.contract.roles import ATTITUDE, DISSIPATION, INTERFACE_LOAD, LOAD

from ..analysis.motion.histories import chosen
from ..results import point_loads
from ..results.crests import Peak
from ..results.key_figures import latch_times, line_latch_torque
from ..results.line_travel import overruns
from ..results.peaks import extremes, peak
from ..results.result import Result, ResultError
from .motion.histories import draw_histories
from .motion.plates import draw_plates
from .shapes import shapes
from .style import (
    COLOURS,
    STYLE,
    as_written,
    draw,
    finish,
    new_columns,
    new_figure,
    save_figure,
    share_legend,
    tell_of_interruption,
)

_CLOSE_UP_CROSSINGS = 8
_SWING = 2
"""Changes of sign before another line latches, from which on that is the end of a close-up."""
_ROUNDING = 1e-9  # of the sum of causes
_UNSEEN = 1e-3
"""Fraction of the largest load of a unit, about the width of a line."""

ENERGIES: Final = {
    "stored_energy": "stored",
    "dissipated_energy": "dissipated",
    "numerical_dissipation": "numerical loss",
    "supplied_energy": "supplied",
}
"""Energies of a scene (J) in the balance, and their names in figures."""


class Drawing(NamedTuple):
    """A figure, its name, and a sentence on what it shows."""

    name: str
    caption: str
    figure: Figure


def draw_all(result: Result) -> Iterator[Drawing]:
    """Every figure that the signals of the result allow, in the style of all figures."""
    with mpl.rc_context(STYLE):
        for name, (caption, draw_it) in _drawers(result).items():
            figure = draw_it()
            if figure is not None:
                tell_of_interruption(figure, result)
                yield Drawing(name, caption, as_written(figure))
        yield from _of_motions(result)


def draw_one(result: Result, name: str) -> Drawing:
    """The figure of a name, without the suffix of its file; ResultError where the result has none such."""
    known = _drawers(result)
    if name not in known:
        with mpl.rc_context(STYLE):
            for drawing in _of_motions(result):
                if drawing.name == name:
                    return drawing
        raise ResultError(f"{result.name}: there is no figure {name!r}; figures are {', '.join(known)}")
    caption, draw_it = known[name]
    with mpl.rc_context(STYLE):
        figure = draw_it()
    if figure is None:
        raise ResultError(f"{result.name}: it has no signals for the figure {name!r}")
    tell_of_interruption(figure, result)
    return Drawing(name, caption, as_written(figure))


def _of_motions(result: Result) -> Iterator[Drawing]:
    """Figures of a run that follows a prescribed motion."""
    for name, caption, figure in (*draw_histories(result), *draw_plates(result)):
        tell_of_interruption(figure, result)
        yield Drawing(name, caption, as_written(figure))


def _drawers(result: Result) -> dict[str, tuple[str, Callable[[], Figure | None]]]:
    """Caption and function of every figure by name: those of all results, and the loads of the kinds in this one."""
    known: dict[str, tuple[str, Callable[[], Figure | None]]] = {
        name: ((draw_it.__doc__ or name).strip().splitlines()[0], partial(draw_it, result))
        for name, draw_it in (_FIGURES | _added).items()
    }
    for name, found in loads_by_kind(result).items():
        known[name] = (f"{loads_title(result, found)}.", partial(loads, result, found))
    return known


Watch = Callable[[str], None]
"""Takes the name of a figure that is about to be written."""


def plot_all(
    result: Result, directory: str | Path, format: str = "png", watch: Watch | None = None
) -> list[Path]:
    """Write every figure that the signals of the result allow; the paths written."""
    return write_all(draw_all(result), Path(directory), format, watch)


def write_all(
    drawings: Iterable[Drawing], directory: Path, format: str = "png", watch: Watch | None = None
) -> list[Path]:
    """Write figures into a folder that is made if missing, under their names; the paths written.

    FanfoldError for a format that there is none of.
    """
    if format not in (known := sorted(FigureCanvasBase.filetypes)):
        raise FanfoldError(f"format {unknown(format, known, 'format')}")
    directory.mkdir(parents=True, exist_ok=True)
    written = []
    for name, _, figure in drawings:
        if watch is not None:
            watch(name)
        written.append(directory / f"{name}.{format}")
        save_figure(figure, written[-1])
    return written


def deployment_angles(result: Result) -> Figure | None:
    """Hinge angles; dashed: deployed angle of lines without latch."""
    names = result.recording("angle")
    if not names:
        return None
    figure, (axes,) = new_figure("Deployment angles", [1.0])
    lines = {line.sensor: line.name for line in result.hinge_lines}
    shown = one_a_line(result, names)
    draw(
        axes,
        result.time,
        [(lines.get(name, name), np.rad2deg(result.signal(name, "angle"))) for name in shown],
    )
    meant = {line.deployed_angle for line in result.hinge_lines if line.name in overruns(result)}
    for angle in sorted(np.rad2deg([angle for angle in meant if angle is not None])):
        axes.axhline(
            angle, color="0.2", linewidth=0.9, linestyle=(0, (6, 3)), label=f"deployed at {angle:g} deg"
        )
    finish(axes, result, "hinge angle, deg")
    return figure


def latch_torques(result: Result) -> Figure | None:
    """Latch torque of every hinge line, and close-ups of its vibration until the next latch-up."""
    times = latch_times(result)
    lines = [line for line in result.hinge_lines if times.get(line.name, np.inf) < result.time[-1]]
    if not lines:
        return None
    figure, axes = new_figure("Latch torque, sum over the hinges of a line", [1.4] + [1.0] * len(lines))
    torques = [(line.name, line_latch_torque(result, line)) for line in lines]
    for k, (close_up, (name, torque)) in enumerate(zip(axes[1:], torques, strict=True)):
        start, following = times[name], min((t for t in times.values() if t > times[name]), default=np.inf)
        swings = _crossings(result.time, torque, start)
        if np.count_nonzero(swings < following) < _SWING:
            following = np.inf
        top = _peak_between(result, torque, start, following)
        ringing = float([*swings, *[result.time[-1]] * (_CLOSE_UP_CROSSINGS + 1)][_CLOSE_UP_CROSSINGS])
        end = min(following, max(top.time, ringing))
        left = start - 0.08 * (end - start)
        shown = (result.time >= left) & (result.time <= end)
        draw(close_up, result.time[shown], [(name, torque[shown])], first=k)
        if start < top.time < result.time[shown][-1]:  # not where the close-up is cut
            _mark(close_up, top, f"{name} peak {top.value:.4g} N.m at {top.time:.4f} s")
        close_up.set_xlim(left, end)
        finish(close_up, result, "latch torque, N.m")
        largest, label = peak(result, torque), name
        if abs(largest.value) > abs(top.value):
            _mark(axes[0], largest)
            label = f"{name}, largest {largest.value:.4g} N.m at {largest.time:.2f} s"
        draw(axes[0], result.time, [(label, torque)], first=k)
    finish(axes[0], result, "latch torque, N.m")
    return figure


def _peak_between(result: Result, values: Vector, start: float, end: float) -> Peak:
    """Value of largest magnitude from one instant until another, which is left out, with its sign."""
    part = slice(int(np.searchsorted(result.time, start)), int(np.searchsorted(result.time, end)))
    low, high = extremes(result.time[part], values[part], [time for time, _, _ in result.events])
    return high if abs(high.value) >= abs(low.value) else low


def _mark(axes: Axes, top: Peak, label: str | None = None) -> None:
    """A ring around a peak, whole at the edge of the axes as well."""
    axes.plot(top.time, top.value, "ko", markerfacecolor="none", label=label, clip_on=False)


def loads(result: Result, found: Sequence[tuple[str, str]]) -> Figure:
    """Loads of one kind of component, one panel a unit."""
    names = {name for name, _ in found}
    units = dict.fromkeys(result.unit(*of) for of in found)
    figure, axes = new_figure(loads_title(result, found), [1.0] * len(units))
    for panel, unit in zip(axes, units, strict=True):
        shown = [of for of in found if result.unit(*of) == unit]
        draw(panel, result.time, [curve for of in shown for curve in curves_of(result, *of, len(names) > 1)])
        finish(panel, result, f"{'torque' if unit == 'N.m' else 'force'}, {unit}")
    return figure


def loads_by_kind(result: Result) -> dict[str, list[tuple[str, str]]]:
    """Components and variables of all loads, by the name of their figure."""
    found: dict[str, list[tuple[str, str]]] = {}
    for name, variable in result.in_role(INTERFACE_LOAD, LOAD):
        kind = result.noun(name).replace(" ", "_").replace("-", "_")
        found.setdefault(f"{kind}_loads", []).append((name, variable))
    return found


def loads_title(result: Result, found: Sequence[tuple[str, str]]) -> str:
    """Title of the loads of one kind of component."""
    return f"Loads: {result.noun(found[0][0])}"


def curves_of(result: Result, name: str, variable: str, with_name: bool) -> Iterator[tuple[str, Vector]]:
    """Labelled curves of a signal, one an axis of a vector."""
    values, words = result.signal(name, variable), variable.replace("_", " ")
    label = f"{name} {words}" if with_name else words
    if values.ndim == 1:
        yield label, values
    else:
        yield from ((f"{label} {axis}", v) for axis, v in zip("xyz", values.T, strict=True))


def port_loads(result: Result) -> Figure | None:
    """Loads on the spacecraft by attachment, in its axes, about each. Components below 0.1 % are not shown."""
    return _loads_at_points(result, "Loads at the attachments of the spacecraft", point_loads.port_loads)


def hinge_loads(result: Result) -> Figure | None:
    """Loads of hinges on outboard bodies, in axes of the inboard port. Components below 0.1 % are not shown."""
    return _loads_at_points(result, "Loads at the hinges between bodies", point_loads.hinge_loads)


def _loads_at_points(
    result: Result, title: str, of: Callable[[Result, str], dict[str, Vector]]
) -> Figure | None:
    """A column of panels for the axes of the force, and one for those of the torque."""
    units = [list(_panels_of_vectors(of(result, unit), unit)) for unit in ("N", "N.m")]
    columns = [panels for panels in units if panels]
    if not columns:
        return None
    figure, grid = new_columns(title, [len(panels) for panels in columns])
    for panels, column in zip(columns, grid, strict=True):
        for axes, (label, curves) in zip(column, panels, strict=True):
            draw(axes, result.time, curves)
            finish(axes, result, label, legend=False)
    share_legend(figure)
    return figure


def _panels_of_vectors(
    loads: Mapping[str, Vector], unit: str
) -> Iterator[tuple[str, list[tuple[str, Vector]]]]:
    """Label and curves of each axis along which any of the vectors has something to be seen."""
    sizes = np.array([np.abs(load).max(0) for load in loads.values()]).reshape(-1, 3).max(0, initial=0.0)
    for k in np.flatnonzero(sizes > _UNSEEN * sizes.max()).tolist():
        label = f"{'torque' if unit == 'N.m' else 'force'} {'xyz'[k]}, {unit}"
        yield label, [(name, load[:, k]) for name, load in loads.items()]


def attitude(result: Result) -> Figure | None:
    """Attitude of a free spacecraft as a rotation vector, and its rate in its axes."""
    found = result.in_role(ATTITUDE)
    if not found:
        return None
    figure, axes = new_figure("Attitude of the spacecraft", [1.0] * len(found))
    for panel, of in zip(axes, found, strict=True):
        curves = [
            (axis, np.rad2deg(values)) for axis, values in zip("xyz", result.signal(*of).T, strict=True)
        ]
        draw(panel, result.time, curves)
        finish(panel, result, f"{of[1].replace('_', ' ')}, {result.unit(*of).replace('rad', 'deg')}")
    return figure


def energy_balance(result: Result) -> Figure | None:
    """Stored, dissipated (by cause) and supplied energy, numerical loss, and the residual of the balance."""
    if not result.has("scene", "stored_energy"):
        return None
    signals = [
        (label, result.signal("scene", channel))
        for channel, label in ENERGIES.items()
        if result.has("scene", channel)
    ]
    totals = [(label, energy) for label, energy in signals if energy.any()]
    figure, axes = new_figure("Energy balance", [1.0, 1.0, 0.8])
    draw(axes[0], result.time, totals)
    draw(axes[1], result.time, dissipated_by_cause(result))
    if result.has("scene", "energy_residual"):
        axes[2].plot(result.time, result.signal("scene", "energy_residual"), color=COLOURS[0])
    for panel, label in zip(axes, ("energy, J", "dissipated, J", "residual, J"), strict=True):
        finish(panel, result, label)
    return figure


def steps(result: Result) -> Figure | None:
    """Communication step size and iterations."""
    channels = (("step_size", "step size, s"), ("iterations", "iterations"))
    if not all(result.has("scene", variable) for variable, _ in channels):
        return None
    figure, axes = new_figure("Communication steps", [1.0, 1.0])
    for panel, (variable, label) in zip(axes, channels, strict=True):
        values = result.signal("scene", variable)
        shown = values > 0.0
        panel.plot(
            result.time[shown], values[shown], color=COLOURS[0], marker=".", markersize=3, linestyle=""
        )
        if result.time[-1] > result.time[0]:  # of one row there is nothing to fit
            panel.set_xlim(result.time[0], result.time[-1])
        finish(panel, result, label)
    if np.any(result.signal("scene", "step_size") > 0.0):  # none where a run ended after its first row
        axes[0].set_yscale("log")
    axes[1].yaxis.set_major_locator(MaxNLocator(integer=True))
    return figure


_FIGURES: Final[dict[str, Callable[[Result], Figure | None]]] = {
    "deployment_angles": deployment_angles,
    "latch_torques": latch_torques,
    "attitude": attitude,
    "port_loads": port_loads,
    "hinge_loads": hinge_loads,
    "energy_balance": energy_balance,
    "steps": steps,
    "shapes": shapes,
}


_added: dict[str, Callable[[Result], Figure | None]] = {}
"""Figures from outside."""


def add_figure(name: str, draw_it: Callable[[Result], Figure | None]) -> None:
    """Draw one more figure of every result; ResultError where the name is that of one of Fanfold's own."""
    if name in _FIGURES:
        raise ResultError(f"there is a figure {name!r} already; give yours another name")
    _added[name] = draw_it


def one_a_line(result: Result, names: Sequence[str]) -> list[str]:
    """The sensor hinge of every line, and hinges that belong to no line, of arrays the first."""
    others = {hinge for line in result.hinge_lines for hinge in line.hinges if hinge != line.sensor}
    shown = [name for name in names if name not in others]
    of_lines = {line.sensor for line in result.hinge_lines}
    free = chosen([name for name in shown if name not in of_lines])
    return [name for name in shown if name in of_lines or name in free]


def _crossings(time: Vector, torque: Vector, start: float) -> Vector:
    """Times at which a torque changes its sign after a latch-up."""
    after = time > start
    crossings: Vector = time[after][1:][np.diff(np.sign(torque[after])) != 0.0]
    return crossings


def dissipated_by_cause(result: Result) -> list[tuple[str, Vector]]:
    """Dissipated energy by cause since the start, and the numerical loss.

    Dissipation without a recorded cause counts under the kind of its component; that of a static search is excluded.
    """
    causes: dict[str, list[str]] = {}
    for name, variable in result.in_role(DISSIPATION):
        causes.setdefault(name, []).append(variable)
    found: dict[str, Vector] = {}
    for name in result.recording("dissipated_energy"):
        if name == "scene":
            continue
        total, kind = result.signal(name, "dissipated_energy"), result.noun(name)
        for variable in causes.get(name, ()):
            energy = result.signal(name, variable)
            cause = f"{kind} {variable.removesuffix('_energy')}"
            found[cause] = found.get(cause, 0.0) + energy - energy[0]
            total = total - energy
        rest = total - total[0]
        if name not in causes or np.abs(rest).max() > _ROUNDING * np.abs(total).max(initial=1.0):
            found[kind] = found.get(kind, 0.0) + rest
    if result.has("scene", "numerical_dissipation"):
        found["numerical loss"] = result.signal("scene", "numerical_dissipation")
    return list(found.items())
