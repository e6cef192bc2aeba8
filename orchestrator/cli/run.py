"""`fanfold run` and `fanfold resume`: simulate a scene, and continue an interrupted run."""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import orchestrator as fanfold

from .options import (
    SceneChoice,
    backend_option,
    large_deformation_option,
    ordered_names,
    replace_option,
    result_options,
    scene_choice,
)
from .progress import progress
from .types import Number, OutputFile, Seconds, Spacing

if TYPE_CHECKING:
    from rich.table import Table

    from fmus import Backend

    from ..api.result import Result
    from ..cosim.ports import Order
    from ..run.run import MasterKind
    from ..run.verify import Verified

NOT_OPENED = 3
"""Exit code of a run that reached its end while a line has not opened that should have."""
every_option = click.option("--all", "every", is_flag=True, help="Show every headline number.")
_ORDERS: dict[str, Order | None] = {"auto": None, "2": 2, "4": 4}


@click.command("run")
@scene_choice
@large_deformation_option
@backend_option
@click.option(
    "--tolerance", type=Number(min=1e-10, max=0.1), help="Relative accuracy; by default that of the scene."
)
@click.option(
    "--until",
    type=Seconds(min=0.0, min_open=True),
    metavar="SECONDS",
    help="End time, in seconds; by default that of the scene.",
)
@click.option(
    "-o", "--output", type=OutputFile(),
    help=(
        "Result file (HDF5); by default SCENE.h5, or SCENE.rigid.h5, SCENE.mixed.h5 for other models of bodies "
        "than those of the scene."
    ),
)  # fmt: skip
@replace_option
@click.option(
    "--step",
    type=Seconds(min=1e-7),
    metavar="SECONDS",
    help="Constant communication step size, in seconds; by default step-size control.",
)
@click.option(
    "--order", type=click.Choice(["auto", "2", "4"]), default="auto", show_default=True,
    help="Order of the coupling: wrenches constant (2) or linear (4) in time over a step; auto: 4.",
)  # fmt: skip
@click.option(
    "--master",
    type=click.Choice(["implicit", "jacobi", "gauss-seidel"]),
    default="implicit",
    show_default=True,
)
@click.option(
    "--checkpoint", type=Seconds(min=0.0, min_open=True), metavar="SECONDS",
    help=(
        "Simulated time between checkpoints, from which `fanfold resume` continues; checkpoints change the last "
        "digits."
    ),
)  # fmt: skip
@click.option("--isolate", is_flag=True, help="Run every FMU in its own process, so that a crash names it.")
@click.option(
    "--verify",
    "with_verify",
    is_flag=True,
    help="Repeat with halved and quartered steps; print errors and orders.",
)
@click.option(
    "--estimate/--no-estimate", "with_estimate", default=True, show_default=True,
    help="Estimate the errors of headline numbers, for half the cost of the run.",
)  # fmt: skip
@click.option(
    "--refine/--no-refine", "refine", default=True, show_default=True,
    help="Repeat the run with a smaller tolerance if it is likely to miss ten tolerances.",
)  # fmt: skip
@click.option(
    "--record", type=Spacing(), default="all", show_default=True, metavar="all|SECONDS",
    help="Rows of the result: all, or time between rows; rows of events and peaks are always kept.",
)  # fmt: skip
@click.option(
    "--signals", multiple=True, callback=ordered_names, metavar="PATTERNS",
    help=(
        "Signals of the result, in addition to those of headline numbers: patterns separated by commas, such as "
        "'hl1_*,panel1.frame_*'; by default all."
    ),
)  # fmt: skip
@every_option
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    large_deformation: frozenset[str],
    tolerance: float | None,
    until: float | None,
    output: Path | None,
    replace: bool,
    step: float | None,
    order: str,
    master: MasterKind,
    checkpoint: float | None,
    isolate: bool,
    with_verify: bool,
    with_estimate: bool,
    refine: bool,
    record: float | None,
    signals: tuple[str, ...],
    every: bool,
    as_json: bool,
    backend: Backend | None,
) -> None:
    """Simulate the deployment of SCENE, a built-in scene or a scene file, and write its result.

    Exit codes: 0, every line that should open has opened; 3, one has not; 1, the run failed; 2, wrong use.
    """
    if with_verify and master != "implicit":
        raise click.UsageError("--verify extrapolates runs of the implicit master; leave --master out")
    if master != "implicit" and step is None:
        raise click.UsageError("an explicit master needs a --step that is stable; for rigid wings try 2e-5 s")
    from ..api.simulate import run_options  # takes its time, which --help need not
    from ..run.simulation import fidelity_word, phase_file, refuse_to_lose, result_file

    runs = choice.load().runs
    if until is not None and len(runs) > 1:
        raise click.UsageError(
            f"--until is the end of one run; choose a phase with --variant: {', '.join(runs)}"
        )
    asked: dict[str, Any] = {
        **choice.fidelities,
        "large_deformation": large_deformation,
        "until": until,
        "tolerance": tolerance,
        "step": step,
        "order": _ORDERS[order],
        "master": master,
        "backend": backend,
        "checkpoint": checkpoint,
        "isolate": isolate,
        "refine": refine,
        "record": "all" if record is None else record,
        "signals": signals,
    }
    fidelity = fidelity_word(**choice.fidelities, large_deformation=large_deformation)
    paths = {
        phase: phase_file(output, phase) if output else result_file(scene.name, scene.chosen, fidelity)
        for phase, scene in runs.items()
    }
    if not replace:  # of all phases before the first
        for phase, scene in runs.items():
            refuse_to_lose(paths[phase], scene.check_one_run(), run_options(**asked), with_estimate)
    contents: dict[str, dict[str, object]] = {}
    opened = True
    for phase, scene in runs.items():
        result = fanfold.simulate(
            scene, **asked, estimate=with_estimate, save=paths[phase], progress=progress
        )
        verified = result.verify(progress) if with_verify else None
        contents[phase] = content(result, verified)
        opened = opened and not result.headline.not_opened
        if not as_json:
            report(result, verified, every=every)
    if as_json:
        click.echo(json.dumps({"phases": contents} if len(runs) > 1 else contents[next(iter(runs))]))
    _exit_unless(opened)


