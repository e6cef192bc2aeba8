"""`fanfold run` and `fanfold resume`: simulate a scene, and continue an interrupted run."""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..api.options import OutputFile
from .command import Asked, made_of, usual_file
from .progress import progress
from .types import Choice

if TYPE_CHECKING:
    from rich.table import Table

    from ..api.result import Result
    from ..run.verify import Verified
    from ..scene.builder import Scene

NOT_OPENED, NOT_MET = 3, 4
"""Exit codes of a run that reached its end: a line has not opened that should have; a requirement is not met."""
_ALL = {"flags": "--all"}


@made_of(
    "simulate",
    name="run",
    order={"type": Choice({"auto": None, "2": 2, "4": 4}), "default": "auto"},
    require={"metavar": "LIMIT"},
    every=_ALL,
)
def command(
    scene: Scene,
    asked: Asked,
    save: OutputFile | None = None,
    replace: bool = False,
    verify: bool = False,
    every: bool = False,
    as_json: bool = False,
) -> None:
    """Simulate the deployment of SCENE, a built-in scene or a scene file, and write its result.

    Exit codes: 0, every line that should open has opened and every requirement is met; 3, a line has not opened; 4, a
    requirement is not met; 1, the run failed; 2, wrong use.

    Options
    -------
    save
        result file (HDF5); by default SCENE.h5, or SCENE.rigid.h5, SCENE.mixed.h5 for other models of bodies than those
        of the scene
    replace
        replace an existing file, even if it was made with other settings
    verify
        repeat with halved and quartered steps; print errors and orders
    """
    options = asked["simulate"]
    if verify and options["master"] != "implicit":
        raise click.UsageError("--verify extrapolates runs of the implicit master; leave --master out")
    if options["master"] != "implicit" and options["step"] is None:
        raise click.UsageError("an explicit master needs a --step that is stable; for rigid wings try 2e-5 s")
    from ..api.simulate import options_of  # takes its time, which --help need not
    from ..run.simulation import phase_file, refuse_to_lose

    runs = scene.runs
    if options["until"] is not None and len(runs) > 1:
        raise click.UsageError(
            f"--until is the end of one run; choose a phase with --variant: {', '.join(runs)}"
        )
    paths = {
        phase: phase_file(Path(save), phase) if save else usual_file(one, options, "h5")
        for phase, one in runs.items()
    }
    if not replace:  # of all phases before the first
        for phase, one in runs.items():
            refuse_to_lose(paths[phase], one.check_one_run(), options_of(options), options["estimate"])
    contents: dict[str, dict[str, object]] = {}
    codes: list[int] = []
    for phase, one in runs.items():
        result = fanfold.simulate(one, **options, save=paths[phase], progress=progress)
        verified = result.verify(progress) if verify else None
        contents[phase] = content(result, verified)
        codes.append(_code(result))
        if not as_json:
            report(result, verified, every=every)
    if as_json:
        click.echo(json.dumps({"phases": contents} if len(runs) > 1 else contents[next(iter(runs))]))
    _exit(codes)


def content(result: Result, verified: list[Verified] | None) -> dict[str, object]:
    """Headline numbers, costs and messages of a run, for JSON."""
    content = {**result.headline.as_dict(), **result.costs, "output": str(result.path)}
    content["warnings"], content["notes"] = list(result.warnings), list(result.notes)
    if verified is not None:
        content["verification"] = [one.as_dict() for one in verified]
    return content


@made_of(name="resume", result={"type": click.Path(path_type=Path, dir_okay=False)}, every=_ALL)
def resume_command(result: Path, every: bool = False, as_json: bool = False) -> None:
    """Continue the interrupted run of RESULT from its last checkpoint, bit-identical to an uninterrupted run.

    Runs write checkpoints with --checkpoint.
    """
    found = fanfold.resume(result, progress=progress)
    if as_json:
        click.echo(json.dumps(content(found, None)))
    else:
        report(found, None, every=every)
    _exit([_code(found)])


def _code(result: Result) -> int:
    """Exit code of one run that reached its end."""
    found = result.headline
    if found.not_opened:
        return NOT_OPENED
    return 0 if all(one.met for one in found.requirements) else NOT_MET


def _exit(codes: list[int]) -> None:
    """With the code of the runs that are not as they should be; a line that has not opened comes first."""
    if worst := min(filter(None, codes), default=0):
        click.get_current_context().exit(worst)


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
    from .tables import table_of

    rows = []
    for v in verified:
        order = "" if v.order is None else f"{v.order:.2f}"
        numbers = (f"{v.number.value:.7g}", f"{v.extrapolated:.7g}", f"{v.error:.2g}", order)
        rows.append((v.number.id, *numbers, "" if v.number.unit == "1" else v.number.unit))
    headings = ("number", "value", "extrapolated", "error", "order", "unit")
    title = "verification with halved and quartered steps"
    return table_of(title, headings, rows, ("number", "unit"))
