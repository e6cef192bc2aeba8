"""`fanfold analyse equilibrium`: static equilibrium and its loads, at one configuration or over a sweep."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..command import Asked, made_of
from ..types import ordered_names
from ._configuration import ANGLES, angle_of

if TYPE_CHECKING:
    from ...scene.builder import Scene

_EXAMPLES = """\b
Examples:
  fanfold analyse equilibrium amos3 --rigid all --preload
  fanfold analyse equilibrium amos3 --rigid all --steps 6 \\
    --sweep HL1=0deg:90deg,HL2=0deg:180deg,HL3=0deg:180deg
"""


def sweeps_given(
    _: click.Context, __: click.Parameter, values: tuple[str, ...]
) -> dict[str, tuple[str, str]]:
    """First and last angle by line, of HL1=0deg:90deg,HL2=0deg:180deg."""
    found: dict[str, tuple[str, str]] = {}
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


@made_of(
    "equilibrium",
    "quasi_static",
    name="equilibrium",
    epilog=_EXAMPLES,
    angles=ANGLES,
    sweeps={
        "flags": "--sweep",
        "multiple": True,
        "required": False,
        "metavar": "LINE=FROM:TO,...",
        "callback": sweeps_given,
        "help": "Sweep the angles of lines, each with deg or rad, such as HL1=0deg:90deg; other lines follow.",
    },
    steps={"needs": "sweeps"},
)
def command(scene: Scene, asked: Asked, as_json: bool = False) -> None:
    """Static equilibrium of SCENE and the loads of its connections, in one configuration or over a sweep.

    Options
    -------
    hold
        held lines, or all, or none; by default all lines that are not latched, in a sweep none
    """
    sweeps = asked["quasi_static"]["sweeps"]
    if asked["equilibrium"]["preload"] and sweeps:
        raise click.UsageError("--preload and --sweep exclude each other; leave one of them out")
    if sweeps:
        found = fanfold.quasi_static(scene, **asked["quasi_static"])
    else:
        found = [fanfold.equilibrium(scene, **asked["equilibrium"])]
    if as_json:
        content = {"scene": scene.name, "equilibria": [one.as_dict() for one in found]}
        click.echo(json.dumps(content))
        return
    from ..equilibrium_table import print_loads, print_sweep

    if sweeps:
        print_sweep(found)
    else:
        print_loads(found[0])
