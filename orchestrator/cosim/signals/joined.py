"""An FMU with signals among the participants: where its inputs come from, and what its outputs set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...assembly import Signal
from ..participant import Participant, ParticipantError, Vector, first_observations

if TYPE_CHECKING:
    from .process import SignalProcess

Target = tuple[str, str]
"""Name of a participant, and of a parameter of it."""


@dataclass(slots=True)
class _Place:
    """Where a signal is: an array, its element, and the signal that converts it."""

    array: Vector
    element: int
    signal: Signal

    def value(self) -> float:
        return self.signal.arriving(self.array.item(self.element))


class Participants:
    """Participants as sources and targets of signals. observations: of all participants in order.

    given: values of the outputs of FMUs, by name of FMU and variable, as an array and a place in it.
    """

    def __init__(
        self,
        participants: Sequence[Participant],
        observations: Vector,
        given: Mapping[tuple[str, str], tuple[Vector, int]],
    ) -> None:
        self._by_name = {p.name: p for p in participants}
        self._given = given
        self._firsts = first_observations(participants)
        self._observations = observations
        self._parameters: dict[Target, Vector] = {}
        self._left: set[Target] = set()

    def source(self, signal: Signal) -> _Place:
        """Where an input of an FMU comes from."""
        if (of_fmu := self._given.get((signal.part, signal.quantity))) is not None:
            return _Place(*of_fmu, signal)
        participant = self._by_name[signal.part]
        if signal.quantity in participant.observation_layout:
            first = self._firsts[signal.part] + participant.observation_layout[signal.quantity].start
            return _Place(self._observations, first + signal.index, signal)
        first = participant.output_layout[signal.quantity].start
        return _Place(participant.outputs, first + signal.index, signal)

    def will_set(self, signal: Signal) -> None:
        """Parameters have their start values before anything sets them."""
        self._parameters.setdefault((signal.part, signal.quantity), np.array(signal.start))

    def set_among(self, names: Sequence[str]) -> bool:
        """Whether parameters of any of these are set."""
        return any(part in names for part, _ in self._parameters)

    def leave(self, targets: Iterable[Target]) -> None:
        """Stop setting these parameters, as an event has set them."""
        self._left |= set(targets)

    def set(self, values: Iterable[tuple[Signal, float]], who: str, time: float) -> bool:
        """Set parameters; whether anything changed. ParticipantError with who set them at a time (s)."""
        changed: dict[Target, Vector] = {}
        for signal, value in values:
            key = signal.part, signal.quantity
            if key not in self._left and self._parameters[key].item(signal.index) != value:
                self._parameters[key][signal.index] = value
                changed[key] = self._parameters[key]
        for (part, name), numbers in changed.items():
            try:
                self._by_name[part].set_parameter(name, numbers.tolist())
            except ParticipantError as error:
                raise ParticipantError(f"{who}, at t = {time:.6g} s: {error}") from None
        return bool(changed)


class JoinedFmu:
    """One FMU, its inputs from participants, and the parameters that it sets; its signals go into `values`.

    An output that is the impulse of a load sets its growth over a step, divided by the step.
    """

    def __init__(self, process: SignalProcess, participants: Participants, values: Vector) -> None:
        self.process, self.fmu = process, process.fmu
        self._participants, self._values = participants, values
        self._sources = [participants.source(s) for s in self.fmu.inputs]
        self._last: Mapping[str, float] = {}
        for signal in self.fmu.outputs:
            participants.will_set(signal)

    def start(self) -> bool:
        """Initialise it at t = 0; whether that changed anything."""
        inputs = self.inputs()
        given = self._named(self.process.open(inputs), 0.0)
        self._last = given
        self._note(inputs, given)
        changed = self._participants.set(
            ((s, s.arriving(given[s.variable])) for s in self.fmu.outputs if not s.is_impulse),
            self.fmu.name,
            0.0,
        )
        return changed

    def sample(self, time: float, h: float) -> Mapping[str, float]:
        """Its outputs after a step from a time (s) over h, with the inputs of the end."""
        inputs = self.inputs()
        given = self._named(self.process.sample(time, h, inputs), time + h)
        self._note(inputs, given)
        return given

    def take(self, given: Mapping[str, float], h: float, time: float) -> bool:
        """Set the targets of its outputs at a time (s), after a step over h (s); whether that changed anything."""
        changed = self._participants.set(
            ((s, self._growth(s, given) / h if s.is_impulse else s.arriving(given[s.variable]))
             for s in self.fmu.outputs),
            self.fmu.name,
            time,
        )  # fmt: skip
        self._last = given
        return changed

    def _growth(self, signal: Signal, given: Mapping[str, float]) -> float:
        return (given[signal.variable] - self._last[signal.variable]) * signal.factor

    def inputs(self) -> list[float]:
        """Its present inputs."""
        return [place.value() for place in self._sources]

    def _named(self, outputs: Sequence[float], time: float) -> Mapping[str, float]:
        given = dict(zip(self.process.outputs, outputs, strict=True))
        for name, value in given.items():
            if not np.isfinite(value):
                raise ParticipantError(f"{self.fmu.name}: its output {name} is {value} at t = {time:.6g} s")
        return given

    def _note(self, inputs: Sequence[float], given: Mapping[str, float]) -> None:
        """Its signals at its last communication point, for the record and for other FMUs."""
        self._values[:] = [*inputs, *given.values()]
