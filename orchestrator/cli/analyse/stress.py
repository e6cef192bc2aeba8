"""`fanfold analyse stress`: von Mises stresses of a panel's face sheets, as a table, a file and pictures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..options import result_options
from ..types import Count, Number

if TYPE_CHECKING:
    from rich.table import Table

    from ...analysis.stress.hot_spots import HotSpot, PanelStress

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
    help="Smallest distance between two hot spots, in m.",
)  # fmt: skip
@click.option("--nodes", callback=_numbers, metavar="N,N,...", help="Only these nodes of the mesh.")
@click.option(
    "--within", type=Number(), nargs=4, callback=_rectangle, metavar="X0 X1 Y0 Y1",
    help="Only nodes in this rectangle of the body frame, in m.",
)  # fmt: skip
@click.option(
    "--around", type=Number(), nargs=3, callback=_circle, metavar="X Y R",
    help="Only nodes within a radius R of a point x, y of the body frame, in m.",
)  # fmt: skip
@click.option(
    "--insert-margin", type=Number(min=0.0), default=0, show_default=True, metavar="M",
    help="Smallest distance of nodes to rigid inserts, in m, whose corners are singular.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, file_okay=False),
    help="Folder for table and pictures; by default named after RESULT.",
)  # fmt: skip
@result_options
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
    opened = fanfold.Result.open(result)
    found = fanfold.stress(
        opened,
        body,
        count=count,
        radius=radius,
        nodes=nodes,
        within=within,
        around=around,
        insert_margin=insert_margin,
    )
    from ..picture_list import pictures
    from ..tables import terminal

    console = terminal()
    console.print(_table(found))
    console.print(
        f"{len(found.stress.recovery.nodes)} of {len(found.stress.plate.positions)} nodes, "
        f"{opened.time.size} recorded times up to {opened.time[-1]:g} s"
    )
    for sentence in found.remarks:
        click.echo(sentence)
    folder = output or result.with_suffix("")
    drawn = pictures(found, output, folder)
    for path in (_write_table(folder, body, found.hot_spots), *drawn):
        click.echo(path)


def _table(found: PanelStress) -> Table:
    from rich.table import Table

    table = Table(title=f"{found.body}: hot spots of the von Mises stress, {found.radius:g} m apart")
    for name in _COLUMNS:
        table.add_column(name, justify="left" if name in ("face", "insert") else "right")
    for rank, spot in enumerate(found.hot_spots, 1):
        table.add_row(*spot.row(rank))
    return table


def _write_table(folder: Path, body: str, spots: Sequence[HotSpot]) -> Path:
    path = folder / f"{body}_hot_spots.csv"
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        writer.writerows(spot.row(rank) for rank, spot in enumerate(spots, 1))
    return path
