"""Studies from Python: a scene run many times with drawn values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import fields
from dataclasses import replace as changed
from pathlib import Path
from typing import Annotated, Self

from ..analysis.sampling.carry_out import StudyProgress, Watch, begin, go_on
from ..analysis.sampling.influence import Influence, influence
from ..analysis.sampling.journal import journal_file
from ..analysis.sampling.plan import Method, Plan
from ..analysis.sampling.sample import Task
from ..analysis.sampling.study import Study as Record
from ..analysis.sampling.targets import signals_of
from ..analysis.sampling.varied import all_varied
from ..messages import message
from ..results.signal import matches
from ..scene.builder import Names, listed
from .options import OutputFile, Positive, Within
from .quantities import Duration, Tolerance
from .simulate import SceneLike, options_of, with_requirements
from .warnings import warn


class Study(Record):
    """Result of a study; `study` returns one, `Study.open` reads one.

    Attributes
    ----------
    parameters, numbers, opened, signals : dict
        arrays over the samples by name; failed samples are NaN
    units : dict
        units of parameters and numbers by name
    failed : dict
        why samples failed, by sample
    """

    @classmethod
    def of_record(cls, record: Record) -> Self:
        """The same study with the methods of this class."""
        return cls(*(getattr(record, one.name) for one in fields(Record)))

    def influence(self, number: str) -> Influence | None:
        """Sensitivity of a headline number to each parameter; None if the number does not change."""
        return influence(self, number)

    def plot_all(self, folder: str | Path, format: str = "png") -> list[Path]:
        """Write all figures into a folder; returns their paths."""
        from ..views.study import plot_study

        return plot_study(self, Path(folder), format)


def study(
    scene: SceneLike,
    vary: Mapping[str, str] | Sequence[str],
    *,
    method: Method = "latin-hypercube",
    runs: Positive = 100,
    levels: Annotated[int, Within(low=2)] = 5,
    seed: Annotated[int, Within(low=0)] = 0,
    workers: Positive = 1,
    cluster: str | None = None,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Duration | None = None,
    tolerance: Tolerance | None = None,
    estimate: bool = False,
    require: str | Sequence[str] = (),
    signals: Names = (),
    points: Annotated[int, Within(low=2)] = 201,
    save: OutputFile | None = None,
    replace: bool = True,
    progress: StudyProgress | None = None,
) -> Study:
    """Run a scene many times with parameters drawn from distributions.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    vary : mapping or sequence of str
        distributions by key, such as ``{"friction.coefficient": "uniform(0.05, 0.2)"}``: uniform, normal,
        truncated_normal, lognormal (mean, coefficient of variation), triangular or values; a key that ends in ``*`` is
        a factor; keys separated by commas get the same value
    method : {"latin-hypercube", "random", "sobol", "sobol-indices", "grid", "one-at-a-time", "corners"}
        design of the samples; "one-at-a-time" and "corners" use bounds, or three standard deviations
    runs : int
        samples of random methods
    levels : int
        levels of each key of a grid
    seed : int
        seed of random methods; samples are the same on every machine
    workers : int
        number of processes
    cluster : str, optional
        address of a Dask scheduler, instead of `workers`
    rigid, flexible, large_deformation, until, tolerance
        see `simulate`
    estimate : bool
        estimate the errors of headline numbers in every run
    require : str or sequence of str
        further requirements, such as "latch_rate.HL1 < 15 deg/s"; the margin of each is a number of every sample
    signals : str or sequence of str
        signals to keep, by patterns of COMPONENT.VARIABLE; a warning lists patterns without a match
    points : int
        equally spaced times of these signals
    save : str or Path, optional
        file of the study (HDF5), next to a table (.csv); `resume_study` continues an interrupted study
    replace : bool
        replace an existing study; if False, only a study of the same settings is replaced
    progress : callable, optional
        progress bar

    Returns
    -------
    Study
        headline numbers, opened lines and signals of all samples; failed samples are listed in `failed`

    Raises
    ------
    StudyError, SceneError
        if the study cannot start

    Examples
    --------
    >>> found = fanfold.study("amos3", {"friction.coefficient": "uniform(0.05, 0.2)"}, rigid="all", runs=50)
    >>> found.quantiles("latch_time.HL1")
    """
    options = changed(options_of(locals()), signals=())  # which the task samples
    plan = Plan(all_varied(vary), method, runs, levels, seed)
    task = Task(with_requirements(scene, require), options, estimate, listed(signals), points)
    _tell_of_unknown_signals(task)
    path = None if save is None else Path(save)
    found = begin(task, plan, path, workers, cluster, progress or _silent, replace=replace)
    return Study.of_record(found)


_SCENE = "scene"
"""What records that are of no component go by."""


def _tell_of_unknown_signals(task: Task) -> None:
    """Warn about patterns without a match before the first sample runs."""
    known = [tuple(name.partition("[")[0].split(".", 1)) for name in signals_of(task)] if task.signals else []
    components = list(dict.fromkeys(component for component, _ in known))
    unmatched = [
        one
        for one in task.signals
        if one.partition(".")[0] != _SCENE
        and not any(matches((name, variable), one) for name, variable in known)
    ]
    if unmatched:
        warn(
            message(
                "W-signals",
                f"{task.scene.name}: no signal matches {', '.join(unmatched)}. Use patterns of COMPONENT or "
                f"COMPONENT.VARIABLE; components are {', '.join(components)}.",
            )
        )


def resume_study(
    path: str | Path,
    *,
    workers: Positive = 1,
    cluster: str | None = None,
    trust: bool = False,
    progress: StudyProgress | None = None,
) -> Study:
    """Continue an interrupted study, or open a complete one.

    Parameters
    ----------
    path : str or Path
        file of the study; load its plugins with `load_plugin` first
    workers, cluster, progress
        see `study`
    trust : bool
        open files of bodies and FMUs that the study names

    Returns
    -------
    Study
        the complete study

    Raises
    ------
    StudyError
        if there is no study, or files of its bodies have changed
    """
    if Path(path).is_file() and not journal_file(Path(path)).is_file():
        return Study.open(path)
    return Study.of_record(go_on(Path(path), workers, cluster, progress or _silent, trust))


def _silent(_: str, __: int) -> AbstractContextManager[Watch]:
    return nullcontext(lambda done, failed: None)
