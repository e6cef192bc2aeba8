"""Figure of impacts: forces of contacts and torques of end stops over the run, and the hardest of each close up."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

from ..analysis.impact import CONTACT_FORCE, STOP_TORQUE, Impact
from ..results.result import Result
from .style import STYLE, draw, new_figure, save_figure


def draw_impacts(path: Path, result: Result, found: list[Impact]) -> None:
    """Loads over the run, and the hardest impact of each contact and end stop close up."""
    loads = sorted({impact.angular for impact in found})
    names = list(dict.fromkeys((impact.angular, impact.contact) for impact in found))
    hardest = [
        max((i for i in found if i.contact == name), key=lambda i: i.peak_force)
        for _, name in sorted(names, key=lambda one: one[0])
    ]
    with mpl.rc_context(STYLE):
        figure, axes = new_figure("Impacts", [1.0] * (len(loads) + len(hardest)))
        for panel, angular in zip(axes, loads, strict=False):
            shown = [name for is_angular, name in names if is_angular == angular]
            draw(panel, result.time, [(name, result.signal(name, _load(angular))) for name in shown])
            panel.set(xlabel="time, s", ylabel=_label(angular))
            panel.legend(loc="best", frameon=False)
        for panel, impact in zip(axes[len(loads) :], hardest, strict=True):
            _draw_impact(panel, result, impact)
        path.parent.mkdir(parents=True, exist_ok=True)
        save_figure(figure, path)


def _draw_impact(panel: mpl.axes.Axes, result: Result, impact: Impact) -> None:
    margin = 0.3 * impact.duration + 1e-6
    shown = (result.time > impact.start - margin) & (result.time < impact.start + impact.duration + margin)
    load = result.signal(impact.contact, _load(impact.angular))[shown]
    draw(panel, 1e3 * (result.time[shown] - impact.start), [(impact.contact, load)])
    unit = "N.m" if impact.angular else "N"
    label = f"{impact.peak_force:.4g} {unit} at {impact.peak_time:.4f} s"
    since_touch = 1e3 * (impact.peak_time - impact.start)
    panel.plot(since_touch, impact.peak_force, "ko", fillstyle="none", label=label)
    panel.set(xlabel="time since touch, ms", ylabel=_label(impact.angular))
    panel.legend(loc="best", frameon=False)


def _load(angular: bool) -> str:
    return STOP_TORQUE if angular else CONTACT_FORCE


def _label(angular: bool) -> str:
    return "stop torque, N.m" if angular else "contact force, N"
