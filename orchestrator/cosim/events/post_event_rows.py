"""Rows with loads right after an event, from steps too short for motion, which are undone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from components.numerics.scheme import INSTANT, INSTANT_SHARE

from ..implicit.solver import Solver
from ..participant import Vector
from ..rows import Rows

_AFTER_START = 1e-8
"""An instant (s) after the start, in which joints hardly move; shorter ones are rounded."""
_PARABOLA = (3.0, -3.0, 1.0)
"""Shares of three values, at equal distances, of what the parabola through them has one such distance before."""


def instant_of(size: float) -> float:
    """A time (s) too short for motion, relative to steps of a size (s)."""
    return min(INSTANT, INSTANT_SHARE * size)


class PostEventRows:
    """One row per instant; of several simultaneous events that of the last, as nothing lasts between them.

    observe: takes how long after the present time (s); tell: a row so long after it. waiting: errors of loads, by
    `roughness`, before the first event of an instant whose row is still to come; empty without one.
    """

    def __init__(
        self, solver: Solver, rows: Rows, observe: Callable[[float], object], tell: Callable[[float], None]
    ) -> None:
        self._solver, self._rows, self._observe, self._tell = solver, rows, observe, tell
        self.waiting: list[Vector | None] = []

    def roughness(self, time: float, size: float, steps: int) -> Vector | None:
        """Errors of loads at an instant before an event acts at a time (s), to separate the contribution of the event.

        size: of steps (s); steps: since the last event.
        """
        if self.waiting:
            return self.waiting[0]
        solver, after, found = self._solver, instant_of(size), None
        solver.restore()
        if solver.solve(time, after, solver.accepted).converged:
            self._observe(after)
            found = self._rows.roughness(time, steps)
        solver.restore()
        solver.forget_all()
        return found

    def record(
        self,
        time: float,
        after: float,
        forget: Callable[[], None],
        roughness: Vector | None = None,
        *,
        others: bool = False,
    ) -> Vector | None:
        """A row so long after a time (s), unless other events follow at that time; the solver then discards the step.

        Returns the wrenches of that step; None if it does not converge.
        """
        solver = self._solver
        found = self.observe_after(time, after)
        if found is not None and roughness is not None:
            self._rows.smooth(roughness)
        if others:
            self.waiting = [roughness]
        else:
            self._tell(after)
        solver.restore()
        forget()
        return found

    def observe_start(self) -> None:
        """Have participants tell t = 0, bodies what is brought to them on the parabola through three instants after it.

        They know it of steps alone, and friction of a light line grows to its whole within microseconds.
        """
        solver, rows, found = self._solver, self._rows, []
        solver.save(0.0)
        for k in range(1, len(_PARABOLA) + 1):
            if self.observe_after(0.0, k * _AFTER_START) is None:
                break
            found.append(rows.brought())
        solver.restore()
        solver.forget_all()
        self._observe(0.0)
        if len(found) == len(_PARABOLA):
            rows.bring(np.tensordot(_PARABOLA, found, 1))

    def observe_after(self, time: float, after: float) -> Vector | None:
        """Have participants stand so long after a time (s): the wrenches of that step, None where it does not converge.

        Then they stand at that time.
        """
        solver = self._solver
        solver.restore()
        if solver.solve(time, after, solver.accepted).converged:
            found: Vector = solver.wrenches.copy()
            self._observe(after)
            return found
        solver.restore()
        self._observe(0.0)
        return None
