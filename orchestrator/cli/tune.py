"""`fanfold tune`: fit parameters of a scene to target values and measured curves."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .command import Asked, made_of

if TYPE_CHECKING:
    from ..analysis.sampling.tuning import Tuned
    from ..scene.builder import Scene

_NOT_REACHED = 2
"""Exit code where the targets are not met."""


@made_of(
    "tune",
    name="tune",
    vary={"metavar": "KEY=RANGE"},
    targets={"flags": "--target", "metavar": "NUMBER=VALUE"},
)
def command(scene: Scene, asked: Asked, as_json: bool = False) -> None:
    """Fit keys of SCENE to target values of headline numbers and to measured curves.

    Exit code 2 if the targets are not met.

    Options
    -------
    vary
        range of a key, such as 'hinge_line.HL1.motor.stowed=uniform(1.2 N.m, 2 N.m)'; 'KEY*=uniform(0.5, 2)' is a
        factor, keys separated by commas get the same value; repeatable
    targets
        target of a headline number, such as 'latch_time.HL1=11.6 s'; repeatable
    """
    with _shown(asked["tune"]["most_runs"]) as watch:
        found = fanfold.tune(scene, **asked["tune"], watch=watch)
    if as_json:
        click.echo(json.dumps({**asdict(found), "derivatives": found.derivatives.tolist()}))
    else:
        _report(found)
    if not found.reached:
        click.get_current_context().exit(_NOT_REACHED)


@contextmanager
def _shown(most: int) -> Iterator[Callable[[int, float], None]]:
    """Progress on standard error: number of runs, and the largest difference of the best one."""
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, SpinnerColumn, TextColumn

    columns = (
        SpinnerColumn(),
        MofNCompleteColumn(),
        TextColumn("runs, largest difference {task.fields[off]}"),
    )
    with Progress(*columns, console=Console(stderr=True), refresh_per_second=5) as bar:
        task = bar.add_task("tune", total=most, off="")
        yield lambda runs, residual: bar.update(task, completed=runs, off=f"{residual:.2g}")


def _report(found: Tuned) -> None:
    from .tables import table_of, terminal

    console = terminal()
    rows = [
        (name, f"{found.start[name]:.6g}", f"{value:.6g}", "", found.units[name])
        for name, value in found.values.items()
    ]
    rows += [
        (one.number, f"{one.start:.6g}", f"{one.found:.6g}", f"{one.wanted:.6g}", one.unit)
        for one in found.numbers
    ]
    headings = ("", "start", "found", "wanted", "unit")
    table = table_of(f"{found.scene}: {found.runs} runs", headings, rows, ("", "unit"))
    console.print(table)
    console.print(
        f"{'Targets met' if found.reached else 'Targets NOT met'}: largest relative difference "
        f"{found.residual:.2g}, at the start {found.start_residual:.2g}."
    )
    for name in found.at_ends:
        console.print(f"Warning: {name} is at a bound of its range. Widen the range to reach the targets.")
    for sentence in found.jumps:
        console.print(f"Warning: {sentence}")
    for name in found.blind:
        console.print(f"Warning: the targets do not determine {name}: other values fit as well.")
    console.print(" ".join(f"--set '{key}={value}'" for key, value in found.settings.items()))
