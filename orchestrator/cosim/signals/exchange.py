"""When FMUs with signals take part, what they are given, and what they set."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from components import Quantity

from ...assembly import Signal, SignalFmu
from ..participant import Participant, ParticipantError, Vector
from .process import SignalProcess

_REACHED = 1e-9  # s, what sums of step sizes may leave


def recorded(fmu: SignalFmu) -> tuple[Quantity, ...]:
    """What is recorded of an FMU: its inputs and its outputs, in its own units."""
    signals = {s.variable: s for s in (*fmu.inputs, *fmu.outputs, *fmu.told)}
    return tuple(
        Quantity(name.replace("/", "_"), s.unit, s.description or f"Signal of {fmu.path.name}")
        for name, s in signals.items()
    )


@dataclass(slots=True)
class _Place:
    """Where a signal is: an array, its element, and the two numbers that convert it."""

    array: Vector
    element: int
    factor: float
    offset: float

    def value(self) -> float:
        return self.array.item(self.element) * self.factor + self.offset


class SignalExchange:
    """Takes FMUs through time beside the participants, each from one of its communication points to the next.

    An FMU steps when the participants have come to the end of its step, with the inputs that they have there; what it
    gives then acts on them from there on. observations: of all participants in order. bodies: names of those that are
    bodies. values: what is recorded, see `recorded`.
    """

    def __init__(
        self,
        processes: Sequence[SignalProcess],
        participants: Sequence[Participant],
        observations: Vector,
        bodies: Collection[str],
    ) -> None:
        self._processes = processes
        self._participants = {p.name: p for p in participants}
        sizes = [p.observation_layout.size for p in participants]
        self._firsts = dict(zip(self._participants, np.cumsum([0, *sizes]).tolist(), strict=False))
        self._observations = observations
        self._sources = [[self._source(s) for s in one.fmu.inputs] for one in processes]
        self._parameters = {
            (s.part, s.quantity): np.array(s.start) for one in processes for s in one.fmu.outputs
        }
        self._steps = [0] * len(processes)
        self._sets_bodies = any(part in bodies for part, _ in self._parameters)
        self.values = np.zeros(sum(len(recorded(one.fmu)) for one in processes))

    def _source(self, signal: Signal) -> _Place:
        participant = self._participants[signal.part]
        if signal.quantity in participant.observation_layout:
            first = self._firsts[signal.part] + participant.observation_layout[signal.quantity].start
            return _Place(self._observations, first + signal.index, signal.factor, signal.offset)
        first = participant.output_layout[signal.quantity].start
        return _Place(participant.outputs, first + signal.index, signal.factor, signal.offset)

    @property
    def is_any(self) -> bool:
        """Whether there are FMUs with signals."""
        return bool(self._processes)

    @property
    def sets_bodies(self) -> bool:
        """Whether parameters of bodies are set, which then move otherwise under the same wrenches."""
        return self._sets_bodies

    @property
    def next_time(self) -> float:
        """Time (s) of the next communication point of any."""
        return min((self._next(k) for k in range(len(self._processes))), default=inf)

    def _next(self, k: int) -> float:
        return (self._steps[k] + 1) * self._processes[k].fmu.step

    def is_due(self, time: float) -> bool:
        """Whether an FMU has come to the end of its step."""
        return self.next_time <= time + _REACHED

    def start(self) -> bool:
        """Initialise all at t = 0; whether that changed anything."""
        given = [one.open(self._inputs(k)) for k, one in enumerate(self._processes)]
        return any([self._set(k, outputs, 0.0) for k, outputs in enumerate(given)])

    def exchange(self, time: float) -> bool:
        """Step all that have come to the end of their step; whether what they give is different from before.

        They are given what was before any of them set something.
        """
        due = [k for k in range(len(self._processes)) if self._next(k) <= time + _REACHED]
        given = []
        for k in due:
            step = self._processes[k].fmu.step
            given.append(self._processes[k].sample(self._steps[k] * step, step, self._inputs(k)))
            self._steps[k] += 1
        return any([self._set(k, outputs, time) for k, outputs in zip(due, given, strict=True)])

    def _inputs(self, k: int) -> list[float]:
        return [place.value() for place in self._sources[k]]

    def _set(self, k: int, outputs: Sequence[float], time: float) -> bool:
        """Set what the outputs of an FMU are joined to, and note them; whether anything changed."""
        one = self._processes[k]
        given = dict(zip(one.outputs, outputs, strict=True))
        for name, value in given.items():
            if not np.isfinite(value):
                raise ParticipantError(f"{one.fmu.name}: its output {name} is {value} at t = {time:.6g} s")
        changed: dict[tuple[str, str], Vector] = {}
        for signal in one.fmu.outputs:
            key, value = (
                (signal.part, signal.quantity),
                given[signal.variable] * signal.factor + signal.offset,
            )
            if self._parameters[key].item(signal.index) != value:
                self._parameters[key][signal.index] = value
                changed[key] = self._parameters[key]
        for (part, name), values in changed.items():
            try:
                self._participants[part].set_parameter(name, values.tolist())
            except ParticipantError as error:
                raise ParticipantError(f"{one.fmu.name}, at t = {time:.6g} s: {error}") from None
        self._note(k, given)
        return bool(changed)

    def _note(self, k: int, given: dict[str, float]) -> None:
        """The signals of an FMU at its last communication point, for the record."""
        fmu = self._processes[k].fmu
        first = sum(len(recorded(one.fmu)) for one in self._processes[:k])
        shown = dict(zip((s.variable for s in fmu.inputs), self._inputs(k), strict=True)) | given
        self.values[first : first + len(shown)] = list(shown.values())
