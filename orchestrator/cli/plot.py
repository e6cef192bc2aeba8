"""`fanfold plot`: the pictures of a result."""

from __future__ import annotations

from pathlib import Path

import click

from ..results.result import Result


@click.command("plot")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--output", type=click.Path(path_type=Path, file_okay=False), help="Folder for the pictures.")
def command(result: Path, output: Path | None) -> None:
    """Draw the pictures of RESULT."""
    from ..views.plots import plot_all  # matplotlib takes its time, which no other command needs

    for path in plot_all(Result.open(result), output or result.with_suffix("")):
        click.echo(path)
