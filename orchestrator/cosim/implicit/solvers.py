"""Which solver a network gets."""

from __future__ import annotations

from ..native.library import library
from ..network import Network
from .convergence import Tolerance
from .native_solver import NativeSolver
from .python_solver import PythonSolver
from .solver import Solver


def solver_for(network: Network, tolerance: Tolerance) -> Solver:
    """The native one where its library is there and can call every participant, or else the one in Python."""
    compiled = library()
    callable_ones = [native for p in network.participants if (native := p.native) is not None]
    if compiled is None or len(callable_ones) < len(network.participants):
        return PythonSolver(network, tolerance)
    return NativeSolver(network, tolerance, callable_ones, compiled)
