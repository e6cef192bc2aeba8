"""`fanfold report`: a run as one self-contained HTML file."""

from __future__ import annotations

from pathlib import Path

import click

from ..results.result import Result, ResultError
from ..views.report.report import report


@click.command("report")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "--with", "other", type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="A second result to set against it.",
)  # fmt: skip
@click.option("--output", type=click.Path(path_type=Path, dir_okay=False), help="HTML file.")
@click.option(
    "--frames", "count", type=click.IntRange(min=0, max=300), default=60, show_default=True,
    help="Pictures of the animation; 0 for none.",
)  # fmt: skip
def command(result: Path, other: Path | None, output: Path | None, count: int) -> None:
    """Write RESULT as one HTML file with everything inside."""
    path = output or result.with_suffix(".html")
    if path.suffix.lower() not in (".html", ".htm"):
        raise ResultError(f"{path}: the report is an HTML file; let its name end in .html")
    if path.resolve() in {p.resolve() for p in (result, other) if p is not None}:
        raise ResultError(f"{path}: this is the result itself and would be lost; name another file")
    second = None if other is None else Result.open(other)
    path.write_text(report(Result.open(result), second, count), encoding="utf-8")
    click.echo(path)
