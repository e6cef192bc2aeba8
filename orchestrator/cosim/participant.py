"""Participants of a co-simulation: one protocol, with an in-process component as the simplest case.

The master sets inputs and reads outputs through arrays that a participant owns and keeps for its life, so
stepping allocates nothing on the master's side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from ctypes import CFUNCTYPE, Structure, addressof, c_double, c_int, c_size_t, c_void_p, cast, memmove
from typing import Any, Protocol, TypeVar

import numpy as np

from components import REGISTRY, Component, ComponentError, FanfoldError, Instance, Layout
from fmus.native.records import structure

from ..assembly import Part

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]
T = TypeVar("T")
OK, WARNING, DISCARD, ERROR, FATAL = range(5)
"""What functions of FMI 2.0 return (fmi2Status)."""


class ParticipantError(FanfoldError):
    """A participant failed: a sentence with its name, and the time where there is one."""


def all_finite(values: Vector) -> bool:
    """Whether all values are finite."""
    return bool(np.isfinite(values).all())


def refuse_not_finite(
    owner: str, what: str, layout: Layout, values: Vector, time: float | None = None
) -> None:
    """ParticipantError that names the first value that is not finite, with its owner and time (s)."""
    if not all_finite(values):
        bad = int(np.argmin(np.isfinite(values)))
        when = "" if time is None else f" at t = {time:.6g} s"
        raise ParticipantError(f"{owner}: {what} {layout.scalar_names()[bad]} is {values[bad]}{when}")


ParticipantRecord = structure("Participant")
"""A participant as the compiled library calls it."""


class Participant(Protocol):
    """One FMU or component in a running co-simulation.

    `inputs` and `outputs` are arrays in the order of `input_layout` and `output_layout`. `save` remembers
    the present state in the single slot; `restore` returns to it, any number of times.
    `noun`: word for its kind in messages, empty where unknown. `constant_mobility`, `prescribed_motion`: of a
    body, see `Component`; False where nothing is known. `record`: the same calls for the compiled library.
    """

    name: str
    inputs: Vector
    outputs: Vector
    input_layout: Layout
    output_layout: Layout
    observation_layout: Layout
    parameter_layout: Layout
    can_restore: bool
    constant_mobility: bool
    prescribed_motion: bool
    noun: str

    @property
    def record(self) -> Structure:
        """Functions and memory for the compiled library; valid until `close`."""

    def failure(self, call: int, status: int, time: float, h: float) -> BaseException:
        """What to raise when a call of the library failed, by its number in `FAILURES` and its FMI status."""

    def initialize(self, time: float) -> None:
        """Leave initialisation with the inputs as they are."""

    def write(self) -> None:
        """Hand over the inputs."""

    def do_step(self, time: float, h: float) -> None:
        """Step from time over h; ParticipantError if it cannot."""

    def read(self) -> None:
        """Fetch the outputs."""

    def save(self) -> None:
        """Remember the state."""

    def restore(self) -> None:
        """Return to the remembered state."""

    def serialized(self) -> bytes:
        """The remembered state; ParticipantError where it cannot be had as bytes."""

    def deserialize(self, content: bytes) -> None:
        """Remember and return to such a state, with the same inputs as when it was remembered."""

    def observe(self) -> Vector:
        """The observations of the present state and inputs, an array of the participant's own."""

    def set_parameter(self, name: str, value: float | Sequence[float]) -> None:
        """Change a parameter; ParticipantError for an unknown name or an impossible value."""

    def close(self) -> None:
        """Free what it holds."""


def first_observations(participants: Iterable[Participant]) -> dict[str, int]:
    """First place of the observations of each participant, by its name, among those of all in order."""
    firsts, first = {}, 0
    for participant in participants:
        firsts[participant.name] = first
        first += participant.observation_layout.size
    return firsts


_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "set_real": (c_void_p, c_size_t, c_void_p),
    "get_real": (c_void_p, c_size_t, c_void_p),
    "do_step": (c_double, c_double, c_int),
    "get_state": (c_void_p,),
    "set_state": (c_void_p,),
    "free_state": (c_void_p,),
}
"""Types of arguments of the functions that the library calls, after the component."""


