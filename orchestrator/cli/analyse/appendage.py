"""`fanfold analyse appendage`: the wing as attitude control sees it, in a table and in files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...analysis.vibration import DIRECTIONS
from ...api.options import OutputFile
from ..command import Asked, made_of
from ._configuration import ANGLES

if TYPE_CHECKING:
    from ...analysis.appendage.model import Appendage
    from ...scene.builder import Scene

_SMALLEST_SHARE = 1e-3
"""Fraction of the rigid mass; smaller values are shown as 0."""
_EXAMPLES = """\b
Examples:
  fanfold analyse appendage amos3 --configuration deployed --save wing.mat
  fanfold analyse appendage amos3 --angle HL1=45deg --hold all --points hl1 --json
"""


@made_of("appendage", name="appendage", epilog=_EXAMPLES, angles=ANGLES, save={"flags": "-o --save"})
def command(scene: Scene, asked: Asked, save: OutputFile | None = None, as_json: bool = False) -> None:
    """Linear appendage model of SCENE: cantilever modes, participation, rigid and residual mass.

    Options
    -------
    save
        file to write: .json, .npz, .mat (MATLAB), .op4 (Craig-Bampton, one grid), .txt (flexible body of 42)
    """
    found = fanfold.appendage(scene, **asked["appendage"])
    if as_json:
        click.echo(json.dumps({"appendages": [one.as_dict() for one in found]}))
    else:
        for one in found:
            _print(one)
    if save is not None:
        from ...analysis.appendage.files import write_appendages

        for path in write_appendages(found, Path(save)):
            click.echo(path, err=as_json)


def _print(found: Appendage) -> None:
    from ..tables import table_of, terminal

    least = _SMALLEST_SHARE * found.rigid_mass.diagonal()
    modes = zip(found.frequency, found.damping_ratio, found.effective_mass, strict=True)
    rows = []
    for k, (frequency, ratio, masses) in enumerate(modes, start=1):
        shown = ("0" if mass < small else f"{mass:.3g}" for mass, small in zip(masses, least, strict=True))
        rows.append((f"{k}", f"{frequency:.5g}", f"{100.0 * ratio:.3g}", *shown))
    for name, matrix in (("left", found.residual_mass), ("rigid", found.rigid_mass)):
        shown = (
            "0" if mass < small else f"{mass:.4g}"
            for mass, small in zip(matrix.diagonal(), least, strict=True)
        )
        rows.append((name, "", "", *shown))
    title = f"appendage about {found.point}; effective masses, kg and kg.m2"
    table = table_of(title, ("mode", "freq.,\nHz", "damp.,\n%", *DIRECTIONS), rows)
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
