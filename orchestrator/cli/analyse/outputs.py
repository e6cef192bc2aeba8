"""`fanfold analyse outputs`: stresses and forces of elements of an imported body, as a table and a file."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...api.options import OutputFile
from ..command import Asked, made_of

if TYPE_CHECKING:
    from rich.table import Table

    from ...analysis.stress.outputs import BodyOutputs


@made_of("body_outputs", name="outputs")
def command(result: Path, asked: Asked, output: OutputFile | None = None) -> None:
    """Element stresses and forces of an imported body in RESULT: extremes and histories.

    Options
    -------
    body
        the imported body
    output
        CSV file with all recorded times; by default BODY_outputs.csv in a folder named after RESULT
    """
    found = fanfold.body_outputs(result, **asked["body_outputs"])
    from ..tables import terminal

    terminal().print(_table(found))
    click.echo(_write(found, Path(output or result.with_suffix("") / f"{found.body}_outputs.csv")))


def _table(found: BodyOutputs) -> Table:
    from rich.table import Table

    table = Table(title=f"{found.body}: extremes over {found.time.size} recorded times")
    for name in ("output", "unit", "smallest", "at, s", "largest", "at, s"):
        table.add_column(name, justify="left" if name in ("output", "unit") else "right")
    for label, unit, low, first, high, last in found.extremes():
        table.add_row(label, unit, f"{low:.6g}", f"{first:.5f}", f"{high:.6g}", f"{last:.5f}")
    return table


def _write(found: BodyOutputs, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        heads = zip(found.labels, found.units, strict=True)
        writer.writerow(["time (s)", *(f"{label} ({unit})" for label, unit in heads)])
        rows = zip(found.time.tolist(), found.values.tolist(), strict=True)
        writer.writerows([time, *values] for time, values in rows)
    return path
