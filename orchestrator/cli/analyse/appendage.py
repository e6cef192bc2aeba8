"""`fanfold analyse appendage`: the wing as attitude control sees it, in a table and in files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...analysis.vibration import DIRECTIONS
from ..options import SceneChoice, ordered_names, scene_choice
from ..types import Count, OutputFile
from ._configuration import ConfigurationChoice, as_posed_option, configuration_choice, lines_given

if TYPE_CHECKING:
    from ...analysis.appendage.model import Appendage

_SMALLEST_SHARE = 1e-3
"""Fraction of the rigid mass; smaller values are shown as 0."""
_EXAMPLES = """\b
Examples:
  fanfold analyse appendage amos3 --configuration deployed --save wing.mat
  fanfold analyse appendage amos3 --angle HL1=45deg --hold all --points hl1 --json
"""


@click.command("appendage", epilog=_EXAMPLES)
@scene_choice
@configuration_choice
@as_posed_option
@click.option(
    "--hold", multiple=True, default=("none",), show_default=True, metavar="LINES", callback=lines_given,
    help="Lines fixed at their angles without being latched, separated by commas, or all, or none.",
)  # fmt: skip
@click.option(
    "--points", multiple=True, callback=ordered_names, metavar="NAMES",
    help="Points of the base, with a model about each; by default the point that the base rotates about.",
)  # fmt: skip
@click.option("--count", type=Count(min=1), default=15, show_default=True, help="Number of cantilever modes.")
@click.option(
    "-o", "--save", type=OutputFile(), metavar="FILE",
    help="File to write: .json, .npz, .mat (MATLAB), .op4 (Craig-Bampton, one grid), .txt (flexible body of 42).",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    wanted: ConfigurationChoice,
    as_posed: bool,
    hold: tuple[str, ...],
    points: tuple[str, ...],
    count: int,
    save: Path | None,
    as_json: bool,
) -> None:
    """Linear appendage model of SCENE: cantilever modes, participation, rigid and residual mass."""
    found = fanfold.appendage(
        choice.load(),
        **wanted.posed,
        **choice.fidelities,
        as_posed=as_posed,
        hold=hold,
        points=points,
        count=count,
    )
    if as_json:
        click.echo(json.dumps({"appendages": [one.as_dict() for one in found]}))
    else:
        for one in found:
            _print(one)
    if save is not None:
        from ...analysis.appendage.files import write_appendages

        for path in write_appendages(found, save):
            click.echo(path, err=as_json)


def _print(found: Appendage) -> None:
    from ..tables import plain_table, terminal

    table = plain_table(f"appendage about {found.point}; effective masses, kg and kg.m2")
    for heading, width in (
        ("mode", 5),
        ("freq.,\nHz", 7),
        ("damp.,\n%", 6),
        *((axis, 6) for axis in DIRECTIONS),
    ):
        table.add_column(heading, justify="right", no_wrap=True, min_width=width)
    least = _SMALLEST_SHARE * found.rigid_mass.diagonal()
    modes = zip(found.frequency, found.damping_ratio, found.effective_mass, strict=True)
    for k, (frequency, ratio, masses) in enumerate(modes, start=1):
        shown = ("0" if mass < small else f"{mass:.3g}" for mass, small in zip(masses, least, strict=True))
        table.add_row(f"{k}", f"{frequency:.5g}", f"{100.0 * ratio:.3g}", *shown)
    for name, matrix in (("left", found.residual_mass), ("rigid", found.rigid_mass)):
        shown = (
            "0" if mass < small else f"{mass:.4g}"
            for mass, small in zip(matrix.diagonal(), least, strict=True)
        )
        table.add_row(name, "", "", *shown)
    console = terminal()
    console.print(table)
    center = ", ".join(f"{x:.4g}" for x in found.center_of_mass)
    console.print(f"mass {found.mass:.5g} kg, centre of mass at ({center}) m from the point, world axes")
    console.print(str(found.configuration) + (f"; held: {', '.join(found.held)}" if found.held else ""))
    force, torque = found.unbalanced
    console.print(f"Residual of the static equilibrium: {force:.3g} N, {torque:.3g} N.m.")
    free = int((found.frequency == 0.0).sum())
    if free:
        console.print(
            f"{free} of the modes are rigid-body modes of the wing (0 Hz). Use --hold to fix lines at their angles."
        )
