"""Impacts of a run: every touch of every contact, how hard, how long, and what it took away.

Bagnoli (2007), sections 2.3.1 and 6.1.2: with a raised holding torque of the SADM the latching outboard panel
throws the inboard one against the spacecraft.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from ..cli.types import Picture
from ..results.key_figures import extremes
from ..results.result import Result, ResultError
from ..views.style import STYLE, draw, new_figure
from ._tables import plain_table

Vector = NDArray[np.float64]

_NUMBER = 7

_SHORTEST_GAP = 1e-3
"""Touches of one contact that are less than this apart (s) are one impact that chatters."""


@dataclass(frozen=True)
class Impact:
    """One touch of one contact."""

    contact: str
    start: float
    """s"""
    duration: float
    """s"""
    closing_speed: float
    """of penetration at first touch, m/s"""
    peak_force: float
    """N"""
    peak_time: float
    """s"""
    impulse: float
    """N.s"""
    deepest: float
    """penetration, m"""
    dissipated: float
    """J"""


def impacts(result: Result) -> list[Impact]:
    """All touches that a result holds, in order of time; ResultError where it has no contact."""
    names = result.recording("contact_force")
    if not names:
        raise ResultError(f"{result.path}: the scene has no contact, so there is no impact to look for")
    found = [impact for name in names for impact in _impacts_of(result, name)]
    return sorted(found, key=lambda impact: impact.start)


def _impacts_of(result: Result, name: str) -> Iterator[Impact]:
    time = result.time
    depth = result.signal(name, "penetration")
    force = result.signal(name, "contact_force")
    heat = result.signal(name, "dissipated_energy")
    for first, last in _touches(time, depth):
        inside = slice(first, last + 1)
        start, end = _crossing(time, depth, first - 1), _crossing(time, depth, last)
        _, top = extremes(time[inside], force[inside])
        _, deepest = extremes(time[inside], depth[inside])
        yield Impact(
            name,
            start,
            end - start,
            closing_speed(time, depth, first, start),
            top.value,
            top.time,
            float(np.trapezoid(np.r_[0.0, force[inside], 0.0], np.r_[start, time[inside], end])),
            deepest.value,
            float(heat[min(last + 1, time.size - 1)] - heat[max(first - 1, 0)]),
        )


def _touches(time: Vector, depth: Vector) -> list[tuple[int, int]]:
    """First and last sample of every touch; a gap too short to be one does not part two."""
    touching = np.flatnonzero(depth > 0.0)
    found: list[tuple[int, int]] = []
    for sample in touching.tolist():
        if found and (sample == found[-1][1] + 1 or time[sample] - time[found[-1][1]] < _SHORTEST_GAP):
            found[-1] = (found[-1][0], sample)
        else:
            found.append((sample, sample))
    return found


def _crossing(time: Vector, depth: Vector, sample: int) -> float:
    """Time at which the penetration passes zero after a sample; the end of the record where it does not."""
    if sample < 0 or sample + 1 >= time.size:
        return float(time[0] if sample < 0 else time[-1])
    before, after = depth[sample], depth[sample + 1]
    return float(time[sample] + (time[sample + 1] - time[sample]) * before / (before - after))


def closing_speed(time: Vector, depth: Vector, sample: int, touch: float) -> float:
    """Rate of penetration at the touch, from the parabola through the three samples before it; 0 at the start.

    Of the two samples at an event only the second, from which the motion goes on.
    """
    before = np.flatnonzero(np.diff(time[: sample + 1]) > 0.0)[-3:]
    if before.size < 3:
        return 0.0
    return float(np.polyval(np.polyder(np.polyfit(time[before] - touch, depth[before], 2)), 0.0))


def impact_table(found: list[Impact]) -> Table:
    """For people."""
    table = plain_table("impacts")
    table.add_column("contact")
    for heading in (
        "at, s",
        "for, ms",
        "closing, mm/s",
        "peak, N",
        "impulse, N.s",
        "deepest, mm",
        "lost, mJ",
    ):
        table.add_column(heading, justify="right", min_width=_NUMBER)
    for k in found:
        values = (1e3 * k.duration, 1e3 * k.closing_speed, k.peak_force, k.impulse, 1e3 * k.deepest)
        table.add_row(
            k.contact, f"{k.start:.4f}", *(f"{value:.4g}" for value in values), f"{1e3 * k.dissipated:.3g}"
        )
    return table


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


@click.command("impact")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "--output", type=Picture(), metavar="FILE",
    help="Picture to write; by default named after RESULT, with .impact.png.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(result: Path, output: Path | None, as_json: bool) -> None:
    """Impacts in RESULT: when, how hard, how long, and the energy they took."""
    opened = Result.open(result)
    found = impacts(opened)
    picture = output or result.with_suffix(".impact.png")
    if found:
        draw_impacts(picture, opened, found)
    if as_json:
        click.echo(json.dumps({"impacts": [asdict(impact) for impact in found]}))
        return
    if not found:
        click.echo("nothing touched; no picture was drawn")
        return
    Console().print(impact_table(found))
    click.echo(picture)
