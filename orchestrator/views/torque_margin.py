"""Figure of the torque margin of a line, or of coupled ones, over the travel, one curve per case and rule."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ..analysis.torque_margin.margins import TorqueMargin
from ..analysis.torque_margin.rules import LIMITS, Margins, Torques
from .style import COLOURS, STYLE, WIDTH, empty_figure, save_figure

_MARKERS: Final = ("s", "^", "D", "v", "x")
_DASHES: Final = {"sum": "-", "ECSS": "--", "GEVS": "-."}
_MARK_EVERY = 5
_ROOM = 1.25
_SHOWN = 4.0
"""Margins of so many times the worst are beyond the picture; where nothing resists they are infinite."""


def plot_margins(found: TorqueMargin, folder: Path) -> list[Path]:
    """One picture per hinge line and per group of coupled ones, all cases in it; the paths written."""
    paths = []
    for line in dict.fromkeys(one.line for one in found.lines):
        paths.append(folder / f"torque_margin_{line}.png")
        cases = [(one.case, one.torques, one.margins) for one in found.lines if one.line == line]
        draw_line(paths[-1], f"{line}: torque margin over the travel", cases)
    return paths


def draw_line(path: Path, title: str, cases: Sequence[tuple[str, Torques, Sequence[Margins]]]) -> None:
    """Margins with limit and worst angles above, driving and factored resisting torque below."""
    with mpl.rc_context(STYLE):
        figure = empty_figure(WIDTH, 5.6, "constrained")
        figure.suptitle(title)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1.4, 1.0])
        for k, (case, torques, found) in enumerate(cases):
            style = _style(k)
            _draw_margins(upper, case, torques, found, style)
            angle = np.rad2deg(torques.angle)
            lower.plot(angle, torques.driving, **style, label=f"{case}: driving")
            lower.plot(
                angle, found[0].resisting, **style, linestyle=":", label=f"{case}: resisting x factors"
            )
        limits = {LIMITS[m.rule] for *_, found in cases for m in found}
        for limit in sorted(limits):
            upper.axhline(limit, color="0.3", linewidth=1.6, linestyle=(0, (1, 1)), label=f"limit {limit:g}")
        worst = max(
            [
                *limits,
                *(m.margin[m.worst] for *_, found in cases for m in found if m.margin[m.worst] < np.inf),
            ]
        )
        upper.set_ylim(top=min(upper.get_ylim()[1], _SHOWN * worst))
        upper.set_ylim(bottom=min(0.0, upper.get_ylim()[0]))
        lower.set_ylim(0.0, _ROOM * lower.get_ylim()[1])
        upper.set_ylabel("torque margin")
        first, *others = cases[0][1].rates
        lower.set(ylabel="torque, N.m", xlabel=f"angle of {first}, deg" if others else "hinge angle, deg")
        lower.xaxis.set_major_locator(MaxNLocator(steps=[1.5, 3, 4.5, 9]))
        for axes in (upper, lower):
            axes.margins(x=0.02)
            axes.legend(
                ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, frameon=False
            )
        save_figure(figure, path)


def _style(k: int) -> dict[str, Any]:
    """Colour and marker of a case."""
    k %= len(_MARKERS)
    return {"color": COLOURS[k], "marker": _MARKERS[k], "markersize": 4, "markevery": (k, _MARK_EVERY)}


def _draw_margins(
    axes: Axes, case: str, torques: Torques, found: Sequence[Margins], style: Mapping[str, Any]
) -> None:
    """Curves of a case; the worst point of each is ringed and told in the legend."""
    angle = np.rad2deg(torques.angle)
    for margins in found:
        finite = np.where(np.isfinite(margins.margin), margins.margin, np.nan)
        at, value = angle[margins.worst], margins.margin[margins.worst]
        worst = f"worst {value:.2f} at {at:.0f} deg" if np.isfinite(value) else "no resisting torque"
        label = f"{case}, {margins.rule} rule: {worst}"
        axes.plot(angle, finite, **style, linestyle=_DASHES[margins.rule], label=label)
        if np.isfinite(value):
            ring: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": "none"}
            axes.plot(at, value, color=style["color"], linestyle="none", clip_on=False, zorder=5, **ring)
