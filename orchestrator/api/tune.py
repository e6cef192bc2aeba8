"""Tuning from Python: fit parameters of a scene to target values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated

from ..analysis.sampling.sample import Task
from ..analysis.sampling.targets import Target, curves, target
from ..analysis.sampling.tuning import Tuned
from ..analysis.sampling.tuning import tune as _tune
from ..analysis.sampling.varied import all_varied
from ..scene.builder import Names
from .options import InputFile, Positive, Within
from .quantities import Duration, Tolerance
from .simulate import SceneLike, as_scene, options_of


def tune(
    scene: SceneLike,
    vary: Mapping[str, str] | Sequence[str],
    targets: Mapping[str, float | str] | Sequence[str] = (),
    *,
    curve: InputFile | None = None,
    accuracy: Annotated[float, Within("1", 1e-9, 0.1)] = 1e-4,
    most_runs: Annotated[int, Within(low=2)] = 100,
    workers: Positive = 1,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Duration | None = None,
    tolerance: Tolerance | None = None,
    watch: Callable[[int, float], None] = lambda runs, residual: None,
) -> Tuned:
    """Fit parameters of a scene to target values of headline numbers and to measured curves.

    Bounded least squares from the values of the scene, with finite differences of runs.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    vary : mapping or sequence of str
        ranges by key, such as ``{"hinge_line.HL1.motor.stowed": "uniform(1.2 N.m, 2 N.m)"}``; a key that ends in ``*``
        is a factor; keys separated by commas get the same value
    targets : mapping or sequence of str
        values by identifier of the headline number, such as ``{"latch_time.HL1": "11.6 s"}``; plain numbers are in the
        unit of the table of headline numbers
    curve : str or Path, optional
        CSV file with times (s) in the first column, other columns headed COMPONENT.VARIABLE or COMPONENT.VARIABLE[1]
    accuracy : float
        largest relative difference to the targets
    most_runs : int
        limit on the number of runs, derivatives included
    workers : int
        number of processes
    rigid, flexible, large_deformation, until
        see `simulate`
    tolerance : float, optional
        relative accuracy of every run, which should be well below `accuracy`; by default that of the scene
    watch : callable, optional
        called with the number of runs and the smallest residual

    Returns
    -------
    Tuned
        values, settings, residual; `reached` is False if the targets are missed by more than `accuracy`

    Raises
    ------
    StudyError, SceneError
        if the tuning cannot start

    Examples
    --------
    >>> keys = {"hinge_line.HL1.motor.stowed": "uniform(1.2 N.m, 2 N.m)"}
    >>> fanfold.tune("amos3", keys, {"latch_time.HL1": "11.6 s"}, rigid="all").settings
    """
    options = options_of(locals())
    wanted = (
        [_wanted(name, value) for name, value in targets.items()]
        if isinstance(targets, Mapping)
        else list(map(target, targets))
    )
    measured = () if curve is None else curves(Path(curve))
    task = Task(as_scene(scene), options)
    return _tune(task, all_varied(vary), wanted, measured, workers, accuracy, most_runs, watch)


def _wanted(name: str, value: float | str) -> Target:
    return Target(target(f"{name}=0").number, value)
