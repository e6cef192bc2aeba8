"""`fanfold plot`: the pictures of a result."""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator as fanfold

from ..api.options import Folder
from .command import made_of
from .progress import working


@made_of(name="plot")
def command(result: Path, output: Folder | None = None) -> None:
    """Write the pictures of RESULT.

    Options
    -------
    output
        folder for the pictures
    """
    with working("plot") as watch:
        paths = fanfold.Result.open(result).plot_all(output or result.with_suffix(""), watch=watch)
    for path in paths:
        click.echo(path)
