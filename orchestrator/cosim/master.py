"""The master algorithm: implicit steps, their size, events inside them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf

import numpy as np

from components.contract.roles import IMPULSE, LATCH_COMMAND
from components.numerics.scheme import AGAIN, INSTANT

from ..assembly import Event, HingeLine
from . import latch_up, stepping
from .cosimulation import CoSimulation, Statistics
from .energy_balance import Energies
from .energy_guard import EnergyGuard
from .events.breaks import HoldDowns, times_to_break
from .events.contact_onset import Strikes
from .events.crossings import Fall, find_event, first_met, met_with, still_to_latch
from .events.load_error_weights import JudgedLoads
from .events.post_event_rows import PostEventRows, instant_of
from .implicit.convergence import Solution, Tolerance
from .implicit.impulse import impulse
from .implicit.snapshot import Snapshot, plain
from .implicit.solvers import solver_for
from .network import Network
from .participant import ParticipantError, Vector
from .rows import Recorder
from .settings import Settings
from .signals.process import SignalProcess
from .stepping import ErrorEstimate, StepError, StepSizes, SubdividedStep, failure


class Master(CoSimulation):
    """Couples the participants of a network implicitly and follows them through time."""

    def __init__(
        self,
        network: Network,
        hinge_lines: Sequence[HingeLine],
        recorder: Recorder,
        settings: Settings,
        events: Sequence[Event] = (),
        signals: Sequence[SignalProcess] = (),
    ) -> None:
        iterated = stepping.iterated(hinge_lines, network.order).of(settings.tolerance)
        solver = solver_for(network, Tolerance.beside(settings.driving.load, iterated))
        super().__init__(network, hinge_lines, recorder, solver, events, signals)
        self._events = {event.name: event for event in events}
        self.settings = settings
        self.solver.persistent = not self._controlled
        self._error = ErrorEstimate(settings.tolerance, 0.0, settings.driving.energy, network.order)
        share = stepping.share_of_steps(settings.tolerance)
        largest = share * settings.largest_step
        self._sizes = StepSizes(largest, share * settings.smallest_step, network.order)
        self._start_step = min(share * settings.start_step, largest)
        self._sizes.restart(self._start_step)
        self._guard = EnergyGuard(self._energies)
        self._divided = SubdividedStep()
        self._plan = stepping.StepPlan(settings.step_plan or ())
        self._judged = JudgedLoads(solver)
        self._strikes = Strikes(network.participants, solver.observations)
        self._reached: list[HingeLine | Event] = []
        self._jumps = PostEventRows(solver, self._rows, self._observe, self._add_instant)
        self._laws = times_to_break(network.participants)
        self._hold_downs = HoldDowns(network.participants)
        self._break = inf
        self._sweeps_before = 0
        self.keep: Callable[[Snapshot], None] = lambda snapshot: None

    def initialize(self, *, preload: bool) -> None:
        """Bring every participant to t = 0; with preload, in static equilibrium with all hinges held."""
        super().initialize(preload=preload)
        self._hold_downs.note()
        self._save()
        self._guard = EnergyGuard(self._energies)
        self._error = ErrorEstimate(
            self.settings.tolerance, self._energies.stored, self.settings.driving.energy, self.network.order
        )

    def _record_start(self) -> None:
        """Of loads just after the start: motors act from then on, and what held lines in a search has let go."""
        self._jumps.observe_start()
        super()._record_start()

    def run(self, until: float) -> None:
        """Step to the given time (s); StepError where no step size converges."""
        try:
            self._step_to_end(until)
        finally:
            self._rows.release()
        sweeps, self.statistics.fmu_time = self.solver.costs()
        self.statistics.sweeps = self._sweeps_before + sweeps

    def _step_to_end(self, until: float) -> None:
        while self.time < until - stepping.TIME_ROUNDING:
            if (event := self._scheduled.due(self.time)) is not None:
                self._happen(event)
                continue
            if self._signals.is_due(self.time):
                self._take_signals()
                continue
            made = self._next_made(until)
            if made is None:
                continue
            h, solution = made
            crossed = first_met(self._falls(), h)
            if crossed is not None:
                found = self._step_to(crossed, h, solution)
                if found is None:
                    continue
                h, solution = found
                self._observe(h)
            self._reached = reached = [] if crossed is None else met_with(crossed, self._falls(), h)
            is_break = not reached and self.time + h >= self._break - stepping.BREAK_REACHED
            self._accept(h, solution)
            for one in reached:
                self._let_act(one)
            self._record_waiting()
            if is_break and self._scheduled.due(self.time) is None and not self._signals.is_due(self.time):
                self._pass_break()
            self._keep_snapshot(h)
            self.settings.progress(self.time, h)

    def _keep_snapshot(self, h: float) -> None:
        """Give one away where a step h (s) led past a time for it, and go on as a run that starts from it."""
        every = self.settings.snapshot_every
        if every is not None and self.time // every > (self.time - h) // every:
            self.solver.forget_all()
            self.keep(self.snapshot())

    def snapshot(self) -> Snapshot:
        """Where this run stands."""
        participants = self.network.participants
        held_time, held_observations, held_scene = self._rows.held()
        times, values = self.solver.past()
        arrays = {
            "accepted": self.solver.accepted.copy(),
            "times": times,
            "values": values,
            "observations": held_observations.copy(),
            "scene": held_scene.copy(),
            "steps": np.concatenate([np.array(segment, dtype=float) for segment in self.segments]),
        }
        for participant in participants:
            arrays[f"inputs {participant.name}"] = participant.inputs.copy()
            arrays[f"outputs {participant.name}"] = participant.outputs.copy()
        numbers = {
            "time": self.time,
            "held": held_time,
            "segments": [len(segment) for segment in self.segments],
            "statistics": plain(self.statistics) | {"sweeps": self._sweeps_before + self.solver.costs()[0]},
            "pending": [line.name for line in self._pending],
            "happened": self._scheduled.happened,
            "energies": plain(self._energies),
            "energy_start": plain(self._energy_start),
            "error_energy": self._error.energy,
            "sizes": plain(self._sizes),
            "guard": plain(self._guard),
            "divided": plain(self._divided),
            "before": self._before,
            "break": self._break,
            "judged": self._judged.numbers(),
            "strikes": plain([self._strikes.before, self._strikes.waiting]),
        }
        return Snapshot(numbers, arrays, {p.name: p.serialized() for p in participants})

    def resume(self, snapshot: Snapshot) -> None:
        """Stand where another run stood, in place of `initialize`."""
        numbers, arrays = snapshot.numbers, snapshot.arrays
        for name in numbers["happened"]:
            self._scheduled.take(self._events[name])
            self._scheduled.set(self._events[name])
            self._without(self._events[name].releases)
        for participant in self.network.participants:
            if "order" in participant.parameter_layout:
                participant.set_parameter("order", self.network.order_of(participant.name))
            participant.inputs[:] = arrays[f"inputs {participant.name}"]
            participant.initialize(0.0)
            participant.deserialize(snapshot.states[participant.name])
            participant.outputs[:] = arrays[f"outputs {participant.name}"]
        self.solver.accepted[:] = arrays["accepted"]
        self.solver.remember(arrays["times"], arrays["values"])
        self._rows.take(numbers["held"], arrays["observations"], arrays["scene"])
        self.time = numbers["time"]
        ends = np.cumsum(numbers["segments"])[:-1]
        self.segments = [segment.tolist() for segment in np.split(arrays["steps"], ends)]
        self.statistics = Statistics(**numbers["statistics"])
        self._sweeps_before = self.statistics.sweeps
        self._pending = [line for line in self._pending if line.name in numbers["pending"]]
        self._hold_downs.note()
        self._energies = Energies(**numbers["energies"])
        self._energy_start = Energies(**numbers["energy_start"])
        self._error.see(numbers["error_energy"])
        self._sizes = StepSizes(**numbers["sizes"])
        self._guard = EnergyGuard.of(numbers["guard"])
        self._divided = SubdividedStep(**numbers["divided"])
        self._judged.take(numbers["judged"])
        self._strikes.before[:], self._strikes.waiting[:] = numbers["strikes"]
        self._before, self._break = numbers["before"], numbers["break"]

    def _next_step(self, until: float) -> float:
        remaining = min(until, self._break) - self.time
        if self._plan:
            plan, position = self._plan.now(self.segments)
            h = plan[position]
        elif self.settings.fixed_step is not None:
            h = self.settings.fixed_step / self._divided.parts
        else:
            h = self._sizes.size
        # a remainder that is a tiny step would cost accuracy; stretch or share instead
        if remaining < stepping.STRETCHED * h:
            return remaining
        return 0.5 * remaining if remaining < stepping.SHARED * h and self._controlled else h

    @property
    def _controlled(self) -> bool:
        return self.settings.fixed_step is None and self.settings.step_plan is None

    def _next_made(self, until: float) -> tuple[float, Solution] | None:
        """Size and solution of the next step, if it stands; it is not accepted yet."""
        h = self._next_step(until)
        solution = self._solved(h)
        return (h, solution) if self._stands(h, solution) else None

    def _solved(self, h: float) -> Solution:
        """A step h (s) from the present time."""
        return self.solver.solve(self.time, h, self.solver.predicted(self.time, h))

    def _stands(self, h: float, solution: Solution) -> bool:
        """Whether a step converged and its error is accepted; if not, a smaller step size is set."""
        solver = self.solver
        if not solution.converged:
            if not self._smaller(to_converge=True):
                raise failure(solver, solution, self.time, h)
            self.statistics.rejected += 1
            return False
        if not self._guard.allows(self._observe(h), h):
            if self._smaller():
                self.statistics.rejected += 1
                return False
            self._guard.give_in(self._energies)
        if not self._controlled:
            self._divided.stood()
            return True
        if struck := self._strikes.met():
            # make it once more, judged by what they push with as well
            self._judged.add_struck(struck, self.time, h, self._sizes.largest)
            self._judged.judge(self._error.energy)
            self.statistics.rejected += 1
            return False
        square = solver.error_square(self.time, h, self._error.energy)
        if square is None or self._sizes.judge(self._error(square)):
            return True
        self.statistics.rejected += 1
        return False

    def _smaller(self, *, to_converge: bool = False) -> bool:
        """Make the next step smaller after one that cannot stand; False where that is at an end."""
        if self._controlled:
            return self._sizes.shrink(2, to_converge=to_converge)
        if self._plan:
            return self._plan.divide(self.segments, self._sizes.least(to_converge=to_converge))
        return self._divided.divide()

    def _let_act(self, one: HingeLine | Event) -> None:
        """An event happens, or a line latches, with those that lock with it, unless another has let go of it."""
        if isinstance(one, Event):
            self._happen(one)
        elif lines := still_to_latch(one, self._reached, self._pending):
            self._latch(*lines)

    def _awaited(self) -> list[HingeLine | Event]:
        """What may come within a step."""
        return [*self._pending, *self._scheduled.conditional]

    def _falls(self) -> list[Fall]:
        """What was left of all that may come before the step just made, and is left after it."""
        return [Fall(one, self._before[one.name], self._left(one)) for one in self._awaited()]

    def _left(self, one: HingeLine | Event) -> float:
        """How far a line is from its latch, or a condition from holding as last observed."""
        return self._scheduled.distance(one) if isinstance(one, Event) else self._distance(one)

    def _step_to(self, crossed: Fall, h: float, solution: Solution) -> tuple[float, Solution] | None:
        """Repeat the step so that it ends where a line latches or a condition holds; None with a smaller size set."""
        found = [solution]

        def distance(trial: float) -> float:
            found[0] = self._solved(trial)
            if not found[0].converged:
                raise failure(self.solver, found[0], self.time, trial)
            if isinstance(crossed.one, Event):
                self._observe(trial)
            return self._left(crossed.one)

        try:
            return find_event(distance, crossed.before, crossed.after, h), found[0]
        except (StepError, ParticipantError):
            if not self._smaller():
                raise
        self.statistics.rejected += 1
        return None

    def _accept(self, h: float, solution: Solution) -> None:
        self.solver.accept(self.time, h)
        self._advance(h)
        self._watch()
        self._record(h, solution.iterations, accepted=True)
        self._error.see(self._energies.kinetic)

    def _happen(self, event: Event) -> None:
        """Let an event act at this instant, and go on as after any other."""
        roughness = self._roughness()
        self._act(event)
        free = {i for i, one in enumerate(self.network.connections) if one.name in event.releases}
        self._judged.let_go(free)
        self.solver.forget_all()
        latching = [line for line in self._pending if line.name in event.latches]
        self._record_jump(
            self._instant(self._sizes.size), self.solver.forget_all, roughness, others=bool(latching)
        )
        self._hold_downs.note()
        self._watch()
        self._latch_all([line for line in latching if line in self._pending])
        self._record_waiting()
        self._judge_loads()
        self._renew()

    def _pass_break(self) -> None:
        """Go on after a break of a law; where a hold-down has let go, with a row of what that makes of loads."""
        if self._hold_downs.note():
            self.solver.forget_all()
            self._record_jump(self._instant(self._sizes.size), self.solver.forget_all)
        self._renew()

    def _take_signals(self) -> None:
        """Have FMUs with signals act at this instant; where something changes, a hold-down too, as after an event."""
        if any([self._exchange_signals(), self._hold_downs.note()]):
            solver, h = self.solver, self._sizes.size
            forget = solver.forget_all if self._signals.sets_bodies else solver.forget
            after = self._instant(h)
            before = solver.predicted(self.time, after).copy()
            forget()
            found = self._record_jump(after, forget)
            square = None if found is None else solver.jump_square(h, found - before, self._error.energy)
            self._renew(0.0 if square is None else h * self._error.share(square))
        else:
            self._begin_segment()
        self._watch()

    def _latch(self, line: HingeLine, *others: HingeLine) -> None:
        """Engage all latches of a line; kinematic ones, of others too, take relative rates away in an impulse."""
        lines = (line, *others)
        self._pending = [one for one in self._pending if one not in lines]
        roughness, passed = None, []
        if line.kinematic:
            # bushings leave the joints rates of the order H^2; the latch must meet joints that move as such
            passed += self._impulse()
        elif self.settings.fixed_step is None:
            roughness = self._roughness()
        for one in lines:
            self.recorder.event(self.time, one.sensor, one.latch_event)
        size = min(self._engage(one) for one in lines)
        self.solver.forget()
        if line.kinematic:
            # a lock would ring with the rate that an impulse leaves
            passed += [*self._impulse(), *self._impulse(AGAIN)]
            # joints without their rates and no lock yet, and a lock that still moves, are states of no wing
            self._record(AGAIN, 0)
        elif self.settings.fixed_step is None:
            self._record_jump(self._instant(size), self.solver.forget_all, roughness)
        self.solver.restart()
        self._sizes.restart(size, stirred=False)
        self._begin_segment()
        self._latch_all(passed)

    def _latch_all(self, lines: Sequence[HingeLine]) -> None:
        """Latch the lines that are pending at this instant, kinematic ones in one impulse."""
        reached, self._reached = self._reached, [*self._reached, *lines]
        for line in lines:
            if joined := still_to_latch(line, lines, self._pending):
                self._latch(*joined)
        self._reached = reached

    def _renew(self, known: float = 0.0) -> None:
        """Continue with short steps (s), or a known short step; earlier steps do not predict the following ones."""
        self.solver.restart()
        if (size := max(self._start_step, known)) < self._sizes.size:
            self._sizes.restart(size, stirred=False)
        self._begin_segment()

    def _begin_segment(self) -> None:
        """Count steps anew, where any were made since the last event."""
        if self.segments[-1]:
            self.segments.append([])

    def _instant(self, size: float) -> float:
        """A step (s) too short for motion, where the next one has a size (s), or the one that is planned."""
        if self._plan:
            size = self._plan.first_after(self.segments)
        return instant_of(size)

    def _roughness(self) -> Vector | None:
        return self._jumps.roughness(self.time, self._sizes.size, len(self.segments[-1]))

    def _record_jump(
        self,
        after: float,
        forget: Callable[[], None],
        roughness: Vector | None = None,
        *,
        others: bool = False,
    ) -> Vector | None:
        others |= any(one in (*self._pending, *self._scheduled.conditional) for one in self._reached)
        return self._jumps.record(self.time, after, forget, roughness, others=others)

    def _record_waiting(self) -> None:
        """The row of an instant that was left to what then had none of its own."""
        if waiting := self._jumps.waiting:
            self._record_jump(self._instant(self._sizes.size), self.solver.forget_all, *waiting)

    def _add_instant(self, after: float) -> None:
        """A row of an instant that lies a little (s) behind the present time."""
        self.time += after
        self._record(after, 0)
        self.time -= after

    def _engage(self, line: HingeLine) -> float:
        """Latch a line, and return the step size (s) to go on with.

        What a latch law stiffens is resolved, and its torque judged from now on. A lock cannot be resolved.
        """
        solver, h = self.solver, self._sizes.size
        if line.kinematic or not self._controlled:
            self._command(LATCH_COMMAND.name, 1.0, line.hinges)
            return min(h, self._start_step)
        before = latch_up.slopes(solver, line.hinges, self.time, h)
        self._command(LATCH_COMMAND.name, 1.0, line.hinges)
        after = latch_up.slopes(solver, line.hinges, self.time, h)
        self._command(LATCH_COMMAND.name, 0.0, line.hinges)
        hinges = latch_up.stiffenings(solver, line.hinges, before, after, h)
        if hinges:
            slow, size = latch_up.swinging(solver, self.time, hinges, self._sizes.largest)
            self._judged.add_latched(slow)
            self._judge_loads()
            if slow.fastest:
                h = latch_up.resolving(solver, self.time, slow, size, h, self._error.resolved_angle)
        self._command(LATCH_COMMAND.name, 1.0, line.hinges)
        return min(h, self._start_step)

    def _judge_loads(self) -> None:
        """Judge those of lines and stops by the energies of now; what an event changed may strike stops anew."""
        self._judged.judge(self._error.energy)
        self._strikes.wait_anew()

    def _impulse(self, h: float = INSTANT) -> list[HingeLine]:
        """A vanishing step h (s) that stops joints; returns lines that pass their latches in it."""
        self._command(IMPULSE.name, 1.0)
        solution, passed = impulse(self.solver, self.time, h), []
        if not solution.converged and h == INSTANT:
            raise failure(self.solver, solution, self.time, h)
        if solution.converged:
            self.time += h
            waiting = (line for line in self._pending if line not in self._reached)
            passed = [line for line in waiting if self._before[line.name] > 0.0 >= self._left(line)]
            self._save()
        self._command(IMPULSE.name, 0.0)
        self.solver.forget()
        self._observe()
        return passed

    def _save(self) -> None:
        """The present states are those to return to."""
        self.solver.save(self.time)
        self._watch()

    def _watch(self) -> None:
        """Note how far lines are from their latches and conditions from holding, and the next time to end a step at."""
        self._before = {one.name: self._left(one) for one in self._awaited()}
        self._strikes.note()
        form = self.time + min((outputs.item(place) for outputs, place in self._laws), default=inf)
        self._break = min(form, self._next_stop)

    def _record(self, h: float, iterations: int, *, accepted: bool = False) -> None:
        self._guard.accept(self._energies)
        self._jumps.waiting = []
        super()._record(h, iterations, accepted=accepted)
