"""Warnings about probable mistakes in a scene, before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..assembly import Assembly
from ..assembly.hinges import unfollowed_curves
from ..messages import coded
from ..scene.placed_scene import PlacedScene
from ..scene.plausible import Plausible
from .bodies import body_warnings, unlike_rigid_models
from .cable_loops import loop_warnings
from .idle_parts import idle_part_warnings
from .lines import line_warnings
from .ranges import range_warnings
from .signal_fmus import signal_fmu_warnings
from .start import start_warnings

_MOST_STEPS = 1e6
"""Of a run, that take minutes at the least."""


def scene_warnings(scene: PlacedScene) -> list[str]:
    """All warnings about a scene, with their keys."""
    kinds = (
        _steps,
        range_warnings,
        line_warnings,
        idle_part_warnings,
        loop_warnings,
        start_warnings,
        body_warnings,
    )
    return [sentence for warnings in kinds for sentence in warnings(scene)]


def warnings_before_run(scene: PlacedScene, assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    """All warnings about a scene, and about its assembly with these bodies flexible."""
    yield from scene_warnings(scene)
    yield from signal_fmu_warnings(assembly, scene)
    yield from coded("W-latch-curve", unfollowed_curves(scene, bending))
    yield from coded("W-rigid-twin", unlike_rigid_models(scene, bending))


def _steps(scene: PlacedScene) -> Iterator[str]:
    """Largest steps and steps of FMUs that are a very small part of the run, or longer than it."""
    until = scene.header.until
    shortest = until / _MOST_STEPS
    reason = "a millionth of the run"
    advice = "Increase it; the tolerance keeps steps short where motion is fast."
    largest = Plausible("W-steps", "s", least=shortest, reason=reason, check=advice)
    yield from largest.warnings("scene.largest_step:", scene.header.largest_step)
    of_fmus = Plausible("W-fmu-step", "s", shortest, until, f"{reason}, or the run")
    for fmu in scene.fmus:
        yield from of_fmus.warnings(f"fmu.{fmu.name}.step:", until if fmu.step is None else fmu.step)
