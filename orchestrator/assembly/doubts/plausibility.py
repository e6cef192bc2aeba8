"""What a consistent scene says that is hardly meant: sentences to be told before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ...messages import coded, message
from ...scene.schema import CheckedScene
from .. import Assembly
from ..hinges import unfollowed_curves
from .at_the_start import start_doubts
from .bodies import body_doubts, unlike_twins
from .cable_loops import loop_doubts
from .idle import idle_doubts
from .lines import line_doubts
from .signals import signal_sentences

_MOST_STEPS = 1e6
"""Of a run, that take minutes at the least."""


def doubts(scene: CheckedScene) -> list[str]:
    """Everything about a scene that is hardly meant, as sentences with their keys."""
    kinds = (_many_steps, line_doubts, idle_doubts, loop_doubts, start_doubts, body_doubts)
    return [sentence for of in kinds for sentence in of(scene)]


def assembled_doubts(scene: CheckedScene, assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    """The same, and what is hardly meant of it as assembled with these bodies flexible."""
    yield from doubts(scene)
    yield from signal_sentences(assembly, scene)
    yield from coded("W-latch-curve", unfollowed_curves(scene, bending))
    yield from coded("W-rigid-twin", unlike_twins(scene, bending))


def _many_steps(scene: CheckedScene) -> Iterator[str]:
    """Runs that are long beside the largest step that the scene allows."""
    steps = scene.header.until / scene.header.largest_step
    if steps > _MOST_STEPS:
        yield message(
            "W-steps",
            f"scene.largest_step: is {scene.header.largest_step:g} s, with which {scene.header.until:g} s take "
            f"{steps:.2g} steps at the least; give a larger one, which the tolerance keeps to where motion is slow",
        )
