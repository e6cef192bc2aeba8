"""Events of a scene in a run: which are pending, when the next one is due, and what it sets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf

from components.contract.roles import FAILURE_COMMAND, RELEASE_COMMAND

from ..assembly import Condition, Event
from .participant import Participant

_REACHED = 1e-9  # s, what sums of step sizes may leave


class ScheduledEvents:
    """The events of a run.

    distance: function for the distance of a condition from being met; it falls through zero. pending: events that have
    not happened; happened: names of the others, in their order.
    """

    def __init__(
        self,
        events: Sequence[Event],
        participants: Sequence[Participant],
        distance: Callable[[Event], float],
    ) -> None:
        self.pending = list(events)
        self.happened: list[str] = []
        self._participants: Mapping[str, Participant] = {p.name: p for p in participants}
        self._distance = distance

    @property
    def conditional(self) -> list[Event]:
        """Pending events that wait for a condition that a step can be ended at."""
        return [event for event in self.pending if event.condition and not event.condition.is_sampled]

    @property
    def next_time(self) -> float:
        """Time (s) of the next event that has a time; infinite without."""
        return min((event.time for event in self.pending if event.time is not None), default=inf)

    def due(self, time: float) -> Event | None:
        """A pending event whose time has come or whose condition is met; None without."""
        for event in self.pending:
            if self._distance(event) <= 0.0 if event.time is None else event.time <= time + _REACHED:
                return event
        return None

    def holding(self, observed: Callable[[Condition], float]) -> list[str]:
        """Sentences on conditions that are met already; observed: function for the quantity of a condition."""
        found = []
        for event in self.pending:
            if (c := event.condition) is not None and self._distance(event) <= 0.0:
                side, other = ("above", "below") if c.rising else ("below", "above")
                found.append(
                    f"event.{event.name}: its condition holds from the start: {c.part}.{c.variable} is "
                    f"{observed(c):.6g}, {side} {c.value:.6g} (SI); give time = 0 for the start, or {other} for a "
                    "passage the other way"
                )
        return found

    def take(self, event: Event) -> None:
        """Note that an event happens now."""
        self.pending.remove(event)
        self.happened.append(event.name)

    def release(self, event: Event) -> None:
        """Command the releases of an event; they act from the start of the next step."""
        for name in event.releases:
            participant = self._participants[name]
            for command in (RELEASE_COMMAND.name, FAILURE_COMMAND.name):
                if command in participant.input_layout:
                    participant.inputs[participant.input_layout[command]] = 1.0

    def set(self, event: Event) -> None:
        """Set the parameters of an event."""
        for setting in event.settings:
            self._participants[setting.part].set_parameter(setting.parameter, setting.value)
