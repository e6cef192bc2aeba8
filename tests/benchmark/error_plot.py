"""Pictures of errors against wall time: a row for every subject, latch times left, latch torque peaks right.

Lines join the best runs of a series.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from orchestrator.results.result import Vector

KINDS = ("latch time", "latch torque peak")
_LEAST = 1e-9
"""Errors are drawn no smaller, so that an exact hit has a place on the axis."""


class Point(NamedTuple):
    """One run of a series: wall time (s), errors that are relative, the largest over all lines, NaN without an answer.

    estimated: a wall time that is known without a run; the picture has it as a line at every error.
    """

    series: str
    setting: str
    time_error: float
    peak_error: float
    wall: float
    steps: int = 0
    estimated: bool = False


def error_texts(point: Point) -> list[str]:
    """Both errors for a table."""
    missing = "estimated" if point.estimated else "diverged"
    return [missing if np.isnan(e) else f"{e:.1e}" for e in (point.time_error, point.peak_error)]


def plot(results: Mapping[str, Sequence[Point]], path: Path) -> None:
    """Draw and save; a series has the same colour and marker in every row."""
    figure = Figure(figsize=(11.0, 3.9 * len(results)), layout="constrained")
    axes = figure.subplots(len(results), 2, squeeze=False)
    names = list(dict.fromkeys(point.series for found in results.values() for point in found))
    for pair, (title, found) in zip(axes, results.items(), strict=True):
        for i, (axis, kind) in enumerate(zip(pair, KINDS, strict=True)):
            axis.set(xscale="log", yscale="log")
            for number, name in enumerate(names):
                _draw(axis, [point for point in found if point.series == name], i, number)
            axis.set(title=f"{title}: {kind}", xlabel="wall time, s", ylabel="relative error")
            axis.grid(visible=True, which="major", alpha=0.3)
        pair[1].legend(fontsize="x-small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=120)


def _draw(axis: Axes, points: Sequence[Point], kind: int, number: int) -> None:
    """One series."""
    if not points:
        return
    color, marker, label = f"C{number % 10}", "os^vDPX*<>"[number % 10], points[0].series
    if points[0].estimated:
        axis.axvline(points[0].wall, color=color, linestyle=":", label=f"{label} (estimated)")
        return
    errors = np.maximum([(point.time_error, point.peak_error)[kind] for point in points], _LEAST)
    walls = np.array([point.wall for point in points])
    axis.plot(walls, errors, color=color, marker=marker, markersize=5, linestyle="", label=label)
    best = _best(walls, errors)
    axis.plot(walls[best], errors[best], color=color)


def _best(walls: Vector, errors: Vector) -> list[int]:
    """Numbers of the runs that none as quick is as accurate as, the quickest first; without those without an answer."""
    found: list[int] = []
    for k in np.lexsort((errors, walls)).tolist():
        if not np.isnan(errors[k]) and (not found or errors[k] < errors[found[-1]]):
            found.append(k)
    return found
