"""Solvers of a leader and of its neighbours, whose steps start from what the leader's came to and end beside it.

A neighbour takes the leader's factors, and the residual that its iteration left; see `coupling/neighbours.h`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from ctypes import addressof, string_at
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..implicit.convergence import Solution
from ..implicit.native_solver import NativeSolver
from ..native.library import Led, LoopData, NeighbourData, NeighboursData, NetworkData
from ..participant import Vector


@dataclass(frozen=True)
class Solved:
    """A step that a leader has solved.

    guess, wrenches, residual (size,): what its iteration started from, came to and left. memory: what `led` points to.
    """

    h: float
    solution: Solution
    guess: Vector
    wrenches: Vector
    led: Led
    memory: tuple[Any, ...]


class LeadingSolver(NativeSolver):
    """Tells its neighbours of the steps that it solves.

    solved: while this is a list, steps are added to it, each with factors of its own.
    """

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of NativeSolver
        super().__init__(*arguments)
        self.neighbours: Beside | None = None
        self.solved: list[Solved] | None = None

    def solve(self, time: float, h: float, guess: Vector) -> Solution:
        """As any; and note it, where that is asked for."""
        guess = guess.copy()
        solution = super().solve(time, h, guess)
        if self.solved is not None:
            self.solved.append(self.at_hand(h, solution, guess, lasts=True))
        return solution

    def at_hand(self, h: float, solution: Solution, guess: Vector, *, lasts: bool = False) -> Solved:
        """The step just solved; lasts: beyond the next one, for which its factors are copied."""
        data, kept = self._data, []
        wrenches = self.wrenches.copy()
        residual = self._response - wrenches
        if lasts:
            data = NetworkData.from_buffer_copy(self._data)
            for name, count, kind in (
                ("values", data.matrix.length, np.float64),
                ("transposed", data.matrix.length, np.float64),
                ("pivots", data.matrix.size, np.uintp),
            ):
                bytes_there = string_at(getattr(data.matrix, name), count * np.dtype(kind).itemsize)
                kept.append(np.frombuffer(bytes_there, kind).copy())
                setattr(data.matrix, name, kept[-1].ctypes.data)
        led = Led(addressof(data), guess.ctypes.data, wrenches.ctypes.data, residual.ctypes.data)
        return Solved(h, solution, guess, wrenches, led, (data, residual, *kept))

    def _refuse(self, loop: LoopData) -> None:
        if self.neighbours is not None:
            self.neighbours.refuse(loop.time + loop.h)
        super()._refuse(loop)


class Beside:
    """Neighbours as the library sees them."""

    def __init__(self, solvers: Sequence[NeighbourSolver]) -> None:
        self._solvers = solvers
        self.each = (NeighbourData * len(solvers))()
        self._room = np.zeros((2, solvers[0].network.size * len(solvers)))
        changes, ordered = (int(row.ctypes.data) for row in self._room)
        self._data = NeighboursData(addressof(self.each), changes, ordered, len(solvers), len(solvers))
        for data, solver in zip(self.each, solvers, strict=True):
            data.network = solver.address
        self.address = addressof(self._data)

    def refuse(self, time: float) -> None:
        """ParticipantError with the words of the one that failed, if one did."""
        if self._data.at < len(self._solvers):
            self._solvers[self._data.at].refuse(time)


class NeighbourSolver(NativeSolver):
    """Solves steps beside a leader's: `led` holds those to come; without any, it solves as any other."""

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - those of NativeSolver
        super().__init__(*arguments)
        self.led: deque[Solved] = deque()
        self._alone = Beside([self])

    def solve(self, time: float, h: float, guess: Vector) -> Solution:
        """Beside the next of the leader's steps."""
        if not self.led:
            return super().solve(time, h, guess)
        return self.beside(self.led.popleft(), time, h, guess)

    def beside(self, solved: Solved, time: float, h: float, guess: Vector) -> Solution:
        """Beside a step of the leader, which may be a little longer or shorter."""
        self.wrenches[:] = guess
        done = self._library.coupling_beside(self._alone.address, addressof(solved.led), time, h)
        self._check(done, time, h)
        return solved.solution

    def refuse(self, time: float) -> None:
        """ParticipantError with the words of the participant that failed last."""
        self._check(False, time)
