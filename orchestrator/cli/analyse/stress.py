"""`fanfold analyse stress`: von Mises stresses of a panel's face sheets, as a table, a file and pictures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...api.options import Folder
from ..command import Asked, made_of

if TYPE_CHECKING:
    from ...analysis.stress.hot_spots import HotSpot

_COLUMNS = ("rank", "von Mises, MPa", "node", "face", "time, s", "x, m", "y, m", "insert")


@made_of(
    "stress",
    name="stress",
    within={"metavar": "X0 X1 Y0 Y1"},
    around={"metavar": "X Y R"},
)
def command(result: Path, asked: Asked, output: Folder | None = None) -> None:
    """Von Mises stresses of a flexible panel in RESULT: hot spots, peak field, histories.

    Options
    -------
    body
        the panel
    output
        folder for table and pictures; by default named after RESULT
    """
    found = fanfold.stress(result, **asked["stress"])
    opened = found.result
    from ..picture_list import pictures
    from ..tables import table_of, terminal

    console = terminal()
    title = f"{found.body}: hot spots of the von Mises stress, {found.radius:g} m apart"
    rows = (spot.row(rank) for rank, spot in enumerate(found.hot_spots, 1))
    console.print(table_of(title, _COLUMNS, rows, ("face", "insert")))
    console.print(
        f"{len(found.stress.recovery.nodes)} of {len(found.stress.plate.positions)} nodes, "
        f"{opened.time.size} recorded times up to {opened.time[-1]:g} s"
    )
    for sentence in found.remarks:
        click.echo(sentence)
    folder = Path(output or result.with_suffix(""))
    drawn = pictures(found, output, folder)
    for path in (_write_table(folder, found.body, found.hot_spots), *drawn):
        click.echo(path)


def _write_table(folder: Path, body: str, spots: Sequence[HotSpot]) -> Path:
    path = folder / f"{body}_hot_spots.csv"
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        writer.writerows(spot.row(rank) for rank, spot in enumerate(spots, 1))
    return path
