"""Stops and contacts that may be struck: which of them a step has struck, first in a run or since its last event."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from components.contract.roles import PENETRATION

from ..participant import Participant, Vector, first_observations


class Strikes:
    """Those that declare how deep they are touched, by number.

    names: of them; before (stops,): penetrations (m or rad) after the last accepted step; waiting (stops,): whether
    nothing has struck it yet.
    """

    def __init__(self, participants: Sequence[Participant], observations: Vector) -> None:
        found = dict(penetrations(participants))
        self.names = list(found)
        self.places = np.array(list(found.values()), dtype=np.intp)
        self.before = np.zeros(len(found))
        self.waiting = np.ones(len(found), dtype=bool)
        self._observations = observations

    def note(self) -> None:
        """The step that was observed last is accepted."""
        self.before[:] = self._observations[self.places]

    def met(self) -> list[str]:
        """Those that wait and that the step observed last has struck, which wait no longer."""
        struck = self.waiting & (self.before < 0.0) & (self._observations[self.places] >= 0.0)
        self.waiting &= ~struck
        return [self.names[k] for k in np.flatnonzero(struck)]

    def wait_anew(self) -> None:
        """An event has changed what strikes them."""
        self.waiting[:] = True


def penetrations(participants: Sequence[Participant]) -> Iterator[tuple[str, int]]:
    """Names of the participants with a penetration, and its index among the observations of all."""
    firsts = first_observations(participants)
    for participant in participants:
        layout = participant.observation_layout
        for quantity in layout.quantities:
            if quantity.role == PENETRATION:
                yield participant.name, firsts[participant.name] + layout[quantity.name].start