class Callbacks:
    """Functions for the library that call a participant in Python."""

    def __init__(self, participant: Participant) -> None:
        self._participant = participant
        self._failure: BaseException | None = None
        self._is_over = False
        self._saved = c_void_p()
        self.record = record = ParticipantRecord()
        outputs, observations = participant.outputs, participant.observation_layout.size
        calls: dict[str, Callable[..., object]] = {
            "set_real": lambda *_: participant.write(),
            "get_real": lambda _, count, to: self._read(to, at_ports=to == outputs.ctypes.data),
            "do_step": lambda time, h, _: participant.do_step(time, h),
            "get_state": lambda _: self._save(),
            "set_state": lambda _: participant.restore(),
            "free_state": lambda _: None,
        }
        self._functions = {name: self._function(name, call) for name, call in calls.items()}
        for name, function in self._functions.items():
            setattr(record, name, cast(function, c_void_p))
        record.inputs, record.outputs, record.observations = (
            participant.inputs.size,
            outputs.size,
            observations,
        )
        record.input, record.output = participant.inputs.ctypes.data, outputs.ctypes.data
        record.saved = addressof(self._saved)
        record.overwrites_state = True

    def _function(self, name: str, call: Callable[..., object]) -> Any:  # noqa: ANN401 - of ctypes
        def called(_: object, *arguments: Any) -> int:  # noqa: ANN401
            if self._is_over:
                return FATAL
            try:
                call(*arguments)
            except ParticipantError as error:
                self._failure = error
                return ERROR
            except BaseException as error:  # which would be lost on its way through C
                self._failure, self._is_over = error, True
                return FATAL
            return OK

        return CFUNCTYPE(c_int, c_void_p, *_FUNCTIONS[name])(called)

    def _read(self, to: int, *, at_ports: bool) -> None:
        """Read outputs into the participant's own array, or copy observations to their place among all."""
        if at_ports:
            self._participant.read()
        else:
            found = np.ascontiguousarray(self._participant.observe())
            memmove(to, found.ctypes.data, found.nbytes)

    def _save(self) -> None:
        self._participant.save()
        self._saved.value = 1

    def failure(self) -> BaseException:
        """The error that the participant raised last."""
        assert self._failure is not None
        return self._failure


class InProcess:
    """A component as a participant, without an FMU around it."""

    can_restore = True

    def __init__(
        self, name: str, component: Component, start: Mapping[str, float | Sequence[float]] | None = None
    ) -> None:
        self.name = name
        self.component = component
        self.constant_mobility = component.constant_mobility
        self.prescribed_motion = component.prescribed_motion
        self.noun = component.noun
        self.parameter_layout = component.parameter_layout
        self.input_layout = component.input_layout
        self.output_layout = component.output_layout
        self.observation_layout = component.observation_layout
        self.outputs = self.output_layout.start_values()
        self._instance = self._trying(lambda: Instance(component, start))
        self.inputs = self._instance.inputs
        self._trying(lambda: self._instance.constants)
        self._saved = self._instance.state
        self._callbacks: Callbacks | None = None

    @property
    def record(self) -> Structure:
        """Functions that call the methods of this class."""
        if self._callbacks is None:
            self._callbacks = Callbacks(self)
        return self._callbacks.record

    def failure(self, call: int, status: int, time: float, h: float) -> BaseException:
        """The error that a method raised last."""
        assert self._callbacks is not None
        return self._callbacks.failure()

    def _trying(self, act: Callable[[], T]) -> T:
        """Result of a call of the component; its errors name the participant."""
        try:
            return act()
        except ComponentError as error:
            raise ParticipantError(f"{self.name}: {error}") from None

    def initialize(self, time: float) -> None:
        """Compute the state from parameters and inputs."""
        self._trying(self._instance.initialize)

    def write(self) -> None:
        """Inputs are read where they are."""

    def do_step(self, time: float, h: float) -> None:
        """Step; a state that is not finite is refused."""
        self._trying(lambda: self._instance.constants)
        try:
            self._instance.step(h)
        except ComponentError as error:
            raise ParticipantError(
                f"{self.name}: cannot do a step of {h:g} s at t = {time:.6g} s: {error}"
            ) from None
        except (ValueError, ArithmeticError) as error:
            raise ParticipantError(f"{self._refusal(time, h)} ({error})") from None
        if not all_finite(self._instance.state):
            raise ParticipantError(self._refusal(time, h))

    def _refusal(self, time: float, h: float) -> str:
        return f"{self.name}: the state is no longer finite after the step of {h:g} s from t = {time:.6g} s"

    def read(self) -> None:
        """Compute the outputs."""
        self.outputs[:] = self._trying(self._instance.outputs)

    def save(self) -> None:
        """States are never changed in place, so a reference is enough."""
        self._saved = self._instance.state

    def restore(self) -> None:
        """Return to the saved state."""
        self._instance.state = self._saved

    def serialized(self) -> bytes:
        """The numbers of the state."""
        return self._saved.tobytes()

    def deserialize(self, content: bytes) -> None:
        """From the numbers of the state."""
        self._saved = np.frombuffer(content).copy()
        self.restore()

    def observe(self) -> Vector:
        """Observations; those that are no numbers are refused."""
        found = self._trying(self._instance.observe)
        refuse_not_finite(self.name, "observation", self.observation_layout, found)
        return found

    def set_parameter(self, name: str, value: float | Sequence[float]) -> None:
        """Change a parameter; it acts from the next step on."""
        if name not in self.parameter_layout:
            raise ParticipantError(f"{self.name}: there is no parameter {name!r}")
        self._instance.set(name, value)

    def close(self) -> None:
        """Nothing to free."""


def in_process(parts: Sequence[Part]) -> list[InProcess]:
    """Every part of an assembly as an in-process participant."""
    return [InProcess(part.name, REGISTRY[part.kind](**part.structure), part.start) for part in parts]