def content(result: Result, verified: list[Verified] | None) -> dict[str, object]:
    """Headline numbers, costs and messages of a run, for JSON."""
    content = {**result.headline.as_dict(), **result.costs, "output": str(result.path)}
    content["warnings"], content["notes"] = list(result.warnings), list(result.notes)
    if verified is not None:
        content["verification"] = [one.as_dict() for one in verified]
    return content


@click.command("resume")
@click.argument("result", type=click.Path(path_type=Path, dir_okay=False))
@every_option
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@result_options
def resume_command(result: Path, every: bool, as_json: bool) -> None:
    """Continue the interrupted run of RESULT from its last checkpoint, bit-identical to an uninterrupted run.

    Runs write checkpoints with --checkpoint.
    """
    found = fanfold.resume(result, progress=progress)
    if as_json:
        click.echo(json.dumps(content(found, None)))
    else:
        report(found, None, every=every)
    _exit_unless(not found.headline.not_opened)


def _exit_unless(opened: bool) -> None:
    """Exit code 3 where a line has not opened that should have."""
    if not opened:
        click.get_current_context().exit(NOT_OPENED)


def report(result: Result, verified: list[Verified] | None, *, every: bool = False) -> None:
    """Print the summary of a run."""
    from .tables import headline_tables, terminal

    console, costs = terminal(), result.costs
    console.print(result.headline.verdict)
    for table in headline_tables(result.headline, every=every):
        console.print(table)
    say = partial(console.print, soft_wrap=True, highlight=False)  # one line each, whatever the width
    say(
        f"{costs['steps']} steps, {costs['rejected_steps']} rejected, {costs['iterations']} iterations, "
        f"{costs['wall_time_s']:.1f} s wall time, {costs['real_time_factor']:.3g} times real time"
    )
    for note in result.notes if every else ():
        say(f"note: {note}")
    if verified is not None:
        console.print(_verification_table(verified))
    say(f"next: fanfold report {shlex.quote(str(result.path))}")


def _verification_table(verified: list[Verified]) -> Table:
    from rich.table import Table

    table = Table(title="verification with halved and quartered steps")
    table.add_column("number", overflow="fold")
    for heading in ("value", "extrapolated", "error", "order"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit")
    for v in verified:
        order = "" if v.order is None else f"{v.order:.2f}"
        numbers = (f"{v.number.value:.7g}", f"{v.extrapolated:.7g}", f"{v.error:.2g}", order)
        table.add_row(v.number.id, *numbers, "" if v.number.unit == "1" else v.number.unit)
    return table
