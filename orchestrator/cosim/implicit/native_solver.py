"""The coupled step in C, fmus/native/coupling: its structures, filled once from a network, then a few calls a step."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import CDLL, addressof, c_void_p
from enum import IntEnum
from math import inf, isnan, nan
from typing import Any

import numpy as np

from ..energy_balance import Energies
from ..native.library import POINTS, Allowed, Calls, Limits, LoopData, NetworkData, PortWidth, Watched
from ..network import Network
from ..participant import NativeAccess, ParticipantError, Vector
from ..ports import carried
from . import convergence
from .convergence import LAST_REFRESHED, Solution, Tolerance
from .elimination import eliminate
from .history import Table
from .interface_jacobian import Matrices
from .local_error import NO_LOAD, WeightedLoad
from .solver import Solver

_LIMITS = Limits(
    convergence.SLOW,
    convergence.DIVERGED,
    convergence.STEEPEST,
    convergence.ROUND_OFF,
    convergence.NEAR,
    convergence.CREDIBLE,
    convergence.AGREED,
    convergence.OVERSHOT,
    convergence.ROUGH,
    convergence.LEAST_REACH,
    NO_LOAD,
    convergence.PATIENCE,
    convergence.MAX_ITERATIONS,
    convergence.HALVINGS,
    convergence.REFRESHED,
)


class Status(IntEnum):
    """How an iteration ended, as in coupled_step.h."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    REFUSED = 2
    NOT_FINITE = 3
    WANTS_MATRICES = 4
    WANTS_EVALUATION = 5


class Stop(IntEnum):
    """Why plain steps ended, as in loop.h."""

    PAUSED = 0
    STANDS = 1
    UNSOLVED = 2
    UNGUARDED = 3
    NEEDS_MATRICES = 4
    NEEDS_EVALUATION = 5
    FAILED = 6


