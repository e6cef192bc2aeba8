"""`fanfold report`: a run as one self-contained HTML file."""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator as fanfold

from .options import result_options
from .progress import working
from .types import OutputFile


@click.command("report")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "--with", "others", type=click.Path(path_type=Path, exists=True, dir_okay=False), multiple=True,
    help="Result to compare with; repeatable.",
)  # fmt: skip
@click.option("-o", "--output", type=OutputFile(), help="HTML file; by default next to RESULT.")
@click.option(
    "--frames", "count", type=click.IntRange(min=0, max=300), default=6, show_default=True,
    help="Number of still pictures for browsers without WebGL2.",
)  # fmt: skip
@result_options
def command(result: Path, others: tuple[Path, ...], output: Path | None, count: int) -> None:
    """Write a report of RESULT as one self-contained HTML file."""
    with working("report"):
        path = fanfold.report(result, output, others, count)
    click.echo(path)
