"""`fanfold analyse equilibrium`: static equilibrium and its loads, at one configuration or over a sweep."""

from __future__ import annotations

import json

import click

import orchestrator as fanfold

from ..options import SceneChoice, ordered_names, refuse_idle, scene_choice
from ..types import Count
from ._configuration import ConfigurationChoice, angle_of, configuration_choice, lines_given

_EXAMPLES = """\b
Examples:
  fanfold analyse equilibrium amos3 --rigid all --preload
  fanfold analyse equilibrium amos3 --rigid all --steps 6 \\
    --sweep HL1=0deg:90deg,HL2=0deg:180deg,HL3=0deg:180deg
"""


def sweeps_given(
    _: click.Context, __: click.Parameter, values: tuple[str, ...]
) -> dict[str, tuple[float, float]]:
    """First and last angle (rad) by line, of HL1=0deg:90deg,HL2=0deg:180deg."""
    found: dict[str, tuple[float, float]] = {}
    for entry in ordered_names(_, __, values):
        name, equals, angles = entry.partition("=")
        start, colon, end = angles.partition(":")
        line = name.strip()
        if not (equals and colon and line):
            raise click.BadParameter(f"{entry!r} is not of the form HL1=0deg:90deg")
        way = (angle_of(line, start), angle_of(line, end))
        if way[0] == way[1]:
            raise click.BadParameter(f"{entry!r}: the two angles are the same")
        if line in found:
            raise click.BadParameter(f"{entry!r}: {line} is swept already")
        found[line] = way
    return found


@click.command("equilibrium", epilog=_EXAMPLES)
@scene_choice
@configuration_choice
@click.option(
    "--hold", multiple=True, metavar="LINES", callback=lines_given,
    help=(
        "Held lines, separated by commas, or all, or none; by default all lines that are not latched, in a sweep "
        "none."
    ),
)  # fmt: skip
@click.option(
    "--preload", is_flag=True, help="Give cable loops exactly their preload, as at the start of a run."
)
@click.option(
    "--sweep", "sweeps", multiple=True, callback=sweeps_given, metavar="LINE=FROM:TO,...",
    help="Sweep the angles of lines, each with deg or rad, such as HL1=0deg:90deg; other lines follow.",
)  # fmt: skip
@click.option(
    "--steps",
    type=Count(min=1, max=10_000),
    default=12,
    show_default=True,
    help="Number of steps of a sweep.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    wanted: ConfigurationChoice,
    hold: tuple[str, ...] | None,
    preload: bool,
    sweeps: dict[str, tuple[float, float]],
    steps: int,
    as_json: bool,
) -> None:
    """Static equilibrium of SCENE and the loads of its connections, in one configuration or over a sweep."""
    refuse_idle("--steps", "--sweep")
    if preload and sweeps:
        raise click.UsageError("--preload and --sweep exclude each other; leave one of them out")
    scene = choice.load()
    if sweeps:
        found = fanfold.quasi_static(
            scene, sweeps, **wanted.posed, **choice.fidelities, hold=hold, steps=steps
        )
    else:
        found = [fanfold.equilibrium(scene, **wanted.posed, **choice.fidelities, hold=hold, preload=preload)]
    if as_json:
        content = {"scene": scene.name, "equilibria": [one.as_dict() for one in found]}
        click.echo(json.dumps(content))
        return
    from ..equilibrium_table import print_loads, print_sweep

    if sweeps:
        print_sweep(found)
    else:
        print_loads(found[0])
