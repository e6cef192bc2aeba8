"""Writing a scene as one FMU."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from components import ComponentError
from fmus import About, CompileError, Experiment, FmiVersion, build_fmu, cross_compiled

from ...assembly import Assembly
from ...cosim.coupling import StepError
from ...cosim.participant import ParticipantError
from ...cosim.settings import Settings
from ...scene.table import SceneError
from ..errors import RunError
from .component import AssembledScene
from .reference import reference
from .tables import DRIVEN


def export_as_one(
    assembly: Assembly,
    folder: Path,
    experiment: Experiment,
    driven_base: bool = False,
    fmi: FmiVersion = "2.0",
    with_sources: bool = False,
    platforms: Sequence[str] = (),
    watch: Callable[[str], object] = lambda name: None,
    about: About | None = None,
    with_reference: bool = False,
) -> Path:
    """Write a scene with mean wrenches as one native FMU into a folder; return its path.

    It has the scene's name, as an identifier. driven_base: the fixed base of the scene moves by inputs. with_reference:
    add a reference result, which takes a run of the experiment. RunError where that cannot be.
    """
    if driven_base:
        assembly = _with_driven_base(assembly)
    settings = Settings(assembly.tolerance, assembly.largest_step, driving=assembly.driving)
    name = re.sub(r"\W|^(?=\d)", "_", assembly.name, flags=re.ASCII)
    try:
        for platform in platforms:
            watch(platform)
            cross_compiled(platform)
        scene = AssembledScene(assembly, settings)
        return build_fmu(
            scene,
            name,
            folder,
            scene.start(),
            "native",
            fmi,
            with_sources,
            experiment,
            platforms=platforms,
            about=about,
            further=reference(scene, name, experiment) if with_reference else None,
        )
    except SceneError as error:
        raise RunError(str(error)) from None
    except (ComponentError, CompileError, ParticipantError, StepError) as error:
        raise RunError(f"{assembly.name}: {error}") from None


def _with_driven_base(assembly: Assembly) -> Assembly:
    """The same on a base that is driven in place of the fixed one."""
    if carried := [part.name for part in assembly.parts if part.structure.get("carried")]:
        raise RunError(
            f"{assembly.name}: {carried[0]} carries bodies by held hinge lines, and loads of a driven base would "
            "lack their inertia; replace these lines by a [[connection]] with the preset fixed"
        )
    parts = [
        replace(part, kind=DRIVEN, structure={"ports": part.structure["ports"]})
        if part.kind == "fixed_base"
        else part
        for part in assembly.parts
    ]
    if not any(part.kind == DRIVEN for part in parts):
        raise RunError(
            f"{assembly.name}: only a fixed base can be driven from outside; this one moves by itself"
        )
    return replace(assembly, parts=tuple(parts))
