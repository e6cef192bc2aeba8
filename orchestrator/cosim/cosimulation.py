"""A co-simulation under way, whatever steps it: participants, time, latches that may engage, energies, records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from components.contract.roles import HOLD

from ..assembly import Event, HingeLine, bolted_hinges
from ..assembly.statics.connection_at_rest import LEADING, LEADING_STEP
from .energy_balance import Energies
from .events.scheduled import ScheduledEvents
from .implicit.solver import Solver
from .network import Network
from .participant import ParticipantError, Vector
from .rows import Recorder, Rows
from .signals.exchange import SignalExchange
from .signals.process import SignalProcess

SCENE_CHANNELS = (
    ("step_size", "s", "Communication step size that led here"),
    ("iterations", "1", "Sweeps over all participants in that step"),
    ("stored_energy", "J", "Kinetic and potential energy of all participants"),
    ("dissipated_energy", "J", "Energy dissipated by all participants since the start"),
    ("numerical_dissipation", "J", "Energy taken by the scheme itself since the start, not a physical loss"),
    ("supplied_energy", "J", "Work put in from outside, such as by drives, since the start"),
    ("energy_residual", "J", "Stored and lost less supplied energy, minus their value at the start"),
)


@dataclass(slots=True)
class Statistics:
    """What a run cost; fmu_time: seconds inside FMUs in steps that the native solver made."""

    steps: int = 0
    sweeps: int = 0
    rejected: int = 0
    fmu_time: float = 0.0


class CoSimulation(ABC):
    """What masters share: each steps the participants in its own way, this knows where they are and records it.

    time (s): of the participants. segments: sizes of all steps, one list for each stretch between events.
    """

    def __init__(
        self,
        network: Network,
        hinge_lines: Sequence[HingeLine],
        recorder: Recorder,
        solver: Solver,
        events: Sequence[Event] = (),
        signals: Sequence[SignalProcess] = (),
    ) -> None:
        self.network = network
        self.recorder = recorder
        self.solver = solver
        self.statistics = Statistics()
        self.time = 0.0
        self.segments: list[list[float]] = [[]]
        self._bolted = bolted_hinges(hinge_lines)
        self._pending = [line for line in hinge_lines if line.latches]
        self._energies = self._energy_start = Energies(0.0, 0.0, 0.0, 0.0, 0.0)
        self._sensors = self._found_sensors()
        self._scheduled = ScheduledEvents(events, network.participants, solver.observations)
        bodies = [body.name for body in network.bodies]
        self._signals = SignalExchange(signals, network.participants, solver.observations, bodies)
        self._scene = np.zeros(len(SCENE_CHANNELS) + self._signals.values.size)
        coarse, loaded = network.coarse, {body.name for body in network.bodies}
        self._rows = Rows(recorder, network.participants, solver.observations, self._scene, coarse, loaded)

    def initialize(self, *, preload: bool) -> None:
        """Bring every participant to t = 0.

        With preload bodies start in static equilibrium with all hinges held, and connections are led there.
        """
        network = self.network
        for participant in network.participants:
            if "order" in participant.parameter_layout:
                participant.set_parameter("order", network.order_of(participant.name))
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
        self._energy_start = self._observe()
        if holding := self._scheduled.holding():
            raise ParticipantError("; ".join(holding))
        if self._signals.is_any:
            self._exchange_signals(start=True)
        self._record_start()

    def _record_start(self) -> None:
        """The row at t = 0; of loads as the search has left them, with preload."""
        self._record(0.0, 0)

    @abstractmethod
    def run(self, until: float) -> None:
        """Step to the given time (s); StepError where that cannot be done."""

    @property
    def _next_stop(self) -> float:
        """Time (s) of the next event that has one, or communication point of an FMU with signals."""
        return min(self._scheduled.next_time, self._signals.next_time)

    def _lead_connections(self) -> None:
        """Have connections remember that they rest: from where they were built to where the bodies are, and on there.

        Hinges are held but those that hold-downs or drives keep, and clocks stand.
        """
        network, accepted = self.network, self.solver.accepted
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

    def _found_sensors(self) -> dict[str, tuple[Vector, int]]:
        """Outputs, and the place among them, that tell how far each line is from its latch."""
        sensors = {line.name: self.network.by_name[line.sensor] for line in self._pending}
        return {
            name: (sensor.outputs, sensor.output_layout["latch_distance"].start)
            for name, sensor in sensors.items()
        }

    def _act(self, event: Event) -> None:
        """Release and set what an event does; what settings change of the energies is supplied from outside."""
        self._scheduled.take(event)
        self.recorder.event(self.time, event.name, event.text)
        self._scheduled.release(event)
        self._without(event.releases)
        with self._supplied():
            self._scheduled.set(event)
        self._signals.leave(event)

    def _exchange_signals(self, *, start: bool = False) -> bool:
        """Have FMUs with signals take part at this instant, or start; whether they changed anything."""
        self._rows.release()
        with self._supplied():
            changed = self._signals.start() if start else self._signals.exchange(self.time)
        # rows that are made in C leave these as they are held
        self._rows.held()[2][len(SCENE_CHANNELS) :] = self._signals.values
        return changed

    @contextmanager
    def _supplied(self) -> Iterator[None]:
        """What is set meanwhile changes energies from outside."""
        before = self._observe()
        yield
        changed = self._observe().balance - before.balance
        self._energy_start = self._energy_start._replace(supplied=self._energy_start.supplied - changed)

    def _without(self, released: Collection[str]) -> None:
        """Lines go on with those of their hinges that are not released; without any they have no latch."""
        lines = [
            replace(line, hinges=tuple(name for name in line.hinges if name not in released))
            for line in self._pending
        ]
        self._pending = [
            line if line.sensor in line.hinges else replace(line, sensor=line.hinges[0])
            for line in lines
            if line.hinges
        ]
        self._sensors = self._found_sensors()

    def _distance(self, line: HingeLine) -> float:
        """How far a hinge line that has not latched is from its latch, by its sensor; falls through zero."""
        outputs, place = self._sensors[line.name]
        return outputs.item(place)

    def _command(self, name: str, value: float, names: Sequence[str] | None = None) -> None:
        """Set a discrete input of all participants that have it, or of the named ones."""
        for participant in self.network.participants:
            if name in participant.input_layout and (names is None or participant.name in names):
                participant.inputs[participant.input_layout[name]] = value

    def _advance(self, h: float) -> None:
        """Count a step h (s) that all participants have made."""
        self.time += h
        self.statistics.steps += 1
        self.segments[-1].append(h)

    def _observe(self, h: float = 0.0) -> Energies:
        """Observations of all participants, h (s) after the present time, and their energies."""
        self._energies = self.solver.observe(self.time + h)
        return self._energies

    def _record(self, h: float, iterations: int, *, accepted: bool = False) -> None:
        """The last observations and the scene's channels to the recorder; those of an accepted step one step later."""
        found, start = self._energies, self._energy_start
        self._scene[len(SCENE_CHANNELS) :] = self._signals.values
        self._scene[: len(SCENE_CHANNELS)] = (
            h,
            iterations,
            found.stored,
            found.dissipated - start.dissipated,
            found.numerical - start.numerical,
            found.supplied - start.supplied,
            found.balance - start.balance,
        )
        if accepted:
            self._rows.hold(self.time, continues=self.network.order == 4 and len(self.segments[-1]) > 1)
        else:
            self._rows.add(self.time)
