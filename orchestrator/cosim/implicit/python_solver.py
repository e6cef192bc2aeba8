"""The coupled step in Python, for participants of any kind: what fmus/native/coupling does, to be read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..energy_balance import Energies
from ..network import Network
from ..participant import Matrix, Vector
from . import convergence
from .convergence import Extent, Solution, Tolerance, broyden, round_off
from .history import History, Table
from .interface_jacobian import Matrices
from .local_error import Accuracy, Loads, WeightedLoad, error_square
from .solver import Solver
from .sparse_system import SparseSystem


class PythonSolver(Solver):
    """Makes every call of a participant itself."""

    def __init__(self, network: Network, tolerance: Tolerance) -> None:
        super().__init__(network, tolerance)
        self._sweeps = 0
        self._system = SparseSystem(network)
        self._history = History(len(network.port_names), network.width)
        self._watched: Sequence[WeightedLoad] = ()
        self._mobilities: list[Matrix] = []
        self._extent = Extent(0.0, 0.0)
        self._tolerated = np.zeros(network.size)
        self._endured = 0

    def costs(self) -> tuple[int, float]:
        """Sweeps; all calls are made one by one."""
        return self._sweeps, 0.0

    def sweep(self, time: float, h: float) -> None:
        """Bodies, then connections."""
        network = self.network
        self._sweeps += 1
        network.set_wrenches(self.wrenches)
        for body in network.bodies:
            body.restore()
            body.write()
            body.do_step(time, h)
            body.read()
        network.carry_motion()
        for connection in network.connections:
            connection.restore()
            connection.write()
            connection.do_step(time, h)
            connection.read()
        network.collect_wrenches(self._response)

    def save(self, time: float) -> None:
        """Every participant into its slot."""
        for participant in self.network.participants:
            participant.save()

    def accept(self, time: float, h: float) -> None:
        """Remember the wrenches, save the states."""
        self.accepted[:] = self.wrenches
        self._history.add(time + 0.5 * h, self.wrenches, h)
        self.save(time + h)

    def restart(self) -> None:
        """Clear the history."""
        self._history.clear()

    def past(self) -> tuple[Table, Table]:
        """As the history has them."""
        return self._history.points()

    def remember(self, times: Table, values: Table) -> None:
        """Into the history."""
        self._history.take(times, values)

    def forget_all(self) -> None:
        """Patience with slow iterations as well."""
        super().forget_all()
        self._endured = 0

    def predicted(self, time: float, h: float) -> Vector:
        """From the history, where there is one."""
        found = self._history.extrapolated(time + 0.5 * h, h)
        return self.accepted if found is None else found

    def error_square(self, time: float, h: float, energy: float) -> float | None:
        """From the bend of the history."""
        bend = self._history.curvature(time + 0.5 * h, self.wrenches, h)
        if bend is None:
            return None
        accuracy = Accuracy(self._tolerated, self._round_off, self._extent.reach)
        loads = Loads(self.accepted, self.wrenches)
        return error_square(self.network, self._mobilities, bend, accuracy, self._watched, loads, h, energy)

    def watch(self, watched: Sequence[WeightedLoad]) -> None:
        """Keep them for `error_square`."""
        self._watched = watched

    def observe(self, time: float) -> Energies:
        """Ask one after the other."""
        participants = self.network.participants
        if participants:
            np.concatenate([p.observe() for p in participants], out=self.observations[:-1])
        return Energies(*self.observations.take(self._energy_rows).sum(axis=1).tolist())

    def _iterate(self, time: float, h: float) -> Solution:
        steps: list[Vector] = []
        scale = np.ones(0)
        last = np.inf
        iteration = halvings = 0
        halved = False
        while iteration < convergence.MAX_ITERATIONS:
            iteration += 1
            self.sweep(time, h)
            residual = self._response - self.wrenches
            if not np.all(np.isfinite(residual)):
                return Solution(False, iteration, np.inf, int(np.argmin(np.isfinite(residual))))
            if halved or self._in_use != h:
                self._refresh(time, h, evaluate=False)
            direction = self._direction(residual)
            if iteration == 1:
                scale = self.tolerance.scale(self.wrenches + direction)
            correction = direction / scale if halved else broyden(direction / scale, steps)
            size = float(np.abs(correction).max(initial=0.0))
            settled = self._settled(size, residual, scale)
            if settled and (
                iteration == convergence.MAX_ITERATIONS or self._is_enough(size, last, residual, scale)
            ):
                self._tolerated = scale * min(size, 1.0)
                return Solution(True, iteration, size, 0)
            if (size > convergence.DIVERGED * last and not halved) or (size <= 1.0 and not settled):
                break
            rough = size * self.tolerance.relative > convergence.ROUGH
            may_halve = rough and iteration > convergence.REFRESHED[0] and halvings < convergence.HALVINGS
            if may_halve and steps and convergence.overshoots(correction, steps[-1], last):
                # back half of the step before, where matrices are made anew; no iteration of its own
                steps = [0.5 * steps[-1]]
                self.wrenches -= steps[0] * scale
                last, halved, halvings, iteration = 0.5 * last, True, halvings + 1, iteration - 1
                continue
            if halved:
                steps.clear()
            elif self._refreshed(time, h, size, last, iteration):
                steps.clear()
                correction = self._direction(residual) / scale
            last, halved = size, False
            steps.append(correction)
            self.wrenches += correction * scale
        return Solution(False, iteration, size, int(np.argmax(np.abs(correction))))

    def _refreshed(self, time: float, h: float, size: float, last: float, iteration: int) -> bool:
        """Have matrices refreshed where a contraction is slow, and say so; evaluated anew only where that pays."""
        if size <= convergence.SLOW * last or iteration not in convergence.REFRESHED:
            return False
        evaluate = iteration > convergence.REFRESHED[0]
        self._endured += evaluate
        late = self._endured > convergence.PATIENCE or convergence.is_too_slow(size, last, iteration)
        if evaluate and not late:
            return False
        self._endured = 0 if evaluate else self._endured
        self._refresh(time, h, evaluate=evaluate, bodies=iteration == convergence.LAST_REFRESHED)
        return True

    def _is_enough(self, size: float, last: float, residual: Vector, scale: Vector) -> bool:
        """Whether no further sweep is worth it after a small correction; one beyond 1 is rounding."""
        little = size > 1.0 or convergence.leaves_little(size, last)
        return little and (last <= 1.0 or self._agrees(residual, scale))

    def _agrees(self, residual: Vector, scale: Vector) -> bool:
        """Whether residuals are within the accuracy of the recorded loads, or are round-off.

        A stiff joint turns a small correction into a large residual.
        """
        return bool(np.all(np.abs(residual) <= np.maximum(convergence.AGREED * scale, self._round_off)))

    def _direction(self, residual: Vector) -> Vector:
        return self._system.solve(residual)

    def _present(self, stiffnesses: Matrices) -> list[Matrix]:
        """Connections that give theirs at once: about the step just made; the others: as they were, turned."""
        network, turned = self.network, stiffnesses.turned()
        for i, (connection, places) in enumerate(
            zip(network.connections, network.connection_places, strict=True)
        ):
            present = connection.jacobian_at_once(places, network.width)
            turned[i] = turned[i] if present is None else present
        return turned

    def _factorize(self, mobilities: Matrices, stiffnesses: Matrices, h: float) -> None:
        network = self.network
        self._mobilities, turned = mobilities.turned(), self._present(stiffnesses)
        self._system.factorize(self._mobilities, turned)
        self._extent = Extent.of(
            connection.inputs[: 13 * len(ports)]
            for connection, ports in zip(network.connections, network.connection_ports, strict=True)
        )
        for index, stiffness in zip(network.connection_rows, turned, strict=True):
            self._round_off[index] = round_off(stiffness, network.width, self._extent, h)
