"""An FMI 2.0 co-simulation FMU as a participant, called through raw functions on preallocated arrays."""

from __future__ import annotations

import shutil
from collections import deque
from collections.abc import Collection, Mapping, Sequence
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
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, ClassVar

import numpy as np
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2OK,
    fmi2Warning,
    free,
)
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free

from components import Layout
from components.cache.temporary import process_folder
from components.contract.errors import shortened
from fmus.binary import cut_short
from fmus.host.process import LONGEST_CALL, HostError

from .fmu_variables import described_in, said_of, says
from .isolated import IsolatedFmu
from .participant import ParticipantError, ParticipantRecord, Vector, refuse_not_finite
from .shared_library import library_of, unpack

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
_PYTHON = "PythonFMU"
"""Its FMUs create a new state with every save, and log texts with percent signs unchanged."""


class FMU2Declared(FMU2Slave):  # type: ignore[misc] # FMPy looks at the beginning of the name
    """FMPy's slave, with the types of all functions determined once, not for every instance."""

    _declared: ClassVar[dict[str, tuple[Any, Any, Any]]] = {}

    def _loadFunctions(self) -> None:
        if not self._declared:
            super()._loadFunctions()
            for name, function in self._functions.items():
                self._declared[name] = function.argnames, function.argtypes, function.restype
            return
        for name, types in self._declared.items():
            function = getattr(self.dll, name)
            function.argnames, function.argtypes, function.restype = types
            self._functions[name] = function


