"""Warnings about probable mistakes in a scene, before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..assembly import Assembly
from ..assembly.hinges import unfollowed_curves
from ..messages import coded, message
from ..scene.placed_scene import CheckedScene
from .bodies import body_warnings, unlike_rigid_models
from .cable_loops import loop_warnings
from .idle_parts import idle_part_warnings
from .lines import line_warnings
from .signal_fmus import signal_fmu_warnings
from .start import start_warnings

_MOST_STEPS = 1e6
"""Of a run, that take minutes at the least."""


def scene_warnings(scene: CheckedScene) -> list[str]:
    """All warnings about a scene, with their keys."""
    kinds = (_many_steps, line_warnings, idle_part_warnings, loop_warnings, start_warnings, body_warnings)
    return [sentence for of in kinds for sentence in of(scene)]


def warnings_before_run(scene: CheckedScene, assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    """All warnings about a scene, and about its assembly with these bodies flexible."""
    yield from scene_warnings(scene)
    yield from signal_fmu_warnings(assembly, scene)
    yield from coded("W-latch-curve", unfollowed_curves(scene, bending))
    yield from coded("W-rigid-twin", unlike_rigid_models(scene, bending))


def _many_steps(scene: CheckedScene) -> Iterator[str]:
    """Runs with very many steps by the largest step that the scene allows."""
    steps = scene.header.until / scene.header.largest_step
    if steps > _MOST_STEPS:
        yield message(
            "W-steps",
            f"scene.largest_step: {scene.header.largest_step:g} s needs at least {steps:.2g} steps for "
            f"{scene.header.until:g} s. Increase it; the tolerance still keeps steps short where motion is fast.",
        )
