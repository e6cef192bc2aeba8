"""`fanfold analyse latch-tuning`: the latch spring that gives a rigid pair the frequency of the flexible one."""

from __future__ import annotations

import json
from math import degrees, isfinite, pi
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..command import Asked, made_of

if TYPE_CHECKING:
    from ...analysis.latch_tuning import Tuning
    from ...analysis.latch_tuning_of_wing import WingTuning
    from ...scene.builder import Scene


@made_of("latch_tuning", name="latch-tuning")
def command(scene: Scene, asked: Asked, wing: bool = False, as_json: bool = False) -> None:
    """Tune the latch spring of a hinge line of SCENE so that its rigid model has the frequency of the flexible one.

    Options
    -------
    line
        hinge line whose latch spring to tune
    stiffness_of
        stiffness that the frequency belongs to: total with flexible hinges, structure with rigid ones. By default total
        with `frequency`, else structure, because the hinges of the flexible pair are locked
    wing
        tune to the whole deployed wing instead of the two bodies of the line
    """
    options = asked["latch_tuning"]
    if wing:
        if [options.pop(name) for name in ("stiffness_of", "hinge_stiffness")] != [None, None]:
            raise click.UsageError(
                "--stiffness-of and --hinge-stiffness are of the pair; leave them out with --wing"
            )
        whole = fanfold.wing_latch_tuning(scene, **options)
        click.echo(json.dumps(whole.as_dict()) if as_json else _of_wing(whole))
        return
    tuning = fanfold.latch_tuning(scene, **options)
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
    from ..tables import table_of, terminal

    inboard, outboard = tuning.inertias
    inner = (f"{inboard:.6g}", "kg.m2") if isfinite(inboard) else ("fixed", "")
    rows = [
        ("inertia about the line, inboard", *inner),
        ("inertia about the line, outboard", f"{outboard:.6g}", "kg.m2"),
        ("effective inertia", f"{tuning.inertia:.6g}", "kg.m2"),
        ("target frequency", f"{tuning.frequency:.7g}", "Hz"),
    ]
    if tuning.overlap is not None:
        rows.append(("rotation of the line in that mode", f"{100.0 * tuning.overlap:.2f}", "%"))
    stiffnesses = {"total": tuning.total, "structure": tuning.structure, "hinges": tuning.hinges}
    for what, value in stiffnesses.items():
        if value is not None:
            per_hinge = value / tuning.springs * pi / 180.0
            rows.append((f"{what} stiffness", f"{value:.7g}", "N.m/rad"))
            rows.append((f"{what} stiffness, each of {tuning.springs}", f"{per_hinge:.6g}", "N.m/deg"))
    rows.append(("check: frequency of the rigid pair", f"{tuning.check:.7g}", "Hz"))
    title = f"latch spring of {tuning.line}"
    terminal().print(table_of(title, ("quantity", "value", "unit"), rows, ("quantity", "unit")))
