"""Studies from Python: a scene run many times with drawn values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import fields
from pathlib import Path
from typing import Self

from ..analysis.sampling.carry_out import StudyProgress, Watch, begin, go_on
from ..analysis.sampling.influence import Influence, influence
from ..analysis.sampling.journal import journal_file
from ..analysis.sampling.plan import Plan
from ..analysis.sampling.sample import Task
from ..analysis.sampling.study import Study as Record
from ..analysis.sampling.targets import signals_of
from ..analysis.sampling.varied import varied
from ..messages import message
from ..results.signal import matches
from ..scene.builder import Names, listed
from .quantities import Quantity
from .simulate import SceneLike, as_scene, options_of
from .warnings import warn


class Study(Record):
    """What a study found; `study` returns one, `Study.open` reads one.

    `parameters`, `numbers`, `opened` and `signals` are arrays over the samples by name, `units` their units, `failed`
    says which samples did not come to their end, and why.
    """

    @classmethod
    def of_record(cls, record: Record) -> Self:
        """The same study with everything that is offered here."""
        return cls(*(getattr(record, one.name) for one in fields(Record)))

    def influence(self, number: str) -> Influence | None:
        """How much each parameter moves a headline number; None where it does not change."""
        return influence(self, number)

    def plot_all(self, folder: str | Path, format: str = "png") -> list[Path]:
        """Write every figure into a folder; the paths written."""
        from ..views.study import plot_study

        return plot_study(self, Path(folder), format)


def study(
    scene: SceneLike,
    vary: Mapping[str, str] | Sequence[str],
    *,
    method: str = "latin-hypercube",
    runs: int = 100,
    levels: int = 5,
    seed: int = 0,
    workers: int = 1,
    cluster: str | None = None,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Quantity | None = None,
    tolerance: float | None = None,
    estimate: bool = False,
    signals: Names = (),
    points: int = 201,
    save: str | Path | None = None,
    replace: bool = True,
    progress: StudyProgress | None = None,
) -> Study:
    """Run a scene many times with values drawn from distributions.

    vary: distributions by key, such as {"friction.coefficient": "uniform(0.05, 0.2)"}; a key that ends in * is
    multiplied by what is drawn, keys with commas between get the same. Distributions are uniform, normal,
    truncated_normal, lognormal, triangular and values; "lognormal(0.15 N.m, 40 %)" has its mean and its coefficient of
    variation. method: "latin-hypercube", "random", "sobol", "sobol-indices",
    "grid", "one-at-a-time" or "corners", the last two between bounds, or three standard deviations. runs, seed: of
    random methods, which draw the same on every machine. levels: of a grid. workers: processes; cluster: address of a
    Dask scheduler instead. rigid ... tolerance: as for `simulate`. estimate: errors of headline numbers in every run.
    signals: what to keep over time, by patterns of COMPONENT.VARIABLE, at so many points; a FanfoldWarning tells of
    those that nothing matches. save: an HDF5 file, beside which a table (.csv) is written; an interrupted study goes on
    with `resume_study`. replace: an earlier study in that file; if false, only one of the same settings is.

    StudyError or SceneError where it cannot begin; samples that fail are kept in `failed`.
    """
    texts = [f"{key}={text}" for key, text in vary.items()] if isinstance(vary, Mapping) else list(vary)
    plan = Plan(tuple(map(varied, texts)), method, runs, levels, seed)
    options = options_of(rigid, flexible, large_deformation, until, tolerance)
    task = Task(as_scene(scene), options, estimate, listed(signals), points)
    _tell_of_unknown_signals(task)
    path = None if save is None else Path(save)
    found = begin(task, plan, path, workers, cluster, progress or _silent, replace=replace)
    return Study.of_record(found)


_SCENE = "scene"
"""What records that are of no component go by."""


def _tell_of_unknown_signals(task: Task) -> None:
    """Before the first sample runs, as a study takes long."""
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
                f"{task.scene.name}: no signal matches {', '.join(unmatched)}; patterns are COMPONENT or "
                f"COMPONENT.VARIABLE, and components are {', '.join(components)}",
            )
        )


def resume_study(
    path: str | Path,
    *,
    workers: int = 1,
    cluster: str | None = None,
    trust: bool = False,
    progress: StudyProgress | None = None,
) -> Study:
    """Go on with the interrupted study that was to be saved in a file, or open the one that is whole there.

    trust: files of bodies and FMUs that it names may be opened; its plugins are loaded by `load_plugin` before.
    StudyError where there is neither, or where files that its bodies are read from have changed.
    """
    if Path(path).is_file() and not journal_file(Path(path)).is_file():
        return Study.open(path)
    return Study.of_record(go_on(Path(path), workers, cluster, progress or _silent, trust))


def _silent(_: str, __: int) -> AbstractContextManager[Watch]:
    return nullcontext(lambda done, failed: None)
