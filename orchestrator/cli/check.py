"""`fanfold check`: a scene before its run, or every problem of an FMU."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import orchestrator as fanfold

from ..api.options import Folder
from .command import Asked, SceneChoice, made_of

if TYPE_CHECKING:
    from ..analysis.scene_check import SceneCheck


@made_of(
    "check_scene", "check", name="check", scene={"nargs": -1, "required": True, "metavar": "SCENE | FMU..."}
)
def command(choice: SceneChoice, asked: Asked, output: Folder | None = None, as_json: bool = False) -> None:
    """Check a SCENE without running it, or FMUs (files with the suffix .fmu). Exit code 1 if there is any problem.

    Prints problems of a scene, warnings about probable mistakes, tables of its bodies, lines and loops. Writes a
    picture, and a page in which a slider opens the scene without any force.

    A problem of an FMU breaks the standard or a requirement of Fanfold; advice alone is no problem.

    Options
    -------
    output
        folder of the picture and the page of the scene
    as_json
        print one JSON object (scenes only)
    run
        let FMUs make two steps, in their own process
    """
    what = choice.scene
    fmus = [one for one in what if Path(one).suffix.lower() == ".fmu"]
    if fmus and len(fmus) == len(what):
        sys.exit(1 if _check_fmus(fmus, asked["check"]["run"]) else 0)
    if len(what) > 1:
        raise click.UsageError("give one scene, or FMUs only")
    sys.exit(1 if _check_scene(replace(choice, scene=what[0]), asked["check_scene"], output, as_json) else 0)


def _check_fmus(paths: list[str], run: bool) -> bool:
    """Print every problem of FMUs; returns whether there is any problem other than advice."""
    from ..results.parts import printable  # takes its time, which --help need not

    found = False
    for path in paths:
        if not Path(path).is_file():
            raise click.BadParameter(f"file {path!r} does not exist")
        problems = fanfold.check(path, run)
        found = found or any(problem.kind != "advice" for problem in problems)
        for problem in problems:
            click.echo(f"{Path(path).name}: {problem.kind}: {printable(problem)}")
        if not problems:
            click.echo(f"{Path(path).name}: OK")
    return found


def _check_scene(
    choice: SceneChoice, models: Mapping[str, Any], folder: Folder | None, as_json: bool
) -> bool:
    """Print the check of every run of a scene; returns whether there is any problem."""
    try:
        runs = choice.load().runs
        found = {phase: fanfold.check_scene(scene, **models) for phase, scene in runs.items()}
        problems = [problem for one in found.values() for problem in one.problems]
    except fanfold.FanfoldError as error:
        found, problems = {}, str(error).splitlines()
    if as_json:
        click.echo(
            json.dumps({"problems": problems, "runs": {phase: one.as_dict() for phase, one in found.items()}})
        )
        return bool(problems)
    for problem in problems:
        click.echo(f"problem: {problem}")
    for phase, one in found.items():
        if not one.problems:
            _print(one, folder, Path(".".join(filter(None, (one.scene, *choice.variant, phase)))))
    return bool(problems)


def _print(found: SceneCheck, asked: Folder | None, usual: Path) -> None:
    """Print tables and warnings, and write the picture."""
    from .picture_list import pictures
    from .scene_tables import scene_tables
    from .tables import terminal

    console = terminal()
    for table in scene_tables(found):
        console.print(table)
    for sentence in found.warnings:
        click.echo(f"warning: {sentence}")
    count = len(found.warnings)
    words = f", {count} warning{'s' if count > 1 else ''}" if count else ""
    click.echo(f"{found.scene}: OK{words}")
    for path in pictures(found, asked, usual):
        click.echo(path)
