"""`fanfold analyse stress`: von Mises stresses of a panel's face sheets, as a table, a file and pictures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from components.flexible.stress import PeakStress

from ...analysis.stress.hot_spots import Choice, HotSpot, Indices, find_hot_spots
from ...analysis.stress.model import BodyStress, body_stress
from ...results.key_figures import latch_times
from ...results.result import Result, ResultError
from ..types import Count, Number

_COLUMNS = ("rank", "von Mises, MPa", "node", "face", "time, s", "x, m", "y, m", "insert")


def _numbers(_: click.Context, __: click.Parameter, value: str | None) -> tuple[int, ...] | None:
    if value is None:
        return None
    parts = [part.strip() for part in value.split(",") if part.strip()]
    if not parts or not all(part.isdecimal() for part in parts):
        raise click.BadParameter(f"{value!r} is no list of node numbers such as 12,40,41")
    return tuple(int(part) for part in parts)


def _rectangle(
    _: click.Context, __: click.Parameter, value: tuple[float, ...] | None
) -> tuple[float, ...] | None:
    if value is not None and (value[0] > value[1] or value[2] > value[3]):
        raise click.BadParameter("the smaller x comes before the larger, and the smaller y before the larger")
    return value


def _circle(
    _: click.Context, __: click.Parameter, value: tuple[float, ...] | None
) -> tuple[float, ...] | None:
    if value is not None and value[2] < 0.0:
        raise click.BadParameter("the radius R must not be negative")
    return value


@click.command("stress")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--body", required=True, metavar="BODY", help="The panel.")
@click.option("--count", type=Count(min=1), default=10, show_default=True, help="Hot spots.")
@click.option(
    "--radius", type=Number(min=0.0), default=0.05, show_default=True, metavar="M",
    help="Nodes this near to a hot spot are no further one, in m.",
)  # fmt: skip
@click.option("--nodes", callback=_numbers, metavar="N,N,...", help="Only these nodes of the mesh.")
@click.option(
    "--within", type=Number(), nargs=4, callback=_rectangle, metavar="X0 X1 Y0 Y1",
    help="Only nodes in this rectangle of the body's frame, in m.",
)  # fmt: skip
@click.option(
    "--around", type=Number(), nargs=3, callback=_circle, metavar="X Y R",
    help="Only nodes at most R from a point of the body's frame, in m.",
)  # fmt: skip
@click.option(
    "--insert-margin", type=Number(min=0.0), default=0, show_default=True, metavar="M",
    help="Leave out nodes nearer to rigid inserts, in m; their corners are singular.",
)  # fmt: skip
@click.option(
    "--output", type=click.Path(path_type=Path, file_okay=False),
    help="Folder for table and pictures; by default named after RESULT.",
)  # fmt: skip
def command(
    result: Path,
    body: str,
    count: int,
    radius: float,
    nodes: tuple[int, ...] | None,
    within: tuple[float, float, float, float] | None,
    around: tuple[float, float, float] | None,
    insert_margin: float,
    output: Path | None,
) -> None:
    """Von Mises stresses of a flexible panel in RESULT: hot spots, peak field, histories."""
    opened = Result.open(result)
    stress = body_stress(opened, body, Choice(nodes, within, around, insert_margin))
    peak = stress.recovery.peak(stress.coordinates)
    if not np.all(np.isfinite(peak.value)):
        raise ResultError(f"{result}: {body}: the modal coordinates are not finite; the run was unstable")
    places, spots = find_hot_spots(opened, stress, peak, radius, count)
    console = Console()
    console.print(_table(body, spots, radius))
    console.print(
        f"{len(stress.recovery.nodes)} of {len(stress.plate.positions)} nodes, "
        f"{opened.time.size} recorded times up to {opened.time[-1]:g} s"
    )
    folder = output or result.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    for path in (_write_table(folder, body, spots), *_draw(folder, body, opened, stress, peak, places)):
        click.echo(path)


def _table(body: str, spots: Sequence[HotSpot], radius: float) -> Table:
    table = Table(title=f"{body}: hot spots of the von Mises stress, {radius:g} m apart")
    for name in _COLUMNS:
        table.add_column(name, justify="left" if name in ("face", "insert") else "right")
    for rank, spot in enumerate(spots, 1):
        table.add_row(*spot.row(rank))
    return table


def _write_table(folder: Path, body: str, spots: Sequence[HotSpot]) -> Path:
    path = folder / f"{body}_hot_spots.csv"
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        writer.writerows(spot.row(rank) for rank, spot in enumerate(spots, 1))
    return path


def _draw(
    folder: Path, body: str, result: Result, stress: BodyStress, peak: PeakStress, places: Indices
) -> list[Path]:
    from ...views.stress import MOST_HISTORIES, draw_field, draw_histories  # matplotlib takes its time

    field, histories = folder / f"{body}_stress_field.png", folder / f"{body}_stress_histories.png"
    draw_field(
        field, f"{body}: peak of the larger face over time", stress.plate, stress.recovery, peak, places
    )
    shown = stress.recovery.at(places[:MOST_HISTORIES])
    draw_histories(
        histories,
        f"{body}: von Mises stress of the hottest nodes",
        result.time,
        shown.von_mises(stress.coordinates),
        shown.nodes,
        latch_times(result),
    )
    return [field, histories]
