"""Figure of impacts: contact forces over the run, and the hardest of each contact close up."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

from ..analysis.impact import Impact
from ..results.result import Result
from .style import STYLE, draw, new_figure


def draw_impacts(path: Path, result: Result, found: list[Impact]) -> None:
    """Contact forces over the run, and the hardest impact of each contact close up."""
    contacts = list(dict.fromkeys(impact.contact for impact in found))
    hardest = [max((i for i in found if i.contact == name), key=lambda i: i.peak_force) for name in contacts]
    with mpl.rc_context(STYLE):
        figure, axes = new_figure("Contact force", [1.0] * (1 + len(contacts)))
        draw(axes[0], result.time, [(name, result.signal(name, "contact_force")) for name in contacts])
        axes[0].set(xlabel="time, s", ylabel="contact force, N")
        axes[0].legend(loc="best", frameon=False)
        for panel, impact in zip(axes[1:], hardest, strict=True):
            margin = 0.3 * impact.duration + 1e-6
            shown = (result.time > impact.start - margin) & (
                result.time < impact.start + impact.duration + margin
            )
            force = result.signal(impact.contact, "contact_force")[shown]
            draw(panel, 1e3 * (result.time[shown] - impact.start), [(impact.contact, force)])
            label = f"{impact.peak_force:.4g} N at {impact.peak_time:.4f} s"
            panel.plot(
                1e3 * (impact.peak_time - impact.start),
                impact.peak_force,
                "ko",
                fillstyle="none",
                label=label,
            )
            panel.set(xlabel="time since touch, ms", ylabel="contact force, N")
            panel.legend(loc="best", frameon=False)
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)
