"""Common parts of the convergence studies: pictures, table of latch-ups."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

if TYPE_CHECKING:
    from rich.table import Table

    from ...analysis.studies import Case, LatchStudy


def report_study(
    study: LatchStudy, folder: Path, content: Mapping[str, object] | None, further: Iterable[Table] = ()
) -> None:
    """Draw the pictures; then print the content as JSON, or the tables and the folder."""
    fanfold.plot(study, folder)
    if content is not None:
        click.echo(json.dumps(content))
        return
    from ..tables import terminal

    console = terminal()
    console.print(latch_table(f"{study.scene}: relative to {study.against}", study.shown, study.reference))
    for table in further:
        console.print(table)
    console.print(f"pictures and results in {folder}")


def latch_table(title: str, cases: Sequence[Case], reference: Case) -> Table:
    """Latch times and latch torque peaks of every case, with their differences from the reference."""
    from ...analysis.studies import latch_rows
    from ..tables import table_of

    rows = []
    for case in cases:
        first = True
        for line, time, shift, peak, change in latch_rows(case, reference):
            steps = str(case.outcome.costs.steps) if first else ""
            name = case.label if first else ""
            rows.append((name, line, f"{time:.6f}", f"{shift:+.2e}", f"{peak:.5g}", f"{change:+.3f}", steps))
            first = False
    headings = ("case", "line", "latch-up, s", "change, s", "peak, N.m", "change, %", "steps")
    return table_of(title, headings, rows, ("case",))
