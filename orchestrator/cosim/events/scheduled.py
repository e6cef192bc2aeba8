"""Events of a scene in a run: which have not happened, when the next one comes, and what one does to participants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from components.contract.roles import FAILURE_COMMAND, RELEASE_COMMAND

from ...assembly import Event
from ..participant import Participant, Vector, first_observations

_REACHED = 1e-9  # s, what sums of step sizes may leave


class ScheduledEvents:
    """The events that are still to come.

    observations: of all participants in order, as last observed; conditions are read there. happened: names of the
    others, in their order.
    """

    def __init__(
        self, events: Sequence[Event], participants: Sequence[Participant], observations: Vector
    ) -> None:
        self.pending = list(events)
        self.happened: list[str] = []
        self._participants: Mapping[str, Participant] = {p.name: p for p in participants}
        self._observations = observations
        firsts = first_observations(participants)
        self._places = {
            event.name: firsts[c.part]
            + self._participants[c.part].observation_layout[c.variable].start
            + c.index
            for event in events
            if (c := event.condition) is not None
        }

    @property
    def conditional(self) -> list[Event]:
        """Those that wait for a condition."""
        return [event for event in self.pending if event.condition is not None]

    @property
    def next_time(self) -> float:
        """Time (s) of the next one that has a time."""
        return min((event.time for event in self.pending if event.time is not None), default=inf)

    def distance(self, event: Event) -> float:
        """How far a condition is from holding, over its value where that is above one; falls through zero."""
        array, place, value, scale = self.where(event)
        return (value - array.item(place)) / scale

    def where(self, event: Event) -> tuple[Vector, int, float, float]:
        """Of an event's `distance`: array, place in it, value, and what their difference is divided by."""
        condition = event.condition
        assert condition is not None
        size = max(1.0, abs(condition.value))
        return (
            self._observations,
            self._places[event.name],
            condition.value,
            size if condition.rising else -size,
        )

    def due(self, time: float) -> Event | None:
        """One whose time has come, or whose condition holds."""
        for event in self.pending:
            if self.distance(event) <= 0.0 if event.time is None else event.time <= time + _REACHED:
                return event
        return None

    def holding(self) -> list[str]:
        """Sentences on conditions that hold already."""
        found = []
        for event in self.conditional:
            if (c := event.condition) is not None and self.distance(event) <= 0.0:
                side, other = ("above", "below") if c.rising else ("below", "above")
                value = self._observations.item(self._places[event.name])
                found.append(
                    f"event.{event.name}: its condition holds from the start: {c.part}.{c.variable} is {value:.6g}, "
                    f"{side} {c.value:.6g} (SI); give time = 0 for the start, or {other} for a passage the other way"
                )
        return found

    def take(self, event: Event) -> None:
        """It happens now."""
        self.pending.remove(event)
        self.happened.append(event.name)

    def release(self, event: Event) -> None:
        """Command what lets go; it does from the next step's start."""
        for name in event.releases:
            participant = self._participants[name]
            for command in (RELEASE_COMMAND.name, FAILURE_COMMAND.name):
                if command in participant.input_layout:
                    participant.inputs[participant.input_layout[command]] = 1.0

    def set(self, event: Event) -> None:
        """Set parameters."""
        for setting in event.settings:
            self._participants[setting.part].set_parameter(setting.parameter, setting.value)
