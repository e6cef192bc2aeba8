"""`fanfold report` and `fanfold live`: a run as one self-contained HTML file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .command import EXISTING, Asked, made_of
from .progress import progress, working

if TYPE_CHECKING:
    from ..scene.builder import Scene


@made_of(
    "report",
    name="report",
    other={"flags": "--with", "type": EXISTING, "multiple": True, "metavar": "FILE"},
    require={"metavar": "LIMIT"},
    author={"metavar": "NAME", "show_default": False},
    slider={"metavar": "KEY=LOW..HIGH", "needs": "live"},
)
def command(result: Path, asked: Asked) -> None:
    """Write a report of RESULT as one self-contained HTML file.

    Options
    -------
    path
        HTML file; by default next to RESULT
    other
        result to compare with; repeatable
    """
    with working("report"):
        path = fanfold.report(result, **asked["report"])
    click.echo(path)


@made_of(
    "live",
    name="live",
    require={"metavar": "LIMIT"},
    author={"metavar": "NAME", "show_default": False},
    slider={"metavar": "KEY=LOW..HIGH"},
)
def live_command(scene: Scene, asked: Asked) -> None:
    """Simulate SCENE and write a page in which sliders change it and the wing deploys anew, offline.

    Options
    -------
    path
        HTML file; by default SCENE.live.html
    """
    click.echo(fanfold.live(scene, **asked["live"], progress=progress))
