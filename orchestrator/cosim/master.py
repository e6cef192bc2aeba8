"""The master algorithm: what happens when in a co-simulation with implicit communication steps.

Participants are stepped until something happens: a line reaches its latch, a condition is met, an event is due, a
motion law breaks, or FMUs with signals are to act. This acts at its instant, and steps go on from there. `Coupling`
makes the steps, and computes what an event changes. docs/communication_step.md follows both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from components.numerics.scheme import AGAIN, INSTANT

from ..assembly import Event, HingeLine
from .cosimulation import CoSimulation, Statistics
from .coupling import Advance, StepError, Stop
from .network import Network
from .rows import Recorder
from .settings import TIME_ROUNDING, Settings
from .snapshot import Snapshot
from .step_plan import StepPlan

if TYPE_CHECKING:
    from .signals.process import SignalProcess

_TO_CONVERGE = 1.0 / 1024.0
"""Share of the smallest step for accuracy, down to which a planned step is divided in order to converge."""


class Master(CoSimulation):
    """Couples the participants of a network implicitly and steps them through time.

    keep: receives snapshots, where the settings have an interval for them.
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
        super().__init__(network, hinge_lines, recorder, settings, events, signals)
        self._events = {event.name: event for event in events}
        self._body_names = {body.name for body in network.bodies}
        self._plan = StepPlan(settings.step_plan or ())
        self._chooses_steps = settings.fixed_step is None and settings.step_plan is None
        self.coupling.settle_for(
            settings.tolerance, persistent=not self._chooses_steps, fixed_step=settings.fixed_step
        )
        self._acting: list[HingeLine | Event] = []
        self._lets_go = False
        self._sweeps_before = 0
        self.keep: Callable[[Snapshot], None] = lambda snapshot: None

    def _record_start(self) -> None:
        """The first row has loads just after the start: motors act, and the static search no longer holds lines."""
        self.coupling.record_start()

    def run(self, until: float) -> None:
        """Step to the given time (s); StepError where no step size converges or that takes too many steps."""
        try:
            while self.time < until - TIME_ROUNDING:
                if (event := self._scheduled.due(self.time)) is not None:
                    self._happen(event)
                elif self._signals.is_due(self.time):
                    self._take_signals()
                else:
                    self._advance(until)
            if self._signals.is_due(self.time):
                self._exchange_signals()
                self.coupling.add_row(0.0, 0)
        finally:
            self.coupling.release_rows()
        sweeps, self.statistics.fmu_time = self.coupling.costs
        self.statistics.sweeps = self._sweeps_before + sweeps

    def _advance(self, until: float) -> None:
        """Step until something happens, and let it act."""
        plan = self._plan.next(self.segments) if self._plan else None
        made = self.coupling.advance(until, self._next_stop, self._next_snapshot, plan)
        self.segments[-1].extend(made.steps)
        self.statistics.steps += len(made.steps)
        self.statistics.rejected += made.rejected
        if self.statistics.steps > self.settings.most_steps:
            raise StepError(f"it takes more than {self.settings.most_steps:.0f} steps")
        self._lets_go = made.lets_go
        if made.stop == Stop.REACHED:
            self._meet(made)
        elif made.stop == Stop.BROKE and not self._is_due:
            self._pass_break()
        elif made.stop in (Stop.TOO_LONG, Stop.UNSOLVED):
            self._divide(made.stop)
        elif made.stop == Stop.STOPPED_SHORT:
            raise self.coupling.failure()
        if made.steps:
            self._keep_snapshot(made.steps[-1])
            self.settings.progress(self.time, made.steps[-1])

    @property
    def _is_due(self) -> bool:
        """Whether an event, or FMUs with signals, are to act at this instant."""
        return self._scheduled.due(self.time) is not None or self._signals.is_due(self.time)

    def _divide(self, stop: Stop) -> None:
        """Divide a planned step that leaves the energy balance open or does not converge."""
        least = self.coupling.smallest * (_TO_CONVERGE if stop == Stop.UNSOLVED else 1.0)
        if self._plan.divide(self.segments, least):
            self.statistics.rejected += 1
        elif stop == Stop.UNSOLVED:
            raise self.coupling.failure()
        else:
            self.coupling.give_in()

    def _meet(self, made: Advance) -> None:
        """Let the line or the event act that ended the step, then all others that were reached at this instant."""
        waiting: list[HingeLine | Event] = [*self._pending, *self._scheduled.conditional]
        awaited = {self._numbers[one.name]: one for one in waiting}
        others = [number for number in made.reached if number != made.crossed]
        self._acting = [awaited[number] for number in (made.crossed, *others)]
        for one in list(self._acting):
            if isinstance(one, Event):
                self._happen(one)
            elif lines := self._locking(one, self._acting):
                self._latch(*lines)
        self._acting = []
        self._record_untold()

    def _locking(self, line: HingeLine, acting: Sequence[HingeLine | Event]) -> list[HingeLine]:
        """The line, and kinematic lines that act and lock together with it; empty if the line is not pending."""
        own = [one for one in self._pending if one.name == line.name]
        names = {one.name for one in acting} - {line.name}
        return own and own + [
            one for one in self._pending if one.name in names and one.kinematic and line.kinematic
        ]

    def _happen(self, event: Event) -> None:
        """Let an event act at this instant, with the latches that it commands, and continue with first steps."""
        coupling = self.coupling
        coupling.note_roughness()
        self._act(event)
        coupling.forget(bodies=any(setting.part in self._body_names for setting in event.settings))
        latching = [line for line in self._pending if line.name in event.latches]
        self._record_jump(self._instant(coupling.size), others=bool(latching))
        coupling.watch()
        self._latch_all([line for line in latching if line in self._pending])
        self._record_untold()
        coupling.judge_loads()
        self._renew()

    def _pass_break(self) -> None:
        """Continue after a break of a law; where a hold-down has let go, with a row of the jump of loads."""
        if self._lets_go:
            self.coupling.forget()
            self._record_jump(self._instant(self.coupling.size))
        self._renew()

    def _take_signals(self) -> None:
        """Let FMUs with signals act at this instant; if anything changes or a hold-down lets go, as after an event."""
        coupling = self.coupling
        if any([self._exchange_signals(), self._lets_go]):
            size = coupling.size
            after = self._instant(size)
            before = coupling.predicted(after)
            coupling.forget(bodies=self._signals.sets_bodies)
            solved = self._record_jump(after)
            self._renew(coupling.step_after_jump(size, coupling.wrenches - before) if solved else 0.0)
        else:
            coupling.add_row(0.0, 0)
            coupling.begin_segment()
            self._begin_segment()
        self._lets_go = False
        coupling.watch()

    def _latch(self, line: HingeLine, *others: HingeLine) -> None:
        """Engage all latches of a line; kinematic lines, with others, lose their relative rates in an impulse."""
        coupling, lines = self.coupling, (line, *others)
        numbers = [self._numbers[one.name] for one in lines]
        coupling.pending[numbers] = 0.0
        tells_jumps, passed = self.settings.fixed_step is None, []
        if line.kinematic:
            # bushings leave the joints rates of the order H^2; the latch must meet joints that move as such
            passed += self._impulse(INSTANT)
        elif tells_jumps:
            coupling.note_roughness()
        for one in lines:
            self.recorder.event(self.time, one.sensor, one.latch_event)
        size = min(coupling.engage(number, judged=self._chooses_steps) for number in numbers)
        coupling.forget()
        if line.kinematic:
            # a lock would ring with the rate that an impulse leaves
            passed += [*self._impulse(INSTANT), *self._impulse(AGAIN)]
            # joints without their rates and no lock yet, and a lock that still moves, are states of no wing
            coupling.record_impulse()
        elif tells_jumps:
            self._record_jump(self._instant(size))
        coupling.restart(size)
        self._begin_segment()
        self._latch_all(passed)

    def _latch_all(self, lines: Sequence[HingeLine]) -> None:
        """Latch the lines that are pending at this instant, kinematic ones in one impulse."""
        acting, self._acting = self._acting, [*self._acting, *lines]
        for line in lines:
            if joined := self._locking(line, lines):
                self._latch(*joined)
        self._acting = acting

    def _impulse(self, h: float) -> list[HingeLine]:
        """Make an impulse of a step h (s); returns pending lines that pass their latches in it."""
        passed = self.coupling.impulse(h)
        waiting = [line for line in self._pending if line not in self._acting]
        return [line for line in waiting if self._numbers[line.name] in passed]

    def _record_jump(self, after: float, *, others: bool = False) -> bool:
        """Write a row with the jump of what just acted, unless others act at this instant; whether it was solved."""
        others |= any(one in (*self._pending, *self._scheduled.conditional) for one in self._acting)
        return self.coupling.record_jump(after, others=others)

    def _record_untold(self) -> None:
        """Write the row of this instant, if it was left to a later event that did not write it."""
        if self.coupling.is_untold:
            self._record_jump(self._instant(self.coupling.size))

    def _instant(self, size: float) -> float:
        """Size (s) of a step in which nothing moves, where the next one has a size (s) or is planned."""
        return self.coupling.instant(self._plan.first_after(self.segments) if self._plan else size)

    def _renew(self, known: float = 0.0) -> None:
        """Continue with first steps, or with a known size (s) if larger; earlier steps do not predict the next ones."""
        self.coupling.renew(known)
        self._begin_segment()

    def _begin_segment(self) -> None:
        """Begin a new segment, if the present one has steps."""
        if self.segments[-1]:
            self.segments.append([])

    @property
    def _next_snapshot(self) -> float:
        """Time (s) after which the next snapshot is due."""
        every = self.settings.snapshot_every
        return inf if every is None else (self.time // every + 1.0) * every - TIME_ROUNDING

    def _keep_snapshot(self, h: float) -> None:
        """Keep a snapshot if one was due within the last step h (s), and go on like a run that starts from it."""
        every = self.settings.snapshot_every
        if every is not None and self.time // every > (self.time - h) // every:
            self.coupling.forget(bodies=True)
            self.keep(self.snapshot())

    def snapshot(self) -> Snapshot:
        """The present state of the run."""
        participants = self.network.participants
        arrays = {
            "coupling": self.coupling.state(),
            "steps": np.concatenate([np.array(segment, dtype=float) for segment in self.segments]),
        }
        for participant in participants:
            arrays[f"inputs {participant.name}"] = participant.inputs.copy()
            arrays[f"outputs {participant.name}"] = participant.outputs.copy()
        sweeps = self._sweeps_before + self.coupling.costs[0]
        numbers = {
            "segments": [len(segment) for segment in self.segments],
            "statistics": asdict(self.statistics) | {"sweeps": sweeps},
            "happened": self._scheduled.happened,
        }
        return Snapshot(numbers, arrays, {p.name: p.serialized() for p in participants})

    def resume(self, snapshot: Snapshot) -> None:
        """Restore the state of another run, in place of `initialize`."""
        numbers, arrays = snapshot.numbers, snapshot.arrays
        for name in numbers["happened"]:
            self._scheduled.take(self._events[name])
            self._scheduled.set(self._events[name])
            self._without(self._events[name].releases)
        self._choose_orders()
        for participant in self.network.participants:
            participant.inputs[:] = arrays[f"inputs {participant.name}"]
            participant.initialize(0.0)
            participant.deserialize(snapshot.states[participant.name])
            participant.outputs[:] = arrays[f"outputs {participant.name}"]
        self.coupling.stand(arrays["coupling"])
        ends = np.cumsum(numbers["segments"])[:-1]
        self.segments = [segment.tolist() for segment in np.split(arrays["steps"], ends)]
        self.statistics = Statistics(**numbers["statistics"])
        self._sweeps_before = self.statistics.sweeps
