"""`fanfold tune`: fit parameters of a scene to target values and measured curves."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .options import SceneChoice, large_deformation_option, scene_choice
from .types import Number, Seconds

if TYPE_CHECKING:
    from ..analysis.sampling.tuning import Tuned

_NOT_REACHED = 2
"""Exit code where the targets are not met."""


@click.command("tune")
@scene_choice
@large_deformation_option
@click.option(
    "--target", "targets", multiple=True, metavar="NUMBER=VALUE",
    help="Target of a headline number, such as 'latch_time.HL1=11.6 s'; repeatable.",
)  # fmt: skip
@click.option(
    "--curve", type=click.Path(path_type=Path, exists=True, dir_okay=False), metavar="CSV",
    help="CSV file of measured signals: times (s) in the first column, others headed COMPONENT.VARIABLE.",
)  # fmt: skip
@click.option(
    "--vary", multiple=True, required=True, metavar="KEY=RANGE",
    help=(
        "Range of a key, such as 'hinge_line.HL1.motor.stowed=uniform(1.2 N.m, 2 N.m)'; 'KEY*=uniform(0.5, 2)' is "
        "a factor, keys separated by commas get the same value; repeatable."
    ),
)  # fmt: skip
@click.option(
    "--accuracy",
    type=Number(min=1e-9, max=0.1),
    default=1e-4,
    show_default=True,
    help="Largest relative difference to the targets.",
)
@click.option("--most-runs", type=click.IntRange(min=2), default=100, show_default=True)
@click.option(
    "--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Number of processes."
)
@click.option("--tolerance", type=Number(min=1e-10, max=0.1), help="Relative accuracy of every run.")
@click.option(
    "--until",
    type=Seconds(min=0.0, min_open=True),
    metavar="SECONDS",
    help="End time of every run in seconds.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.pass_context
def command(
    context: click.Context,
    choice: SceneChoice,
    large_deformation: frozenset[str],
    targets: tuple[str, ...],
    curve: Path | None,
    vary: tuple[str, ...],
    accuracy: float,
    most_runs: int,
    workers: int,
    tolerance: float | None,
    until: float | None,
    as_json: bool,
) -> None:
    """Fit keys of SCENE to target values of headline numbers and to measured curves.

    Exit code 2 if the targets are not met.
    """
    with _shown(most_runs) as watch:
        found = fanfold.tune(
            choice.load(),
            vary,
            targets,
            **choice.fidelities,
            large_deformation=large_deformation,
            curve=curve,
            accuracy=accuracy,
            most_runs=most_runs,
            workers=workers,
            tolerance=tolerance,
            until=until,
            watch=watch,
        )
    if as_json:
        click.echo(json.dumps({**asdict(found), "derivatives": found.derivatives.tolist()}))
    else:
        _report(found)
    if not found.reached:
        context.exit(_NOT_REACHED)


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
    from .tables import plain_table, terminal

    console = terminal()
    table = plain_table(f"{found.scene}: {found.runs} runs")
    for heading in ("", "start", "found", "wanted", "unit"):
        table.add_column(heading, justify="left" if heading in ("", "unit") else "right")
    for name, value in found.values.items():
        table.add_row(name, f"{found.start[name]:.6g}", f"{value:.6g}", "", found.units[name])
    for one in found.numbers:
        table.add_row(one.number, f"{one.start:.6g}", f"{one.found:.6g}", f"{one.wanted:.6g}", one.unit)
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
