"""One coupled step: the wrenches at all ports such that bodies and connections agree.

Residual: wrenches that the connections return for the motions that the wrenches cause, minus the
wrenches. A chord Newton iteration on the interface Jacobian, sharpened by Broyden's update. What every solver does
stands here; the iteration itself in `python_solver`, to be read, and in `native_solver`, to be fast.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from ..energy_balance import Energies, energy_rows
from ..network import Network
from ..participant import Matrix, ParticipantError, Vector
from .convergence import ROUND_OFF, Solution, Tolerance, is_credible
from .history import Table
from .interface_jacobian import InterfaceJacobian, Matrices
from .local_error import WeightedLoad, jump_work

_MAX_DAMPED = 30
_SMALLEST_SHARE = 1e-3


class Solver(ABC):
    """Solves coupled steps from the participants' saved states and leaves them stepped.

    `wrenches` is the solution of the last solve, `accepted` that of the last accepted step. `persistent` requests a
    slow damped iteration before giving up, if the step cannot be made smaller. `observations` are those of the last
    `observe`, in the order of the participants, followed by a zero.
    """

    def __init__(self, network: Network, tolerance: Tolerance) -> None:
        self.network = network
        self.tolerance = tolerance
        self.wrenches = np.zeros(network.size)
        self.accepted = np.zeros(network.size)
        self.observations = np.zeros(sum(p.observation_layout.size for p in network.participants) + 1)
        self.jacobian = InterfaceJacobian(network)
        self.persistent = False
        self._response = np.zeros(network.size)
        self._round_off = np.zeros(network.size)
        self._energy_rows = energy_rows(network.participants)
        self._in_use: float | None = None

    @abstractmethod
    def costs(self) -> tuple[int, float]:
        """Sweeps so far, and time (s) inside FMUs that the C loop called."""

    @abstractmethod
    def sweep(self, time: float, h: float) -> None:
        """Bodies under the wrenches, then connections over the motions, all from their saved states."""

    @abstractmethod
    def save(self, time: float) -> None:
        """The present states of all participants are those that `solve` starts from."""

    @abstractmethod
    def accept(self, time: float, h: float) -> None:
        """Take the step from a time over h as made: wrenches for the next guess, states to solve from."""

    @abstractmethod
    def restart(self) -> None:
        """Forget the wrenches of steps before: something jumped."""

    @abstractmethod
    def past(self) -> tuple[Table, Table]:
        """Times (points,) and values (points, size) of the steps before, oldest first."""

    @abstractmethod
    def remember(self, times: Table, values: Table) -> None:
        """Take such for the steps before."""

    @abstractmethod
    def predicted(self, time: float, h: float) -> Vector:
        """Wrenches to solve a step from: extrapolated over the last ones, or those accepted last."""

    @abstractmethod
    def error_square(self, time: float, h: float, energy: float) -> float | None:
        """Square of the relative error of the last solved step, see `local_error`; None with too few steps before.

        energy (J): reference energy of the whole motion.
        """

    @abstractmethod
    def watch(self, watched: Sequence[WeightedLoad]) -> None:
        """From now on weight these torques, and no others, by energies of their own."""

    @abstractmethod
    def observe(self, time: float) -> Energies:
        """Put the observations of all participants into `observations`, bodies first; energies among them."""

    @abstractmethod
    def _iterate(self, time: float, h: float) -> Solution:
        """Chord Newton from the present wrenches, with the matrices in use if they are those of the step."""

    @abstractmethod
    def _factorize(self, mobilities: Matrices, stiffnesses: Matrices, h: float) -> None:
        """LU factors of I - stiffness x mobility, from matrices turned to the present orientations."""

    @abstractmethod
    def _direction(self, residual: Vector) -> Vector:
        """Chord Newton correction for a residual."""

    def restore(self) -> None:
        """Take all participants back to their saved states, with the motions of those at the connections."""
        for participant in self.network.participants:
            participant.restore()
            participant.read()
        self.network.carry_motion()

    def forget(self) -> None:
        """Laws changed (an event): evaluate connections anew at the next solve."""
        self.jacobian.outdate()
        self._in_use = None

    def forget_all(self) -> None:
        """Keep nothing but what a step starts from."""
        self.jacobian.forget()
        self._in_use = None

    def linearize(self, time: float, h: float) -> None:
        """Have the matrices of a step h in use, about the wrenches accepted last; participants end stepped."""
        self.wrenches[:] = self.accepted
        self.sweep(time, h)
        self._refresh(time, h, evaluate=True)

    def displacements(self, wrenches: Vector) -> Matrix:
        """Motions of all ports of bodies (ports, coordinates) under more wrenches (size,) over the step in use.

        Connections resist; motions are those of its end, in the coordinates of `interface_jacobian`.
        """
        assert self._in_use is not None
        change = self._direction(wrenches)
        mobilities = self.jacobian.mobilities(self._in_use)
        moved = [
            mobility @ change[rows] for mobility, rows in zip(mobilities, self.network.rows, strict=True)
        ]
        result: Matrix = np.concatenate(moved).reshape(-1, self.network.width.coordinates)
        return result

    def jump_square(self, h: float, change: Vector, energy: float) -> float | None:
        """Square of the relative error that a jump of wrenches (size,) makes in a step that takes it as bent ones.

        From the mobilities of a step as near to h as there is, which go with its square; None where none are known.
        """
        known = self.jacobian.nearest(h)
        if known is None:
            return None
        work = jump_work(self.network, self.jacobian.mobilities(known), change)
        return work * (h / known) ** 2 / energy

    def solve(self, time: float, h: float, guess: Vector) -> Solution:
        """Find the wrenches of the step from the saved states; participants end stepped when it converges."""
        return self.insisted(self._attempt(self._iterate, time, h, guess), time, h, guess)

    def insisted(self, solution: Solution, time: float, h: float, guess: Vector) -> Solution:
        """What a first iteration from a guess came to, or where it did not converge, what others come to."""
        if not solution.converged:
            self.forget()
            self.jacobian.outdate(h, bodies=True)
            near = self.tolerance.is_near(solution.correction)
            again = self._attempt(self._iterate, time, h, self.wrenches.copy() if near else guess)
            solution = again._replace(iterations=solution.iterations + again.iterations)
        if self.persistent and not solution.converged:
            again = self._attempt(self._damped, time, h, guess)
            refusal = None if again.converged else again.failure or solution.failure
            solution = again._replace(iterations=solution.iterations + again.iterations, failure=refusal)
        return solution

    def _attempt(
        self, iterate: Callable[[float, float], Solution], time: float, h: float, guess: Vector
    ) -> Solution:
        """One way of iterating, from a guess; a participant that refuses to step ends it."""
        self.wrenches[:] = guess
        try:
            return iterate(time, h)
        except ParticipantError as error:
            self._in_use = None
            return Solution(False, 1, np.inf, 0, error)

    def _refresh(self, time: float, h: float, *, evaluate: bool, bodies: bool = False) -> None:
        """Have matrices of a step in use at the present orientations; anew those of connections, or of bodies too."""
        self._in_use = None
        if evaluate:
            self.jacobian.outdate(h, bodies=bodies)
        self._factorize(*self.jacobian.matrices(h, time), h)
        self._in_use = h

    def _damped(self, time: float, h: float) -> Solution:
        """Newton with all matrices of the present wrenches, each correction halved until it makes progress."""
        solution = Solution(False, 0, np.inf, 0)
        residual = self._residual(time, h)
        for iteration in range(1, _MAX_DAMPED + 1):
            if residual is None:
                break
            self.jacobian.forget(h)
            self._refresh(time, h, evaluate=True)
            direction = self._direction(residual)
            scale = self.tolerance.scale(self.wrenches + direction)
            size = float(np.abs(direction / scale).max(initial=0.0))
            converged = self._settled(size, residual, scale)
            solution = Solution(converged, iteration, size, int(np.argmax(np.abs(direction / scale))))
            if converged:
                break
            residual = self._search(time, h, direction, scale)
        return solution

    def _search(self, time: float, h: float, direction: Vector, scale: Vector) -> Vector | None:
        """Line search along a correction until the next one, by the same matrices, is smaller; the residual there."""
        start, share, size = self.wrenches.copy(), 1.0, float(np.abs(direction / scale).max())
        residual = None
        while share > _SMALLEST_SHARE:
            self.wrenches[:] = start + share * direction
            residual = self._residual(time, h)
            if residual is not None:
                left = float(np.abs(self._direction(residual) / scale).max())
                if left <= (1.0 - 0.25 * share) * size:
                    break
            share *= 0.5
        return residual

    def _residual(self, time: float, h: float) -> Vector | None:
        """What the connections return for the present wrenches, minus those; None where a participant refuses."""
        try:
            self.sweep(time, h)
        except ParticipantError:
            return None
        residual: Vector = self._response - self.wrenches
        return residual if bool(np.all(np.isfinite(residual))) else None

    def _settled(self, correction: float, residual: Vector, scale: Vector) -> bool:
        """Whether the scaled correction is small, or ports cannot agree better for the rounding of their poses.

        Rounding of absurd trial wrenches says nothing.
        """
        if correction <= 1.0:
            return is_credible(self.wrenches, residual)
        allowed = self.tolerance
        rounded = self._round_off + max(allowed.residual, ROUND_OFF / allowed.relative) * scale
        return allowed.is_near(correction) and bool(np.all(np.abs(residual) <= rounded))
