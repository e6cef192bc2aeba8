"""`fanfold check`: every problem of an FMU."""

from __future__ import annotations

import sys
from pathlib import Path

import click

import orchestrator as fanfold


@click.command("check")
@click.argument("fmu", type=click.Path(path_type=Path, exists=True, dir_okay=False), nargs=-1, required=True)
def command(fmu: tuple[Path, ...]) -> None:
    """Print every problem of each FMU as a sentence; exit code 1 if there is any."""
    found = False
    for path in fmu:
        problems = fanfold.check(path)
        found = found or bool(problems)
        for problem in problems or ["no problem found"]:
            click.echo(f"{path.name}: {problem}")
    sys.exit(1 if found else 0)
