"""Writing a scene as one FMU."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from components import ComponentError
from fmus import CompileError, Experiment, FmiVersion, build_fmu, cross_compiled

from ...assembly import Assembly
from ...cosim.participant import ParticipantError
from ...cosim.settings import Settings
from ...cosim.stepping import StepError
from ..errors import RunError
from .component import AssembledScene


def export_as_one(
    assembly: Assembly,
    folder: Path,
    fmi: FmiVersion = "2.0",
    *,
    with_sources: bool = False,
    platforms: Sequence[str] = (),
    watch: Callable[[str], object] = lambda name: None,
) -> Path:
    """Write a scene with mean wrenches as one native FMU into a folder; return its path.

    It has the scene's name, as an identifier. RunError where that cannot be.
    """
    settings = Settings(assembly.tolerance, assembly.largest_step, driving_energy=assembly.driving_energy)
    name = re.sub(r"\W|^(?=\d)", "_", assembly.name, flags=re.ASCII)
    experiment = Experiment(assembly.until, assembly.largest_step)
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
        )
    except (ComponentError, CompileError, ParticipantError, StepError) as error:
        raise RunError(f"{assembly.name}: {error}") from None
