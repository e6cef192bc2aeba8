"""Rows of results: who takes them, and what they take of observations."""

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
    """Takes what happened, in order."""

    def extend(self, times: Vector, rows: Matrix) -> None:
        """Rows (n, values) at times (n,): of every participant what is recorded, then `SCENE_CHANNELS` and signals."""

    def event(self, time: float, component: str, text: str) -> None:
        """Something switched."""


def recorded_layout(layout: Layout) -> Layout:
    """What is recorded of observations: all but the lagged ones, which correct others."""
    return Layout(q for q in layout.quantities if not q.name.endswith(LAGGED))


def recorded_places(participants: Sequence[Participant]) -> Vector:
    """Places of it among the observations of all; lagged ones come last in each."""
    layouts = [p.observation_layout for p in participants]
    firsts = np.cumsum([0, *(layout.size for layout in layouts)]).tolist()
    found = [
        np.arange(first, first + recorded_layout(layout).size)
        for first, layout in zip(firsts, layouts, strict=False)
    ]
    return np.concatenate([np.zeros(0, dtype=int), *found])


def lagged_pairs(first: int, participant: Participant) -> Iterator[tuple[int, int]]:
    """Places of every scalar of a lagged observation, and of its source; first: where the participant's begin."""
    layout = participant.observation_layout
    for quantity in layout.quantities:
        if quantity.name.endswith(LAGGED):
            known, corrected = layout[quantity.name], layout[quantity.name.removesuffix(LAGGED)]
            yield from ((first + known.start + i, first + corrected.start + i) for i in range(quantity.size))
