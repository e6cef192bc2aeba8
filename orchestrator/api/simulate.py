"""Loading and running scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from h5py import is_hdf5

from fmus import Backend

from ..cosim.ports import Order
from ..results.requirements import refuse_unknown
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
from .options import OutputFile
from .progress import chosen
from .quantities import Duration, StepSize, Tolerance, in_si
from .result import Result
from .warnings import warn

if TYPE_CHECKING:
    from fmus.check.check import Problem

    from ..analysis.scene_check import SceneCheck

SceneLike = Scene | str | Path
"""A scene, or the name or file of one."""


def scenes() -> tuple[str, ...]:
    """Names of the built-in scenes.

    Returns
    -------
    tuple of str
        names that `load`, `simulate` and `fanfold run` accept
    """
    return list_scenes()


def load(
    scene: SceneLike,
    variant: Names = (),
    settings: Mapping[str, object] | Sequence[Setting] = (),
    trust: bool = False,
) -> Any:  # noqa: ANN401 - what a file holds decides
    """Read a scene or a result.

    Parameters
    ----------
    scene : str, Path or Scene
        name of a built-in scene, scene file (.toml), result file (.h5), or a scene built in code
    variant : str or sequence of str
        variants of the scene to apply, in this order; by default none
    settings : mapping or sequence
        values by key, such as ``{"friction.coefficient": 0.1, "scene.until": "8 s"}``; plain numbers are SI
    trust : bool
        let plugins that the file names run, now and until they change; by default only plugins that are trusted
        already, or loaded by `load_plugin`, run

    Returns
    -------
    Scene or Result
        a `Result` for a result file, a `Scene` for all else

    Raises
    ------
    SceneError
        with every problem of the scene
    ResultError
        if the result is damaged, or has variants or settings applied

    Examples
    --------
    >>> scene = fanfold.load("amos3", settings={"friction.coefficient": 0.12})
    >>> result = fanfold.simulate(scene)
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
    """A scene with variants and settings applied; see `load`. SceneError with every problem of the scene."""
    if isinstance(scene, Scene):
        found = scene.with_variants(*listed(variant)).with_settings(settings)
        found.check()
        return found
    return Scene.load(scene, variant, settings, trust)


def with_requirements(scene: SceneLike, require: Names) -> Scene:
    """A scene with further requirements; SceneError where one of all is on a number that no run of it can have."""
    found = as_scene(scene).with_requirements(require)
    for one in found.runs.values():
        refuse_unknown(one.check())
    return found


def options_of(arguments: Mapping[str, Any]) -> Options:
    """Options of a run among the arguments of a function, by name; see `simulate`."""
    found = {one.name: arguments[one.name] for one in fields(Options) if one.name in arguments}
    for name in {"rigid", "flexible", "large_deformation", "signals"} & {*found}:
        found[name] = frozenset(listed(found[name]))
    if found.get("record") == "all":
        found["record"] = None
    for name, unit in (
        ("tolerance", "1"),
        *((name, "s") for name in ("until", "step", "checkpoint", "record")),
    ):
        found[name] = in_si(found.get(name), unit, name)
    return Options(**found)


