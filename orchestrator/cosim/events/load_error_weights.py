"""Loads that weight the error of a step in addition to its work: torques of latched lines, loads of struck stops.

A light part that latches or strikes has little of a scene's energy, and a large share of its loads.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import sqrt

import numpy as np

from .. import latch_up
from ..implicit.local_error import WeightedLoad
from ..implicit.snapshot import Numbers, plain
from ..implicit.solver import Solver

_LEAST_SHARE = 1e-3


class JudgedLoads:
    """What has latched, and what was struck, each with an inertia and an energy of its own."""

    def __init__(self, solver: Solver) -> None:
        self._solver = solver
        self._latched: list[latch_up.StiffenedLine] = []
        self._struck: list[latch_up.StiffenedLine] = []
        self._watched: list[WeightedLoad] = []

    def add_latched(self, line: latch_up.StiffenedLine) -> None:
        """A line that latches at this instant."""
        self._latched.append(line)

    def add_struck(self, names: Sequence[str], time: float, h: float, largest: float) -> None:
        """Connections by name that the present step of h (s) has struck; participants end stepped otherwise.

        largest: largest step (s) for the computation of their inertia.
        """
        solver = self._solver
        pushing = latch_up.slopes(solver, names, time, h)
        free = [latch_up.Slope(*map(np.zeros_like, slope)) for slope in pushing]
        if stops := latch_up.stiffenings(solver, names, free, pushing, h):
            self.let_go({stop.connection for stop in stops}, latched=False)
            self._struck.append(latch_up.swinging(solver, time, stops, largest)[0])

    def let_go(self, free: Collection[int], *, latched: bool = True) -> None:
        """Connections, by number, that were released, or that will be judged anew."""
        if latched:
            self._latched = latch_up.still_held(self._latched, free)
        self._struck = latch_up.still_held(self._struck, free)

    def judge(self, whole: float) -> None:
        """From now on weight them by the geometric mean of their energy and the whole energy (J)."""
        solver = self._solver
        self._watched = [
            load
            for line in (*self._latched, *self._struck)
            for load in latch_up.watched_loads(
                solver.network, line, sqrt(whole * max(line.energy, _LEAST_SHARE * whole))
            )
        ]
        solver.watch(self._watched)

    def numbers(self) -> Numbers:
        """As part of a snapshot."""
        return {
            "latched": plain(self._latched),
            "struck": plain(self._struck),
            "watched": plain(self._watched),
        }

    def take(self, numbers: Numbers) -> None:
        """Go on with those of a snapshot."""
        self._latched = [latch_up.stiffened_line_of(one) for one in numbers["latched"]]
        self._struck = [latch_up.stiffened_line_of(one) for one in numbers["struck"]]
        self._watched = [WeightedLoad(**{**one, "axis": tuple(one["axis"])}) for one in numbers["watched"]]
        self._solver.watch(self._watched)
