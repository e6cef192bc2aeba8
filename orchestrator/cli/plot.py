"""`fanfold plot`: the pictures of a result."""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator as fanfold

from .options import result_options
from .progress import working


@click.command("plot")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, file_okay=False), help="Folder for the pictures."
)
@result_options
def command(result: Path, output: Path | None) -> None:
    """Write the pictures of RESULT."""
    with working("plot") as watch:
        paths = fanfold.Result.open(result).plot_all(output or result.with_suffix(""), watch=watch)
    for path in paths:
        click.echo(path)
