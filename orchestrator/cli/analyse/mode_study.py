"""`fanfold analyse mode-study`: how many fixed-interface modes a body needs, by latch-up and by frequencies."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..options import SceneChoice, scene_choice
from ..progress import progress
from ._latch_study import report_study, study_options

if TYPE_CHECKING:
    from rich.table import Table

    from components.contract.component import Vector

    from ...analysis.mode_study import Frequencies


def frequency_tables(name: str, found: Frequencies, width: int) -> Iterator[Table]:
    """Fixed-interface and free frequencies of the full model, and errors of the free ones of every reduced body.

    width: of the terminal, in characters.
    """
    from ...analysis.mode_study import mode_label
    from ..tables import Column, tables_that_fit

    count = len(found.free)
    fixed = [
        Column("mode", [str(k + 1) for k in range(count)]),
        Column("clamped,\nHz", [f"{value:.4f}" for value in found.fixed]),
        Column("free,\nHz", [f"{value:.4f}" for value in found.free]),
    ]
    reduced = [
        Column(f"{mode_label(kept)},\n%", [_error(values, found.free, k) for k in range(count)])
        for kept, values in found.reduced.items()
    ]
    return tables_that_fit(
        f"{name}: full model, and errors of the reduced body's\nfree frequencies by number of modes",
        fixed,
        reduced,
        width,
    )


def _error(values: Vector, free: Vector, k: int) -> str:
    """Error (%) of a frequency of the reduced body, where it has that many."""
    return f"{100.0 * (values[k] / free[k] - 1.0):+.3g}" if k < len(values) else ""


def _counts(_: click.Context, param: click.Parameter, value: str) -> tuple[int, ...]:
    try:
        counts = tuple(sorted({int(text) for text in value.split(",")}))
    except ValueError:
        raise click.BadParameter("give integers separated by commas", param=param) from None
    if counts[0] < 0 or len(counts) < 2:
        raise click.BadParameter("give at least two different numbers of modes, none negative", param=param)
    return counts


@click.command("mode-study")
@scene_choice
@click.option(
    "--body",
    metavar="BODY",
    help="Body whose number of modes varies; required if several bodies are flexible.",
)
@click.option(
    "--modes", "counts", default="2,3,4,5,10,20,30", show_default=True, callback=_counts, metavar="N,N,...",
    help="Numbers of fixed-interface modes; the largest is the reference.",
)  # fmt: skip
@study_options("mode-study", "runs")
def command(
    choice: SceneChoice,
    body: str | None,
    counts: tuple[int, ...],
    tolerance: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Convergence of the latch-up of SCENE with the number of fixed-interface modes of a body."""
    from ...run.simulation import fidelity_word, result_file  # takes its time, which --help need not

    scene = choice.load()
    fidelity = fidelity_word(**choice.fidelities)
    folder = output or result_file(scene.name, scene.chosen, fidelity, "mode-study")
    study = fanfold.mode_study(
        scene,
        body,
        counts=counts,
        **choice.fidelities,
        tolerance=tolerance,
        folder=folder,
        progress=progress,
    )
    from ..tables import terminal

    tables = frequency_tables(study.body, study.frequencies, terminal().width)
    report_study(study.latch_up, folder, study.as_dict() if as_json else None, tables)
