"""How far a result depends on the communication step size: fixed steps, and step control at its tolerance.

The study of Bagnoli (2007), section 3.3.6, whose solver needed a largest step of 1e-4 s.
"""

from __future__ import annotations

import json
from pathlib import Path

import click
from rich.console import Console

from ...analysis.studies import refuse_unlatched
from ...cosim.master import Settings
from ..options import SceneChoice, scene_choice
from ._latch_study import LatchStudy, run_case, study_options


def _label(step: float) -> str:
    """How a step size is called in tables and names of files."""
    return f"{step:g} s"


def _steps(_: click.Context, param: click.Parameter, value: str) -> tuple[float, ...]:
    try:
        steps = tuple(sorted({float(text) for text in value.split(",")}, reverse=True))
    except ValueError:
        raise click.BadParameter("give step sizes in seconds with commas between", param=param) from None
    if len({_label(step) for step in steps}) < max(2, len(steps)) or not all(
        1e-7 <= step <= 1.0 for step in steps
    ):
        raise click.BadParameter("give at least two different step sizes between 1e-7 and 1 s", param=param)
    return steps


@click.command("step-study")
@scene_choice
@click.option(
    "--steps", default="2e-3,1e-3,5e-4,2e-4,1e-4,5e-5", show_default=True, callback=_steps, metavar="S,S,...",
    help="Fixed communication step sizes in seconds; the smallest is the reference.",
)  # fmt: skip
@study_options("step-study", "run with step control")
def command(
    choice: SceneChoice,
    steps: tuple[float, ...],
    tolerance: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Latch-up of SCENE against the communication step size."""
    assembly = choice.assemble(choice.load_one_run())
    folder = output or Path(f"{assembly.name}.step-study")
    folder.mkdir(parents=True, exist_ok=True)
    controlled = Settings(tolerance or assembly.tolerance, assembly.largest_step)
    label = f"tolerance {controlled.tolerance:g}"
    run_time = assembly.until
    adaptive = run_case(label, 0.0, assembly, folder / "controlled.h5", controlled, run_time)
    refuse_unlatched(adaptive)
    cases = [
        run_case(
            _label(h),
            h,
            assembly,
            folder / f"{_label(h).replace(' ', '_')}.h5",
            Settings(controlled.tolerance, fixed_step=h),
            run_time,
        )
        for h in steps
    ]
    study = LatchStudy(assembly.name, folder, cases, [adaptive])
    smallest = f"steps of {study.reference.label}"
    study.draw("Latch-up and step size", smallest, "communication step size, s", 0.3)
    if as_json:
        click.echo(json.dumps({"cases": study.as_dict()}))
    else:
        study.print(Console(), smallest)
