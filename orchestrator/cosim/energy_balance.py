"""The energy balance of a scene: which observations it adds up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from components import (
    DISSIPATED_ENERGY,
    KINETIC_ENERGY,
    NUMERICAL_DISSIPATION,
    POTENTIAL_ENERGY,
    SUPPLIED_ENERGY,
)

from .participant import Participant

Rows = np.ndarray[Any, np.dtype[np.uintp]]

_ENERGIES = (KINETIC_ENERGY, POTENTIAL_ENERGY, DISSIPATED_ENERGY, NUMERICAL_DISSIPATION, SUPPLIED_ENERGY)


class Energies(NamedTuple):
    """Sums over all participants (J); what was dissipated and supplied counts from the start."""

    kinetic: float
    potential: float
    dissipated: float
    numerical: float
    supplied: float

    @property
    def stored(self) -> float:
        """Kinetic and potential energy."""
        return self.kinetic + self.potential

    @property
    def balance(self) -> float:
        """The constant sum: stored and lost energies, less those supplied from outside."""
        return self.stored + self.dissipated + self.numerical - self.supplied


def energy_rows(participants: Sequence[Participant]) -> Rows:
    """Places of each of `Energies` (5, participants) among the observations of all, in order.

    Where a participant has none it is the place behind the last observation, which holds a zero.
    """
    end = sum(p.observation_layout.size for p in participants)
    rows = np.full((len(_ENERGIES), len(participants)), end, dtype=np.uintp)
    start = 0
    for column, participant in enumerate(participants):
        layout = participant.observation_layout
        for row, energy in enumerate(_ENERGIES):
            if energy.name in layout:
                rows[row, column] = start + layout[energy.name].start
        start += layout.size
    return rows
