"""Warnings about probable mistakes in a scene, before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial

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


def scene_warnings(scene: PlacedScene, until: float | None = None) -> list[str]:
    """All warnings about a scene, with their keys, for a run to `until` (s), by default to the end of the scene."""
    end = until or scene.header.until
    kinds = (
        partial(_steps, until=end),
        range_warnings,
        line_warnings,
        partial(idle_part_warnings, until=end),
        loop_warnings,
        start_warnings,
        body_warnings,
    )
    return [sentence for warnings in kinds for sentence in warnings(scene)]


def warnings_before_run(
    scene: PlacedScene, assembly: Assembly, bending: Collection[str], until: float | None = None
) -> Iterator[str]:
    """All warnings about a scene, see `scene_warnings`, and about its assembly with these bodies flexible."""
    yield from scene_warnings(scene, until)
    yield from signal_fmu_warnings(assembly, scene)
    yield from coded("W-latch-curve", unfollowed_curves(scene, bending))
    yield from coded("W-rigid-twin", unlike_rigid_models(scene, bending))


def _steps(scene: PlacedScene, until: float) -> Iterator[str]:
    """Largest steps and steps of FMUs that are a very small part of the run, or longer than it."""
    shortest = until / _MOST_STEPS
    reason = "a millionth of the run"
    advice = "Increase it; the tolerance keeps steps short where motion is fast."
    largest = Plausible("W-steps", "s", least=shortest, reason=reason, check=advice)
    yield from largest.warnings("scene.largest_step:", scene.header.largest_step)
    of_fmus = Plausible("W-fmu-step", "s", shortest, until, f"{reason}, or the run")
    for fmu in scene.fmus:
        yield from of_fmus.warnings(f"fmu.{fmu.name}.step:", until if fmu.step is None else fmu.step)
