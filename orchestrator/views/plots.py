"""Figures of a result."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..results.key_figures import Peak, extremes, latch_times, line_latch_torque, overruns, peak
from ..results.result import Result, ResultError
from .shapes import shapes
from .style import COLOURS, STYLE, as_written, draw, finish, new_figure, tell_of_interruption

Vector = NDArray[np.float64]

_CLOSE_UP_CROSSINGS = 8
_SWING = 2
"""Changes of sign before another line latches, from which on that is the end of a close-up."""

OTHER_FORCES: Final = ("contact_force", "tension", "normal_force", "drag_force")
"""Signals of contacts, suspensions, rails and air drag that share a figure."""

_TOTALS: Final = {
    "stored_energy": "stored",
    "dissipated_energy": "dissipated",
    "numerical_dissipation": "taken by the scheme",
    "supplied_energy": "supplied",
}
_CAUSES: Final = {
    "friction_energy": "hinge friction",
    "latch_energy": "latches",
    "damping_energy": "hinge damping",
}
_MARKS: Final = {
    "frame_position": "modal damping",
    "tension_a": "cable loops",
    "damper_torque": "dampers",
    "drive_torque": "drives",
    "contact_force": "contacts",
    "normal_force": "rails",
    "drag_force": "air drag",
    "released": "hold-downs",
    "tension": "suspensions",
}


class Drawing(NamedTuple):
    """A figure, its name, and a sentence on what it shows."""

    name: str
    caption: str
    figure: Figure


def draw_all(result: Result) -> Iterator[Drawing]:
    """Every figure that the signals of the result allow, in the style of all figures."""
    with mpl.rc_context(STYLE):
        for name, draw_it in _FIGURES.items():
            figure = draw_it(result)
            if figure is not None:
                tell_of_interruption(figure, result)
                yield Drawing(name, (draw_it.__doc__ or name).strip(), as_written(figure))


def draw_one(result: Result, name: str) -> Drawing:
    """The figure of a name, without the suffix of its file; ResultError where the result has none such."""
    if name not in _FIGURES:
        raise ResultError(f"there is no figure {name!r}; figures are {', '.join(_FIGURES)}")
    with mpl.rc_context(STYLE):
        figure = _FIGURES[name](result)
    if figure is None:
        raise ResultError(f"{result.name}: it has no signals for the figure {name!r}")
    tell_of_interruption(figure, result)
    return Drawing(name, (_FIGURES[name].__doc__ or name).strip(), as_written(figure))


def plot_all(result: Result, directory: str | Path, format: str = "png") -> list[Path]:
    """Write every figure that the signals of the result allow; the paths written."""
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    written = []
    for name, _, figure in draw_all(result):
        written.append(directory / f"{name}.{format}")
        figure.savefig(written[-1])
    return written


def deployment_angles(result: Result) -> Figure | None:
    """Angle of every hinge line over time; the deployed angle of lines that nothing kept there."""
    names = result.recording("angle")
    if not names:
        return None
    figure, (axes,) = new_figure("Deployment angles", [1.0])
    lines = {line.sensor: line.name for line in result.hinge_lines}
    shown = _one_a_line(result, names)
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
    """Latch torque of every hinge line; close-ups of each line's own ringing, until another one latches."""
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
        if start < top.time < end:
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


def cable_forces(result: Result) -> Figure | None:
    """Strand tensions and pulley forces of every closed cable loop."""
    names = result.recording("tension_a")
    if not names:
        return None
    figure, axes = new_figure("Closed cable loops", [1.0, 1.0])
    kinds = {"tension, N": ("tension_a", "tension_b"), "pulley force, N": ("axial_force", "lateral_force")}
    for panel, (label, variables) in zip(axes, kinds.items(), strict=True):
        draw(panel, result.time, _curves(result, names, variables))
        finish(panel, result, label)
    return figure


def damper_torques(result: Result) -> Figure | None:
    """Torque of every damper."""
    names = result.recording("damper_torque")
    if not names:
        return None
    figure, (axes,) = new_figure("Damper torque", [1.0])
    draw(axes, result.time, [(name, result.signal(name, "damper_torque")) for name in names])
    finish(axes, result, "damper torque, N.m")
    return figure


