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
    from ..tables import table_of, terminal

    title = f"{found.body}: extremes over {found.time.size} recorded times"
    headings = ("output", "unit", "smallest", "at, s", "largest", "at, s")
    rows = (
        (label, unit, f"{low:.6g}", f"{first:.5f}", f"{high:.6g}", f"{last:.5f}")
        for label, unit, low, first, high, last in found.extremes()
    )
    terminal().print(table_of(title, headings, rows, ("output", "unit")))
    click.echo(_write(found, Path(output or result.with_suffix("") / f"{found.body}_outputs.csv")))


def _write(found: BodyOutputs, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        heads = zip(found.labels, found.units, strict=True)
        writer.writerow(["time (s)", *(f"{label} ({unit})" for label, unit in heads)])
        rows = zip(found.time.tolist(), found.values.tolist(), strict=True)
        writer.writerows([time, *values] for time, values in rows)
    return path
