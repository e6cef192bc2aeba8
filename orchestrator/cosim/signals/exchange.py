"""When FMUs with signals are stepped, their inputs, and what they set."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ...assembly import Condition, Event
from ..participant import Participant, Vector
from .joined import JoinedFmu, Participants

if TYPE_CHECKING:
    from .process import SignalProcess

_REACHED = 1e-9  # s, what sums of step sizes may leave


class SignalExchange:
    """Steps FMUs with signals together with the participants, each from one of its communication points to the next.

    An FMU steps when the participants have reached the end of its step, with the inputs there; its outputs act on them
    from then on (zero-order hold). At one time FMUs step in their order, each with the last outputs of the others.
    observations: of all participants in order. bodies: names of the bodies. values: recorded signals of all FMUs.
    """

    def __init__(
        self,
        processes: Sequence[SignalProcess],
        participants: Sequence[Participant],
        observations: Vector,
        bodies: Sequence[str],
    ) -> None:
        sizes = [len(one.fmu.recorded()) for one in processes]
        self.values = np.zeros(sum(sizes))
        ends = np.cumsum([0, *sizes]).tolist()
        given = {
            (one.fmu.name, name): (self.values, end - len(one.outputs) + k)
            for one, end in zip(processes, ends[1:], strict=True)
            for k, name in enumerate(one.outputs)
        }
        names = (
            (one.fmu.name, quantity.name) for one in processes for quantity in one.fmu.recorded().values()
        )
        self._places = {key: place for place, key in enumerate(names)}
        self._participants = known = Participants(participants, observations, given)
        self._all = [
            JoinedFmu(one, known, self.values[a:b])
            for one, a, b in zip(processes, ends[:-1], ends[1:], strict=True)
        ]
        self._steps = [0] * len(self._all)
        self._sets_bodies = known.set_among(bodies)

    @property
    def is_any(self) -> bool:
        """Whether there are FMUs with signals."""
        return bool(self._all)

    @property
    def sets_bodies(self) -> bool:
        """Whether parameters of bodies are set, which changes their mobility."""
        return self._sets_bodies

    @property
    def next_time(self) -> float:
        """Time (s) of the next communication point of any."""
        return min((self._next(k) for k in range(len(self._all))), default=inf)

    def _next(self, k: int) -> float:
        return (self._steps[k] + 1) * self._all[k].fmu.step

    def is_due(self, time: float) -> bool:
        """Whether an FMU has come to the end of its step."""
        return self.next_time <= time + _REACHED

    def value(self, condition: Condition) -> float:
        """The signal of a condition at the last communication point."""
        return self.values.item(self._places[condition.part, condition.variable])

    def start(self) -> bool:
        """Initialise all at t = 0; whether that changed anything."""
        return any([one.start() for one in self._all])

    def leave(self, event: Event) -> None:
        """What an event has set is no longer set by any FMU."""
        self._participants.leave((setting.part, setting.parameter) for setting in event.settings)

    def exchange(self, time: float) -> bool:
        """Step all that have reached the end of their step; whether they changed anything.

        Inputs from participants are those before any of them sets something.
        """
        due = [k for k in range(len(self._all)) if self._next(k) <= time + _REACHED]
        given = []
        for k in due:
            one = self._all[k]
            given.append(one.sample(self._steps[k] * one.fmu.step, one.fmu.step))
            self._steps[k] += 1
        pairs = zip(due, given, strict=True)
        return any([self._all[k].take(outputs, self._all[k].fmu.step, time) for k, outputs in pairs])
