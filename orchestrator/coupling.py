"""One coupled step: the wrenches at all ports such that bodies and connections agree.

Residual: wrenches that the connections return for the motions that the wrenches cause, minus the
wrenches. A chord Newton iteration on the probed interface Jacobian, sharpened by Broyden's update.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, lu_factor, lu_solve

from .interface import Matrix, Probe, first_port_axes, probe_mobility, probe_stiffness
from .network import Network
from .participant import ParticipantError, Vector

_MAX_ITERATIONS = 14
_SLOW = 0.15
_DIVERGED = 50.0
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
    the step cannot be made smaller.
    """

    def __init__(self, network: Network, tolerance: Tolerance) -> None:
        self.network = network
        self.tolerance = tolerance
        self.wrenches = np.zeros(network.size)
        self.mode = "dynamic"
        self.persistent = False
        self.sweeps = 0
        self.probes = 0
        self._law = np.zeros(network.size)
        self._round_off = np.zeros(network.size)
        self._mobilities: dict[tuple[str, float], list[Probe]] = {}
        self._stiffnesses: dict[tuple[str, float], list[Probe]] = {}
        self._factor_key: tuple[str, float] | None = None
        self._factors: tuple[Matrix, Any] = lu_factor(np.eye(network.size))

    def forget(self) -> None:
        """The laws changed (an event): probe connections anew at the next solve."""
        self._stiffnesses.clear()
        self._factor_key = None

    def solve(self, time: float, h: float, guess: Vector) -> Solution:
        """Find the wrenches of the step from the saved states; participants end stepped when it converges."""
        solution = self._attempt(self._iterate, time, h, guess)
        if not solution.converged:
            self.forget()
            finite = bool(np.all(np.isfinite(self.wrenches)))
            again = self._attempt(self._iterate, time, h, self.wrenches.copy() if finite else guess)
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
            if size <= 1.0 or bool(np.all(np.abs(residual) <= self._round_off)):
                return Solution(True, iteration, size, 0)
            if size > _DIVERGED * last:
                break
            if size > _SLOW * last and iteration in (2, 4, 8):
                self._refresh(time, h, probe=iteration > 2)
                steps.clear()
                correction = self._direction(residual) / scale
            last = size
            steps.append(correction)
            self.wrenches += correction * scale
        return Solution(False, iteration, size, int(np.argmax(np.abs(correction))))

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
            converged = size <= 1.0 or bool(np.all(np.abs(residual) <= self._round_off))
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

    def _refresh(self, time: float, h: float, *, probe: bool) -> None:
        """Turn the probed matrices to the present orientations, or probe the connections anew."""
        self._factor_key = None
        if probe:
            self._stiffnesses.pop((self.mode, h), None)
        self._factorize(time, h)

    def sweep(self, time: float, h: float) -> None:
        """Bodies under the wrenches, then connections over the motions, all from their saved states."""
        network = self.network
        self.sweeps += 1
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
        total = 0.0
        for rows, probe in zip(self.network.rows, self._mobilities[(self.mode, h)], strict=True):
            moved = (probe.matrix @ change[rows]).reshape(-1, 12)[:, :6]
            total += float(moved.ravel() @ change[rows])
        return total

    def _direction(self, residual: Vector) -> Vector:
        result: Vector = lu_solve(self._factors, residual, check_finite=False)
        return result

    def _factorize(self, time: float, h: float) -> None:
        """LU factors of I - stiffness x mobility, from probes turned to the present orientations."""
        key = (self.mode, h)
        if key not in self._mobilities:
            self.probes += 1
            self._mobilities[key] = [
                probe_mobility(body, len(ports), time, h)
                for body, ports in zip(self.network.bodies, self.network.body_ports, strict=True)
            ]
        if key not in self._stiffnesses:
            self.probes += 1
            self._stiffnesses[key] = [
                probe_stiffness(connection, len(ports), time, h)
                for connection, ports in zip(
                    self.network.connections, self.network.connection_ports, strict=True
                )
            ]
        size = self.network.size
        mobility = np.zeros((2 * size, size))
        for body, rows, probe in zip(
            self.network.bodies, self.network.rows, self._mobilities[key], strict=True
        ):
            mobility[2 * rows.start : 2 * rows.stop, rows] = probe.turned(first_port_axes(body.outputs))
        matrix = np.eye(size)
        rate = max(
            _largest_rate(connection.inputs, len(ports))
            for connection, ports in zip(self.network.connections, self.network.connection_ports, strict=True)
        )
        for connection, index, probe in zip(
            self.network.connections, self.network.connection_rows, self._stiffnesses[key], strict=True
        ):
            motion_rows = (2 * index.reshape(-1, 6)[:, :1] + np.arange(12)).ravel()
            stiffness = probe.turned(first_port_axes(connection.inputs))
            matrix[index] -= stiffness @ mobility[motion_rows]
            self._round_off[index] = _round_off(stiffness, connection.inputs, rate)
        try:
            self._factors = lu_factor(matrix, check_finite=False)
        except (LinAlgError, ValueError):
            self._factors = lu_factor(np.eye(size))
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
    result: Vector = 8.0 * np.finfo(float).eps * (np.abs(stiffness) @ sizes.ravel())
    return result


def _broyden(direction: Vector, steps: list[Vector]) -> Vector:
    """Broyden's update of a chord Newton direction from the steps taken so far (scaled), without a matrix."""
    for before, after in pairwise(steps):
        direction = direction + after * (float(before @ direction) / float(before @ before))
    if steps:
        newest = steps[-1]
        slope = float(newest @ direction) / float(newest @ newest)
        if slope < 0.9:
            direction = direction / (1.0 - slope)
    return direction
