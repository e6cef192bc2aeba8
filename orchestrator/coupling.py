"""One coupled step: the wrenches at all ports such that bodies and connections agree.

Residual: wrenches that the connections return for the motions that the wrenches cause, minus the
wrenches. A chord Newton iteration on the probed interface Jacobian, sharpened by Broyden's update.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from .engine import Engine, Limits, Status
from .interface import Matrix, Probe, first_port_axes, mobility_of, stiffness_of
from .network import Network
from .participant import ParticipantError, Vector
from .sparse import SparseSystem

_MAX_ITERATIONS = 14
_REFRESHED = (2, 4, 8)
"""Iterations after which slow contraction has matrices refreshed: first only turned, then probed anew."""
_SLOW = 0.15
_DIVERGED = 50.0
_STEEPEST = 0.9
_ROUND_OFF = 8.0 * float(np.finfo(float).eps)
_NEAR = 1e-2
"""Largest relative correction of wrenches that are near a solution; beyond it they may be absurd."""
_CREDIBLE = 1e12
"""Largest residual over wrench at a solution; stiff joints leave up to 1e5, matrices of an absurd motion 1e30."""
_MAX_DAMPED = 30
_SMALLEST_SHARE = 1e-3


@dataclass(frozen=True, slots=True)
class Solution:
    """Outcome of a coupled step: whether it converged, sweeps taken, size of the last correction (scaled).

    failure: what a participant said that refused a sweep, as it may under absurd wrenches of an iteration.
    """

    converged: bool
    iterations: int
    correction: float
    worst_row: int
    failure: ParticipantError | None = None


@dataclass(slots=True)
class Tolerance:
    """When the correction of the wrenches is small: relative to the largest force and torque, and to these."""

    relative: float
    force: float = 1.0
    torque: float = 1.0

    def scale(self, wrenches: Vector) -> Vector:
        """What a correction of 1 means for every row."""
        table = np.abs(wrenches).reshape(-1, 2, 3)
        force = self.relative * (self.force + float(table[:, 0].max(initial=0.0)))
        torque = self.relative * (self.torque + float(table[:, 1].max(initial=0.0)))
        return np.tile(np.repeat((force, torque), 3), len(table))


class Coupling:
    """Solves coupled steps from the participants' saved states and leaves them stepped.

    `wrenches` holds the solution of the last solve. `mode` tells probed mobilities of different parameter
    sets apart (static against dynamic). `persistent` asks for a slow damped iteration before giving up, where
    the step cannot be made smaller. `observations` are those of the last `observe`, one participant's after
    the other's, and a zero. A network of FMUs is iterated by the engine in C, any other one here.
    """

    def __init__(self, network: Network, tolerance: Tolerance) -> None:
        self.network = network
        self.tolerance = tolerance
        self.wrenches = np.zeros(network.size)
        self.mode = "dynamic"
        self.persistent = False
        self.probes = 0
        self._sweeps = 0
        self._law = np.zeros(network.size)
        self._round_off = np.zeros(network.size)
        self._mobilities: dict[tuple[str, float], list[Probe]] = {}
        self._stiffnesses: dict[tuple[str, float], list[Probe]] = {}
        self._factor_key: tuple[str, float] | None = None
        self._participants = [*network.bodies, *network.connections]
        self.observations = np.zeros(sum(p.observation_layout.size for p in self._participants) + 1)
        self._engine: Engine | None = None
        if Engine.serves(network):
            limits = Limits(
                _SLOW, _DIVERGED, _STEEPEST, _ROUND_OFF, _NEAR, _CREDIBLE, _MAX_ITERATIONS, _REFRESHED
            )
            shared = (self.wrenches, self._law, self._round_off, self.observations)
            self._engine = Engine(network, limits, *shared)
        else:
            self._system = SparseSystem(network)

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

    def observe(self, time: float) -> None:
        """Put the observations of all participants into `observations`, bodies first."""
        if self._engine is not None:
            self._engine.observe(time)
        elif self._participants:
            np.concatenate([p.observe() for p in self._participants], out=self.observations[:-1])

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
            near = self._is_near(solution.correction)
            again = self._attempt(iterate, time, h, self.wrenches.copy() if near else guess)
            solution = replace(again, iterations=solution.iterations + again.iterations)
        if self.persistent and not solution.converged:
            again = self._attempt(self._damped, time, h, guess)
            solution = replace(again, iterations=solution.iterations + again.iterations)
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
        for iteration in range(1, _MAX_ITERATIONS + 1):
            self.sweep(time, h)
            residual = self._law - self.wrenches
            if not np.all(np.isfinite(residual)):
                return Solution(False, iteration, np.inf, int(np.argmin(np.isfinite(residual))))
            if self._factor_key != (self.mode, h):
                self._factorize(time, h)
            direction = self._direction(residual)
            if iteration == 1:
                scale = self.tolerance.scale(self.wrenches + direction)
            correction = _broyden(direction / scale, steps)
            size = float(np.abs(correction).max(initial=0.0))
            if self._settled(size, residual):
                return Solution(True, iteration, size, 0)
            if size > _DIVERGED * last or size <= 1.0:
                break
            if size > _SLOW * last and iteration in _REFRESHED:
                self._refresh(time, h, probe=iteration > _REFRESHED[0])
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
            engine.use(self._probed(key, time))
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
            converged = self._settled(size, residual)
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

    def _is_near(self, correction: float) -> bool:
        """Whether a scaled correction is small enough for the wrenches to be those of a solution nearby."""
        return correction * self.tolerance.relative <= _NEAR

    def _settled(self, correction: float, residual: Vector) -> bool:
        """Whether the scaled correction is small, or ports cannot agree better for the rounding of their poses.

        A correction says nothing of a motion gone astray, whose matrices make any residual small, nor does
        rounding of absurd trial wrenches.
        """
        if correction <= 1.0:
            wrench = 1.0 + float(np.abs(self.wrenches).max(initial=0.0))
            return float(np.abs(residual).max(initial=0.0)) <= _CREDIBLE * wrench
        return self._is_near(correction) and bool(np.all(np.abs(residual) <= self._round_off))

    def _refresh(self, time: float, h: float, *, probe: bool) -> None:
        """Turn the probed matrices to the present orientations, or probe the connections anew."""
        self._factor_key = None
        if probe:
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

    def work(self, h: float, change: Vector) -> float:
        """Work (J) that a change of wrenches does on the motion it causes in a step of size h."""
        if self._engine is not None:
            return self._engine.work(change)
        total = 0.0
        for rows, probe in zip(self.network.rows, self._mobilities[(self.mode, h)], strict=True):
            moved = (probe.matrix @ change[rows]).reshape(-1, 12)[:, :6]
            total += float(moved.ravel() @ change[rows])
        return total

    def _direction(self, residual: Vector) -> Vector:
        return self._system.solve(residual) if self._engine is None else self._engine.direction(residual)

    def _probed(self, key: tuple[str, float], time: float) -> list[Probe]:
        """Matrices of all bodies and of all connections at their last motions, probed where they are not known."""
        network, h = self.network, key[1]
        if key not in self._mobilities:
            self.probes += 1
            self._mobilities[key] = [
                mobility_of(body, len(ports), time, h)
                for body, ports in zip(network.bodies, network.body_ports, strict=True)
            ]
        if key not in self._stiffnesses:
            self.probes += 1
            self._stiffnesses[key] = [
                stiffness_of(connection, len(ports), time, h)
                for connection, ports in zip(network.connections, network.connection_ports, strict=True)
            ]
        return self._mobilities[key] + self._stiffnesses[key]

    def _factorize(self, time: float, h: float) -> None:
        """LU factors of I - stiffness x mobility, from probes turned to the present orientations."""
        key = (self.mode, h)
        probes = self._probed(key, time)
        if self._engine is not None:
            self._engine.use(probes)
            self._engine.assemble()
        else:
            network = self.network
            motions = [b.outputs for b in network.bodies] + [c.inputs for c in network.connections]
            turned = [p.turned(first_port_axes(m)) for p, m in zip(probes, motions, strict=True)]
            first = len(network.bodies)
            self._system.factorize(turned[:first], turned[first:])
            rate = max(
                _largest_rate(connection.inputs, len(ports))
                for connection, ports in zip(network.connections, network.connection_ports, strict=True)
            )
            for connection, index, stiffness in zip(
                network.connections, network.connection_rows, turned[first:], strict=True
            ):
                self._round_off[index] = _round_off(stiffness, connection.inputs, rate)
        self._factor_key = key


def _largest_rate(motion: Vector, ports: int) -> float:
    """Largest component of the velocities (m/s) and angular velocities (rad/s) of a connection's ports."""
    return float(np.abs(motion[: 13 * ports].reshape(-1, 13)[:, 7:]).max())


def _round_off(stiffness: Matrix, motion: Vector, rate: float) -> Vector:
    """Wrenches that the rounding of a connection's poses and rates makes: ports cannot agree better than that.

    rate: largest in the network; a port that a latch just stopped still sums terms of that size.
    """
    sizes = np.full((len(stiffness) // 6, 12), rate)
    sizes[:, :3] = np.abs(motion[: 13 * len(sizes)].reshape(-1, 13)[:, :3]).max(axis=1, keepdims=True)
    sizes[:, 3:6] = 1.0
    result: Vector = _ROUND_OFF * (np.abs(stiffness) @ sizes.ravel())
    return result


def _broyden(direction: Vector, steps: list[Vector]) -> Vector:
    """Broyden's update of a chord Newton direction from the steps taken so far (scaled), without a matrix."""
    for before, after in pairwise(steps):
        direction = direction + after * (float(before @ direction) / float(before @ before))
    if steps:
        newest = steps[-1]
        slope = float(newest @ direction) / float(newest @ newest)
        if slope < _STEEPEST:
            direction = direction / (1.0 - slope)
    return direction