class FmuParticipant:
    """One instance of an FMU file.

    Raises ParticipantError with the FMU's own log message when a call fails, and names the FMU and time.
    directional_derivatives: whether it returns, right after a step, the derivatives of that step; the standard means
    those at the end of the step alone. isolate: whether it runs in a process of its own, by default where its binary is
    not the one that was compiled here; longest_call: time (s) after which a call to this process counts as hanging.
    """

    def __init__(
        self,
        name: str,
        path: Path,
        start: Mapping[str, float | Sequence[float]] | None = None,
        *,
        isolate: bool | None = None,
        longest_call: float = LONGEST_CALL,
    ) -> None:
        self.name = name
        self.path = path
        self._isolate = isolate
        self._longest_call = longest_call
        self._messages: deque[str] = deque(maxlen=1)
        self._last_words = ""
        self._time = 0.0
        self._saved = c_void_p()
        self._folder = Path(mkdtemp(dir=process_folder()))
        try:
            self._load(start or {}, unpack(path, self._folder))
        except ParticipantError:
            self.close()
            raise
        except Exception as error:
            self.close()
            reason = ": ".join([str(error), *self._messages])
            raise ParticipantError(f"{name}: {path.name} cannot be loaded: {reason}") from None

    def _load(self, start: Mapping[str, float | Sequence[float]], own: Collection[Path]) -> None:
        """own: binaries that were compiled here."""
        described = described_in(self._folder)
        description, annotation = described.description, described.annotation
        if description.fmiVersion != "2.0" or description.coSimulation is None:
            raise ParticipantError(f"{self.name}: {self.path.name} is not an FMI 2.0 co-simulation FMU")
        self.can_restore = bool(description.coSimulation.canGetAndSetFMUstate)
        self._serializes = bool(description.coSimulation.canSerializeFMUstate)
        self.directional_derivatives = bool(description.coSimulation.providesDirectionalDerivative) and says(
            annotation, "DirectionalDerivative", "afterStep"
        )
        self.constant_mobility = says(annotation, "Mobility", "constant")
        self.prescribed_motion = says(annotation, "Mobility", "zero")
        self.noun = "" if (said := said_of(annotation, "Component")) is None else said.get("noun", "")
        self._is_python = _PYTHON in (description.generationTool or "")
        self.parameter_layout, self._parameter_references = described.parameters
        self.input_layout, inputs = described.inputs
        self.output_layout, coupled = described.outputs
        self.observation_layout, observed = described.observations
        self.inputs = self.input_layout.start_values()
        self.outputs = self.output_layout.start_values()
        self._observations = self.observation_layout.start_values()
        self._write_arguments = _arguments(inputs, self.inputs)
        self._read_arguments = _arguments(coupled, self.outputs)
        self._observe_arguments = _arguments(observed, self._observations)
        binary = library_of(self._folder, description.coSimulation.modelIdentifier)
        if binary.is_file() and (problem := cut_short(binary)):
            raise ParticipantError(f"{self.name}: {self.path.name} cannot be loaded: {problem}")
        apart = binary not in own if self._isolate is None else self._isolate
        self._fmu: FMU2Slave | IsolatedFmu = (
            IsolatedFmu(self._folder, self.name, self._longest_call)
            if apart
            else self._instance_here(description)
        )
        self._component = self._fmu.component
        self._bind()
        self._start = start
        self._set_up()

    def _instance_here(self, description: Any) -> FMU2Slave:  # noqa: ANN401
        fmu = FMU2Declared(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=str(self._folder),
            instanceName=self.name,
        )
        self._callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(self._log), Allocate(calloc), Free(free)
        )
        fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        return fmu

    def _set_up(self) -> None:
        """From a new instance, or one that was reset, into initialization mode."""
        dll, component = self._fmu.dll, self._component
        self.check(dll.fmi2SetupExperiment(component, 0, 0.0, 0.0, 0, 0.0), "set up the experiment")
        for key, value in self._start.items():
            self._set(key, value)
        self.check(self._fmu.dll.fmi2EnterInitializationMode(self._component), "enter initialization mode")

    def reset(self, start: Mapping[str, float | Sequence[float]] | None = None) -> None:
        """fmi2Reset: back to the state after instantiation, with its arrays in place, ready for another run.

        start: start values of parameters and inputs that replace its own.
        """
        start = self._start if start is None else start
        self._start = {name: value for name, value in start.items() if name in self.parameter_layout}
        self._free_saved()
        self._time = 0.0
        self.check(self._fmu.dll.fmi2Reset(self._component), "reset")
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

    def _bind(self) -> None:
        """Raw functions; argument types are set so that nothing is converted per call but the two times."""
        dll = self._fmu.dll
        self._set_real = dll.fmi2SetReal
        self._get_real, self._do_step = dll.fmi2GetReal, dll.fmi2DoStep
        self._set_state, self._get_state = dll.fmi2SetFMUstate, dll.fmi2GetFMUstate
        self._free_state = dll.fmi2FreeFMUstate
        self.record = self._made_record()

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
            ("port_stiffness", getattr(self._fmu.dll, "fanfoldGetPortStiffness", None)),
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
        record.overwrites_state = not self._is_python
        return record

    def _derivative(self) -> Any:  # noqa: ANN401 - of ctypes
        """The function for derivatives of the step just made; None where the FMU has none or means others."""
        offered = getattr(self._fmu.dll, "fmi2GetDirectionalDerivative", None)
        return offered if self.directional_derivatives else None

    def failure(self, call: int, status: int, time: float, h: float) -> BaseException:
        """What to raise when a call of the library failed, by its number in `FAILURES`."""
        self._time = time
        try:
            if call == _FINITE:
                self._check_finite("output", self.output_layout, self.outputs)
            if call == _OBSERVED:
                self.observe()
            self.check(max(status, fmi2Warning + 1), FAILURES[call] or f"do a step of {h:g} s")
        except ParticipantError as error:
            return error
        raise AssertionError("a failure that is none")

    def _log(self, environment: Any, instance: Any, status: int, category: Any, message: bytes) -> None:  # noqa: ANN401
        if category is not None:
            self._messages.append(shortened(message.decode("utf-8", "replace").strip()))

    def check(self, status: int, action: str) -> None:
        """ParticipantError with the FMU's own words when a call could not do what it should."""
        if status in (fmi2OK, fmi2Warning):
            return
        if isinstance(self._fmu, IsolatedFmu):
            failure = self._fmu.failure
            if failure is not None and not isinstance(failure, HostError):
                raise failure
            self._messages.append(self._fmu.reason)
        reason = "".join(self._messages) or f"FMI status {status}, no message"
        self._messages.clear()
        sentence = self._last_words or f"{self.name}: cannot {action} at t = {self._time:.6g} s: {reason}"
        if isinstance(self._fmu, IsolatedFmu) and not self._fmu.is_sound:
            self._last_words = sentence  # shorter steps are tried in vain
        raise ParticipantError(sentence)

    @property
    def is_isolated(self) -> bool:
        """Whether it has a process of its own."""
        return isinstance(self._fmu, IsolatedFmu)

    def initialize(self, time: float) -> None:
        """Write the inputs and leave initialization mode."""
        self._time = time
        self.write()
        self.check(self._fmu.dll.fmi2ExitInitializationMode(self._component), "initialise")

    def write(self) -> None:
        """fmi2SetReal on all inputs."""
        if self._set_real(self._component, *self._write_arguments) > fmi2Warning:
            self.check(3, "set inputs")

    def do_step(self, time: float, h: float) -> None:
        """fmi2DoStep."""
        self._time = time
        status = self._do_step(self._component, time, h, 0)
        if status > fmi2Warning:
            self.check(status, f"do a step of {h:g} s")

    def read(self) -> None:
        """fmi2GetReal on all coupled outputs; values that are not finite are refused."""
        if self._get_real(self._component, *self._read_arguments) > fmi2Warning:
            self.check(3, "give outputs")
        self._check_finite("output", self.output_layout, self.outputs)

    def _check_finite(self, what: str, layout: Layout, values: Vector) -> None:
        refuse_not_finite(self.name, what, layout, values, self._time)

    def save(self) -> None:
        """fmi2GetFMUstate into the one slot."""
        if self._is_python:
            self._free_saved()
        self.check(self._get_state(self._component, byref(self._saved)), "save its state")

    def _free_saved(self) -> None:
        if self._saved:
            self._free_state(self._component, byref(self._saved))
            self._saved.value = None

    def restore(self) -> None:
        """fmi2SetFMUstate from the slot."""
        if self._set_state(self._component, self._saved) > fmi2Warning:
            self.check(3, "restore its state")

    def serialized(self) -> bytes:
        """fmi2SerializeFMUstate of the slot."""
        if not self._serializes:
            raise ParticipantError(
                f"{self.name}: this FMU cannot give its state as bytes (canSerializeFMUstate)"
            )
        size = c_size_t()
        dll, component = self._fmu.dll, self._component
        self.check(
            dll.fmi2SerializedFMUstateSize(component, self._saved, byref(size)), "tell its state's size"
        )
        content = create_string_buffer(size.value)
        self.check(dll.fmi2SerializeFMUstate(component, self._saved, content, size), "serialise its state")
        return content.raw

    def deserialize(self, content: bytes) -> None:
        """fmi2DeSerializeFMUstate into the slot, and fmi2SetFMUstate from it."""
        self._free_saved()
        made = self._fmu.dll.fmi2DeSerializeFMUstate(
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
        arguments = _arguments(self._parameter_references[where], values)
        self.check(self._fmu.dll.fmi2SetReal(self._component, *arguments), f"set {name}")

    def close(self) -> None:
        """Free state and instance, end its process, remove the unpacked files."""
        if getattr(self, "_component", None) is not None:
            self._free_saved()
            if isinstance(self._fmu, IsolatedFmu):
                self._fmu.close()
            else:
                self._fmu.dll.fmi2FreeInstance(self._component)
            self._component = None
        shutil.rmtree(self._folder, ignore_errors=True)


def _arguments(references: Sequence[int], values: Vector) -> tuple[Any, int, Any]:
    """Value references, their number and the values' memory, ready for a call."""
    array = (c_uint32 * len(references))(*references)
    return array, len(references), values.ctypes.data_as(POINTER(c_double))
