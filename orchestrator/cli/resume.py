"""`fanfold resume`: go on with an interrupted run."""

from __future__ import annotations

import json
from pathlib import Path

import click

import orchestrator as fanfold

from .progress import progress
from .run import content, report


@click.command("resume")
@click.argument("result", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(result: Path, as_json: bool) -> None:
    """Go on with the interrupted run of RESULT from its last checkpoint, in every bit as it would have gone on.

    Runs keep checkpoints with --checkpoint.
    """
    found = fanfold.resume(result, progress=progress)
    if as_json:
        click.echo(json.dumps(content(found, None)))
    else:
        report(found, None)
