"""The coupled step in C: the structures of native/coupling.c, filled once from a network of FMUs.

After that a step costs a few calls. Where the library is missing (an installation without a compiler) or a
participant is no FMU, there is no engine, and orchestrator/cosim/implicit/coupling.py does the same in Python.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from ctypes import (
    CDLL,
    POINTER,
    Structure,
    addressof,
    byref,
    c_double,
    c_int,
    c_size_t,
    c_void_p,
    sizeof,
)
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cache
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..energy_balance import Energies, Rows
from ..fmu import Calls, FmuParticipant
from ..network import WIDTHS, Matrix, Meeting, Network, PortPlaces, Width, carried
from ..participant import ParticipantError, Vector
from .elimination import eliminate

if TYPE_CHECKING:
    from .interface_jacobian import Probe
    from .local_error import WatchedTorque

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
LIBRARY = Path(__file__).parents[1] / "native" / f"_coupling{_SUFFIX.get(sys.platform, '.so')}"
_MISSING = "the engine was not built"
_POINTS = 3


class Status(IntEnum):
    """How an iteration ended, as in native/coupling.c."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    REFUSED = 2
    NOT_FINITE = 3
    WANTS_MATRICES = 4
    WANTS_PROBES = 5


class Limits(Structure):
    """Numbers of the iteration; their values stand in orchestrator/cosim/implicit/convergence.py."""

    _fields_ = (
        ("slow", c_double),
        ("diverged", c_double),
        ("steepest", c_double),
        ("round_off", c_double),
        ("near", c_double),
        ("credible", c_double),
        ("agreed", c_double),
        ("patience", c_size_t),
        ("most", c_size_t),
        ("refreshed", c_size_t * 3),
    )


class _Probe(Structure):
    _fields_ = (("matrix", c_void_p), ("axes", c_void_p))


class _Matrix(Structure):
    _fields_ = (
        *((name, c_size_t) for name in ("groups", "block_count", "size", "length")),
        *(
            (name, c_void_p)
            for name in (
                *("begin", "blocks", "lower_begin", "lower", "upper_begin", "upper", "targets"),
                *("values", "transposed", "pivots", "ordered"),
            )
        ),
    )


class _Watched(Structure):
    _fields_ = (
        *((name, c_size_t) for name in ("connection", "port", "row")),
        ("axis", c_double * 3),
        ("weight", c_double),
    )


class _History(Structure):
    _fields_ = (("count", c_size_t), ("times", c_double * _POINTS), ("values", c_void_p))


class _Network(Structure):
    _fields_ = (
        *((name, c_size_t) for name in ("participants", "bodies", "links", "size", "wrench", "coordinates")),
        *(
            (name, c_void_p)
            for name in (
                *("participant", "link", "mobility", "stiffness", "parts", "wrenches", "accepted", "law"),
                *("residual", "scale", "round_off", "steps", "squares", "product", "bend", "noise"),
                *("observations", "energy_rows", "watched"),
            )
        ),
        ("watched_count", c_size_t),
        ("limits", Limits),
        *((name, c_double) for name in ("relative", "force", "torque")),
        ("matrix", _Matrix),
        ("history", _History),
        ("energies", c_double * len(Energies._fields)),
        *((name, c_double) for name in ("time", "h", "last", "correction", "seconds", "reach")),
        *(
            (name, c_size_t)
            for name in (
                "iteration",
                "kept",
                "endured",
                "sweeps",
                "worst_row",
                "singular",
                "failed",
                "failed_call",
            )
        ),
        ("failed_status", c_int),
    )


_FUNCTIONS: dict[str, tuple[tuple[Any, ...], Any]] = {
    "sweep": ((c_void_p, c_double, c_double), c_int),
    "iterate": ((c_void_p, c_double, c_double, c_int), c_int),
    "resume": ((c_void_p, c_int), c_int),
    "assemble": ((c_void_p,), None),
    "direction": ((c_void_p, c_void_p, c_void_p), None),
    "predict": ((c_void_p, c_double, c_double, c_void_p), None),
    "error_square": ((c_void_p, c_double, c_double, c_double), c_double),
    "save": ((c_void_p,), c_int),
    "accept": ((c_void_p, c_double, c_double), c_int),
    "restart": ((c_void_p,), None),
    "observe": ((c_void_p,), c_int),
    "mobility": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
    "stiffness": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
}


@cache
def library() -> CDLL | None:
    """The compiled engine; None where it was not built, or was built from another version of its source."""
    try:
        found = CDLL(str(LIBRARY))
        sizes = (c_size_t * 2)()
        found.coupling_sizes(sizes)
        for name, (arguments, result) in _FUNCTIONS.items():
            function = getattr(found, f"coupling_{name}")
            function.argtypes, function.restype = arguments, result
    except (OSError, AttributeError):
        return None
    return found if list(sizes) == [sizeof(Calls), sizeof(_Network)] else None