def simulate(
    scene: SceneLike,
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Duration | None = None,
    tolerance: Tolerance | None = None,
    step: StepSize | None = None,
    order: Order | None = None,
    master: MasterKind = "implicit",
    backend: Backend | None = None,
    save: OutputFile | None = None,
    checkpoint: Duration | None = None,
    isolate: bool = False,
    estimate: bool = True,
    refine: bool = True,
    record: Duration | Literal["all"] = "all",
    signals: Names = (),
    require: str | Sequence[str] = (),
    replace: bool = True,
    progress: bool | Progress | None = None,
) -> Result:
    """Simulate the deployment of a scene.

    A scene with phases is simulated phase by phase, see `Scene.runs`. Problems that an engineer should act on are a
    `FanfoldWarning` each, and are listed in `Result.warnings`.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    rigid : str or sequence of str
        names of bodies to model as rigid, or all; by default the models of the scene
    flexible : str or sequence of str
        names of bodies to model as modal, or all
    large_deformation : str or sequence of str
        names of bodies to model as geometrically exact beams, or all
    until : float or str, optional
        end time, in seconds; by default that of the scene
    tolerance : float, optional
        relative accuracy; by default that of the scene
    step : float or str, optional
        constant communication step size, in seconds; by default the master controls the step size
    order : {2, 4}, optional
        order of the coupling: wrenches constant (2) or linear (4) in time over a step; by default 4
    master : {"implicit", "jacobi", "gauss-seidel"}
        scheme of the coupling; "jacobi" and "gauss-seidel" are explicit and need `step`
    backend : {"native", "python"}, optional
        implementation of the FMUs; by default native if compiled
    save : str or Path, optional
        result file (HDF5); by default the result is kept in memory
    checkpoint : float or str, optional
        simulated time between checkpoints, in seconds, from which `resume` continues; checkpoints change the last
        digits
    isolate : bool
        run every FMU in its own process, so that a crash names it
    estimate : bool
        estimate the errors of headline numbers, for half the cost of the run
    refine : bool
        repeat the run with a smaller tolerance if it is likely to miss ten tolerances
    record : float or str
        rows of the result: "all", or time between rows, in seconds; rows of events and peaks are always kept
    signals : str or sequence of str
        signals of the result, by patterns of COMPONENT or COMPONENT.VARIABLE such as "hl1_*"; signals of headline
        numbers are always kept; by default all
    require : str or sequence of str
        further requirements, such as "latch_rate.HL1 < 15 deg/s"; see [requirements] of scenes
    replace : bool
        replace an existing result; if False, only a result of the same scene and settings is replaced
    progress : bool or callable, optional
        progress bar; by default only in notebooks

    Returns
    -------
    Result
        signals, events, headline numbers with estimated errors, warnings

    Raises
    ------
    SceneError
        if the scene has problems
    RunError
        if the run cannot start, or fails before its end
    ResultError
        if `replace` is False and the file has a result of another scene or other settings

    Examples
    --------
    >>> result = fanfold.simulate("amos3", rigid="all", save="amos3.h5")
    >>> result.latch_times
    """
    options = options_of(locals())
    checked = with_requirements(scene, require).check_one_run()
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
    """Continue an interrupted run from its last checkpoint, bit-identical to an uninterrupted run.

    Parameters
    ----------
    result : str or Path
        file of the interrupted result, next to its checkpoint; load its plugins with `load_plugin` first
    progress : bool or callable, optional
        progress bar; by default only in notebooks

    Returns
    -------
    Result
        the complete result

    Raises
    ------
    RunError
        if there is no checkpoint, it is damaged, or FMUs or versions differ from those of the run
    """
    found = resume_simulation(Path(result), progress=chosen(progress), warn=warn)
    return Result.of(found.outcome.result, found)


def check(fmu: str | Path, run: bool = True) -> list[Problem]:
    """Check an FMU against the FMI standard and the requirements of Fanfold.

    Parameters
    ----------
    fmu : str or Path
        file of the FMU
    run : bool
        let the FMU make two steps; by default True

    Returns
    -------
    list of Problem
        a sentence each; `kind` is "breaks the standard", "Fanfold needs" or "advice"; empty if there is no problem
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
    """Check a scene without running it.

    A scene with phases is checked phase by phase, see `Scene.runs`.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    variant, settings, trust
        see `load`
    rigid, flexible, large_deformation
        see `simulate`

    Returns
    -------
    SceneCheck
        `problems` (also of variants that are not applied), `warnings` about probable mistakes, and `bodies`, `lines`,
        `loops` as records; only `problems` if there are any; `plot` draws it stowed and deployed

    Examples
    --------
    >>> found = fanfold.check_scene("amos3")
    >>> found.problems, found.warnings
    """
    from ..analysis.scene_check import SceneCheck
    from ..analysis.scene_check import check_scene as look_at

    try:
        chosen = as_scene(scene, variant, settings, trust)
        checked = chosen.check_one_run()
        if problems := chosen.variant_problems():
            raise SceneError(problems)
        refuse_unknown(checked)
        return look_at(checked, listed(rigid), listed(flexible), listed(large_deformation))
    except SceneError as error:
        return SceneCheck(scene.name if isinstance(scene, Scene) else Path(scene).stem, tuple(error.problems))
