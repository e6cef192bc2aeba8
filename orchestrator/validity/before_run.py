"""What a consistent scene says that is hardly meant: sentences to be told before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..assembly import Assembly
from ..assembly.hinges import unfollowed_curves
from ..messages import coded, message
from ..scene.schema import CheckedScene
from .bodies import body_warnings, unlike_rigid_models
from .cable_loops import loop_warnings
from .idle_parts import idle_part_warnings
from .lines import line_warnings
from .signal_fmus import signal_fmu_warnings
from .start import start_warnings

_MOST_STEPS = 1e6
"""Of a run, that take minutes at the least."""


def doubts(scene: CheckedScene) -> list[str]:
    """Everything about a scene that is hardly meant, as sentences with their keys."""
    kinds = (_many_steps, line_warnings, idle_part_warnings, loop_warnings, start_warnings, body_warnings)
    return [sentence for of in kinds for sentence in of(scene)]


def warnings_before_run(scene: CheckedScene, assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    """The same, and what is hardly meant of it as assembled with these bodies flexible."""
    yield from doubts(scene)
    yield from signal_fmu_warnings(assembly, scene)
    yield from coded("W-latch-curve", unfollowed_curves(scene, bending))
    yield from coded("W-rigid-twin", unlike_rigid_models(scene, bending))


def _many_steps(scene: CheckedScene) -> Iterator[str]:
    """Runs that are long beside the largest step that the scene allows."""
    steps = scene.header.until / scene.header.largest_step
    if steps > _MOST_STEPS:
        yield message(
            "W-steps",
            f"scene.largest_step: {scene.header.largest_step:g} s needs at least {steps:.2g} steps for "
            f"{scene.header.until:g} s. Increase it; the tolerance still keeps steps short where motion is fast.",
        )