def mobility(body: FmuParticipant, places: PortPlaces, width: Width) -> Matrix:
    """Mobility (coordinates, wrenches) of a body from the FMU's own derivatives over the step just made."""
    return _derivatives("mobility", body, (width.coordinates, width.wrench), places)


def stiffness(connection: FmuParticipant, places: PortPlaces, width: Width) -> Matrix:
    """Stiffness (wrenches, coordinates) of a connection from the FMU's own derivatives over the step just made."""
    return _derivatives("stiffness", connection, (width.wrench, width.coordinates), places)


def _derivatives(name: str, participant: FmuParticipant, shape: Sequence[int], places: PortPlaces) -> Matrix:
    """shape: rows and columns for one port."""
    found = library()
    if found is None:
        raise RuntimeError(_MISSING)
    calls = participant.calls
    _place(calls, places)
    matrix, slope = np.empty([count * places.ports for count in shape]), np.empty(calls.outputs)
    status = getattr(found, f"coupling_{name}")(
        byref(calls), matrix.ctypes.data, slope.ctypes.data, max(shape) > WIDTHS[2].coordinates
    )
    participant.check(status, "give derivatives")
    return matrix


def _place(calls: Calls, places: PortPlaces) -> None:
    """Tell the engine of a participant's ports."""
    calls.ports, calls.slopes, calls.moments = places.ports, places.slopes or 0, places.moments or 0


class Matrices:
    """Probed matrices of all bodies or of all connections, and the table of their addresses for the engine."""

    def __init__(self, probes: Iterable[Probe]) -> None:
        self.probes = list(probes)
        self._table = (_Probe * len(self.probes))(
            *(_Probe(probe.matrix.ctypes.data, probe.axes.ctypes.data) for probe in self.probes)
        )
        self.address = addressof(self._table)
        self.zeros = frozenset(i for i, probe in enumerate(self.probes) if not probe.matrix.any())


@dataclass(frozen=True, slots=True)
class Shared:
    """Arrays that the engine and its caller both see.

    wrenches, accepted, law, round_off (size,): the unknown, what it was in the last accepted step, what the
    connections return for it and how far that is rounded; observations: those of all participants in order,
    and a zero; energy_rows: where they hold energies, see `balance.energy_rows`.
    """

    wrenches: Vector
    accepted: Vector
    law: Vector
    round_off: Vector
    observations: Vector
    energy_rows: Rows


