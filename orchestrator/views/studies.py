"""Figures of studies: latch torques of all cases over each other, and their changes over what was changed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from ..analysis.studies import Case, LatchStudy, latch_rows
from ..results.key_figures import line_latch_torque
from .style import STYLE, draw, new_figure, save_figure

_RINGING = 0.5
"""s after latch-up that are shown"""


def plot_study(study: LatchStudy, folder: Path) -> list[Path]:
    """Pictures of the latch torques, and of their changes over what was changed; the paths written."""
    paths = [folder / "latch_torques.png", folder / "changes.png"]
    draw_latch_torques(paths[0], study.title, study.shown)
    draw_changes(paths[1], f"Relative to {study.against}", study.changed, study.cases, study.reference)
    return paths


def draw_latch_torques(path: Path, title: str, cases: Sequence[Case]) -> None:
    """Latch torque of every line that latched, all cases over each other, for a while after latch-up."""
    lines = list(cases[-1].outcome.headline.latch_times)
    with mpl.rc_context(STYLE):
        figure, axes = new_figure(title, [1.0] * len(lines))
        for panel, name in zip(axes, lines, strict=True):
            for k, case in enumerate(cases):
                result = case.outcome.result
                start = case.outcome.headline.latch_times.get(name)
                if start is None:
                    continue
                line = next(line for line in result.hinge_lines if line.name == name)
                shown = (result.time >= start - 0.05 * _RINGING) & (result.time <= start + _RINGING)
                torque = line_latch_torque(result, line)[shown]
                draw(panel, 1e3 * (result.time[shown] - start), [(case.label, torque)], first=k)
            panel.set(xlabel="time since latch-up, ms", ylabel=f"{name} latch torque, N.m")
            panel.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, frameon=False)
        save_figure(figure, path)


def draw_changes(path: Path, title: str, label: str, cases: Sequence[Case], reference: Case) -> None:
    """Change of every latch torque peak (%) over what the study changed, the reference left out."""
    curves: dict[str, tuple[list[float], list[float]]] = {}
    for case in cases:
        if case is reference:
            continue
        for line, _, _, _, change in latch_rows(case, reference):
            values, changes = curves.setdefault(line, ([], []))
            values.append(case.value)
            changes.append(abs(change))
    with mpl.rc_context(STYLE):
        figure, (axes,) = new_figure(title, [1.2])
        for k, (line, (values, changes)) in enumerate(curves.items()):
            draw(axes, np.array(values), [(line, np.array(changes))], first=k)
            axes.lines[-1].set_marker("o")
        axes.set(xlabel=label, ylabel="change of latch torque peak, %")
        _plain_decades(axes, [change for _, changes in curves.values() for change in changes])
        studied = sorted({value for values, _ in curves.values() for value in values})
        if studied and studied[0] > 0.0:
            axes.set_xscale("log")
            axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticks(studied, [f"{value:g}" for value in studied])
        axes.margins(x=0.05)
        axes.legend(loc="best", frameon=False)
        save_figure(figure, path)


def _plain_decades(axes: Axes, changes: Sequence[float]) -> None:
    """A logarithmic y axis over whole decades, at least one, with plain numbers; linear where nothing changed."""
    above = [change for change in changes if change > 0.0]
    if not above:
        return
    low, high = np.floor(np.log10(min(above))), np.ceil(np.log10(max(above)))
    axes.set(yscale="log", ylim=(10.0**low, 10.0 ** max(high, low + 1.0)))
    axes.yaxis.set_major_locator(LogLocator(numticks=8))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
