"""Scenes as FMUs for other tools."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import get_args

from fmus import PLATFORMS, Backend, Experiment, FmiVersion

from ..assembly import Assembly
from ..assembly.assemble import assemble
from ..messages import message
from ..run import run
from ..run.as_one.export import export_as_one
from ..run.body_export import ExportedBody
from ..run.body_export import export_body as _export_body
from ..run.preload import started_at_rest
from ..run.simulation import python_sentence
from ..run.system_structure import check_ssp, write_ssp
from ..scene.builder import Names, listed
from ..scene.component_connections import WrenchMode
from ..scene.layers import files_besides
from ..scene.schema import CheckedScene
from ..scene.table import SceneError
from .simulate import SceneLike, as_scene
from .warnings import warn

_MANY_STEPS = 1e7
"""More communication steps than a night has time for."""


def export(
    scene: SceneLike,
    folder: str | Path,
    *,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    wrench_mode: WrenchMode | None = None,
    fmi: FmiVersion = "2.0",
    sources: bool = False,
    backend: Backend | None = None,
    ssp: str | Path | None = None,
    platforms: Names = (),
    as_one: bool = False,
    driven_base: bool = False,
    watch: Callable[[str], object] = lambda name: None,
) -> list[Path]:
    """Write every component of a scene as an FMU into a folder, and return the paths.

    Of a scene with preload, bodies start in static equilibrium, which other tools do not search for. The default
    experiment lasts as long as the scene, at the largest step at which tools that do not iterate are stable, if there
    is one. Events of a scene are its master's and no part of FMUs; a FanfoldWarning tells so.
    wrench_mode: "endpoint" (default) for other tools, "mean" for the implicit master. fmi: "3.0" needs the native back
    end. sources: add the C sources, to be compiled on other platforms. platforms: names of `fmus.PLATFORMS`, or "all":
    libraries of these in place of the one of here, compiled by Zig (the extra `platforms`); `watch` is told of each
    before, as the first time takes half a minute. as_one: one native FMU of the whole scene, events included, with the
    master that couples its components: inside it steps as the scene's tolerance asks, whatever the communication step.
    driven_base: of one FMU, the fixed base moves by inputs, rates and accelerations in the world's axes, between
    communication points as smoothly as their rates can. ssp: a file that takes all FMUs of FMI 2.0 with
    end-point wrenches and their connections, or the one FMU of the scene (SSP 1.0, needs pyssp_standard).
    """
    _check_form(fmi, as_one, driven_base, plain=wrench_mode is None and backend != "python")
    wrench_mode = wrench_mode or "endpoint"
    checked = as_scene(scene).check_one_run()
    if ssp is not None:
        _check_ssp(Path(ssp), fmi, wrench_mode)
    wanted = list(PLATFORMS) if platforms == "all" else list(listed(platforms))
    if fmi == "2.0" and not sources and not wanted and (sentence := python_sentence(backend)):
        warn(message("W-backend", sentence))

    def assembled(mode: WrenchMode) -> Assembly:
        return assemble(checked, listed(rigid), listed(flexible), mode, listed(large_deformation))

    assembly = assembled("mean" if as_one else wrench_mode)
    _tell_of_absent(checked, with_events=as_one)
    if as_one:
        if driven_base:
            _tell_of_locks(assembly)
        experiment = Experiment(assembly.until, assembly.largest_step, assembly.tolerance)
        paths = [export_as_one(assembly, Path(folder), experiment, driven_base, fmi, sources, wanted, watch)]
    else:
        if assembly.preload:
            assembly = _at_rest(assembly, assembled("mean"))
        step = assembly.largest_step if wrench_mode == "mean" else _step_of_tools(assembly)
        experiment = Experiment(assembly.until, step)
        paths = run.export(
            assembly, Path(folder), backend, fmi, sources, experiment, platforms=wanted, watch=watch
        )
    return paths if ssp is None else [*paths, _as_ssp(Path(ssp), assembly, paths, experiment)]


def _as_ssp(ssp: Path, assembly: Assembly, paths: Sequence[Path], experiment: Experiment) -> Path:
    """Write the SSP file of FMUs that were written; a FanfoldWarning tells of what it leaves behind."""
    if files := ", ".join(files_besides(dict(assembly.scene_tree))):
        warn(
            message(
                "W-export",
                f"{assembly.name}: its scene goes along in {ssp.name}, but not the files that it is made of besides, "
                f"which `fanfold run` of it takes from where they are: {files}",
            )
        )
    return write_ssp(ssp, assembly, paths, experiment)


def _check_form(fmi: FmiVersion, as_one: bool, driven_base: bool, *, plain: bool) -> None:
    """SceneError where what is asked for does not go together; plain: whether nothing is that one FMU has not."""
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
    if driven_base and not as_one:
        raise SceneError(
            ["a driven base is part of a scene as one FMU; ask for that as well (--as-one, as_one)"]
        )


def _check_ssp(path: Path, fmi: FmiVersion, wrench_mode: WrenchMode) -> None:
    if fmi != "2.0" or wrench_mode != "endpoint":
        raise SceneError(
            ["an SSP file takes FMUs of FMI 2.0 with end-point wrenches, as other tools couple them"]
        )
    check_ssp(path)


def _at_rest(assembly: Assembly, coupled: Assembly) -> Assembly:
    """The assembly in the static equilibrium that the coupled one finds."""
    if assembly.large_deformation:
        names = ", ".join(assembly.large_deformation)
        warn(
            message(
                "W-export",
                f"{assembly.name}: beams of large deformation start without load, though preload bends them: {names}",
            )
        )
    return started_at_rest(assembly, coupled)


def _tell_of_locks(assembly: Assembly) -> None:
    """A FanfoldWarning of lines whose latch is an impulse, which no load of an instant holds."""
    if names := ", ".join(line.name for line in assembly.hinge_lines if line.kinematic):
        warn(
            message(
                "W-export",
                f"{assembly.name}: the interface loads do not include the impulses of kinematic latches: {names}. Use "
                "the growth of interface_impulse and interface_angular_impulse, or latches with springs.",
            )
        )


def _tell_of_absent(scene: CheckedScene, *, with_events: bool) -> None:
    """FanfoldWarnings of what a scene has and its FMUs have not."""
    if scene.events and not with_events:
        names = ", ".join(event.name for event in scene.events)
        warn(
            message(
                "W-export",
                f"{scene.header.name}: events are no part of FMUs, so nothing makes these happen: {names}",
            )
        )
    if scene.fmus:
        names = ", ".join(f"{fmu.name} ({Path(fmu.file).name})" for fmu in scene.fmus)
        warn(
            message(
                "W-export",
                f"{scene.header.name}: FMUs of other tools are not exported; connect them as the scene does: {names}",
            )
        )


def export_body(scene: SceneLike, body: str, path: str | Path, *, modes: int | None = None) -> ExportedBody:
    """Write a body of a scene as a Craig-Bampton model, SI units, to an .npz or .op4 file.

    Attachment components come first, those of its attachment points in their order, then amplitudes of fixed-interface
    modes. `[body.import]` reads it back; the table that does is `to_toml` of what is returned. modes: how many, by
    default those of the scene. Damping is the scene's and no part of it. An .asm is an external superelement of
    Nastran with its .op4 and .pch; it and .op4 need the extra `nastran`.
    """
    return _export_body(as_scene(scene).check_one_run(), body, Path(path), modes)


def _step_of_tools(assembly: Assembly) -> float | None:
    """The step (s) that exported FMUs advise; a FanfoldWarning tells where there is none or nobody can wait for it."""
    from ..analysis.stable_step import STEPS, largest_stable_step

    try:
        found = largest_stable_step(assembly)
    except SceneError as error:
        warn(
            message(
                "W-export-step",
                f"{assembly.name}: nothing tells which communication step is stable in other tools: {error}",
            )
        )
        return None
    if found is None or assembly.until / found > _MANY_STEPS:
        stable = (
            f"only up to {found:g} s, {assembly.until / found:.0e} steps to the end"
            if found
            else f"not even at {STEPS[-1]:g} s"
        )
        instead = "export rigid bodies for them, or use" if assembly.flexible else "use"
        warn(
            message(
                "W-export-step",
                f"{assembly.name}: tools that do not iterate are stable {stable}; {instead} the scene as one FMU "
                "or model exchange",
            )
        )
    return found