def drive_torques(result: Result) -> Figure | None:
    """Torque of every drive, and of every motor that is no spring of a hinge."""
    hinges = {hinge for line in result.hinge_lines for hinge in line.hinges}
    motors = [name for name in result.recording("motor_torque") if name not in hinges]
    curves = _curves(result, [*result.recording("drive_torque"), *motors], ("drive_torque", "motor_torque"))
    if not curves:
        return None
    figure, (axes,) = new_figure("Drive torque", [1.0])
    draw(axes, result.time, curves)
    finish(axes, result, "drive torque, N.m")
    return figure


def other_forces(result: Result) -> Figure | None:
    """Forces of contacts, suspensions, rails and air."""
    found = [(name, v) for v in OTHER_FORCES for name in result.recording(v)]
    if not found:
        return None
    figure, (axes,) = new_figure("Contacts, suspensions, rails and air", [1.0])
    curves = [(f"{name} {v.replace('_', ' ')}", result.signal(name, v)) for name, v in found]
    draw(axes, result.time, curves)
    finish(axes, result, "force, N")
    return figure


def interface_loads(result: Result) -> Figure | None:
    """Force and torque on the base, component by component."""
    names = result.recording("interface_force")
    if not names:
        return None
    figure, axes = new_figure("Loads at the interface with the spacecraft", [1.0, 1.0])
    for panel, variable, unit in zip(
        axes, ("interface_force", "interface_torque"), ("N", "N.m"), strict=True
    ):
        kind = variable.split("_")[1]
        curves = [
            (f"{name} {kind} {axis}" if len(names) > 1 else f"{kind} {axis}", load)
            for name in names
            for axis, load in zip("xyz", result.signal(name, variable).T, strict=True)
        ]
        draw(panel, result.time, curves)
        finish(panel, result, f"interface {kind}, {unit}")
    return figure


def energy_balance(result: Result) -> Figure | None:
    """Energy stored, dissipated (by cause), taken by the scheme and supplied; the residual on its own axis."""
    if not result.has("scene", "stored_energy"):
        return None
    signals = [
        (label, result.signal("scene", channel))
        for channel, label in _TOTALS.items()
        if result.has("scene", channel)
    ]
    totals = [(label, energy) for label, energy in signals if energy.any()]
    figure, axes = new_figure("Energy balance", [1.0, 1.0, 0.8])
    draw(axes[0], result.time, totals)
    draw(axes[1], result.time, _dissipated_by_cause(result))
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
        panel.set_xlim(result.time[0], result.time[-1])
        finish(panel, result, label)
    if np.any(result.signal("scene", "step_size") > 0.0):  # none where a run ended after its first row
        axes[0].set_yscale("log")
    axes[1].yaxis.set_major_locator(MaxNLocator(integer=True))
    return figure


_FIGURES: Final[dict[str, Callable[[Result], Figure | None]]] = {
    "deployment_angles": deployment_angles,
    "latch_torques": latch_torques,
    "cable_forces": cable_forces,
    "damper_torques": damper_torques,
    "drive_torques": drive_torques,
    "other_forces": other_forces,
    "interface_loads": interface_loads,
    "energy_balance": energy_balance,
    "steps": steps,
    "shapes": shapes,
}


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


def _crossings(time: Vector, torque: Vector, start: float) -> Vector:
    """Times at which a torque changes its sign after a latch-up."""
    after = time > start
    crossings: Vector = time[after][1:][np.diff(np.sign(torque[after])) != 0.0]
    return crossings


def _dissipated_by_cause(result: Result) -> list[tuple[str, Vector]]:
    """Dissipated energy by cause since the start, and what the scheme itself took.

    Components that tell no causes count by what they are; a static search before the run counts for nothing.
    """
    found: dict[str, Vector] = {}
    for name in result.recording("dissipated_energy"):
        if name == "scene":
            continue
        causes = [(c, text) for c, text in _CAUSES.items() if result.has(name, c)]
        if not causes:
            what = next((text for mark, text in _MARKS.items() if result.has(name, mark)), "other")
            causes = [("dissipated_energy", what)]
        for variable, cause in causes:
            energy = result.signal(name, variable)
            found[cause] = found.get(cause, 0.0) + energy - energy[0]
    if result.has("scene", "numerical_dissipation"):
        found["the scheme"] = result.signal("scene", "numerical_dissipation")
    return list(found.items())
