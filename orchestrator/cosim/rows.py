"""Rows of results: who receives them, and which observations they contain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np

from components import LAGGED, Layout

from .participant import Matrix, Participant, Vector

SCENE_CHANNELS = (
    ("step_size", "s", "Communication step size that led here"),
    ("iterations", "1", "Sweeps over all participants in that step"),
    ("stored_energy", "J", "Kinetic and potential energy of all participants"),
    ("dissipated_energy", "J", "Energy dissipated by all participants since the start"),
    ("numerical_dissipation", "J", "Energy taken by the scheme itself since the start, not a physical loss"),
    ("supplied_energy", "J", "Work put in from outside, such as by drives, since the start"),
    ("energy_residual", "J", "Stored and lost less supplied energy, minus their value at the start"),
)


class Recorder(Protocol):
    """Receives rows and events, in order."""

    def extend(self, times: Vector, rows: Matrix) -> None:
        """Rows (n, values) at times (n,): recorded observations of all participants, `SCENE_CHANNELS`, signals."""

    def event(self, time: float, component: str, text: str) -> None:
        """An event, such as a latch-up, at a time (s)."""


def recorded_layout(layout: Layout) -> Layout:
    """Observations that are recorded: all except the lagged ones, which correct others."""
    return Layout(q for q in layout.quantities if not q.name.endswith(LAGGED))


def recorded_places(participants: Sequence[Participant]) -> Vector:
    """Places of recorded observations among those of all; lagged ones come last in each participant."""
    layouts = [p.observation_layout for p in participants]
    firsts = np.cumsum([0, *(layout.size for layout in layouts)]).tolist()
    found = [
        np.arange(first, first + recorded_layout(layout).size)
        for first, layout in zip(firsts, layouts, strict=False)
    ]
    return np.concatenate([np.zeros(0, dtype=int), *found])


def lagged_pairs(first: int, participant: Participant) -> Iterator[tuple[int, int]]:
    """Places of each scalar of a lagged observation and of the scalar that it corrects.

    first: first place of the participant.
    """
    layout = participant.observation_layout
    for quantity in layout.quantities:
        if quantity.name.endswith(LAGGED):
            known, corrected = layout[quantity.name], layout[quantity.name.removesuffix(LAGGED)]
            yield from ((first + known.start + i, first + corrected.start + i) for i in range(quantity.size))
