"""A vanishing step in which every joint takes away the rates that it does not allow."""

from __future__ import annotations

from dataclasses import replace

from components.numerics.scheme import AGAIN, AGAIN_ITERATED, IMPULSE_ITERATED, IMPULSE_RESIDUAL, INSTANT

from .convergence import Solution
from .solver import Solver

_ITERATED = {INSTANT: IMPULSE_ITERATED, AGAIN: AGAIN_ITERATED}


def impulse(solver: Solver, time: float, h: float) -> Solution:
    """The step h (s), `INSTANT` or `AGAIN`, which participants were commanded to take as an impulse.

    The second one takes what little the first one left, and gives in sooner: all is as before it then.
    """
    usual = solver.tolerance, solver.persistent
    solver.tolerance = replace(solver.tolerance, relative=_ITERATED[h], residual=IMPULSE_RESIDUAL)
    solver.persistent = h == INSTANT
    solver.forget()
    solution = solver.solve(time, h, solver.accepted)
    solver.tolerance, solver.persistent = usual
    if not solution.converged:
        solver.restore()
    return solution
