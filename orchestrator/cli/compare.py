"""`fanfold compare`: two results as a table of peaks and overlaid pictures."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import orchestrator as fanfold

from ..api.options import Folder
from .command import EXISTING, made_of

if TYPE_CHECKING:
    from rich.table import Table

    from ..api.result import Result
    from ..results.compare import Comparison

_DIFFERENCES = 12


def comparison_table(found: Comparison, names: tuple[str, str]) -> Table:
    """The comparison as a table for a terminal; A and B are the two results."""
    from ..results.compare import cells
    from .tables import table_of

    rows = []
    previous = ""
    for row in found.rows:
        a, b, ratio, time_a, _, shift, unit = cells(row)
        if row.quantity != previous:
            rows.append((row.quantity, *[""] * 6))
        rows.append((f"  {row.of}", a, b, ratio, time_a, shift, unit))
        previous = row.quantity
    headings = ("quantity, of", "A", "B", "B / A", "at A, s", "shift, s", "unit")
    return table_of(f"A = {names[0]}, B = {names[1]}", headings, rows, ("quantity, of", "unit"))


@made_of(name="compare")
@click.argument("a", type=EXISTING)
@click.argument("b", type=EXISTING)
def command(a: Path, b: Path, output: Folder | None = None, as_json: bool = False) -> None:
    """Compare result B with result A: peaks, ratios, time shifts, overlaid pictures.

    Options
    -------
    output
        folder for the pictures
    """
    from ..results.compare import by_component, end_note, labels
    from ..results.differences import differences, scene_note
    from .tables import terminal

    first, second = fanfold.Result.open(a), fanfold.Result.open(b)
    found, names = fanfold.compare(first, second), labels(first, second)
    folder = output or a.with_name(f"{a.stem}_against_{b.stem}")
    pictures = fanfold.plot_comparison(first, second, folder)
    if as_json:
        click.echo(json.dumps(_as_dict(first, second, found, pictures)))
        return
    console = terminal()
    console.print(comparison_table(found, names))
    say: Callable[[str], None] = lambda text: console.print(text, soft_wrap=True, highlight=False)  # noqa: E731
    if note := end_note(first, second, names):
        say(note)
    for one in differences(first, second)[:_DIFFERENCES] if not scene_note(first, second) else ():
        say(f"different: {one.key}: {one.a or '-'} | {one.b or '-'}")
    for name, result, signals in zip(names, (first, second), (found.only_a, found.only_b), strict=True):
        if not result.complete:
            say(f"{name} was interrupted at {result.time[-1]:.6g} s")
        for component, variables in by_component(signals).items():
            whole = len(variables) == len(result.variables(component))
            say(f"only in {name}: {component}{'' if whole else ': ' + ', '.join(variables)}")
    for path in pictures:
        click.echo(path)


def _as_dict(a: Result, b: Result, found: Comparison, pictures: Sequence[Path]) -> dict[str, Any]:
    from ..results.differences import differences, scene_note

    return {
        "a": str(a.path),
        "b": str(b.path),
        "complete": [a.complete, b.complete],
        "rows": [row.as_dict() for row in found.rows],
        "different_scenes": scene_note(a, b) or None,
        "differences": [one._asdict() for one in differences(a, b)],
        "only_a": found.only_a,
        "only_b": found.only_b,
        "pictures": [str(path) for path in pictures],
    }
