"""`fanfold report`: a run as one self-contained HTML file."""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator as fanfold

from .command import EXISTING, Asked, made_of
from .progress import working


@made_of(
    "report",
    name="report",
    other={"flags": "--with", "type": EXISTING, "multiple": True, "metavar": "FILE"},
    require={"metavar": "LIMIT"},
    author={"metavar": "NAME", "show_default": False},
)
def command(result: Path, asked: Asked) -> None:
    """Write a report of RESULT as one self-contained HTML file.

    Options
    -------
    path
        HTML file; by default next to RESULT
    other
        result to compare with; repeatable
    """
    with working("report"):
        path = fanfold.report(result, **asked["report"])
    click.echo(path)
