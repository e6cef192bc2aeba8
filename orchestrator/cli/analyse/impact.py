"""`fanfold analyse impact`: every touch in a result, as a table and a picture."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...api.options import Picture
from ..command import made_of

if TYPE_CHECKING:
    from rich.table import Table

    from ...analysis.impact import Impact


def impact_table(found: list[Impact], angular: bool) -> Table:
    """For people: those of contacts, or of end stops."""
    from ..tables import table_of

    what, way, load = ("end stop", "mrad", "N.m") if angular else ("contact", "mm", "N")
    headings = (
        what,
        "at, s",
        "for, ms",
        f"closing, {way}/s",
        f"peak, {load}",
        f"impulse, {load}.s",
        f"deepest, {way}",
        "lost, mJ",
    )
    rows = []
    for k in (impact for impact in found if impact.angular == angular):
        values = (1e3 * k.duration, 1e3 * k.closing_speed, k.peak_force, k.impulse, 1e3 * k.deepest)
        shown = (f"{value:.4g}" for value in values)
        rows.append((k.contact, f"{k.start:.4f}", *shown, f"{1e3 * k.dissipated:.3g}"))
    return table_of("impacts in end stops" if angular else "impacts", headings, rows, (what,))


@made_of("impacts", name="impact")
def command(result: Path, output: Picture | None = None, as_json: bool = False) -> None:
    """Impacts of all contacts and end stops in RESULT: time, speed, peak load, impulse, energy loss.

    Options
    -------
    output
        picture; by default RESULT.impact.png
    """
    opened = fanfold.Result.open(result)
    found = fanfold.impacts(opened)
    picture = output or result.with_suffix(".impact.png")
    if found:
        from ...views.impact import draw_impacts  # matplotlib takes its time

        draw_impacts(picture, opened, found)
    if as_json:
        click.echo(json.dumps({"impacts": [asdict(impact) for impact in found]}))
        return
    if not found:
        click.echo("no impacts; no picture was drawn")
        return
    from ..tables import terminal

    for angular in sorted({impact.angular for impact in found}):
        terminal().print(impact_table(found, angular))
    click.echo(picture)
