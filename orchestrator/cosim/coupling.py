"""The coupling of participants in the compiled library: its functions as a master calls them, with typed results.

The numerics are in `fmus/native/coupling`: one communication step, its size, the location of events, and what events
change of loads and latches. The master decides what happens when.
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping, Sequence
from ctypes import CDLL, POINTER, byref, c_char, c_char_p, c_double, c_int, c_size_t, c_void_p, sizeof
from enum import IntEnum
from functools import cache
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from components import FanfoldError
from fmus import native_library
from fmus.native.binary_data import named_bytes
from fmus.native.records import structure

from .energy_balance import Energies
from .network import Network
from .participant import ParticipantError, ParticipantRecord, Vector
from .rows import Recorder

_ROOM = 160
"""Most rows, and so steps, of one `Coupling.advance`."""
_SENTENCE = 512
_OF_STEP = 2
"""`failure` of the progress where no step size converges, as in coupling.h."""
_POINTER, _REAL, _SIZE = c_void_p, c_double, c_size_t
_Progress, _Request = structure("Progress"), structure("Request")
_FUNCTIONS: dict[str, tuple[tuple[Any, ...], Any]] = {
    "create": ((c_void_p, _SIZE, c_char_p, _SIZE, _SIZE, c_void_p), _POINTER),
    "free": ((_POINTER,), None),
    "request": ((_POINTER,), POINTER(_Request)),
    "progress": ((_POINTER,), POINTER(_Progress)),
    "array": ((_POINTER, c_char_p, c_void_p), _POINTER),
    "set": ((_POINTER, _REAL, c_int), None),
    "start": ((_POINTER,), c_int),
    "record_start": ((_POINTER,), c_int),
    "advance": ((_POINTER,), c_int),
    "give_in": ((_POINTER,), None),
    "watch": ((_POINTER,), None),
    "observe": ((_POINTER,), c_int),
    "note_roughness": ((_POINTER, _REAL), c_int),
    "record_jump": ((_POINTER, _REAL, c_int), c_int),
    "is_untold": ((_POINTER,), c_int),
    "impulse": ((_POINTER, _REAL), c_int),
    "record_impulse": ((_POINTER,), None),
    "engage": ((_POINTER, _SIZE, c_int), _REAL),
    "release": ((_POINTER, _SIZE), None),
    "unlatch": ((_POINTER, _SIZE, c_int), c_int),
    "judge_loads": ((_POINTER,), None),
    "supply": ((_POINTER, _REAL), c_int),
    "renew": ((_POINTER, _REAL), None),
    "restart": ((_POINTER, _REAL), None),
    "begin_segment": ((_POINTER,), None),
    "size": ((_POINTER,), _REAL),
    "smallest": ((_POINTER,), _REAL),
    "instant": ((_REAL,), _REAL),
    "distance": ((_POINTER, _SIZE), _REAL),
    "rows": ((_POINTER,), _SIZE),
    "take_rows": ((_POINTER,), None),
    "release_rows": ((_POINTER,), None),
    "sweeps": ((_POINTER,), _SIZE),
    "seconds": ((_POINTER,), _REAL),
    "forget": ((_POINTER, c_int), None),
    "predict": ((_POINTER, _REAL, c_void_p), None),
    "step_after_jump": ((_POINTER, _REAL, c_void_p), _REAL),
    "add_row": ((_POINTER, _REAL, _REAL), None),
    "write_state": ((_POINTER,), None),
    "stand": ((_POINTER,), c_int),
}


class StepError(FanfoldError):
    """A step failed at every size: a sentence with the connection, the residual and the time."""


class Stop(IntEnum):
    """Why an advance ended, as in coupling.h.

    PAUSED: to report. REACHED: an accepted step ended where a line latches or a condition is met. BROKE: it ended at a
    break of a law. TOO_LONG, UNSOLVED: a planned step has to be divided, for the energy balance or to converge.
    STOPPED_SHORT: no step can be made.
    """

    PAUSED = 0
    REACHED = 1
    BROKE = 2
    TOO_LONG = 3
    UNSOLVED = 4
    STOPPED_SHORT = 5


class Advance(NamedTuple):
    """Steps that were made: why they ended, their sizes (s), and how many were rejected.

    crossed: number of the line or condition that ended the last step, lines first; reached: the numbers of all that
    were reached at this instant. lets_go: whether a hold-down lets go at the end of the last step.
    """

    stop: Stop
    steps: list[float]
    rejected: int
    crossed: int
    reached: list[int]
    lets_go: bool


@cache
def _library() -> CDLL:
    """The compiled library; ParticipantError where it was not built, or from another version of its source."""
    path = native_library()
    again = "install Fanfold again (pip install)"
    if path is None:
        raise ParticipantError(f"the library of the master was not built at installation; {again}")
    records = [structure(name) for name in ("Participant", "Request", "Progress")]
    try:
        found = CDLL(str(path))
        sizes = (c_size_t * len(records))()
        found.fanfold_sizes(sizes)
        for name, (arguments, result) in _FUNCTIONS.items():
            function = getattr(found, f"fanfold_{name}")
            function.argtypes, function.restype = arguments, result
    except (OSError, AttributeError):
        raise ParticipantError(f"{path.name} is of another version than its source; {again}") from None
    if list(sizes) != [sizeof(record) for record in records]:
        raise ParticipantError(f"{path.name} is of another version than its source; {again}")
    return found


class Coupling:
    """The participants of a network from one event to the next.

    Arrays are memory of the library and live as long as this object: wrenches (size,) of the last solution, accepted
    (size,) those of the last accepted step; observations of all participants in order; pending (crossings,), 1 where a
    line or a condition is waited for; signal, channels of FMUs with signals. Methods raise ParticipantError where a
    participant fails, StepError where no step size converges.
    """

    def __init__(self, network: Network, tables: Mapping[str, ArrayLike], recorder: Recorder) -> None:
        self.network, self._recorder = network, recorder
        self._library = library = _library()
        participants = network.participants
        self._records = (ParticipantRecord * len(participants))(*(p.record for p in participants))
        content, sentence = named_bytes({}, tables), (c_char * _SENTENCE)()
        handle = library.fanfold_create(
            self._records, len(participants), content, len(content), _ROOM, sentence
        )
        if not handle:
            raise ParticipantError(sentence.value.decode() or "no memory for a network")
        self._handle = c_void_p(handle)
        weakref.finalize(self, library.fanfold_free, self._handle)
        self._request, self._progress = (
            library.fanfold_request(self._handle).contents,
            library.fanfold_progress(self._handle).contents,
        )
        self.wrenches, self.accepted = self._array("wrenches"), self._array("accepted")
        self.observations, self.signal = self._array("observations"), self._array("signal")
        self.pending = self._array("pending")
        self._energies, self._state = self._array("energies"), self._array("state")
        self._reached, self._passed = self._array("reached"), self._array("passed")
        self._steps, self._times = self._array("steps"), self._array("times")
        self._values = self._array("values").reshape(_ROOM, -1)

    def _array(self, name: str) -> Vector:
        count = c_size_t()
        address = self._library.fanfold_array(self._handle, name.encode(), byref(count))
        if not count.value:
            return np.zeros(0)
        memory = (c_double * count.value).from_address(address)
        return np.ctypeslib.as_array(memory)

    def settle_for(self, tolerance: float, *, persistent: bool, fixed_step: float | None) -> None:
        """Set tolerance and fixed step (s) of a run; persistent: whether a slow damped iteration precedes giving up."""
        self._library.fanfold_set(self._handle, tolerance, persistent)
        self._request.fixed_step = fixed_step or 0.0

    @property
    def time(self) -> float:
        """Time (s) of the participants."""
        return float(self._progress.time)

    @time.setter
    def time(self, time: float) -> None:
        self._progress.time = time

    @property
    def size(self) -> float:
        """Size (s) of the next step, where it is chosen."""
        return float(self._library.fanfold_size(self._handle))

    @property
    def smallest(self) -> float:
        """Smallest size (s) that step control chooses for accuracy."""
        return float(self._library.fanfold_smallest(self._handle))

    @property
    def energies(self) -> Energies:
        """Energies as last observed."""
        return Energies(*self._energies.tolist())

    @property
    def costs(self) -> tuple[int, float]:
        """Sweeps so far, and time (s) inside participants."""
        return self._library.fanfold_sweeps(self._handle), self._library.fanfold_seconds(self._handle)

    def distance(self, crossing: int) -> float:
        """Distance of a line from its latch, or of a condition from being met; it falls through zero."""
        return float(self._library.fanfold_distance(self._handle, crossing))

    def start(self) -> None:
        """Begin at t = 0 with initialised participants; energies count from what they observe there."""
        self.pending[:] = 1.0
        self._check(self._library.fanfold_start(self._handle))

    def record_start(self) -> None:
        """Write the first row, with loads just after t = 0, and save the state to step from."""
        self._check(self._library.fanfold_record_start(self._handle))
        self.hand_on_rows()

    def advance(
        self, until: float, event_time: float, pause_time: float = inf, plan: Sequence[float] | None = None
    ) -> Advance:
        """Step until a time (s), or until something happens: see `Stop`.

        event_time (s): time of the next event. pause_time (s): return after the step that reaches it. plan: sizes (s)
        of the next steps, in place of chosen ones.
        """
        request, progress = self._request, self._progress
        request.until, request.event_time, request.pause_time = until, event_time, pause_time
        sizes = None if plan is None else np.array(plan)
        if sizes is not None:
            request.plan, request.planned = sizes.ctypes.data, len(sizes)
        try:
            stop = Stop(self._library.fanfold_advance(self._handle))
        finally:
            request.plan = None
            self.hand_on_rows()
        steps = self._steps[: progress.made].tolist()
        reached = np.flatnonzero(self._reached).tolist() if stop == Stop.REACHED else []
        return Advance(
            stop, steps, progress.rejected, progress.crossed, reached, bool(steps and progress.lets_go)
        )

    def give_in(self) -> None:
        """Let jumps of the energy balance pass that are as large as the one of the last planned step."""
        self._library.fanfold_give_in(self._handle)

    def watch(self) -> None:
        """Note the distances of lines, conditions and stops, and the times of the next breaks."""
        self._library.fanfold_watch(self._handle)

    def observe(self) -> Energies:
        """Read the observations of all participants; returns their energies."""
        self._check(self._library.fanfold_observe(self._handle))
        return self.energies

    def instant(self, size: float) -> float:
        """Size (s) of a step in which nothing moves, where other steps have a size (s)."""
        return float(self._library.fanfold_instant(size))

    def note_roughness(self) -> None:
        """Before an event: note by how much loads of an instant differ from those of steps."""
        self._check(self._library.fanfold_note_roughness(self._handle, self.instant(self.size)))

    def record_jump(self, after: float, *, others: bool = False) -> bool:
        """Write a row with loads an instant `after` (s) an event; whether this instant could be solved.

        others: whether more acts at this instant; the last of it then writes the row.
        """
        self._check(self._library.fanfold_record_jump(self._handle, after, others))
        self.hand_on_rows()
        return bool(self._progress.solved)

    @property
    def is_untold(self) -> bool:
        """Whether the row of the present instant is still to be written."""
        return bool(self._library.fanfold_is_untold(self._handle))

    def impulse(self, h: float) -> list[int]:
        """Make an impulse over a step h (s), which stops joints; returns lines that pass their latches in it."""
        self._check(self._library.fanfold_impulse(self._handle, h))
        return np.flatnonzero(self._passed).tolist()

    def record_impulse(self) -> None:
        """Write a row after the impulses of a lock."""
        self._library.fanfold_record_impulse(self._handle)
        self.hand_on_rows()

    def engage(self, line: int, *, judged: bool) -> float:
        """Latch a line by number; returns the size (s) of the next step. judged: whether its vibration sets it."""
        size = float(self._library.fanfold_engage(self._handle, line, judged))
        self._check(size)
        return size

    def release(self, participant: int) -> None:
        """Release a participant: lines go on with their other hinges, and its load is no longer judged."""
        self._library.fanfold_release(self._handle, participant)

    def unlatch(self, line: int, *, opens: bool) -> bool:
        """Open the latches of a line, or make them ready again; whether the line was latched and is not any more."""
        return bool(self._library.fanfold_unlatch(self._handle, line, opens))

    def judge_loads(self) -> None:
        """Weight errors of the loads of latched lines and struck stops by the present energies."""
        self._library.fanfold_judge_loads(self._handle)

    def supply(self, before: Energies) -> None:
        """Count the change of the energy balance since `before` as supplied from outside."""
        self._check(self._library.fanfold_supply(self._handle, before.balance))

    def renew(self, known: float = 0.0) -> None:
        """Continue with first steps, or with a known size (s) if larger; earlier steps do not predict the next ones."""
        self._library.fanfold_renew(self._handle, known)

    def restart(self, size: float) -> None:
        """Continue with a size (s) after a latch-up; earlier steps do not predict the next ones."""
        self._library.fanfold_restart(self._handle, size)

    def begin_segment(self) -> None:
        """Begin a new segment, if the present one has steps."""
        self._library.fanfold_begin_segment(self._handle)

    def forget(self, *, bodies: bool = False) -> None:
        """Evaluate interface Jacobians of connections anew, with `bodies` also those of bodies, as laws changed."""
        self._library.fanfold_forget(self._handle, bodies)

    def predicted(self, h: float) -> Vector:
        """Wrenches from which the iteration of the next step, of h (s), starts."""
        result = np.empty(self.network.size)
        self._library.fanfold_predict(self._handle, h, result.ctypes.data)
        return result

    def step_after_jump(self, h: float, change: Vector) -> float:
        """Size (s), at most h, at which a jump of wrenches causes no error beyond the allowed one; 0 where unknown."""
        return float(self._library.fanfold_step_after_jump(self._handle, h, change.ctypes.data))

    def add_row(self, h: float, iterations: int) -> None:
        """Write a row of what was observed last, for a step h (s) after so many iterations."""
        self._library.fanfold_add_row(self._handle, h, iterations)
        self.hand_on_rows()

    def release_rows(self) -> None:
        """Hand on the row that waits for values that components know better one step later."""
        self._library.fanfold_release_rows(self._handle)
        self.hand_on_rows()

    def hand_on_rows(self) -> None:
        """Hand on complete rows to the recorder."""
        if count := self._library.fanfold_rows(self._handle):
            self._recorder.extend(self._times[:count].copy(), self._values[:count].copy())
            self._library.fanfold_take_rows(self._handle)

    def state(self) -> Vector:
        """The state of the coupling as numbers, without the states of participants."""
        self._library.fanfold_write_state(self._handle)
        return self._state.copy()

    def stand(self, state: Vector) -> None:
        """Restore such a state; the saved states of participants must belong to it."""
        self._state[:] = state
        self._check(self._library.fanfold_stand(self._handle))

    def _check(self, fine: float) -> None:
        if not fine:
            raise self.failure()

    def failure(self) -> BaseException:
        """The error to raise after a failed call: of a participant, or of the step that does not converge."""
        progress = self._progress
        if progress.failure == _OF_STEP:
            return StepError(
                f"the step of {progress.h:.3g} s from t = {progress.time:.6f} s does not converge: after "
                f"{progress.iterations} iterations the wrench of {self.network.port_of_row(progress.worst_row)} still "
                f"changes by {progress.correction:.3g} times its tolerance; loosen the tolerance, check that "
                "connection's stiffness, or start from a smaller step"
            )
        participant = self.network.participants[progress.participant]
        found: BaseException = participant.failure(progress.call, progress.status, progress.time, progress.h)
        return found
