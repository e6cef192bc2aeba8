"""`fanfold analyse mode-study`: how many fixed-interface modes a body needs, by latch-up and by frequencies."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import orchestrator as fanfold

from ...api.options import Folder
from ..command import Asked, made_of, usual_file
from ..progress import progress
from ._latch_study import report_study

if TYPE_CHECKING:
    from rich.table import Table

    from components.contract.component import Vector

    from ...analysis.mode_study import Frequencies
    from ...scene.builder import Scene


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


@made_of("mode_study", name="mode-study", counts={"flags": "--modes"})
def command(scene: Scene, asked: Asked, folder: Folder | None = None, as_json: bool = False) -> None:
    """Convergence of the latch-up of SCENE with the number of fixed-interface modes of a body.

    Options
    -------
    folder
        folder for results and pictures; by default SCENE.mode-study
    """
    options = asked["mode_study"]
    place = Path(folder or usual_file(scene, options, "mode-study"))
    study = fanfold.mode_study(scene, **options, folder=place, progress=progress)
    from ..tables import terminal

    tables = frequency_tables(study.body, study.frequencies, terminal().width)
    report_study(study.latch_up, place, study.as_dict() if as_json else None, tables)
