"""A vanishing step in which every joint takes away the rates that it does not allow."""

from __future__ import annotations

from components.numerics.scheme import AGAIN, AGAIN_ITERATED, IMPULSE_ITERATED, IMPULSE_RESIDUAL, INSTANT

from .implicit.convergence import Solution, Tolerance
from .implicit.solver import Solver
from .stepping import failure

_TOLERANCES = {
    size: Tolerance(iterated, residual=IMPULSE_RESIDUAL)
    for size, iterated in ((INSTANT, IMPULSE_ITERATED), (AGAIN, AGAIN_ITERATED))
}


def impulse(solver: Solver, time: float, h: float) -> Solution | None:
    """The step h (s), `INSTANT` or `AGAIN`, which participants were commanded to take as an impulse.

    StepError where it does not converge; None if it is one that takes what little another left: all is as before it.
    """
    usual = solver.tolerance, solver.persistent
    solver.tolerance, solver.persistent = _TOLERANCES[h], h == INSTANT
    solver.forget()
    solution = solver.solve(time, h, solver.accepted)
    solver.tolerance, solver.persistent = usual
    if solution.converged:
        return solution
    if h == INSTANT:
        raise failure(solver, solution, time, h)
    solver.restore()
    return None
