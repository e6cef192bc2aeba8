"""`fanfold analyse torque-margin`: margins of every hinge line by case, and restarts from where it was stopped."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...analysis.torque_margin.standard import DEMANDS, FACTORS
from ...api.options import Folder
from ..command import Asked, made_of
from ..progress import progress
from ..types import given_quantity

if TYPE_CHECKING:
    from ...api.quantities import Duration
    from ...scene.builder import Names, Scene

FAILED = 3
"""Exit code where a margin or a restart fails, which is no error of the command."""
_SYMBOLS = (*FACTORS["theoretical"], *DEMANDS)


def _extra_torques(
    _: click.Context, __: click.Parameter, given: tuple[str, ...]
) -> dict[str, dict[str, float]]:
    """Further torques (N.m) by line and symbol; every torque has its unit."""
    found: dict[str, dict[str, float]] = {}
    for text in given:
        key, equals, value = text.partition("=")
        line, dot, symbol = key.partition(".")
        if not (equals and dot and symbol in _SYMBOLS):
            raise click.BadParameter(
                f"{text!r} is not of the form LINE.SYMBOL=TORQUE with a symbol of {', '.join(_SYMBOLS)}"
            )
        if symbol in found.get(line, {}):
            raise click.BadParameter(f"{key} is given twice; add the torques up")
        found.setdefault(line, {})[symbol] = given_quantity(value, "N.m", key, "zero or positive")
    return found


@made_of(
    "torque_margin",
    name="torque-margin",
    cases={"flags": "--case"},
    torques={
        "flags": "--torque",
        "multiple": True,
        "metavar": "LINE.SYMBOL=TORQUE",
        "callback": _extra_torques,
        "help": (
            f"Additional torque of a line with its unit, such as HL2.HY=0.02N.m; ECSS symbols {', '.join(_SYMBOLS)}; "
            "repeatable."
        ),
    },
    restarts={"flags": "--restart", "metavar": "POSITION,..."},
    until={"needs": "restarts"},
)
def command(
    scene: Scene,
    asked: Asked,
    restarts: Names = (),
    until: Duration | None = None,
    output: Folder | None = None,
    as_json: bool = False,
) -> None:
    """Torque margin of every driven hinge line of SCENE over its travel; bodies are rigid.

    Lines that cable loops or gears couple have one margin, with their torques at the rate of the first line.

    Sum rule, limit 2: driving torque over the sum of the resisting torques times their uncertainty factors. ECSS rule
    (ECSS-E-ST-33-01C, 4.7.5.3), limit 2: 0.8 of the driving torque less 1.25 TD and TL, over the same sum. GEVS rule
    (GSFC-STD-7000, 2.4.5.3), above 0: driving torque over the known torques I, S, TD, TL and the variable ones, each
    times its factor, less 1. Exit code 3 if a margin fails or a restart does not open.

    Options
    -------
    restarts
        simulate from rest at these positions, such as 25%,50% of the travel, or 45deg of the first line with a motor
    until
        end time of restarts, in seconds; by default that of the scene
    output
        folder for pictures and runs; by default named after the scene
    """
    from ...analysis.torque_margin.margins import margin_cases
    from ...analysis.torque_margin.restart import restart_shares
    from ...scene.builder import listed
    from ..picture_list import pictures
    from ..tables import terminal
    from ..torque_margin_table import margin_sentences, margin_table, restart_sentences, restart_table

    names = asked["torque_margin"]["cases"]
    for case in margin_cases(scene, names).values():
        restart_shares(case, listed(restarts))  # refuses what is no position before anything is written
    found = fanfold.torque_margin(scene, **asked["torque_margin"])
    folder = Path(output or ".".join((scene.name, *scene.chosen)))
    drawn = pictures(found, output, folder)
    if not as_json:
        console = terminal()
        console.print(margin_table(found))
        for sentence in margin_sentences(found):
            console.print(sentence, highlight=False)
        for path in drawn:
            click.echo(path)
    runs = fanfold.restart(scene, restarts, cases=names, until=until, folder=folder, progress=progress)
    if as_json:
        restarted = [row for run in runs for row in run.as_dicts()]
        click.echo(json.dumps({**found.as_dict(), "restarts": restarted}))
    elif runs:
        console.print(restart_table(runs))
        for sentence in restart_sentences(runs):
            console.print(sentence, highlight=False)
        for run in runs:
            click.echo(run.path)
    if not found.passes or not all(line.opens for run in runs for line in run.lines):
        sys.exit(FAILED)
