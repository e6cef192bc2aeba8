"""A vanishing step in which every joint takes away the rates that it does not allow."""

from __future__ import annotations

from components.numerics.scheme import AGAIN, AGAIN_ITERATED, IMPULSE_ITERATED, IMPULSE_RESIDUAL, INSTANT

from .convergence import Solution, Tolerance
from .solver import Solver

_TOLERANCES = {
    size: Tolerance(iterated, residual=IMPULSE_RESIDUAL)
    for size, iterated in ((INSTANT, IMPULSE_ITERATED), (AGAIN, AGAIN_ITERATED))
}


def impulse(solver: Solver, time: float, h: float) -> Solution:
    """The step h (s), `INSTANT` or `AGAIN`, which participants were commanded to take as an impulse.

    The second one takes what little the first one left, and gives in sooner: all is as before it then.
    """
    usual = solver.tolerance, solver.persistent
    solver.tolerance, solver.persistent = _TOLERANCES[h], h == INSTANT
    solver.forget()
    solution = solver.solve(time, h, solver.accepted)
    solver.tolerance, solver.persistent = usual
    if not solution.converged:
        solver.restore()
    return solution
