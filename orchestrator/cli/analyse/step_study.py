"""`fanfold analyse step-study`: latch-up against the communication step size."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import orchestrator as fanfold

from ...api.options import Folder
from ..command import Asked, made_of, usual_file
from ..progress import progress
from ._latch_study import report_study

if TYPE_CHECKING:
    from ...scene.builder import Scene


@made_of("step_study", name="step-study")
def command(scene: Scene, asked: Asked, folder: Folder | None = None, as_json: bool = False) -> None:
    """Convergence of the latch-up of SCENE with the communication step size.

    Options
    -------
    tolerance
        relative accuracy of the run with step control; by default that of the scene
    folder
        folder for results and pictures; by default SCENE.step-study
    """
    options = asked["step_study"]
    place = Path(folder or usual_file(scene, options, "step-study"))
    study = fanfold.step_study(scene, **options, folder=place, progress=progress)
    report_study(study, place, {"cases": study.as_dicts()} if as_json else None)
