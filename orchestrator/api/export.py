"""Scenes as FMUs for other tools."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, get_args

from fmus import PLATFORMS, About, Backend, Experiment, FmiVersion

from ..analysis.scene_check import check_scene
from ..assembly import Assembly
from ..assembly.assemble import assemble
from ..assembly.statics.start import started_at_rest
from ..messages import message
from ..run import run
from ..run.as_one.export import export_as_one
from ..run.body_export import ExportedBody
from ..run.body_export import export_body as _export_body
from ..run.simulation import missing_backend
from ..run.system_structure import check_ssp, write_ssp
from ..scene.builder import Names, listed
from ..scene.component_connections import WrenchMode
from ..scene.layers import files_besides
from ..scene.placed_scene import PlacedScene
from ..scene.table import SceneError
from .options import Folder, OutputFile, Within
from .simulate import SceneLike, as_scene
from .warnings import warn

_MANY_STEPS = 1e7
"""More communication steps than a night has time for."""


def export(
    scene: SceneLike,
    folder: Folder,
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    wrench_mode: WrenchMode | None = None,
    fmi: FmiVersion = "2.0",
    sources: bool = False,
    backend: Backend | None = None,
    ssp: OutputFile | None = None,
    platforms: Names = (),
    as_one: bool = False,
    driven_base: bool = False,
    reference: bool = False,
    watch: Callable[[str], object] = lambda name: None,
) -> list[Path]:
    """Export the components of a scene as FMUs, or the whole scene as one FMU.

    If the scene has preload, bodies start in static equilibrium. The default experiment has the end time of the scene
    and the largest step that is stable in tools that do not iterate. A FanfoldWarning lists what the FMUs lack, such as
    events.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    folder : str or Path
        folder of the FMUs
    rigid, flexible, large_deformation
        see `simulate`
    wrench_mode : {"endpoint", "mean"}, optional
        "endpoint" (default) for other tools, "mean" for the implicit master
    fmi : {"2.0", "3.0"}
        version of FMI; "3.0" needs the native back end
    sources : bool
        add the C sources, for compilation on other platforms
    backend : {"native", "python"}, optional
        see `simulate`
    ssp : str or Path, optional
        also write an SSP file (1.0, with FMI 3.0: 2.0) with all FMUs, their connections, ports of the system and a
        parameter set; needs "endpoint"
    platforms : str or sequence of str
        platforms of the libraries, cross-compiled with Zig: linux64, aarch64-linux, win64, darwin64, aarch64-darwin,
        wasm32, or all; by default this machine
    as_one : bool
        one FMU of the whole scene, events included, which controls its step size by the scene's tolerance
    driven_base : bool
        with `as_one`: the fixed base moves by inputs, its pose, rates and accelerations, interpolated smoothly
    reference : bool
        with `as_one`: add the result of the default experiment (fmi-ls-ref), which importers compare with their own;
        it takes a run
    watch : callable, optional
        called with the name of each platform before its library is compiled, which takes up to half a minute

    Returns
    -------
    list of Path
        FMUs, and the SSP file

    Raises
    ------
    SceneError
        if the options contradict each other

    Examples
    --------
    >>> fanfold.export("amos3", "fmus", rigid="all", ssp="amos3.ssp")
    >>> fanfold.export("amos3", "fmus", rigid="all", as_one=True)
    """
    _check_form(fmi, as_one, driven_base or reference, plain=wrench_mode is None and backend != "python")
    wrench_mode = wrench_mode or "endpoint"
    checked = as_scene(scene).check_one_run()
    if ssp is not None:
        _check_ssp(Path(ssp), wrench_mode)
    wanted = list(PLATFORMS) if platforms == "all" else list(listed(platforms))
    if fmi == "2.0" and not sources and not wanted and (sentence := missing_backend(backend)):
        warn(message("W-backend", sentence))

    def assembled(mode: WrenchMode) -> Assembly:
        return assemble(checked, listed(rigid), listed(flexible), mode, listed(large_deformation))

    assembly = assembled("mean" if as_one else wrench_mode)
    header = checked.header
    about = About("", header.author, header.version, header.license)
    _tell_of_absent(checked, with_events=as_one)
    if as_one:
        if driven_base:
            _tell_of_locks(assembly)
        experiment = Experiment(assembly.until, assembly.largest_step, assembly.tolerance)
        from ..views.scene_check import picture_of  # draws, which other exports need not

        found = check_scene(checked, listed(rigid), listed(flexible), listed(large_deformation))
        about = about._replace(description=header.description, picture=picture_of(found))
        where, form = Path(folder), (driven_base, fmi, sources, wanted)
        paths = [export_as_one(assembly, where, experiment, *form, watch, about, reference)]
    else:
        assembly = started_at_rest(assembly)
        step = assembly.largest_step if wrench_mode == "mean" else _step_of_tools(assembly)
        experiment = Experiment(assembly.until, step)
        paths = run.export(
            assembly,
            Path(folder),
            backend,
            fmi,
            sources,
            experiment,
            platforms=wanted,
            watch=watch,
            about=about,
        )
    return paths if ssp is None else [*paths, _as_ssp(Path(ssp), assembly, paths, experiment)]


def _as_ssp(ssp: Path, assembly: Assembly, paths: Sequence[Path], experiment: Experiment) -> Path:
    """Write the SSP file of exported FMUs; a FanfoldWarning lists files that it does not contain."""
    if files := ", ".join(files_besides(dict(assembly.scene_tree))):
        warn(
            message(
                "W-export",
                f"{assembly.name}: {ssp.name} contains the scene, but not its further files, which `fanfold run` "
                f"of it reads from where they are: {files}.",
            )
        )
    return write_ssp(ssp, assembly, paths, experiment)


def _check_form(fmi: FmiVersion, as_one: bool, asks_for_one: bool, *, plain: bool) -> None:
    """SceneError for contradictory options.

    plain: no option that one FMU of the whole scene lacks. asks_for_one: an option that only this FMU has.
    """
    if fmi not in get_args(FmiVersion):
        raise SceneError(
            [f"there is no version {fmi!r} of FMI here; versions are {', '.join(get_args(FmiVersion))}"]
        )
    if as_one and not plain:
        raise SceneError(
            [
                "a scene as one FMU is native and couples its components itself; leave out the back "
                "end and the kind of wrenches (backend, wrench_mode)"
            ]
        )
    if asks_for_one and not as_one:
        raise SceneError(
            [
                "a driven base and a reference result are parts of a scene as one FMU; ask for that as well "
                "(--as-one, as_one)"
            ]
        )


def _check_ssp(path: Path, wrench_mode: WrenchMode) -> None:
    if wrench_mode != "endpoint":
        raise SceneError(
            [
                "an SSP file needs FMUs with end-point wrenches, as other tools couple them; leave out wrench_mode"
            ]
        )
    check_ssp(path)


def _tell_of_locks(assembly: Assembly) -> None:
    """Warn about kinematic latches, whose impulses are in no interface load."""
    if names := ", ".join(line.name for line in assembly.hinge_lines if line.kinematic):
        warn(
            message(
                "W-export",
                f"{assembly.name}: the interface loads do not include the impulses of kinematic latches: {names}. Use "
                "the growth of interface_impulse and interface_angular_impulse, or latches with springs.",
            )
        )


def _tell_of_absent(scene: PlacedScene, *, with_events: bool) -> None:
    """Warn about parts of the scene that its FMUs lack."""
    if scene.events and not with_events:
        names = ", ".join(event.name for event in scene.events)
        warn(
            message(
                "W-export",
                f"{scene.header.name}: component FMUs do not contain events, so these do not happen: {names}. "
                "Export the scene as one FMU (--as-one) to include them.",
            )
        )
    if scene.fmus:
        names = ", ".join(f"{fmu.name} ({Path(fmu.file).name})" for fmu in scene.fmus)
        warn(
            message(
                "W-export",
                f"{scene.header.name}: FMUs of other tools are not exported: {names}. Connect them as in the scene.",
            )
        )


def export_body(
    scene: SceneLike, body: str, path: OutputFile, *, modes: Annotated[int, Within(low=0)] | None = None
) -> ExportedBody:
    """Export a body of a scene as a Craig-Bampton model in SI units.

    Attachment coordinates come first, in the order of the attachment points, then fixed-interface modes. Damping is not
    exported.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    body : str
        flexible body
    path : str or Path
        file: .npz, .op4, or .asm (external superelement of Nastran, with .op4 and .pch); all but .npz need the extra
        `nastran`
    modes : int, optional
        fixed-interface modes; by default those of the scene

    Returns
    -------
    ExportedBody
        `path`; `to_toml` returns the ``[body.import]`` table that reads the file
    """
    return _export_body(as_scene(scene).check_one_run(), body, Path(path), modes)


def _step_of_tools(assembly: Assembly) -> float | None:
    """Advised step (s) of exported FMUs; warns and returns None if no practical step is stable."""
    from ..analysis.stable_step import STEPS, largest_stable_step

    try:
        found = largest_stable_step(assembly)
    except SceneError as error:
        warn(
            message(
                "W-export-step",
                f"{assembly.name}: no stable communication step for other tools could be computed: {error}",
            )
        )
        return None
    if found is None or assembly.until / found > _MANY_STEPS:
        stable = (
            f"only up to {found:g} s, {assembly.until / found:.0e} steps to the end"
            if found
            else f"not even at {STEPS[-1]:g} s"
        )
        instead = "Export rigid bodies for them, or use" if assembly.flexible else "Use"
        warn(
            message(
                "W-export-step",
                f"{assembly.name}: tools that do not iterate are stable {stable}. {instead} the scene as one FMU "
                "or model exchange.",
            )
        )
    return found
