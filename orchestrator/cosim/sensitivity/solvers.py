"""Solvers of a nominal run and its neighbours, whose steps start from the solution of the nominal step.

A neighbour uses the factorisation of the nominal run and the residual of its iteration; see `coupling/neighbours.h`.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import addressof
from dataclasses import dataclass
from math import inf, nan
from typing import Any

import numpy as np

from components import FanfoldError

from ..implicit.convergence import Solution
from ..implicit.native_solver import NativeSolver
from ..native.library import Led, LoopData, NeighbourData, NeighboursData
from ..participant import ParticipantError, Vector


class AstrayError(FanfoldError):
    """A neighbour cannot follow its leader; one that differs less from it may."""


@dataclass(frozen=True)
class Solved:
    """The step h (s) that a leader has solved and not accepted yet; arrays: memory of `led`."""

    h: float
    solution: Solution
    led: Led
    arrays: tuple[Vector, ...]


class LeadingSolver(NativeSolver):
    """Passes the steps that it solves to its neighbours."""

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of NativeSolver
        super().__init__(*arguments)
        self.neighbours: PerturbedRuns | None = None
        self._tried = -inf

    def at_hand(self, time: float, h: float, solution: Solution) -> Solved:
        """The step just solved from a time, until the next one is solved."""
        arrays = self.predicted(time, h).copy(), self.wrenches.copy(), self._response - self.wrenches
        led = Led(self.address, *(array.ctypes.data for array in arrays))
        return Solved(h, solution, led, arrays)

    def _tries_again(self, loop: LoopData) -> bool:
        """Where a neighbour does not converge, as the matrices are from the other side of a kink of friction."""
        if self.neighbours is None or not self.neighbours.is_astray or self._tried == loop.time:
            return False
        self._tried, loop.ready_step = loop.time, nan
        return True

    def _refuse(self, loop: LoopData) -> None:
        if self.neighbours is not None:
            self.neighbours.refuse(loop.time + loop.h)
        super()._refuse(loop)


class NeighbourSolver(NativeSolver):
    """Solves the steps of the nominal run for a neighbour, and its own steps at events."""

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of NativeSolver
        super().__init__(*arguments)
        self._alone = PerturbedRuns([self])

    def beside(self, solved: Solved, time: float, h: float) -> None:
        """Do a step of the nominal run, or one a little longer or shorter; AstrayError where that cannot be."""
        self.wrenches[:] = self.predicted(time, h)
        if not self._library.coupling_beside(self._alone.address, addressof(solved.led), time, h):
            self._alone.refuse(time + h)

    def words(self, time: float, h: float) -> str:
        """Of the participant that failed last."""
        try:
            self._check(False, time, h)
        except ParticipantError as error:
            return str(error)
        return ""


class PerturbedRuns:
    """Neighbours as the library sees them, each in `each`."""

    def __init__(self, solvers: Sequence[NeighbourSolver]) -> None:
        self._solvers = solvers
        self.each = (NeighbourData * len(solvers))()
        self._room = np.zeros((2, solvers[0].network.size * len(solvers)))
        changes, ordered = (int(row.ctypes.data) for row in self._room)
        self._data = NeighboursData(addressof(self.each), changes, ordered, len(solvers), len(solvers))
        for data, solver in zip(self.each, solvers, strict=True):
            data.network = solver.address
        self.address = addressof(self._data)

    @property
    def is_astray(self) -> bool:
        """Whether it was that one does not converge which ended the last step."""
        at = self._data.at
        return at < len(self._solvers) and bool(self.each[at].astray)

    def refuse(self, time: float) -> None:
        """AstrayError with the words of the one that failed, if one did."""
        at = self._data.at
        if at < len(self._solvers):
            one = self.each[at]
            words = "its wrenches do not converge" if one.astray else self._solvers[at].words(time, one.h)
            raise AstrayError(f"at t = {time:.6g} s a neighbouring run cannot follow ({words})")
