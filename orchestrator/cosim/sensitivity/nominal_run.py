"""Master of a nominal run with neighbours, which make all its accepted steps and have all its events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from ...assembly import Event, HingeLine
from .. import stepping
from ..compiled_master import CompiledMaster
from ..events.crossings import Fall
from ..implicit.convergence import Solution
from ..implicit.native_solver import NativeSolver, Stop
from ..stepping import StepError
from .perturbed_run import PerturbedRun
from .solvers import LeadingSolver, PerturbedRuns

_ITERATED = 1e-11
"""Tolerance of its iterations; what they leave is the same in its neighbours, but for rounding in stiff joints."""


class NominalRun(CompiledMaster):
    """A run whose neighbours follow it; its numbers are those of a run without, but for rounding and iterations."""

    native_solver: type[NativeSolver] = LeadingSolver

    def __init__(self, neighbours: Sequence[PerturbedRun], *arguments: Any, **options: Any) -> None:  # noqa: ANN401
        super().__init__(*arguments, **options)
        assert isinstance(self.solver, LeadingSolver)
        self.solver.tolerance = replace(self.solver.tolerance, relative=_ITERATED)
        self._leading = self.solver
        self._neighbours = neighbours
        self._beside = self._leading.neighbours = PerturbedRuns([one.own_solver for one in neighbours])
        self._loop.neighbours = self._beside.address
        self._guess_there = np.zeros(self.network.size)
        self._loop.guess = self._guess_there.ctypes.data
        self._ends_at: HingeLine | Event | None = None
        self._in_event, self._until = False, inf
        self._instants: list[float] = []

    def initialize(self, *, preload: bool) -> None:
        """All of them."""
        super().initialize(preload=preload)
        for one in self._neighbours:
            one.initialize(preload=preload)

    def run(self, until: float) -> None:
        """To the given time, as the neighbours do by their own."""
        self._until = until
        super().run(until)
        for one in self._neighbours:
            one.release_rows()

    def _follow(self, solver: NativeSolver, until: float) -> tuple[Stop, Solution]:
        before = len(self.segments[-1])
        for one, data in zip(self._neighbours, self._beside.each, strict=True):
            one.tell(data)
        found = super()._follow(solver, until)
        steps = self.segments[-1][before:]
        for one, data in zip(self._neighbours, self._beside.each, strict=True):
            one.take(data, steps)
        return found

    def _step_to(self, crossed: Fall, h: float, solution: Solution) -> tuple[float, Solution] | None:
        found = super()._step_to(crossed, h, solution)
        self._ends_at = crossed.one if found else None
        return found

    def _accept(self, h: float, solution: Solution) -> None:
        crossed, self._ends_at = self._ends_at, None
        meets = None if crossed is None else (crossed, self._left(crossed))
        solved = self._leading.at_hand(self.time, h, solution)
        end = self.time + h
        to_break = end >= self._break - stepping.BREAK_REACHED
        until = self._until if end >= self._until - stepping.TIME_ROUNDING else None
        for one in self._neighbours:
            one.follow(solved, meets, until, to_break=to_break)
        super()._accept(h, solution)

    def _let_act(self, one: HingeLine | Event) -> None:
        """StepError where something else has acted at this instant: neighbours would meet it sooner or later."""
        if len(self._reached) > 1:
            names = " and ".join(other.name for other in self._reached)
            raise StepError(
                f"{names} come at one instant, t = {self.time:.6g} s: with other values one of them comes first, so "
                "that numbers have no derivatives there"
            )
        super()._let_act(one)

    def _happen(self, event: Event) -> None:
        with self._one_event() as is_whole:
            super()._happen(event)
        if is_whole:
            for one in self._neighbours:
                one.happen(event, self._instants)

    def _pass_break(self) -> None:
        with self._one_event() as is_whole:
            super()._pass_break()
        if is_whole:
            for one in self._neighbours:
                one.pass_break(self._instants, self.time)

    def _latch(self, line: HingeLine, *others: HingeLine) -> None:
        with self._one_event() as is_whole:
            super()._latch(line, *others)
        if is_whole:
            for one in self._neighbours:
                one.latch(line, self._instants)

    def _renew(self, known: float = 0.0) -> None:
        super()._renew(known)
        if not self._in_event:
            for one in self._neighbours:
                one.renew()

    def _instant(self, size: float) -> float:
        self._instants.append(super()._instant(size))
        return self._instants[-1]

    @contextmanager
    def _one_event(self) -> Iterator[bool]:
        """Whether it is no part of another one, which neighbours make of themselves."""
        is_whole = not self._in_event
        if is_whole:
            self._instants.clear()
        self._in_event = True
        yield is_whole
        self._in_event = not is_whole
