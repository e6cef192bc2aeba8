"""How far a result depends on the communication step size: fixed steps, and step control at its tolerance.

The study of Bagnoli (2007), section 3.3.6, whose solver needed a largest step of 1e-4 s.
"""

from __future__ import annotations

import json
from pathlib import Path

import click
from rich.console import Console

from ..cli_options import fidelity_options, scene_layers, scene_of_one_run
from ..cli_types import Number
from ..master import Settings
from ..scene import assemble
from ._studies import as_dict, draw_changes, draw_latch_torques, latch_table, refuse_unlatched, run_case


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
@click.argument("scene")
@scene_layers
@fidelity_options
@click.option(
    "--steps", default="2e-3,1e-3,5e-4,2e-4,1e-4,5e-5", show_default=True, callback=_steps, metavar="S,S,...",
    help="Fixed communication step sizes in seconds; the smallest is the reference.",
)  # fmt: skip
@click.option(
    "--tolerance", type=Number(min=1e-10, max=0.1),
    help="Relative accuracy of the run with step control; by default that of the scene.",
)  # fmt: skip
@click.option(
    "--output", type=click.Path(path_type=Path, file_okay=False),
    help="Folder for results and pictures; by default SCENE.step-study.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    scene: str,
    variants: tuple[str, ...],
    settings: tuple[str, ...],
    rigid: frozenset[str],
    flexible: frozenset[str],
    steps: tuple[float, ...],
    tolerance: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Latch-up of SCENE against the communication step size."""
    assembly = assemble(scene_of_one_run(scene, variants, settings), rigid, flexible)
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
    reference = cases[-1]
    refuse_unlatched(reference)
    draw_latch_torques(folder / "latch_torques.png", "Latch-up and step size", [adaptive, *cases], 0.3)
    draw_changes(
        folder / "changes.png", f"Against steps of {reference.label}", "communication step size, s",
        cases, reference, log=True,
    )  # fmt: skip
    if as_json:
        click.echo(json.dumps({"cases": as_dict([adaptive, *cases], reference)}))
        return
    console = Console()
    console.print(
        latch_table(f"{assembly.name}: against steps of {reference.label}", [adaptive, *cases], reference)
    )
    console.print(f"pictures and results in {folder}")
