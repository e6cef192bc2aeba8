"""Loading and running scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from h5py import is_hdf5

from fmus import Backend

from ..cosim.ports import Order
from ..results.result import ResultError
from ..run.progress import Progress
from ..run.run import MasterKind
from ..run.simulation import Options, refuse_to_lose
from ..run.simulation import resume as resume_simulation
from ..run.simulation import simulate as run_simulation
from ..scene import list_scenes
from ..scene.builder import Names, Scene, listed
from ..scene.layers import Setting
from ..scene.table import SceneError
from .progress import chosen
from .quantities import Quantity, in_si
from .result import Result
from .warnings import warn

if TYPE_CHECKING:
    from fmus.check.check import Problem

    from ..analysis.scene_check import SceneCheck

SceneLike = Scene | str | Path
"""A scene, or the name or file of one."""


def scenes() -> tuple[str, ...]:
    """Names of the scenes that come with Fanfold."""
    return list_scenes()


def load(
    scene: SceneLike,
    variant: Names = (),
    settings: Mapping[str, object] | Sequence[Setting] = (),
    trust: bool = False,
) -> Any:  # noqa: ANN401 - what a file holds decides
    """A scene by its name or file, or one built in code, with variants and single values laid over it; or a result.

    scene: the file of a result gives a `Result`, as `Result.open` does, everything else a `Scene`. variant: one or
    several, in order. settings: such as {"friction.coefficient": 0.1, "scene.until": "8 s"}. trust: plugins that a file
    names may run, now and until they change; without it they run where they did before, or `load_plugin` has loaded
    them. SceneError with everything that is wrong with a scene, ResultError for a damaged result, or one with variants
    or settings.
    """
    if not isinstance(scene, Scene) and is_hdf5(scene):
        if variant or settings:
            raise ResultError(f"{scene}: variants and settings change a scene; leave them out for a result")
        return Result.open(scene)
    return as_scene(scene, variant, settings, trust)


def as_scene(
    scene: SceneLike,
    variant: Names = (),
    settings: Mapping[str, object] | Sequence[Setting] = (),
    trust: bool = False,
) -> Scene:
    """A scene by its name or file, or one built in code, with variants and single values laid over it; see `load`.

    SceneError with everything that is wrong with it, also where it is a result.
    """
    if isinstance(scene, Scene):
        found = scene.with_variants(*listed(variant)).with_settings(settings)
        found.check()
        return found
    return Scene.load(scene, variant, settings, trust)


def options_of(
    rigid: Names, flexible: Names, large_deformation: Names, until: Quantity | None, tolerance: float | None
) -> Options:
    """What every run is given from Python; see `simulate`."""
    return Options(
        rigid=frozenset(listed(rigid)),
        flexible=frozenset(listed(flexible)),
        large_deformation=frozenset(listed(large_deformation)),
        until=in_si(until, "s", "until"),
        tolerance=in_si(tolerance, "1", "tolerance"),
    )


def run_options(
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Quantity | None = None,
    tolerance: float | None = None,
    step: Quantity | None = None,
    order: Order | None = None,
    master: MasterKind = "implicit",
    backend: Backend | None = None,
    checkpoint: Quantity | None = None,
    isolate: bool = False,
    refine: bool = True,
    record: Quantity = "all",
    signals: Names = (),
) -> Options:
    """What `simulate` is given of a run."""
    return replace(
        options_of(rigid, flexible, large_deformation, until, tolerance),
        step=in_si(step, "s", "step"),
        order=order,
        master=master,
        backend=backend,
        checkpoint=in_si(checkpoint, "s", "checkpoint"),
        refine=refine,
        isolate=isolate,
        record=None if record == "all" else in_si(record, "s", "record"),
        signals=listed(signals),
    )


def simulate(
    scene: SceneLike,
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Quantity | None = None,
    tolerance: float | None = None,
    step: Quantity | None = None,
    order: Order | None = None,
    master: MasterKind = "implicit",
    backend: Backend | None = None,
    save: str | Path | None = None,
    checkpoint: Quantity | None = None,
    isolate: bool = False,
    estimate: bool = True,
    refine: bool = True,
    record: Quantity = "all",
    signals: Names = (),
    replace: bool = True,
    progress: bool | Progress | None = None,
) -> Result:
    """Deploy a scene and return what happened, in memory or in the file that `save` names.

    rigid, flexible, large_deformation: bodies by name, "all" for every one; others are what the scene says. until:
    end time, s. tolerance: relative accuracy, by default that of the scene. step: a constant communication step size,
    s. order: 2 or 4, of the coupling; by default 4. master: "jacobi" and "gauss-seidel" are explicit and
    need a step. backend: "native" or "python" FMUs. checkpoint: simulated time (s) after which the file of the result
    gets a checkpoint that `resume` goes on from; last digits differ from those of a run without. isolate: every
    FMU in a process of its own. estimate: tell the errors of headline numbers, for half the cost of the run. refine:
    where these are likely to miss the tolerance, run again at a smaller one. record: which rows the result keeps,
    "all" or one in so much time (s) beside those of events and peaks, so that headline numbers stay the same. signals:
    which it keeps beside what headline numbers need, by COMPONENT or COMPONENT.VARIABLE, as patterns such as "hl1_*".
    replace: an earlier result in the file; if false, only one of the same scene and settings is, and others are a
    ResultError before the run. progress: a bar, by default in notebooks.

    What is not as it should be is told as a FanfoldWarning, and in the result's `warnings`. SceneError or RunError
    where the scene cannot be run, or not to its end; a scene in phases is run phase by phase, see `Scene.runs`.
    """
    checked = as_scene(scene).check_one_run()
    options = run_options(
        rigid=rigid,
        flexible=flexible,
        large_deformation=large_deformation,
        until=until,
        tolerance=tolerance,
        step=step,
        order=order,
        master=master,
        backend=backend,
        checkpoint=checkpoint,
        isolate=isolate,
        refine=refine,
        record=record,
        signals=signals,
    )
    path = None if save is None else Path(save)
    if path is not None and not replace:
        refuse_to_lose(path, checked, options, estimate)
    found = run_simulation(
        checked,
        options,
        path,
        estimate=estimate,
        progress=chosen(progress),
        warn=warn,
    )
    return Result.of(found.outcome.result, found)


def resume(result: str | Path, *, progress: bool | Progress | None = None) -> Result:
    """Go on with an interrupted run from its last checkpoint to its end, in every bit as it would have gone on.

    result: its file, beside which the checkpoint is; plugins that it names are loaded by `load_plugin` before. RunError
    where there is none, where it is damaged, or where FMUs or versions are others than those that the run began with.
    """
    found = resume_simulation(Path(result), progress=chosen(progress), warn=warn)
    return Result.of(found.outcome.result, found)


def check(fmu: str | Path, run: bool = True) -> list[Problem]:
    """Every problem of an FMU as a sentence; empty where there is none.

    `kind` of each: "breaks the standard", "Fanfold needs" or "advice". run: whether it makes two steps.
    """
    from fmus import check_fmu

    return check_fmu(fmu, run)


def check_scene(
    scene: SceneLike,
    variant: Names = (),
    settings: Mapping[str, object] | Sequence[Setting] = (),
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    trust: bool = False,
) -> SceneCheck:
    """A scene looked at before it is run: its problems and what is hardly meant, as sentences, and what it is made of.

    Problems are also those of variants that are not chosen, which runs do not look at.
    `warnings`, `bodies`, `lines`, `loops` are records, `plot` draws it stowed and deployed. Where there are `problems`
    there is nothing else. trust: see `load`. A scene in phases is checked phase by phase, see `Scene.runs`.
    """
    from ..analysis.scene_check import SceneCheck
    from ..analysis.scene_check import check_scene as look_at

    try:
        chosen = as_scene(scene, variant, settings, trust)
        checked = chosen.check_one_run()
        if problems := chosen.variant_problems():
            raise SceneError(problems)
        return look_at(checked, listed(rigid), listed(flexible), listed(large_deformation))
    except SceneError as error:
        return SceneCheck(scene.name if isinstance(scene, Scene) else Path(scene).stem, tuple(error.problems))
