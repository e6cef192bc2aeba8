"""Pictures of analyses."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from components import FanfoldError

if TYPE_CHECKING:
    from ..analysis.frequency_response import FrequencyResponse
    from ..analysis.mode_study import ModeStudy
    from ..analysis.modes import Modes
    from ..analysis.sampling.study import Study
    from ..analysis.scene_check import SceneCheck
    from ..analysis.stress.hot_spots import PanelStress
    from ..analysis.studies import LatchStudy
    from ..analysis.torque_margin.margins import TorqueMargin

    Found = (
        FrequencyResponse | LatchStudy | ModeStudy | Modes | PanelStress | SceneCheck | Study | TorqueMargin
    )


def plot(found: Found, folder: str | Path) -> list[Path]:
    """Plot the record of an analysis.

    For results see `Result.plot` and `plot_comparison`.

    Parameters
    ----------
    found : record
        returned by `check_scene`, `modes`, `frequency_response`, `stress`, `study`, `step_study`, `mode_study` or
        `torque_margin`
    folder : str or Path
        folder of the pictures

    Returns
    -------
    list of Path
        pictures

    Raises
    ------
    FanfoldError
        if there are no pictures of such a record
    """
    from ..views.linear import plot_modes, plot_response
    from ..views.scene_check import plot_scene
    from ..views.stress import plot_stress
    from ..views.studies import plot_study
    from ..views.study import plot_study as plot_samples
    from ..views.torque_margin import plot_margins

    drawn_by = {
        "FrequencyResponse": plot_response,
        "LatchStudy": plot_study,
        "ModeStudy": lambda study, path: plot_study(study.latch_up, path),
        "Modes": plot_modes,
        "PanelStress": plot_stress,
        "SceneCheck": plot_scene,
        "Study": plot_samples,
        "TorqueMargin": plot_margins,
    }
    kind = type(found).__name__
    if kind not in drawn_by:
        raise FanfoldError(f"there are no pictures of a {kind}; there are of {', '.join(drawn_by)}")
    path = Path(folder)
    path.mkdir(parents=True, exist_ok=True)
    paths: list[Path] = drawn_by[kind](found, path)  # type: ignore[operator]
    return paths
