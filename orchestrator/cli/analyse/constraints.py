"""`fanfold analyse constraints`: number, rank and redundancy of joint constraints, and free motions."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..command import made_of

if TYPE_CHECKING:
    from ...scene.builder import Scene
    from ...scene.freedoms import Constraints


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.3g}"


def _rows(found: Constraints) -> list[tuple[str, str]]:
    return [
        ("moving bodies", str(len(found.moving))),
        ("constraints", str(found.count)),
        ("degrees of freedom by count (Gruebler)", str(found.grubler)),
        ("rank of the constraints", str(found.rank)),
        ("rank 0.01 rad away", "none" if found.nearby is None else str(found.nearby)),
        ("degrees of freedom", str(found.freedoms)),
        ("with motions", str(found.freedoms - found.driven)),
        ("smallest singular value kept", _number(found.smallest_kept)),
        ("largest singular value dropped", _number(found.largest_dropped)),
        ("redundant", ", ".join(found.redundant) or "none"),
        ("spin about the line of their joints", ", ".join(found.spins) or "none"),
    ]


@made_of("constraints", name="constraints")
def command(scene: Scene, as_json: bool = False) -> None:
    """Constraints of the joints of SCENE at its start: number, rank, redundant constraints, free motions."""
    found = fanfold.constraints(scene)
    derived = {"grubler": found.grubler, "freedoms": found.freedoms, "singular": found.is_singular}
    if as_json:
        click.echo(json.dumps(asdict(found) | derived | {"warnings": found.warnings}))
        return
    from ..tables import table_of, terminal

    terminal().print(table_of("constraints", ("", ""), _rows(found), ("",)))
    for sentence in found.warnings:
        click.echo(f"Warning: {sentence}", err=True)
