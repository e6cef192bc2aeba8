"""A participant behind the functions of FMI 2.0, called raw on preallocated arrays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Mapping, Sequence
from ctypes import (
    POINTER,
    Structure,
    addressof,
    byref,
    c_double,
    c_size_t,
    c_uint32,
    c_void_p,
    cast,
    create_string_buffer,
    pointer,
)
from typing import Any

import numpy as np

from components import Layout
from components.contract.errors import shortened

from .participant import OK, WARNING, ParticipantError, ParticipantRecord, Vector, refuse_not_finite

FAILURES = (
    "restore its state",
    "set inputs",
    "",
    "give outputs",
    "",
    "save its state",
    "give observations",
    "",
)
"""Calls that an FMU failed in, by their number in network.h; "" where a message says more."""
_FINITE, _OBSERVED = 4, 7


class FmiParticipant(ABC):
    """One instance that is called by functions of FMI 2.0.

    Raises ParticipantError with the instance's own log message when a call fails, and names it and the time.
    directional_derivatives: whether it returns, right after a step, the derivatives of that step; the standard means
    those at the end of the step alone. digest: of the content that it was made of.
    """

    name: str
    input_layout: Layout
    output_layout: Layout
    observation_layout: Layout
    parameter_layout: Layout
    can_restore = True
    constant_mobility = False
    prescribed_motion = False
    noun = ""
    directional_derivatives = True
    _serializes = True
    _keeps_states_apart = False
    """whether it makes a new state with every save"""

    def __init__(self, name: str, start: Mapping[str, float | Sequence[float]]) -> None:
        self.name = name
        self._start = start
        self._messages: deque[str] = deque(maxlen=1)
        self._time = 0.0
        self._saved = c_void_p()

    @property
    @abstractmethod
    def digest(self) -> str:
        """SHA-256 of its content."""

    @abstractmethod
    def close(self) -> None:
        """Free what it holds."""

    def _bind(
        self,
        functions: Any,  # noqa: ANN401 - of ctypes
        component: Any,  # noqa: ANN401 - of ctypes
        references: tuple[Sequence[int], Sequence[int], Sequence[int], Sequence[int]],
    ) -> None:
        """Raw functions; nothing is converted per call but the two times.

        references: of parameters, inputs, outputs and observations, in the order of their layouts.
        """
        self._functions, self._component = functions, component
        self._parameter_references, inputs, coupled, observed = references
        self.inputs = self.input_layout.start_values()
        self.outputs = self.output_layout.start_values()
        self._observations = self.observation_layout.start_values()
        self._write_arguments = arguments_of(inputs, self.inputs)
        self._read_arguments = arguments_of(coupled, self.outputs)
        self._observe_arguments = arguments_of(observed, self._observations)
        self._set_real = functions.fmi2SetReal
        self._get_real, self._do_step = functions.fmi2GetReal, functions.fmi2DoStep
        self._set_state, self._get_state = functions.fmi2SetFMUstate, functions.fmi2GetFMUstate
        self._free_state = functions.fmi2FreeFMUstate
        self.record = self._made_record()

    def _set_up(self) -> None:
        """From a new instance, or one that was reset, into initialization mode."""
        dll, component = self._functions, self._component
        self.check(dll.fmi2SetupExperiment(component, 0, 0.0, 0.0, 0, 0.0), "set up the experiment")
        for key, value in self._start.items():
            self._set(key, value)
        self.check(self._functions.fmi2EnterInitializationMode(self._component), "enter initialization mode")

    def reset(self, start: Mapping[str, float | Sequence[float]] | None = None) -> None:
        """fmi2Reset: back to the state after instantiation, with its arrays in place, ready for another run.

        start: start values of parameters and inputs that replace its own.
        """
        start = self._start if start is None else start
        self._start = {name: value for name, value in start.items() if name in self.parameter_layout}
        self._free_saved()
        self._time = 0.0
        self.check(self._functions.fmi2Reset(self._component), "reset")
        for values, layout in (
            (self.inputs, self.input_layout),
            (self.outputs, self.output_layout),
            (self._observations, self.observation_layout),
        ):
            values[:] = layout.start_values()
        for name in start.keys() - self._start.keys():
            self.inputs[self.input_layout[name]] = start[name]
        self.write()
        self._set_up()

    def _made_record(self) -> Structure:
        """Functions and arrays of this instance for the compiled library; valid until `close`."""
        record = ParticipantRecord()
        record.component = self._component
        for name, function in (
            ("set_real", self._set_real),
            ("get_real", self._get_real),
            ("do_step", self._do_step),
            ("get_state", self._get_state),
            ("set_state", self._set_state),
            ("free_state", self._free_state),
            ("derivative", self._derivative()),
            ("port_stiffness", getattr(self._functions, "fanfoldGetPortStiffness", None)),
        ):
            setattr(record, name, None if function is None else cast(function, c_void_p))
        for name, (references, count, values) in (
            ("input", self._write_arguments),
            ("output", self._read_arguments),
            ("observation", self._observe_arguments),
        ):
            setattr(record, f"{name}_references", addressof(references))
            setattr(record, f"{name}s", count)
            setattr(record, name, cast(values, c_void_p))
        record.saved = cast(pointer(self._saved), c_void_p)
        record.overwrites_state = not self._keeps_states_apart
        return record

    def _derivative(self) -> Any:  # noqa: ANN401 - of ctypes
        """The function for derivatives of the step just made; None where the FMU has none or means others."""
        offered = getattr(self._functions, "fmi2GetDirectionalDerivative", None)
        return offered if self.directional_derivatives else None

    def failure(self, call: int, status: int, time: float, h: float) -> BaseException:
        """What to raise when a call of the library failed, by its number in `FAILURES`."""
        self._time = time
        try:
            if call == _FINITE:
                self._check_finite("output", self.output_layout, self.outputs)
            if call == _OBSERVED:
                self.observe()
            self.check(max(status, WARNING + 1), FAILURES[call] or f"do a step of {h:g} s")
        except ParticipantError as error:
            return error
        raise AssertionError("a failure that is none")

    def _hear(self, message: str) -> None:
        """Remember what it has to say."""
        self._messages.append(shortened(message.strip()))

    def check(self, status: int, action: str) -> None:
        """ParticipantError with the instance's own words when a call could not do what it should."""
        if status in (OK, WARNING):
            return
        reason = "".join(self._messages) or f"FMI status {status}, no message"
        self._messages.clear()
        raise ParticipantError(f"{self.name}: cannot {action} at t = {self._time:.6g} s: {reason}")

    def initialize(self, time: float) -> None:
        """Write the inputs and leave initialization mode."""
        self._time = time
        self.write()
        self.check(self._functions.fmi2ExitInitializationMode(self._component), "initialise")

    def write(self) -> None:
        """fmi2SetReal on all inputs."""
        if self._set_real(self._component, *self._write_arguments) > WARNING:
            self.check(3, "set inputs")

    def do_step(self, time: float, h: float) -> None:
        """fmi2DoStep."""
        self._time = time
        status = self._do_step(self._component, time, h, 0)
        if status > WARNING:
            self.check(status, f"do a step of {h:g} s")

    def read(self) -> None:
        """fmi2GetReal on all coupled outputs; values that are not finite are refused."""
        if self._get_real(self._component, *self._read_arguments) > WARNING:
            self.check(3, "give outputs")
        self._check_finite("output", self.output_layout, self.outputs)

    def _check_finite(self, what: str, layout: Layout, values: Vector) -> None:
        refuse_not_finite(self.name, what, layout, values, self._time)

    def save(self) -> None:
        """fmi2GetFMUstate into the one slot."""
        if self._keeps_states_apart:
            self._free_saved()
        self.check(self._get_state(self._component, byref(self._saved)), "save its state")

    def _free_saved(self) -> None:
        if self._saved:
            self._free_state(self._component, byref(self._saved))
            self._saved.value = None

    def restore(self) -> None:
        """fmi2SetFMUstate from the slot."""
        if self._set_state(self._component, self._saved) > WARNING:
            self.check(3, "restore its state")

    def serialized(self) -> bytes:
        """fmi2SerializeFMUstate of the slot."""
        if not self._serializes:
            raise ParticipantError(
                f"{self.name}: this FMU cannot give its state as bytes (canSerializeFMUstate)"
            )
        size = c_size_t()
        dll, component = self._functions, self._component
        self.check(
            dll.fmi2SerializedFMUstateSize(component, self._saved, byref(size)), "tell its state's size"
        )
        content = create_string_buffer(size.value)
        self.check(dll.fmi2SerializeFMUstate(component, self._saved, content, size), "serialise its state")
        return content.raw

    def deserialize(self, content: bytes) -> None:
        """fmi2DeSerializeFMUstate into the slot, and fmi2SetFMUstate from it."""
        self._free_saved()
        made = self._functions.fmi2DeSerializeFMUstate(
            self._component, content, c_size_t(len(content)), byref(self._saved)
        )
        self.check(made, "read its state")
        self.restore()

    def observe(self) -> Vector:
        """fmi2GetReal on all other outputs, into an array of its own."""
        self.write()
        self.check(self._get_real(self._component, *self._observe_arguments), "give observations")
        self._check_finite("observation", self.observation_layout, self._observations)
        return self._observations

    def set_parameter(self, name: str, value: float | Sequence[float]) -> None:
        """Set a parameter, also in the saved state, which is the present one between steps."""
        self._set(name, value)
        if self._saved:
            self.save()

    def _set(self, name: str, value: float | Sequence[float]) -> None:
        if name not in self.parameter_layout:
            raise ParticipantError(f"{self.name}: there is no parameter {name!r}")
        where = self.parameter_layout[name]
        values = np.broadcast_to(np.asarray(value, dtype=float), (where.stop - where.start,)).copy()
        arguments = arguments_of(self._parameter_references[where], values)
        self.check(self._functions.fmi2SetReal(self._component, *arguments), f"set {name}")


def arguments_of(references: Sequence[int], values: Vector) -> tuple[Any, int, Any]:
    """Value references, their number and the values' memory, ready for a call."""
    array = (c_uint32 * len(references))(*references)
    return array, len(references), values.ctypes.data_as(POINTER(c_double))
