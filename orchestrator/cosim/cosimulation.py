"""What all masters share: participants, time, pending latches and events, energies, records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from sys import float_info
from typing import TYPE_CHECKING

from components.contract.roles import HOLD

from ..assembly import Condition, Event, HingeLine, bolted_hinges
from ..assembly.statics.connection_at_rest import LEADING, LEADING_STEP
from .coupling import Coupling
from .network import Network
from .participant import ParticipantError
from .rows import Recorder
from .scheduled_events import ScheduledEvents
from .settings import Settings
from .signals.exchange import SignalExchange
from .tables import coupling_tables, observed_place

if TYPE_CHECKING:
    from .signals.process import SignalProcess


@dataclass(slots=True)
class Statistics:
    """What a run cost; fmu_time: seconds inside FMUs."""

    steps: int = 0
    sweeps: int = 0
    rejected: int = 0
    fmu_time: float = 0.0


class CoSimulation(ABC):
    """What masters share; each master steps the participants in its own way.

    segments: sizes of all steps (s), one list for each stretch between events.
    """

    def __init__(
        self,
        network: Network,
        hinge_lines: Sequence[HingeLine],
        recorder: Recorder,
        settings: Settings,
        events: Sequence[Event] = (),
        signals: Sequence[SignalProcess] = (),
    ) -> None:
        self.network = network
        self.recorder = recorder
        self.settings = settings
        self.statistics = Statistics()
        self.segments: list[list[float]] = [[]]
        self._bolted = bolted_hinges(hinge_lines)
        self._lines = [line for line in hinge_lines if line.latches]
        self._numbers = {line.name: number for number, line in enumerate(self._lines)}
        located = {e.name: e.condition for e in events if e.condition and not e.condition.is_sampled}
        self._numbers |= {name: number for number, name in enumerate(located, start=len(self._lines))}
        channels = sum(len(one.fmu.recorded()) for one in signals)
        tables = coupling_tables(network, hinge_lines, [*located.values()], settings, channels)
        self.coupling = Coupling(network, tables, recorder)
        bodies = [body.name for body in network.bodies]
        self._signals = SignalExchange(signals, network.participants, self.coupling.observations, bodies)
        # no method of this object, whose rows would then stay in memory until a search for cycles
        self._distance = partial(_distance, self.coupling, self._numbers, self._signals)
        self._scheduled = ScheduledEvents(events, network.participants, self._distance)

    @property
    def time(self) -> float:
        """Time (s) of the participants."""
        return self.coupling.time

    def initialize(self, *, preload: bool) -> None:
        """Bring every participant to t = 0.

        With preload bodies start in static equilibrium with all hinges held, and connections are led there.
        """
        network = self.network
        self._choose_orders()
        for body in network.bodies:
            body.write()
            body.read()
        if not preload:
            network.carry_motion()
        for participant in network.participants:
            leads = preload and participant in network.connections
            participant.initialize(-LEADING * LEADING_STEP if leads else 0.0)
            participant.read()
        if preload:
            self._lead_connections()
        self.coupling.start()
        if self._signals.is_any:
            self._exchange_signals(start=True)
        if holding := self._scheduled.holding(self._observed):
            raise ParticipantError("; ".join(holding))
        self._record_start()

    def _choose_orders(self) -> None:
        """Set the order of participants that have several to that of the network."""
        for participant in self.network.participants:
            if "order" in participant.parameter_layout:
                participant.set_parameter("order", self.network.order_of(participant.name))

    @abstractmethod
    def _record_start(self) -> None:
        """Write the row at t = 0."""

    @abstractmethod
    def run(self, until: float) -> None:
        """Step to the given time (s); StepError where that cannot be done."""

    @property
    def _next_stop(self) -> float:
        """Time (s) of the next event that has one, or communication point of an FMU with signals."""
        return min(self._scheduled.next_time, self._signals.next_time)

    def _lead_connections(self) -> None:
        """Step connections from the poses where they were built to the present ones, and on at rest there.

        Their internal states are then those of rest. All hinges are held except those of hold-downs or drives.
        """
        network, accepted = self.network, self.coupling.accepted
        self._command(HOLD.name, 1.0)
        self._command(HOLD.name, 0.0, self._bolted)
        network.carry_motion()
        for step in range(-LEADING, 0):
            for connection in network.connections:
                connection.write()
                connection.do_step(step * LEADING_STEP, LEADING_STEP)
        for connection in network.connections:
            connection.read()
        network.collect_wrenches(accepted)
        network.set_wrenches(accepted)
        for body in network.bodies:
            body.write()
        self._command(HOLD.name, 0.0)

    def _act(self, event: Event) -> None:
        """Command the releases of an event and set its parameters; energies that these change count as supplied."""
        self._scheduled.take(event)
        if event.name in self._numbers:
            self.coupling.pending[self._numbers[event.name]] = 0.0
        self.recorder.event(self.time, event.name, event.text)
        self._scheduled.release(event)
        self._without(event.releases)
        for line in self._lines:
            if line.name in event.unlatches or line.name in event.readies:
                self._unlatch(line, opens=line.name in event.unlatches)
        with self._supplied():
            self._scheduled.set(event)
        self._signals.leave(event)

    def _unlatch(self, line: HingeLine, *, opens: bool) -> None:
        """Open the latches of a line, or make them ready again."""
        if self.coupling.unlatch(self._numbers[line.name], opens=opens):
            self.recorder.event(self.time, line.sensor, line.unlatch_event)

    @property
    def _pending(self) -> list[HingeLine]:
        """Lines that wait for their latch-up."""
        return [line for line in self._lines if self.coupling.pending[self._numbers[line.name]]]

    def _exchange_signals(self, *, start: bool = False) -> bool:
        """Let FMUs with signals act at this instant, or start them; whether they changed anything."""
        self.coupling.release_rows()
        with self._supplied():
            changed = self._signals.start() if start else self._signals.exchange(self.time)
        self.coupling.signal[:] = self._signals.values
        return changed

    @contextmanager
    def _supplied(self) -> Iterator[None]:
        """Count changes of energies by settings within the block as supplied from outside."""
        before = self.coupling.observe()
        yield
        self.coupling.supply(before)

    def _without(self, released: Collection[str]) -> None:
        """Remove released hinges from lines; a line without hinges is no longer pending."""
        for number, participant in enumerate(self.network.participants):
            if participant.name in released:
                self.coupling.release(number)
        lines = [
            replace(line, hinges=tuple(name for name in line.hinges if name not in released))
            for line in self._lines
        ]
        self._lines = [
            line if line.sensor in line.hinges else replace(line, sensor=line.hinges[0])
            for line in lines
            if line.hinges
        ]

    def _observed(self, condition: Condition) -> float:
        """The quantity of a condition, as last observed."""
        if condition.is_sampled:
            return self._signals.value(condition)
        return self.coupling.observations.item(observed_place(self.network.participants, condition))

    def _command(self, name: str, value: float, names: Sequence[str] | None = None) -> None:
        """Set a discrete input of all participants that have it, or of the named ones."""
        for participant in self.network.participants:
            if name in participant.input_layout and (names is None or participant.name in names):
                participant.inputs[participant.input_layout[name]] = value


def _distance(
    coupling: Coupling, numbers: Mapping[str, int], signals: SignalExchange, one: HingeLine | Event
) -> float:
    """Distance of a line from its latch, or of a condition from being met; it falls through zero."""
    if isinstance(one, HingeLine) or one.condition is None or not one.condition.is_sampled:
        return coupling.distance(numbers[one.name])
    left = one.condition.value - signals.value(one.condition)
    return (left if one.condition.rising else -left) or float_info.min  # the value itself is not beyond it
