"""The master whose plain steps are made in C, coupling/loop.h, many in one call; all else is the master's in Python."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import addressof
from math import inf
from time import perf_counter
from typing import Any

import numpy as np

from ..assembly import Event, HingeLine
from . import energy_guard, stepping
from .energy_balance import Energies
from .implicit.convergence import Solution
from .implicit.native_solver import NativeSolver, Stop
from .master import Master
from .native.library import Crossing, LoopData, RowBlock, Rules
from .network import Network
from .rows import Recorder, Rows
from .settings import Settings
from .signals.process import SignalProcess

_RULES = Rules(
    ratio=stepping.RATIO,
    rejected=stepping.REJECTED,
    rejected_stirred=stepping.REJECTED_STIRRED,
    forget=stepping.FORGET,
    growth_margin=stepping.GROWTH_MARGIN,
    least_error=stepping.LEAST_ERROR,
    stirred_steps=stepping.STIRRED_STEPS,
    after_growth=stepping.STEPS_AFTER_GROWTH,
    after_shrinking=stepping.STEPS_AFTER_SHRINKING,
    most_levels=stepping.MOST_LEVELS,
    most_growth=stepping.MOST_GROWTH,
    after_division=stepping.STEPS_AFTER_DIVISION,
    share=energy_guard.SHARE,
    rounded=energy_guard.ROUNDED,
    steady=energy_guard.STEADY,
    allowance=energy_guard.ALLOWANCE,
    time_rounding=stepping.TIME_ROUNDING,
    break_reached=stepping.BREAK_REACHED,
    stretched=stepping.STRETCHED,
    shared=stepping.SHARED,
)
_MOST_STEPS = 128
"""Steps after which a run is given back at the latest."""
_PATIENCE = 0.03
"""Wall time (s) after which it is, to tell how far it is and to see whether it is interrupted."""


class CompiledMaster(Master):
    """Has the library make and accept steps as long as they are plain, where it can call every participant.

    `progress` of the settings is called after some of the steps only.
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
        if isinstance(self.solver, NativeSolver):
            self._steps, self._planned_steps = np.zeros(_MOST_STEPS), np.zeros(_MOST_STEPS)
            self._start = np.zeros(len(Energies._fields))
            self._laws_at = np.array(
                [_address(outputs, place) for outputs, place in self._laws], dtype=np.uintp
            )
            self._block = Block(self._rows)
            self._loop = LoopData(
                network=self.solver.address,
                rules=addressof(_RULES),
                law=_address(self._laws_at),
                laws=len(self._laws),
                steps=_address(self._steps),
                energy_start=_address(self._start),
                rows=self._block.data,
                capacity=1,
            )

    def _next_made(self, until: float) -> tuple[float, Solution] | None:
        solver = self.solver
        if not isinstance(solver, NativeSolver):
            return super()._next_made(until)
        stop, solution = self._follow(solver, until)
        h: float = self._loop.h
        if stop == Stop.PAUSED:
            return None
        if stop == Stop.UNSOLVED:
            solution = solver.insisted(solution, self.time, h, solver.predicted(self.time, h))
        return (h, solution) if stop == Stop.STANDS or self._stands(h, solution) else None

    def _follow(self, solver: NativeSolver, until: float) -> tuple[Stop, Solution]:
        """Plain steps; why they ended, and the solution of the step at hand."""
        self._tell(until)
        crossings, strikes = self._tell_events(), self._tell_strikes()
        begun = perf_counter()
        try:
            stop, solution = solver.follow(self._loop)
        finally:
            self._pace(perf_counter() - begun)
            self._take(solver, [crossing.before for crossing in crossings])
            self._strikes.before[self._strikes.waiting] = [-strike.before for strike in strikes]
        if stop == Stop.PAUSED and self._loop.made:
            h = self.segments[-1][-1]
            self._keep_snapshot(h)
            self.settings.progress(self.time, h)
        return stop, solution

    def _pace(self, elapsed: float) -> None:
        """As many steps the next time as should take no longer than anybody waits."""
        loop = self._loop
        most = _PATIENCE * (loop.made + 1) / max(elapsed, 1e-9)
        loop.capacity = int(min(max(most, 1.0), 2.0 * loop.capacity, _MOST_STEPS))

    def _tell(self, until: float) -> None:
        """Where the run stands, how far to go, and what chooses the steps."""
        loop, every = self._loop, self.settings.snapshot_every
        self._start[:] = self._energy_start
        loop.time, loop.position = self.time, len(self.segments[-1])
        loop.parts, loop.stood = self._divided.parts, self._divided.made
        loop.until, loop.break_time, loop.event_time = until, self._break, self._next_stop
        loop.stop = inf if every is None else (self.time // every + 1.0) * every - stepping.TIME_ROUNDING
        loop.sizes, loop.error, loop.guard = map(addressof, (self._sizes, self._error, self._guard))
        loop.fixed_step = self.settings.fixed_step or 0.0
        loop.made = loop.rejected = loop.wanted = 0
        self._block.begin(loop.rows)
        self._tell_plan()

    def _tell_plan(self) -> None:
        """Step sizes to follow, if there are any."""
        loop = self._loop
        plan, position = self._plan.now(self.segments) if self._plan else ([], 0)
        sizes = plan[position : position + _MOST_STEPS]
        self._planned_steps[: len(sizes)] = sizes
        loop.plan, loop.planned = (_address(self._planned_steps) if sizes else None), len(sizes)

    def _tell_events(self) -> Any:  # noqa: ANN401 - memory that the loop reads and writes
        """What may come within a step, lines first."""
        loop, awaited = self._loop, self._awaited()
        crossings = (Crossing * len(awaited))(*(self._crossing(one) for one in awaited))
        loop.crossing, loop.crossings, loop.lines = addressof(crossings), len(awaited), len(self._pending)
        return crossings

    def _tell_strikes(self) -> Any:  # noqa: ANN401 - memory that the loop reads and writes
        """Stops and contacts that nothing has struck."""
        loop, told = self._loop, self._strikes
        waiting = zip(told.places[told.waiting].tolist(), told.before[told.waiting].tolist(), strict=True)
        strikes = [
            Crossing(_address(self.solver.observations, place), 0.0, 1.0, -before)
            for place, before in waiting
        ]
        memory = (Crossing * len(strikes))(*strikes)
        loop.strike, loop.strikes = addressof(memory), len(strikes)
        return memory

    def _crossing(self, one: HingeLine | Event) -> Crossing:
        array, place, value, scale = (
            self._scheduled.where(one) if isinstance(one, Event) else (*self._sensors[one.name], 0.0, -1.0)
        )
        return Crossing(_address(array, place), value, scale, self._before[one.name])

    def _take(self, solver: NativeSolver, distances: Sequence[float]) -> None:
        """Stand where the loop stopped."""
        loop = self._loop
        self._block.end(loop.rows)
        self.time, self._break = loop.time, loop.break_time
        self._divided = stepping.SubdividedStep(loop.parts, loop.stood)
        self.statistics.steps += loop.made
        self.statistics.rejected += loop.rejected
        self.segments[-1].extend(self._steps[: loop.made].tolist())
        names = [one.name for one in self._awaited()]
        self._before = dict(zip(names, distances, strict=True))
        self._energies = solver.energies


class Block:
    """Rows made in C on their way to a recorder, in addition to the one in `Rows`."""

    def __init__(self, rows: Rows) -> None:
        self._rows = rows
        _, observations, scene = rows.held()
        self._times = np.zeros(_MOST_STEPS)
        self._values = np.zeros((_MOST_STEPS, len(rows.recorded) + len(scene)))
        self.data = RowBlock(
            held_observations=_address(observations),
            held_scene=_address(scene),
            times=_address(self._times),
            values=_address(self._values),
            recorded=_address(rows.recorded),
            corrected=_address(rows.corrections),
            observations=len(observations),
            columns=len(rows.recorded),
            channels=len(scene),
            corrections=len(rows.corrections),
        )

    def begin(self, block: RowBlock) -> None:
        """Nothing but what is held."""
        held = self._rows.held()[0]
        block.held, block.held_time, block.count = held is not None, held or 0.0, 0

    def end(self, block: RowBlock) -> None:
        """Hand on what came."""
        self._rows.extend(self._times[: block.count], self._values[: block.count])
        self._rows.held_since(block.held_time if block.held else None)


def _address(array: np.ndarray[Any, Any], place: int = 0) -> int:
    return int(array.ctypes.data) + place * array.itemsize
