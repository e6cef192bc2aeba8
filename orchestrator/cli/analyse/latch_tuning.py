"""`fanfold analyse latch-tuning`: the latch spring that gives a rigid pair the frequency of the flexible one."""

from __future__ import annotations

import json
from math import degrees, isfinite, pi
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..options import SceneChoice, scene_choice
from ..types import Number, given_quantity

if TYPE_CHECKING:
    from ...analysis.latch_tuning import Kind, Tuning
    from ...analysis.latch_tuning_of_wing import WingTuning


def _stiffness(_: click.Context, __: click.Parameter, value: str | None) -> float | None:
    return None if value is None else given_quantity(value, "N.m/rad", "the stiffness", "positive")


@click.command("latch-tuning")
@scene_choice
@click.option("--line", "name", required=True, metavar="LINE", help="Hinge line whose latch spring to tune.")
@click.option(
    "--frequency", type=Number(min=0.0, min_open=True), metavar="HZ",
    help="Target frequency, Hz; by default that of the flexible pair.",
)  # fmt: skip
@click.option(
    "--stiffness-of", "kind", type=click.Choice(["total", "structure"]),
    help=(
        "Stiffness that the frequency belongs to: total with flexible hinges, structure with rigid ones. By "
        "default total with --frequency, else structure, because the hinges of the flexible pair are locked."
    ),
)  # fmt: skip
@click.option(
    "--hinge-stiffness", "hinges", callback=_stiffness, metavar="VALUE",
    help="Measured stiffness of all hinges of the line together, with its unit, such as 51.3N.m/deg.",
)  # fmt: skip
@click.option(
    "--wing", is_flag=True,
    help="Tune to the whole deployed wing instead of the two bodies of the line.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    name: str,
    frequency: float | None,
    kind: Kind | None,
    hinges: float | None,
    wing: bool,
    as_json: bool,
) -> None:
    """Tune the latch spring of a hinge line of SCENE so that its rigid model has the frequency of the flexible one."""
    if wing:
        if kind is not None or hinges is not None:
            raise click.UsageError(
                "--stiffness-of and --hinge-stiffness are of the pair; leave them out with --wing"
            )
        whole = fanfold.wing_latch_tuning(choice.load(), name, frequency=frequency, **choice.fidelities)
        click.echo(json.dumps(whole.as_dict()) if as_json else _of_wing(whole))
        return
    tuning = fanfold.latch_tuning(
        choice.load(),
        name,
        frequency=frequency,
        stiffness_of=kind,
        hinge_stiffness=hinges,
        **choice.fidelities,
    )
    if as_json:
        click.echo(json.dumps(tuning.as_dict()))
        return
    _print(tuning)
    click.echo(tuning.scope)
    for angle, torque in tuning.law:
        click.echo(f"latch law: {degrees(angle):9.4f} deg {torque:9.4f} N.m")


def _of_wing(found: WingTuning) -> str:
    """What was found for a wing, in sentences."""
    return (
        f"{found.line}: with {found.stiffness:.5g} N.m/rad the rigid wing has {found.check:.5g} Hz in "
        f"{found.direction} (target {found.frequency:.5g} Hz); with the present stiffness it has "
        f"{found.present:.5g} Hz\nto use it: --set 'hinge_line.{found.line}.latch.stiffness={found.stiffness:.5g} "
        "N.m/rad', and at least that for inboard_stiffness and outboard_stiffness"
    )


def _print(tuning: Tuning) -> None:
    from rich.table import Table

    from ..tables import terminal

    table = Table(title=f"latch spring of {tuning.line}")
    table.add_column("quantity")
    table.add_column("value", justify="right")
    table.add_column("unit")
    inboard, outboard = tuning.inertias
    fixed = not isfinite(inboard)
    inner, unit = ("fixed", "") if fixed else (f"{inboard:.6g}", "kg.m2")
    table.add_row("inertia about the line, inboard", inner, unit)
    table.add_row("inertia about the line, outboard", f"{outboard:.6g}", "kg.m2")
    table.add_row("effective inertia", f"{tuning.inertia:.6g}", "kg.m2")
    table.add_row("target frequency", f"{tuning.frequency:.7g}", "Hz")
    if tuning.overlap is not None:
        table.add_row("rotation of the line in that mode", f"{100.0 * tuning.overlap:.2f}", "%")
    stiffnesses = {"total": tuning.total, "structure": tuning.structure, "hinges": tuning.hinges}
    for what, value in stiffnesses.items():
        if value is not None:
            table.add_row(f"{what} stiffness", f"{value:.7g}", "N.m/rad")
            per_hinge = value / tuning.springs * pi / 180.0
            table.add_row(f"{what} stiffness, each of {tuning.springs}", f"{per_hinge:.6g}", "N.m/deg")
    table.add_row("check: frequency of the rigid pair", f"{tuning.check:.7g}", "Hz")
    terminal().print(table)
