"""One coupled step: the wrenches at all ports such that bodies and connections agree.

Residual: wrenches that the connections return for the motions that the wrenches cause, minus the
wrenches. A chord Newton iteration on the probed interface Jacobian, sharpened by Broyden's update.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..energy_balance import Energies, energy_rows
from ..network import Matrix, Network
from ..participant import ParticipantError, Vector
from . import convergence
from .convergence import Extent, Solution, Tolerance, broyden, is_credible, round_off
from .engine import Engine, Limits, Matrices, Shared, Status
from .history import History
from .interface_jacobian import first_port_axes, mobility_of, stiffness_of
from .local_error import Accuracy, WatchedTorque, error_square
from .sparse_system import SparseSystem

_MAX_DAMPED = 30
_SMALLEST_SHARE = 1e-3
_LIMITS = Limits(
    convergence.SLOW,
    convergence.DIVERGED,
    convergence.STEEPEST,
    convergence.ROUND_OFF,
    convergence.NEAR,
    convergence.CREDIBLE,
    convergence.AGREED,
    convergence.PATIENCE,
    convergence.MAX_ITERATIONS,
    convergence.REFRESHED,
)


class Coupling:
    """Solves coupled steps from the participants' saved states and leaves them stepped.

    `wrenches` holds the solution of the last solve, `accepted` that of the last accepted step. `mode` tells
    probed mobilities of different parameter sets apart (static against dynamic). `persistent` asks for a slow
    damped iteration before giving up, where the step cannot be made smaller. `observations` are those of the
    last `observe`, one participant's after the other's, and a zero. A network of FMUs is iterated by the
    engine in C, any other one here.
    """

    def __init__(self, network: Network, tolerance: Tolerance) -> None:
        self.network = network
        self.tolerance = tolerance
        self.wrenches = np.zeros(network.size)
        self.accepted = np.zeros(network.size)
        self.mode = "dynamic"
        self.persistent = False
        self.probes = 0
        self._sweeps = 0
        self._extent = Extent(0.0, 0.0)
        self._turned: list[Matrix] = []
        self._tolerated = np.zeros(network.size)
        self._watched: Sequence[WatchedTorque] = ()
        self._law = np.zeros(network.size)
        self._round_off = np.zeros(network.size)
        self._mobilities: dict[tuple[str, float], Matrices] = {}
        self._stiffnesses: dict[tuple[str, float], Matrices] = {}
        self._factor_key: tuple[str, float] | None = None
        self._endured = 0
        self._participants = [*network.bodies, *network.connections]
        self.observations = np.zeros(sum(p.observation_layout.size for p in self._participants) + 1)
        self._energy_rows = energy_rows(self._participants)
        self._engine: Engine | None = None
        if Engine.serves(network):
            shared = Shared(
                self.wrenches,
                self.accepted,
                self._law,
                self._round_off,
                self.observations,
                self._energy_rows,
            )
            self._engine = Engine(network, _LIMITS, shared)
        else:
            self._system = SparseSystem(network)
            self._history = History(len(network.port_names), network.width)

    @property
    def sweeps(self) -> int:
        """Sweeps made so far."""
        return self._sweeps if self._engine is None else self._engine.sweeps

    @property
    def fmu_time(self) -> float:
        """Time (s) inside FMUs so far, as far as they were not called one by one."""
        return 0.0 if self._engine is None else self._engine.seconds

    def save(self, time: float) -> None:
        """The present states of all participants are those that `solve` starts from."""
        if self._engine is not None:
            self._engine.save(time)
            return
        for participant in self._participants:
            participant.save()

    def restore(self) -> None:
        """Take all participants back to their saved states, with the motions of those at the connections."""
        for participant in self._participants:
            participant.restore()
            participant.read()
        self.network.carry_motion()

    def accept(self, time: float, h: float) -> None:
        """Take the step from a time over h as made: wrenches for the next guess, states to solve from."""
        middle = time + 0.5 * h
        if self._engine is not None:
            self._engine.accept(middle, h)
            return
        self.accepted[:] = self.wrenches
        self._history.add(middle, self.wrenches, h)
        self.save(time + h)

    def restart(self) -> None:
        """Forget the wrenches of steps before: something jumped."""
        if self._engine is not None:
            self._engine.restart()
        else:
            self._history.clear()

    def predicted(self, time: float, h: float) -> Vector:
        """Wrenches to solve a step from: extrapolated over the last ones, or those accepted last."""
        middle = time + 0.5 * h
        if self._engine is not None:
            return self._engine.predicted(middle, h)
        found = self._history.extrapolated(middle, h)
        return self.accepted if found is None else found

    def error_square(self, time: float, h: float, energy: float) -> float | None:
        """Square of the relative error of the step solved last, see `local_error`; None with too few steps before.

        energy (J): what errors of the whole motion are judged beside.
        """
        middle = time + 0.5 * h
        if self._engine is not None:
            return self._engine.error_square(middle, h, energy)
        bend = self._history.curvature(middle, self.wrenches, h)
        if bend is None:
            return None
        accuracy = Accuracy(self._tolerated, self._round_off, self._extent.reach)
        return error_square(self.network, self._turned, bend, accuracy, self._watched, h, energy)

    def linearize(self, time: float, h: float) -> None:
        """Have the matrices of a step h in use, about the wrenches accepted last; participants end stepped."""
        self.wrenches[:] = self.accepted
        self.sweep(time, h)
        self._refresh(time, h, probe=True)

    def response(self, wrenches: Vector) -> Matrix:
        """Motions of all ports of bodies (ports, coordinates) under more wrenches (size,) over the step in use.

        Connections resist; motions are those of its end, in the coordinates of `interface_jacobian`.
        """
        assert self._factor_key is not None
        change = self._direction(wrenches)
        probes = self._mobilities[self._factor_key].probes
        moved = [
            probe.turned(first_port_axes(body.outputs)) @ change[rows]
            for probe, body, rows in zip(probes, self.network.bodies, self.network.rows, strict=True)
        ]
        result: Matrix = np.concatenate(moved).reshape(-1, self.network.width.coordinates)
        return result

    def watch(self, watched: Sequence[WatchedTorque]) -> None:
        """Judge these torques beside energies of their own from now on, and no others."""
        self._watched = watched
        if self._engine is not None:
            self._engine.watch(watched)

    def observe(self, time: float) -> Energies:
        """Put the observations of all participants into `observations`, bodies first; energies among them."""
        if self._engine is not None:
            return self._engine.observe(time)
        if self._participants:
            np.concatenate([p.observe() for p in self._participants], out=self.observations[:-1])
        return Energies(*self.observations.take(self._energy_rows).sum(axis=1).tolist())

    def forget(self) -> None:
        """The laws changed (an event): probe connections anew at the next solve."""
        self._stiffnesses.clear()
        self._factor_key = None

    def solve(self, time: float, h: float, guess: Vector) -> Solution:
        """Find the wrenches of the step from the saved states; participants end stepped when it converges."""
        iterate = self._iterate if self._engine is None else self._iterate_in_engine
        solution = self._attempt(iterate, time, h, guess)
        if not solution.converged:
            self.forget()
            near = self.tolerance.is_near(solution.correction)
            again = self._attempt(iterate, time, h, self.wrenches.copy() if near else guess)
            solution = again._replace(iterations=solution.iterations + again.iterations)
        if self.persistent and not solution.converged:
            again = self._attempt(self._damped, time, h, guess)
            solution = again._replace(iterations=solution.iterations + again.iterations)
        return solution

    def _attempt(
        self, iterate: Callable[[float, float], Solution], time: float, h: float, guess: Vector
    ) -> Solution:
        """One way of iterating, from a guess; a participant that refuses to step ends it."""
        self.wrenches[:] = guess
        try:
            return iterate(time, h)
        except ParticipantError as error:
            self._factor_key = None
            return Solution(False, 1, np.inf, 0, error)

    def _iterate(self, time: float, h: float) -> Solution:
        steps: list[Vector] = []
        scale = np.ones(0)
        last = np.inf
        for iteration in range(1, convergence.MAX_ITERATIONS + 1):
            self.sweep(time, h)
            residual = self._law - self.wrenches
            if not np.all(np.isfinite(residual)):
                return Solution(False, iteration, np.inf, int(np.argmin(np.isfinite(residual))))
            if self._factor_key != (self.mode, h):
                self._factorize(time, h)
            direction = self._direction(residual)
            if iteration == 1:
                scale = self.tolerance.scale(self.wrenches + direction)
            correction = broyden(direction / scale, steps)
            size = float(np.abs(correction).max(initial=0.0))
            settled = self._settled(size, residual, scale)
            if settled and (
                last <= 1.0 or iteration == convergence.MAX_ITERATIONS or self._agrees(residual, scale)
            ):
                self._tolerated = scale * min(size, 1.0)
                return Solution(True, iteration, size, 0)
            if size > convergence.DIVERGED * last or (size <= 1.0 and not settled):
                break
            if size > convergence.SLOW * last and iteration in convergence.REFRESHED:
                probe = iteration > convergence.REFRESHED[0]
                self._endured += probe
                late = self._endured > convergence.PATIENCE or convergence.is_too_slow(size, last, iteration)
                if late or not probe:
                    self._refresh(time, h, probe=probe)
                    steps.clear()
                    correction = self._direction(residual) / scale
            last = size
            steps.append(correction)
            self.wrenches += correction * scale
        return Solution(False, iteration, size, int(np.argmax(np.abs(correction))))

    def _iterate_in_engine(self, time: float, h: float) -> Solution:
        """The same as `_iterate`, but for the probing of participants, in C."""
        engine = self._engine
        assert engine is not None
        engine.tolerate(self.tolerance.relative, self.tolerance.force, self.tolerance.torque)
        key = (self.mode, h)
        status = engine.iterate(time, h, self._factor_key == key)
        while status in (Status.WANTS_MATRICES, Status.WANTS_PROBES):
            again = status == Status.WANTS_PROBES
            self._factor_key = None
            if again:
                self._stiffnesses.pop(key, None)
            engine.use(*self._probed(key, time))
            self._factor_key = key
            status = engine.resume(time, h, again=again)
        return Solution(status == Status.CONVERGED, engine.iteration, engine.correction, engine.worst_row)

    def _damped(self, time: float, h: float) -> Solution:
        """Newton with all matrices of the present wrenches, each correction halved until it makes progress."""
        solution = Solution(False, 0, np.inf, 0)
        residual = self._residual(time, h)
        for iteration in range(1, _MAX_DAMPED + 1):
            if residual is None:
                break
            self._mobilities.pop((self.mode, h), None)
            self._refresh(time, h, probe=True)
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
        """Go along a correction as far as the next one, by the same matrices, is smaller; residual there."""
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
        residual: Vector = self._law - self.wrenches
        return residual if bool(np.all(np.isfinite(residual))) else None

    def _settled(self, correction: float, residual: Vector, scale: Vector) -> bool:
        """Whether the scaled correction is small, or ports cannot agree better for the rounding of their poses.

        Rounding of absurd trial wrenches says nothing.
        """
        if correction <= 1.0:
            return is_credible(self.wrenches, residual)
        rounded = self._round_off + convergence.ROUND_OFF / self.tolerance.relative * scale
        return self.tolerance.is_near(correction) and bool(np.all(np.abs(residual) <= rounded))

    def _agrees(self, residual: Vector, scale: Vector) -> bool:
        """Whether residuals are as small as the accuracy asked of the recorded loads, or as rounding lets them be.

        A stiff joint turns a small correction into a residual that is large beside it.
        """
        return bool(np.all(np.abs(residual) <= np.maximum(convergence.AGREED * scale, self._round_off)))

    def _refresh(self, time: float, h: float, *, probe: bool) -> None:
        """Turn the probed matrices to the present orientations, or probe the connections anew."""
        self._factor_key = None
        if probe:
            self._endured = 0
            self._stiffnesses.pop((self.mode, h), None)
        self._factorize(time, h)

    def sweep(self, time: float, h: float) -> None:
        """Bodies under the wrenches, then connections over the motions, all from their saved states."""
        if self._engine is not None:
            self._engine.sweep(time, h)
            return
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
        network.collect_wrenches(self._law)

    def _direction(self, residual: Vector) -> Vector:
        return self._system.solve(residual) if self._engine is None else self._engine.direction(residual)

    def _probed(self, key: tuple[str, float], time: float) -> tuple[Matrices, Matrices]:
        """Matrices of all bodies and of all connections at their last motions, probed where they are not known."""
        network, h = self.network, key[1]
        if key not in self._mobilities or key not in self._stiffnesses:
            self._probe_bodies(key, time)
        if key not in self._stiffnesses:
            self.probes += 1
            self._stiffnesses[key] = Matrices(
                stiffness_of(connection, places, network.width, time, h)
                for connection, places in zip(network.connections, network.connection_places, strict=True)
            )
        return self._mobilities[key], self._stiffnesses[key]

    def _probe_bodies(self, key: tuple[str, float], time: float) -> None:
        """Mobilities of all bodies but those that are known and constant, which are only turned along."""
        network = self.network
        known = self._mobilities.get(key)
        if known and all(body.constant_mobility for body in network.bodies):
            return
        self.probes += 1
        self._mobilities[key] = Matrices(
            known.probes[number]
            if known and body.constant_mobility
            else mobility_of(body, places, network.width, time, key[1])
            for number, (body, places) in enumerate(zip(network.bodies, network.body_places, strict=True))
        )

    def _factorize(self, time: float, h: float) -> None:
        """LU factors of I - stiffness x mobility, from probes turned to the present orientations."""
        key = (self.mode, h)
        mobilities, stiffnesses = self._probed(key, time)
        if self._engine is not None:
            self._engine.use(mobilities, stiffnesses)
            self._engine.assemble()
        else:
            self._factorize_here(mobilities, stiffnesses, h)
        self._factor_key = key

    def _factorize_here(self, mobilities: Matrices, stiffnesses: Matrices, h: float) -> None:
        network = self.network
        self._turned = [
            probe.turned(first_port_axes(body.outputs))
            for probe, body in zip(mobilities.probes, network.bodies, strict=True)
        ]
        turned_stiffnesses = [
            probe.turned(first_port_axes(connection.inputs))
            for probe, connection in zip(stiffnesses.probes, network.connections, strict=True)
        ]
        self._system.factorize(self._turned, turned_stiffnesses)
        self._extent = Extent.of(
            connection.inputs[: 13 * len(ports)]
            for connection, ports in zip(network.connections, network.connection_ports, strict=True)
        )
        for index, stiffness in zip(network.connection_rows, turned_stiffnesses, strict=True):
            self._round_off[index] = round_off(stiffness, network.width, self._extent, h)
