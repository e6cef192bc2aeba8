"""`fanfold analyse step-study`: latch-up against the communication step size."""

from __future__ import annotations

from pathlib import Path

import click

import orchestrator as fanfold

from ..options import SceneChoice, scene_choice
from ..progress import progress
from ._latch_study import report_study, study_options


def _steps(_: click.Context, param: click.Parameter, value: str) -> tuple[float, ...]:
    from ...analysis.step_study import study_steps

    try:
        return study_steps([float(text) for text in value.split(",")])
    except ValueError:
        raise click.BadParameter("give step sizes in seconds, separated by commas", param=param) from None
    except fanfold.FanfoldError as error:
        raise click.BadParameter(str(error), param=param) from None


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
    """Convergence of the latch-up of SCENE with the communication step size."""
    from ...run.simulation import fidelity_word, result_file  # takes its time, which --help need not

    scene = choice.load()
    fidelity = fidelity_word(**choice.fidelities)
    folder = output or result_file(scene.name, scene.chosen, fidelity, "step-study")
    study = fanfold.step_study(
        scene, steps=steps, **choice.fidelities, tolerance=tolerance, folder=folder, progress=progress
    )
    report_study(study, folder, {"cases": study.as_dicts()} if as_json else None)