class NativeSolver(Solver):
    """Has the compiled library sweep and iterate; Python evaluates interface Jacobians when it wants them."""

    def __init__(
        self, network: Network, tolerance: Tolerance, participants: Sequence[NativeAccess], compiled: CDLL
    ) -> None:
        super().__init__(network, tolerance)
        self._participants = participants
        self._library = compiled
        self._calls = (Calls * len(participants))(*(p.calls for p in participants))
        self._memory: list[Any] = []
        self._energies = np.zeros(len(Energies._fields))
        self._guess = np.zeros(network.size)
        self._guess_address = self._guess.ctypes.data
        self._data = NetworkData(
            participants=len(participants),
            bodies=len(network.bodies),
            links=len(network.meetings),
            size=network.size,
            width=PortWidth(*network.width),
            energy_kinds=len(Energies._fields),
            limits=_LIMITS,
            participant=addressof(self._calls),
        )
        self.address = addressof(self._data)
        self._pointer = c_void_p(self.address)
        self._provide_memory()
        self._connect_calls()
        self._arrange(frozenset())

    def _provide_memory(self) -> None:
        """All memory that is ever needed but that of the linear system."""
        network, data, most = self.network, self._data, _LIMITS.most
        size, wrench = network.size, network.width.wrench
        shared = {
            "wrenches": self.wrenches,
            "accepted": self.accepted,
            "law": self._response,
            "round_off": self._round_off,
            "observations": self.observations,
            "energy_rows": self._energy_rows,
            "energies": self._energies,
        }
        largest = wrench**2 * max(map(len, network.connection_ports)) * max(map(len, network.body_ports))
        lengths = dict.fromkeys(("residual", "scale", "bend", "noise"), size)
        lengths |= {"steps": most * size, "squares": most, "product": largest}
        for name, array in (shared | {name: np.zeros(length) for name, length in lengths.items()}).items():
            setattr(data, name, self._keep(array))
        self._past = np.zeros((POINTS, size))
        data.history.values = self._keep(self._past)

    def _connect_calls(self) -> None:
        """Tell of every participant's ports, what it exchanges, and where its observations and its matrix go."""
        network, (wrench, coordinates) = self.network, self.network.width
        rows = [*(np.arange(r.start, r.stop) for r in network.rows), *network.connection_rows]
        places = [*network.body_places, *network.connection_places]
        first = 0
        self._turned = []
        for participant, calls, place, found in zip(
            network.participants, self._calls, places, rows, strict=True
        ):
            calls.ports, calls.slopes, calls.moments = place.ports, place.slopes or 0, place.moments or 0
            calls.inputs = carried(participant.input_layout, network.order)
            calls.outputs = carried(participant.output_layout, network.order)
            calls.observation = self.observations[first:].ctypes.data
            first += participant.observation_layout.size
            calls.links = self._keep((found[::wrench] // wrench).astype(np.uintp))
            self._turned.append(self._keep(np.zeros(wrench * coordinates * place.ports**2)))
            calls.turned = self._turned[-1]

    def _arrange(self, still: frozenset[int]) -> None:
        """Tables of indices and room for the linear system without the bodies that never move."""
        self._still, meetings = still, self.network.meetings
        order = eliminate(meetings, self.network.width.wrench, still)
        first = self._data.bodies
        link = [
            (m.body, m.body_port, first + m.connection, m.connection_port, place)
            for m, place in zip(meetings, order.place.tolist(), strict=True)
        ]
        self._data.link = self._keep(np.array(link, dtype=np.uintp))
        self._data.parts = self._keep(order.parts)
        matrix, size = self._data.matrix, self._data.size
        matrix.groups, matrix.block_count = len(order.begin) - 1, len(order.blocks)
        matrix.size, matrix.length = size, order.length
        for name in ("begin", "blocks", "lower_begin", "lower", "upper_begin", "upper", "targets"):
            setattr(matrix, name, self._keep(getattr(order, name)))
        for name, length in (("values", order.length), ("transposed", order.length), ("ordered", size)):
            setattr(matrix, name, self._keep(np.zeros(length)))
        matrix.pivots = self._keep(np.zeros(size, dtype=np.uintp))
        for body in range(first):
            self._calls[body].turned = None if body in still else self._turned[body]

    def _keep(self, array: np.ndarray[Any, Any]) -> int:
        """The address of an array that lives as long as the solver."""
        self._memory.append(np.ascontiguousarray(array))
        return int(self._memory[-1].ctypes.data)

    def costs(self) -> tuple[int, float]:
        """As the library counts and measures them."""
        return self._data.sweeps, self._data.seconds

    def sweep(self, time: float, h: float) -> None:
        """Bodies, then connections."""
        self._check(self._library.coupling_sweep(self._pointer, time, h), time, h)

    def save(self, time: float) -> None:
        """Every participant into its slot."""
        self._check(self._library.coupling_save(self._pointer), time)

    def accept(self, time: float, h: float) -> None:
        """Remember the wrenches, save the states."""
        self._check(self._library.coupling_accept(self._pointer, time + 0.5 * h, h), time + h)

    def restart(self) -> None:
        """Clear the history."""
        self._library.coupling_restart(self._pointer)

    def past(self) -> tuple[Table, Table]:
        """Out of the library's memory."""
        history = self._data.history
        first = POINTS - history.count
        return np.array(history.times[first:]), self._past[first:].copy()

    def remember(self, times: Table, values: Table) -> None:
        """Into the library's memory."""
        history = self._data.history
        history.count = len(times)
        history.times[POINTS - len(times) :] = times.tolist()
        self._past[POINTS - len(times) :] = values

    def predicted(self, time: float, h: float) -> Vector:
        """From the history, where there is one; an array of the solver's own, written anew by every call."""
        self._library.coupling_predict(self._pointer, time + 0.5 * h, h, self._guess_address)
        return self._guess

    def error_square(self, time: float, h: float, energy: float) -> float | None:
        """From the bend of the history."""
        square: float = self._library.coupling_error_square(self._pointer, time + 0.5 * h, h, energy)
        return None if isnan(square) else square

    def watch(self, watched: Sequence[WeightedLoad]) -> None:
        """Hand them over."""
        first = self._data.bodies
        self._watched = (Watched * len(watched))(
            *(Watched(first + w.connection, w.port, w.row, w.axis, w.weight) for w in watched)
        )
        self._data.watched, self._data.watched_count = addressof(self._watched), len(watched)

    def observe(self, time: float) -> Energies:
        """Have all asked in one call."""
        self._check(self._library.coupling_observe(self._pointer), time)
        return self.energies

    @property
    def energies(self) -> Energies:
        """As last observed."""
        return Energies(*self._energies.tolist())

    def follow(self, loop: LoopData) -> tuple[Stop, Solution]:
        """Plain steps of a loop from where it stands; why it stopped, and the solution of the step at hand."""
        self._allow()
        loop.ready_step, loop.status = nan if self._in_use is None else self._in_use, Status.CONVERGED
        address, solution = addressof(loop), Solution(True, 0, 0.0, 0)
        try:
            stop = Stop(self._library.coupling_follow(address))
            while stop in (Stop.NEEDS_MATRICES, Stop.NEEDS_EVALUATION):
                self._provide(loop.h, loop.time, again=stop == Stop.NEEDS_EVALUATION)
                stop = Stop(self._library.coupling_follow(address))
            solution = self._solution(loop.status, loop.time, loop.h)
        except ParticipantError as error:
            self._in_use = None
            return Stop.UNSOLVED, solution._replace(converged=False, correction=inf, failure=error)
        if not isnan(loop.ready_step):
            self._in_use = loop.ready_step
        if stop == Stop.FAILED:
            self._check(False, loop.time + loop.h)
        return stop, solution

    def _allow(self) -> None:
        allowed = self.tolerance
        self._data.tolerance = Allowed(allowed.relative, allowed.force, allowed.torque, allowed.residual)

    def _provide(self, h: float, time: float, *, again: bool) -> None:
        """Have the matrices of a step in use, as the iteration wants; again: others than those it has."""
        self._in_use = None
        if again:
            self.jacobian.outdate(h, bodies=self._data.iteration == LAST_REFRESHED)
        self._use(*self.jacobian.matrices(h, time))
        self._in_use = h

    def _solution(self, status: int, time: float, h: float) -> Solution:
        """What the iteration came to; ParticipantError where a participant refused."""
        data = self._data
        self._check(status != Status.REFUSED, time, h)
        return Solution(status == Status.CONVERGED, data.iteration, data.correction, data.worst_row)

    def _iterate(self, time: float, h: float) -> Solution:
        self._allow()
        status = self._library.coupling_iterate(self._pointer, time, h, bool(self._in_use == h))
        while status in (Status.WANTS_MATRICES, Status.WANTS_EVALUATION):
            again = status == Status.WANTS_EVALUATION
            self._provide(h, time, again=again)
            status = self._library.coupling_resume(self._pointer, again)
        return self._solution(status, time, h)

    def _use(self, mobilities: Matrices, stiffnesses: Matrices) -> None:
        """Take matrices of all bodies and of all connections; a body without mobility leaves the linear system."""
        if mobilities.zeros != self._still:
            self._arrange(mobilities.zeros)
        self._matrices = (mobilities, stiffnesses)
        self._data.mobility = mobilities.addresses.ctypes.data
        self._data.stiffness = stiffnesses.addresses.ctypes.data

    def _factorize(self, mobilities: Matrices, stiffnesses: Matrices, h: float) -> None:
        self._use(mobilities, stiffnesses)
        self._library.coupling_assemble(self._pointer)

    def _direction(self, residual: Vector) -> Vector:
        result = np.empty(self.network.size)
        self._library.coupling_direction(self._pointer, residual.ctypes.data, result.ctypes.data)
        return result

    def _check(self, fine: int, time: float, h: float = 0.0) -> None:
        """ParticipantError with the words of the one that failed."""
        if fine:
            return
        data = self._data
        raise self._participants[data.failed].failure(data.failed_call, data.failed_status, time, h)
