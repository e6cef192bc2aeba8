"""Explicit masters with a fixed communication step: baselines, and masters for FMUs that cannot restore a state.

Both hold every input over a step and take each participant through it once. Jacobi: all step with the
values of t_n. Gauss-Seidel: bodies step first, connections then see the motion of t_n+1. A connection with
direct feed-through ("endpoint") returns the wrench of the motion it has just received; any other returns the mean
wrench of its last step, which reaches the bodies one step late (Gauss-Seidel) or two (Jacobi). Neither is
stable for stiff joints: the step must resolve the highest frequency between the ports.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import TYPE_CHECKING, Literal

import numpy as np

from components.contract.roles import LATCH_COMMAND, LATCHED

from ..assembly import Event, HingeLine
from .cosimulation import CoSimulation
from .coupling import StepError
from .network import Network
from .participant import ParticipantError
from .rows import Recorder
from .settings import TIME_ROUNDING, Settings

if TYPE_CHECKING:
    from .signals.process import SignalProcess

Order = Literal["jacobi", "gauss-seidel"]

_BOUND = 1e15


class ExplicitMaster(CoSimulation):
    """Steps the participants of a network one after the other, without iteration and without roll-back.

    The communication step is `fixed_step` of the settings, or else `largest_step`; step control, events
    inside steps and tolerances do not exist. A latch engages, and what waits for a condition happens, at a
    communication point, up to a step late.
    """

    def __init__(
        self,
        network: Network,
        hinge_lines: Sequence[HingeLine],
        recorder: Recorder,
        settings: Settings,
        order: Order = "gauss-seidel",
        events: Sequence[Event] = (),
        signals: Sequence[SignalProcess] = (),
    ) -> None:
        super().__init__(network, hinge_lines, recorder, settings, events, signals)
        self.order = order

    def initialize(self, *, preload: bool) -> None:
        """Bring every participant to t = 0; StepError where that would take more than explicit steps."""
        locks = [line.name for line in self._lines if line.kinematic]
        if locks:
            raise StepError(
                f"{', '.join(locks)}: an explicit master cannot solve for a kinematic latch; assemble "
                "the scene for endpoint wrenches, or use the implicit master"
            )
        super().initialize(preload=preload)
        self._exchange()

    def _record_start(self) -> None:
        self.coupling.add_row(0.0, 0)

    def run(self, until: float) -> None:
        """Step to the given time (s); StepError where values grow beyond all bounds."""
        size = self.settings.fixed_step or self.settings.largest_step
        while self.time < until - TIME_ROUNDING:
            self._engage_latches()
            if self._signals.is_due(self.time):
                self._take_signals()
            while (event := self._scheduled.due(self.time)) is not None:
                self._act(event)
                for line in self._pending:
                    if line.name in event.latches:
                        self._engage(line)
            remaining = min(until, self._next_stop) - self.time
            h = remaining if remaining < 1.001 * size else size
            begin = perf_counter()
            self._step_or_fail(h)
            self.statistics.fmu_time += perf_counter() - begin
            self.coupling.time += h
            self.segments[-1].append(h)
            self.statistics.steps += 1
            self.statistics.sweeps += 1
            self.coupling.observe()
            self.coupling.add_row(h, 1)
            self.settings.progress(self.time, h)
        if self._signals.is_due(self.time):
            self._take_signals()

    def _take_signals(self) -> None:
        """Let FMUs with signals act, and write a row with what they return."""
        self._exchange_signals()
        self.coupling.add_row(0.0, 0)

    def _engage_latches(self) -> None:
        """Command all hinges of a line whose sensor has latched by itself or reached the latch angle."""
        for line in self._pending:
            sensor = self.network.by_name[line.sensor]
            latched = sensor.outputs[sensor.output_layout[LATCHED.name].start] > 0.5
            if latched or self._distance(line) <= 0.0:
                self._engage(line)

    def _engage(self, line: HingeLine) -> None:
        self.recorder.event(self.time, line.sensor, line.latch_event)
        self.coupling.pending[self._numbers[line.name]] = 0.0
        self._command(LATCH_COMMAND.name, 1.0, line.hinges)

    def _step_or_fail(self, h: float) -> None:
        """Step all participants; overflow is reported as a failure of the master."""
        reason = ""
        try:
            with np.errstate(all="ignore"):
                self._step(h)
        except (ParticipantError, ArithmeticError, ValueError) as error:
            reason = f" ({error})"
        if reason or not self._bounded:
            raise StepError(
                f"the explicit {self.order} master diverges: values grow beyond all bounds in the step of "
                f"{h:.3g} s from t = {self.time:.6f} s{reason}; choose a smaller step or the implicit master"
            )

    def _step(self, h: float) -> None:
        """Bodies under the present wrenches; connections with the motion before (Jacobi) or after them."""
        for body in self.network.bodies:
            body.write()
            body.do_step(self.time, h)
            body.read()
        if self.order == "gauss-seidel":
            self.network.carry_motion()
        self._step_connections(h)
        self._exchange()

    def _step_connections(self, h: float) -> None:
        for connection in self.network.connections:
            connection.write()
            connection.do_step(self.time, h)

    def _exchange(self) -> None:
        """Motion of this communication point to the connections, their wrenches to the bodies."""
        self.network.carry_motion()
        for connection in self.network.connections:
            connection.write()
            connection.read()
        wrenches = self.coupling.accepted
        self.network.collect_wrenches(wrenches)
        self.network.set_wrenches(wrenches)

    @property
    def _bounded(self) -> bool:
        values = np.concatenate([self.coupling.accepted, *(body.outputs for body in self.network.bodies)])
        return bool(np.abs(values).max(initial=0.0) < _BOUND)
