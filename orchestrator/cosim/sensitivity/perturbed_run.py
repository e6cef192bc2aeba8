"""A neighbouring run: it makes the steps of the nominal run, and has its events at its own times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...assembly import Event, HingeLine
from ..compiled_master import Block
from ..energy_balance import Energies
from ..implicit.native_solver import NativeSolver
from ..master import Master
from ..native.library import NeighbourData
from .solvers import AstrayError, NeighbourSolver, Solved

_ITERATED = 1e-11
"""Tolerance of its iterations at events: what they leave is in the difference."""
_REACHED = 1e-14
_SECANTS = 8
_SHORTER = 1e-4
_ASTRAY = 0.5
"""Of a step: what a neighbour's may differ by, beyond which it does not meet what its leader meets."""


class PerturbedRun(Master):
    """Has the network of its leader with other parameters. Its settings have a step plan, as it chooses no steps.

    name: what is different in it, for messages.
    """

    native_solver: type[NativeSolver] = NeighbourSolver

    def __init__(self, name: str, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - those of Master
        super().__init__(*arguments, **options)
        self.name = name
        assert isinstance(self.solver, NeighbourSolver)
        self.own_solver = self.solver
        self.solver.tolerance = replace(self.solver.tolerance, relative=_ITERATED)
        self._block = Block(self._rows)
        self._start = np.zeros(len(Energies._fields))
        self._instants: Iterator[float] = iter(())

    def tell(self, data: NeighbourData) -> None:
        """Where it stands, for the loop."""
        self._start[:] = self._energy_start
        data.time = self.time
        data.energy_start = self._start.ctypes.data
        data.rows = self._block.data
        self._block.begin(data.rows)

    def take(self, data: NeighbourData, steps: list[float]) -> None:
        """Stand where the loop stopped, so many steps later."""
        self._block.end(data.rows)
        self.time = data.time
        self.segments[-1].extend(steps)
        self._energies = self.own_solver.energies

    def follow(
        self,
        solved: Solved,
        meets: tuple[HingeLine | Event, float] | None,
        until: float | None,
        *,
        to_break: bool,
    ) -> None:
        """Accept the step that the leader accepts: to where it meets the same event, its next break, or the end (s).

        meets: the event, and how far from it the leader's search has ended.
        """
        h = solved.h
        if meets is not None:
            h = self._step_to_own(solved, self._own(meets[0]), meets[1])
        else:
            if until is not None:
                h = until - self.time
            elif to_break:
                self._watch()
                h = self._break - self.time
                self._refuse_astray(h, solved.h, "the next break of a law")
            self._beside(solved, h)
        self._observe(h)
        self._accept(h, solved.solution)

    def latch(self, line: HingeLine, instants: Sequence[float]) -> None:
        """As the leader, whose loads just after it are those after so many seconds, for every part of an event."""
        self._instants = iter(instants)
        self._latch(next(one for one in self._pending if one.name == line.name))

    def happen(self, event: Event, instants: Sequence[float]) -> None:
        """As the leader, see `latch`."""
        self._instants = iter(instants)
        self._happen(self._events[event.name])

    def pass_break(self, instants: Sequence[float], time: float) -> None:
        """As the leader at a time (s), see `latch`; AstrayError where a hold-down lets go in one of both only."""
        self._instants = iter(instants)
        if self._hold_downs.left_any() != bool(instants):
            raise AstrayError(
                f"with {self.name} a little different, hold-downs do not let go in the order in which they do "
                f"without, near t = {time:.6g} s: there is no derivative"
            )
        self._pass_break()

    def renew(self) -> None:
        """As the leader where an FMU has changed something."""
        self._renew()

    def release_rows(self) -> None:
        """Hand on the last row."""
        self._rows.release()

    def _instant(self, size: float) -> float:
        return next(self._instants)

    def _beside(self, solved: Solved, h: float) -> None:
        self.own_solver.beside(solved, self.time, h)

    def _own(self, one: HingeLine | Event) -> HingeLine | Event:
        return next(own for own in self._awaited() if own.name == one.name)

    def _step_to_own(self, solved: Solved, one: HingeLine | Event, goal: float) -> float:
        """The step (s) to where a distance is what is wanted, found by secants; participants end there."""

        def distance(h: float) -> float:
            self._beside(solved, h)
            if isinstance(one, Event):
                self._observe(h)
            return self._left(one) - goal

        h, left = solved.h, distance(solved.h)
        other, left_there = (1.0 - _SHORTER) * h, 0.0
        for k in range(_SECANTS):
            if abs(left) < _REACHED or (k > 1 and left == left_there):
                break
            if k == 0:
                h, other = other, h
            else:
                h, other = h - left * (h - other) / (left - left_there), h
            self._refuse_astray(h, solved.h, one.name)
            left_there, left = left, distance(h)
        return h

    def _refuse_astray(self, h: float, expected: float, what: str) -> None:
        if not abs(h - expected) < _ASTRAY * expected:
            raise AstrayError(
                f"with {self.name} a little different, {what} does not come near t = {self.time + expected:.6g} s, "
                "where it comes without"
            )