class Engine:
    """Sweeps and iterates a network of FMUs in C, remembers accepted steps and reads observations.

    `sweeps` and `seconds` count what was done since the start, the latter only the time inside FMUs.
    """

    def __init__(self, network: Network, limits: Limits, shared: Shared) -> None:
        found = library()
        if found is None:
            raise RuntimeError(_MISSING)
        self._participants: list[FmuParticipant] = [
            p for p in (*network.bodies, *network.connections) if isinstance(p, FmuParticipant)
        ]
        self._calls = (Calls * len(self._participants))(*(p.calls for p in self._participants))
        self._matrices: tuple[Matrices, ...] = ()
        self._watched: Any = None
        self._kept: list[Any] = [shared]
        self._turned: list[int] = []
        self._data = _Network(
            participants=len(self._participants),
            bodies=len(network.bodies),
            links=len(network.meetings),
            size=network.size,
            wrench=network.width.wrench,
            coordinates=network.width.coordinates,
            limits=limits,
            participant=addressof(self._calls),
            **{f.name: getattr(shared, f.name).ctypes.data for f in fields(shared)},
        )
        self._pointer = c_void_p(addressof(self._data))
        self._library = found
        self._iterate, self._predict = found.coupling_iterate, found.coupling_predict
        self._error_square, self._accept = found.coupling_error_square, found.coupling_accept
        self._observe = found.coupling_observe
        self._set_up(network)
        self._guess = np.zeros(network.size)
        self._guess_address = self._guess.ctypes.data
        place = shared.observations.ctypes.data
        for calls in self._calls:
            calls.observation = place
            place += calls.observations * shared.observations.itemsize

    @staticmethod
    def serves(network: Network) -> bool:
        """Whether the engine is there and can do with all participants."""
        return library() is not None and all(
            isinstance(p, FmuParticipant) and p.can_restore for p in network.by_name.values()
        )

    def _set_up(self, network: Network) -> None:
        """All memory that is ever needed."""
        size, most, (wrench, coordinates) = network.size, self._data.limits.most, network.width
        for name in ("residual", "scale", "bend", "noise", "steps", "squares", "product"):
            largest = wrench**2 * max(map(len, network.connection_ports)) * max(map(len, network.body_ports))
            length = {"steps": most * size, "squares": most, "product": largest}.get(name, size)
            setattr(self._data, name, self._keep(np.zeros(length)))
        self._data.history.values = self._keep(np.zeros(_POINTS * size))
        rows = [*(np.arange(r.start, r.stop) for r in network.rows), *network.connection_rows]
        places = [*network.body_places, *network.connection_places]
        for participant, calls, place, found in zip(
            self._participants, self._calls, places, rows, strict=True
        ):
            _place(calls, place)
            calls.inputs = carried(participant.input_layout, network.order)
            calls.outputs = carried(participant.output_layout, network.order)
            calls.links = self._keep((found[::wrench] // wrench).astype(np.uintp))
            self._turned.append(self._keep(np.zeros(wrench * coordinates * place.ports**2)))
            calls.turned = self._turned[-1]
        self._arrange(network.meetings, frozenset())

    def _arrange(self, meetings: list[Meeting], still: frozenset[int]) -> None:
        """Tables of indices and room for the linear system without the bodies that never move."""
        self._meetings, self._still = meetings, still
        order = eliminate(meetings, self._data.wrench, still)
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
        """The address of an array that lives as long as the engine."""
        self._kept.append(np.ascontiguousarray(array))
        return int(self._kept[-1].ctypes.data)

    @property
    def sweeps(self) -> int:
        """Sweeps made so far."""
        return int(self._data.sweeps)

    @property
    def seconds(self) -> float:
        """Time spent inside the FMUs so far."""
        return float(self._data.seconds)

    @property
    def iteration(self) -> int:
        """Number of the last iteration."""
        return int(self._data.iteration)

    @property
    def correction(self) -> float:
        """Size of the last correction, scaled by the tolerance."""
        return float(self._data.correction)

    @property
    def worst_row(self) -> int:
        """Row of the unknown that the last correction changes most, or that is not finite."""
        return int(self._data.worst_row)

    def use(self, mobilities: Matrices, stiffnesses: Matrices) -> None:
        """Take matrices of all bodies and of all connections; a body without mobility leaves the linear system."""
        still = mobilities.zeros
        if still != self._still:
            self._arrange(self._meetings, still)
        self._matrices = (mobilities, stiffnesses)
        self._data.mobility, self._data.stiffness = mobilities.address, stiffnesses.address

    def tolerate(self, relative: float, force: float, torque: float) -> None:
        """Set when a correction is small."""
        data = self._data
        data.relative, data.force, data.torque = relative, force, torque

    def sweep(self, time: float, h: float) -> None:
        """Bodies under the wrenches, connections over the motions; ParticipantError where one fails."""
        if not self._library.coupling_sweep(self._pointer, time, h):
            raise self._failure(time, h)

    def iterate(self, time: float, h: float, ready: bool) -> int:
        """Iterate from the present wrenches to a `Status`; ready: assembled for this h."""
        return self._told(self._iterate(self._pointer, time, h, ready), time, h)

    def resume(self, time: float, h: float, *, again: bool) -> int:
        """Go on after `use`; again: the iteration had other matrices before."""
        return self._told(self._library.coupling_resume(self._pointer, again), time, h)

    def _told(self, status: int, time: float, h: float) -> int:
        if status == Status.REFUSED:
            raise self._failure(time, h)
        return status

    def assemble(self) -> None:
        """Factors of the linear system for the matrices in use and the present motions."""
        self._library.coupling_assemble(self._pointer)

    def direction(self, residual: Vector) -> Vector:
        """Chord Newton correction for a residual (size,)."""
        result = np.empty_like(residual)
        self._library.coupling_direction(self._pointer, residual.ctypes.data, result.ctypes.data)
        return result

    def predicted(self, middle: float, h: float) -> Vector:
        """Wrenches (size,) that a step with this mid-step time may start from; valid until the next call."""
        self._predict(self._pointer, middle, h, self._guess_address)
        return self._guess

    def error_square(self, middle: float, h: float, energy: float) -> float | None:
        """Square of the relative error of the step, see native/prediction.h; None with fewer than two remembered."""
        square: float = self._error_square(self._pointer, middle, h, energy)
        return None if isnan(square) else square

    def watch(self, watched: Sequence[WatchedTorque]) -> None:
        """Judge these torques beside energies of their own, and no others."""
        first = self._data.bodies
        self._watched = (_Watched * len(watched))(
            *(_Watched(first + w.connection, w.port, w.row, w.axis, w.weight) for w in watched)
        )
        self._data.watched, self._data.watched_count = addressof(self._watched), len(watched)

    def save(self, time: float) -> None:
        """Save the states of all."""
        if not self._library.coupling_save(self._pointer):
            raise self._failure(time, 0.0)

    def accept(self, middle: float, h: float) -> None:
        """Remember the present wrenches at their mid-step time, and save the states of all."""
        if not self._accept(self._pointer, middle, h):
            raise self._failure(middle + 0.5 * h, 0.0)

    def restart(self) -> None:
        """Forget the wrenches of steps before."""
        self._library.coupling_restart(self._pointer)

    def observe(self, time: float) -> Energies:
        """Read the observations of all into the shared array, and sum up their energies."""
        if not self._observe(self._pointer):
            raise self._failure(time, 0.0)
        return Energies(*self._data.energies)

    def _failure(self, time: float, h: float) -> ParticipantError:
        data = self._data
        found: ParticipantError = self._participants[data.failed].failure(
            data.failed_call, data.failed_status, time, h
        )
        return found
