"""Instants that participants tell steps to end at: breaks of motion laws, and hold-downs that let go by themselves."""

from __future__ import annotations

from collections.abc import Iterable

from components.contract.roles import RELEASE_COMMAND, TIME_TO_BREAK
from components.numerics.scheme import NEVER

from ..participant import Participant, Vector

TimeToBreak = tuple[Vector, int]
"""Outputs of a participant, and the place among them of the time (s) to its next break."""


def is_hold_down(participant: Participant) -> bool:
    """Whether a participant can let go, so that its break may be that."""
    return RELEASE_COMMAND.name in participant.input_layout


def place_of_break(participant: Participant) -> int | None:
    """Index of the time (s) to the next break among the outputs of a participant; None if it has none."""
    layout = participant.output_layout
    return layout[TIME_TO_BREAK.name].start if TIME_TO_BREAK.name in layout else None


def times_to_break(participants: Iterable[Participant]) -> list[TimeToBreak]:
    """Of all participants that have one."""
    return [(p.outputs, place) for p in participants if (place := place_of_break(p)) is not None]


class HoldDowns:
    """How many of the hold-downs among participants no release by time is to come for."""

    def __init__(self, participants: Iterable[Participant]) -> None:
        self._left = times_to_break(filter(is_hold_down, participants))
        self._gone = 0

    def note(self) -> bool:
        """Whether any has let go since the last call."""
        before, self._gone = self._gone, self._count()
        return self._gone > before

    def _count(self) -> int:
        return sum(outputs.item(place) >= NEVER for outputs, place in self._left)
