"""`fanfold analyse gradients`: derivatives of headline numbers with respect to keys of a scene, from replayed runs."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...api.options import Picture
from ..command import Asked, made_of
from ..progress import progress

if TYPE_CHECKING:
    from ...analysis.sampling.gradients import Gradients
    from ...scene.builder import Scene


_SURE, _MOST, _REAL = 0.01, 10.0, 0.1
"""Relative errors of a derivative: larger than the first they are shown, larger than the second as "all"; up to
the third a derivative of a number that is round-off is shown."""


@made_of("gradients", name="gradients", keys={"flags": "--by", "metavar": "KEY"})
def command(scene: Scene, asked: Asked, output: Picture | None = None, as_json: bool = False) -> None:
    """Derivatives of the headline numbers of SCENE with respect to its keys, through all latch-ups.

    Options
    -------
    keys
        key to differentiate by, such as hinge_line.HL1.motor.stowed; 'KEY*' is a factor, keys separated by commas
        change together; repeatable
    output
        picture; by default SCENE.gradients.png
    """
    found = fanfold.gradients(scene, **asked["gradients"], progress=progress)
    from ...views.gradients import plot_gradients  # matplotlib takes its time

    picture = plot_gradients(found, output or Path(f"{found.scene}.gradients.png"))
    if as_json:
        click.echo(json.dumps(found.plain()))
    else:
        _report(found)
    if warning := found.warning:
        click.echo(warning, err=True)
    click.echo(picture, err=as_json)


def _report(found: Gradients) -> None:
    from ..tables import Column, tables_that_fit, terminal

    console, round_off, unreliable = (
        terminal(),
        found.round_off.tolist(),
        {*found.unreliable},
    )
    fixed = [
        Column("", found.names),
        Column("value", [f"{one.value:.6g} {one.unit}" for one in found.numbers]),
        Column(
            "error",
            [
                "round-off" if nothing else f"{error:.0e}" if error > 0.0 else ""
                for nothing, error in zip(round_off, found.errors.tolist(), strict=True)
            ],
        ),
    ]
    singles = zip(found.derivatives.T.tolist(), found.single_errors.T.tolist(), strict=True)
    columns = [
        Column(
            _heading(key, unit),
            [
                ""
                if nothing and not error <= _REAL * abs(value)
                else _sure(value, error, believed=name not in unreliable)
                for name, nothing, value, error in zip(found.names, round_off, values, errors, strict=True)
            ],
        )
        for key, unit, (values, errors) in zip(found.keys, found.units, singles, strict=True)
    ]
    for table in tables_that_fit(f"{found.scene}: derivatives", fixed, columns, console.width):
        console.print(table)


def _sure(value: float, error: float, *, believed: bool) -> str:
    """A derivative, with its relative error above one per cent; "unreliable" if that is unbounded."""
    if not error > _SURE * abs(value):
        return f"{value:.5g}"
    if not believed:
        return "unreliable"
    share = error / abs(value) if value else inf
    return f"{value:.3g} ±{share:.0%}" if share < _MOST else f"{value:.3g} ±all"


def _heading(key: str, unit: str) -> str:
    """A key on one line per part, and the unit that the number's unit is divided by."""
    return "\n".join([*key.replace(",", ",.").split("."), f"per {unit}" if unit else ""])
