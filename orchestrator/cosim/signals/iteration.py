"""FMUs that take the steps of the participants, each step repeated until loads and motions at its end agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..implicit.convergence import Solution
from ..implicit.solver import Solver
from ..participant import Matrix, ParticipantError, Vector
from .joined import JoinedFmu
from .process import DiscardedStepError

_MOST = 8
"""Repetitions of a step before derivatives are taken anew, and then before it is given up."""
_AGREED = 1e-2
"""Part of the tolerance that loads may be apart by, of the largest of their kind so far."""
_LEAST = 1e-6
"""Of loads (N, N.m) in whose size others are judged where there are hardly any."""


class Iteration:
    """Finds the loads of FMUs over a step: their means over it are those that its motion leads to.

    Newton's method on these loads, a few numbers, with derivatives by differences, taken once and kept up by Broyden's
    update. What the FMUs have come to is kept when the step is accepted; one whose loads do not agree must be smaller.
    """

    def __init__(self, fmus: Sequence[JoinedFmu]) -> None:
        self._fmus = fmus
        signals = [signal for one in fmus for signal in one.fmu.outputs]
        self._loads = np.array([signal.start[signal.index] for signal in signals])
        self._alike = np.array([[a.quantity == b.quantity for b in signals] for a in signals])
        self._ends = np.cumsum([len(one.fmu.outputs) for one in fmus])[:-1]
        self._largest = np.full(len(signals), _LEAST)
        self._derivatives: Matrix | None = None
        self._past: list[tuple[float, Vector]] = []
        self._given: list[Mapping[str, float]] = []

    @property
    def longest_step(self) -> float:
        """Step (s) that none of the FMUs may be taken beyond."""
        return min(one.fmu.step for one in self._fmus)

    def solve(self, solver: Solver, time: float, h: float, tolerance: float) -> Solution:
        """A step of the participants with the loads that the FMUs give over it; they end stepped and observed."""
        solution, apart = self._made(self._predicted(h), solver, time, h, solver.predicted(time, h))
        for attempt in range(2):
            if not solution.converged or self._agree(apart, tolerance):
                return solution
            if attempt == 1 or self._derivatives is None:
                self._derivatives = self._by_differences(apart, solver, time, h)
            for _ in range(_MOST):
                solution, apart = self._corrected(apart, solver, time, h)
                if not solution.converged or self._agree(apart, tolerance):
                    return solution
        names = ", ".join(one.fmu.name for one in self._fmus)
        error = ParticipantError(
            f"{names}: its loads and the motion that they lead to do not agree in the step of {h:.3g} s from "
            f"t = {time:.6g} s, where they stay {self._worst(apart):.3g} of their size apart; a smaller "
            "tolerance, and so smaller steps, may bring them together; one that switches at once with its inputs "
            "has to be held over a step: leave iterated out"
        )
        return solution._replace(converged=False, correction=np.inf, failure=error)

    def accept(self, h: float) -> None:
        """What the FMUs have come to in the step solved last, over h (s), is where the next one starts."""
        for one, given in zip(self._fmus, self._given, strict=True):
            one.keep(given, h)
        self._past = [*self._past[-1:], (h, self._loads)]
        # the mean of an impulse over a short step is no size to judge by
        lasting = min(1.0, h / self.longest_step)
        self._largest = np.maximum(self._largest, lasting * self._largest_alike(self._loads))

    def _predicted(self, h: float) -> Vector:
        """Loads over a step h (s) on the line through the means of the last two."""
        if len(self._past) < 2:
            return self._loads
        (h_before, before), (h_last, last) = self._past
        return last + (last - before) * (h + h_last) / (h_last + h_before)

    def _made(
        self, loads: Vector, solver: Solver, time: float, h: float, guess: Vector
    ) -> tuple[Solution, Vector]:
        """The step under these loads, and how far the FMUs' own are from them."""
        solver.restore()
        self._loads = loads
        for one, values in zip(self._fmus, np.split(loads, self._ends), strict=True):
            one.set(values.tolist(), time)
        solution = solver.solve(time, h, guess)
        if not solution.converged:
            return solution, loads
        solver.observe(time + h)
        try:
            self._given = [one.tried(h) for one in self._fmus]
        except DiscardedStepError as error:
            return solution._replace(converged=False, correction=np.inf, failure=error), loads
        means = [one.means(given, h) for one, given in zip(self._fmus, self._given, strict=True)]
        acts = np.concatenate([one.act() for one in self._fmus])
        return solution, np.where(acts, np.concatenate(means) - loads, 0.0)

    def _corrected(self, apart: Vector, solver: Solver, time: float, h: float) -> tuple[Solution, Vector]:
        """The step under corrected loads; it updates the derivatives."""
        assert self._derivatives is not None
        change = np.linalg.lstsq(self._derivatives, -apart)[0]
        solution, after = self._made(self._loads + change, solver, time, h, solver.wrenches.copy())
        if solution.converged and (square := float(change @ change)) > 0.0:
            missed = after - apart - self._derivatives @ change
            self._derivatives = self._derivatives + np.outer(missed, change) / square
        return solution, after

    def _by_differences(self, apart: Vector, solver: Solver, time: float, h: float) -> Matrix:
        """Derivatives of how far loads are apart by the loads, from changes as large as that is itself."""
        start, columns = self._loads, []
        changes = np.maximum(self._largest_alike(apart), _LEAST)
        for k, change in enumerate(changes.tolist()):
            moved = start.copy()
            moved[k] += change
            solution, after = self._made(moved, solver, time, h, solver.wrenches.copy())
            columns.append((after - apart) / change if solution.converged else -np.eye(len(start))[k])
        self._loads = start
        return np.array(columns).T

    def _agree(self, apart: Vector, tolerance: float) -> bool:
        return self._worst(apart) <= _AGREED * tolerance

    def _worst(self, apart: Vector) -> float:
        """Largest part of their size that loads are apart by."""
        sizes = np.maximum(self._largest, self._largest_alike(self._loads))
        return float((np.abs(apart) / sizes).max(initial=0.0))

    def _largest_alike(self, values: Vector) -> Vector:
        """Of every value the largest size among those of loads of its kind."""
        found: Vector = (self._alike * np.abs(values)).max(axis=1, initial=0.0)
        return found
