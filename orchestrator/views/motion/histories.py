"""Figures over time of runs with a prescribed motion, of one run and of several over each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import matplotlib as mpl
from matplotlib.figure import Figure

from ...analysis.motion.histories import History, histories
from ...results.result import Result
from ..style import COLOURS, DASHES, STYLE, draw, finish, new_figure


def draw_histories(result: Result) -> Iterator[tuple[str, str, Figure]]:
    """Name, caption and figure of every history."""
    for history in histories(result):
        yield history.name, history.caption, _figure(result, history)


def _figure(result: Result, history: History) -> Figure:
    figure, axes = new_figure(_title(history), [0.85] * len(history.panels))
    for panel, (label, curves) in zip(axes, history.panels, strict=True):
        for k, (name, (time, values)) in enumerate(curves.items()):
            draw(panel, time, [(name, values)], first=k)
        panel.set_xlim(result.time[0], result.time[-1])
        finish(panel, result, label)
    return figure


def _title(history: History) -> str:
    return history.name.replace("_", " ").capitalize()


def overlays(results: Mapping[str, Result]) -> Iterator[tuple[str, str, Figure]]:
    """Name, caption and figure of every history that at least two of the runs have, one colour a run."""
    found = {run: {one.name: one for one in histories(result)} for run, result in results.items()}
    names = dict.fromkeys(name for ones in found.values() for name in ones)
    for name in names:
        runs = {run: ones[name] for run, ones in found.items() if name in ones}
        if len(runs) > 1:
            first = next(iter(runs.values()))
            with mpl.rc_context(STYLE):
                figure = _overlay(results, runs)
            yield name, f"{first.caption.rstrip('.')}: {', '.join(runs)}.", figure


def _overlay(results: Mapping[str, Result], runs: Mapping[str, History]) -> Figure:
    order = list(results)
    panels = _common(list(runs.values()))
    figure, axes = new_figure(_title(next(iter(runs.values()))), [0.85] * len(panels))
    for panel, (label, curve) in zip(axes, panels, strict=True):
        for run, history in runs.items():
            shown = next(
                (one.curves[curve] for one in history.panels if one.label == label and curve in one.curves),
                None,
            )
            if shown is not None:
                k = order.index(run)
                style = {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
                panel.plot(*shown, label=run, **style)
        panel.set(xlabel="time, s", ylabel=label)
        panel.set_title(curve, fontsize=9)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(labels)), frameon=False)
    return figure


def _common(runs: Sequence[History]) -> list[tuple[str, str]]:
    """Labels of panels and names of their first curves, of any run, in order."""
    found = {
        (panel.label, name): None
        for history in runs
        for panel in history.panels
        for name in list(panel.curves)[:_CURVES]
    }
    return list(found)


_CURVES = 3
"""Of a panel, in overlays."""
