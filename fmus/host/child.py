"""The process of an FMU: `python -P child.py END`, the number of a pipe's end. Needs FMPy only.

Every request is the name of a method of `Instance` and its arguments. What goes back is (SAID, status, text) for each
message of the FMU that is no good news, then (ANSWERED, result) or (REFUSED, why). Signals of the system are for the
process that asks: this one ends with it.
"""

from __future__ import annotations

import math
import os
import pickle
import select
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from ctypes import byref, c_char, c_double, c_int, c_size_t, c_void_p
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, calloc, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated, free
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free
from fmpy.fmi3 import FMU3Slave, fmi3Boolean, fmi3Float64

Value = float | int | bool | str
SAID, ANSWERED, REFUSED = "said", "answered", "refused"
OK, WARNING, DISCARD = 0, 1, 2
RAW: dict[str, tuple[Any, ...]] = {
    "fmi2SetupExperiment": (c_int, c_double, c_double, c_int, c_double),
    "fmi2EnterInitializationMode": (),
    "fmi2ExitInitializationMode": (),
    "fmi2Reset": (),
    "fmi2SetReal": (c_void_p, c_size_t, c_void_p),
    "fmi2GetReal": (c_void_p, c_size_t, c_void_p),
    "fmi2DoStep": (c_double, c_double, c_int),
    "fmi2GetFMUstate": (c_void_p,),
    "fmi2SetFMUstate": (c_void_p,),
    "fmi2FreeFMUstate": (c_void_p,),
    "fmi2SerializedFMUstateSize": (c_void_p, c_void_p),
    "fmi2SerializeFMUstate": (c_void_p, c_void_p, c_size_t),
    "fmi2DeSerializeFMUstate": (c_void_p, c_size_t, c_void_p),
    "fmi2GetDirectionalDerivative": (c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_void_p),
    "fanfoldGetPortStiffness": (c_size_t, c_void_p),
}
"""Functions that can be called as they are, and their arguments after the instance; pointers are those of memory."""
_ENDS = "it asks for the end of the simulation"
_KINDS = {"2": {"Enumeration": "Integer"}, "3": {"Enumeration": "Int64"}}
_NUMBERS = ("Real", "Float64")
_LONGEST = 1000
"""Characters of a message, of which nobody reads more."""
_LOOK = 1000
"""Time (ms) between two looks at who the parent is."""


class _Refusal(Exception):
    """A sentence of this process, not of the FMU."""


class _Lenient:
    """FMPy's instance of a binary that lacks functions of the standard: only calls of these are refused."""

    dll: Any

    def _loadFunctions(self) -> None:
        prefix = f"fmi{type(self).__name__[3]}"
        self.missing = [n for n in dir(type(self)) if n.startswith(prefix) and not hasattr(self.dll, n)]
        for name in self.missing:
            setattr(self.dll, name, _refusal(name))
        super()._loadFunctions()  # type: ignore[misc] # of the class beside it


def _refusal(name: str) -> Callable[..., None]:
    def refuse(*_: object) -> None:
        raise _Refusal(f"its binary has no function {name}")

    return refuse


class FMU2Lenient(_Lenient, FMU2Slave):  # type: ignore[misc] # FMPy looks at the beginning of the name
    """Of FMI 2.0."""


class FMU3Lenient(_Lenient, FMU3Slave):  # type: ignore[misc]
    """Of FMI 3.0."""


def shape_of(variable: Any, given: Mapping[str, Value]) -> tuple[int, ...]:  # noqa: ANN401 - of FMPy
    """Elements of an array by dimension, which may be the value of a structural parameter; () for a scalar."""
    return tuple(
        int(d.start if d.variable is None else given.get(d.variable.name, d.variable.start))
        for d in variable.dimensions or ()
    )


class Instance:
    """One instance of an FMU 2.0 or 3.0 for co-simulation; its methods raise where the FMU refuses."""

    def __init__(self, send: Callable[..., None]) -> None:
        self._send = send
        self._fmu: Any = None
        self._initialized = False
        self._raw: dict[str, Any] = {}
        self.begin()

    def begin(self) -> None:
        """Forget messages, before the next request."""
        self._rank, self._last = (False, OK), ""

    def instantiate(self, folder: str, name: str) -> list[str]:
        """Make an instance of what is unpacked in a folder; functions of the standard that its binary lacks."""
        self._description = description = read_model_description(folder, validate=False)
        self._kinds = _KINDS[description.fmiVersion[0]]
        self._fmi2 = description.fmiVersion.startswith("2.")
        self._variables = {v.name: v for v in description.modelVariables}
        kind = FMU2Lenient if self._fmi2 else FMU3Lenient
        self._fmu = fmu = kind(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=folder,
            instanceName=name,
        )
        # without logging many FMUs do not even say why they fail
        if self._fmi2:
            fmu.instantiate(callbacks=self._callbacks(), loggingOn=True)
        else:
            fmu.instantiate(loggingOn=True, logMessage=self._log)
        missing: list[str] = fmu.missing
        return missing

    def _callbacks(self) -> Any:  # noqa: ANN401 - of FMPy
        callbacks = fmi2CallbackFunctions(fmi2CallbackLoggerTYPE(self._log), Allocate(calloc), Free(free))
        if "PythonFMU" not in (self._description.generationTool or ""):  # it does not format its messages
            with suppress(Exception):  # not for all platforms
                from fmpy.logging import addLoggerProxy

                addLoggerProxy(byref(callbacks))
        return callbacks

    def _log(self, *arguments: Any) -> None:  # noqa: ANN401 - FMI 2.0 and 3.0 differ
        status, category, text = arguments[-3:]
        if status == OK or not text:
            return
        message = " ".join(text.decode("utf-8", "replace").split())
        message = message if len(message) <= _LONGEST else f"{message[:_LONGEST]} ..."
        rank = (
            category is not None,
            status,
        )  # PythonFMU has no category where it only repeats that Python failed
        if rank >= self._rank:
            self._rank, self._last = rank, message
            self._send(SAID, (status, message))

    def why(self, error: Exception) -> str:
        """Why a request failed: what this process says of it, else what the FMU said that is no good news."""
        said = "" if isinstance(error, _Refusal) else self._last
        return said or f"{error}" or type(error).__name__

    def initialize(
        self,
        start: Mapping[str, Value],
        inputs: Mapping[str, Value],
        tolerance: float | None,
        until: float | None = None,
    ) -> None:
        """From the new instance to step mode at t = 0.

        tolerance, until: relative accuracy and end of the experiment.
        """
        experiment = {"tolerance": tolerance, "startTime": 0.0, "stopTime": until}
        if self._fmi2:
            self._fmu.setupExperiment(**experiment)
        self._configure(start)
        self._set({name: v for name, v in start.items() if not self._is_structural(name)})
        self._fmu.enterInitializationMode(**({} if self._fmi2 else experiment))
        self._set(inputs)
        self._fmu.exitInitializationMode()
        self._initialized = True

    def _is_structural(self, name: str) -> bool:
        return bool(self._place(name)[0].causality == "structuralParameter")

    def _configure(self, start: Mapping[str, Value]) -> None:
        """Set structural parameters, and the sizes of arrays that follow from them."""
        given = {name: value for name, value in start.items() if self._is_structural(name)}
        if not given:
            return
        self._fmu.enterConfigurationMode()
        self._set(given)
        self._fmu.exitConfigurationMode()
        for variable in self._variables.values():
            variable.shape = shape_of(variable, given)

    def sample(
        self, time: float, h: float, inputs: Mapping[str, Value], outputs: Sequence[str]
    ) -> list[float]:
        """Step from a time (s) over h with the inputs of the end, and give the outputs."""
        self._set(inputs)
        if ended := self.step(time, h):
            raise _Refusal(ended)
        return self.get(outputs)

    def step(self, time: float, h: float) -> str:
        """Step from a time (s) over h; why the FMU ended before, empty where it did not."""
        if self._fmi2:
            if self._do_step2(time, h) == WARNING and not self._last:
                self._send(SAID, (WARNING, "a warning without a word"))
            return ""
        needs_event, terminates, early, reached = fmi3Boolean(), fmi3Boolean(), fmi3Boolean(), fmi3Float64()
        flags = (byref(one) for one in (needs_event, terminates, early, reached))
        try:
            self._fmu.fmi3DoStep(self._fmu.component, time, h, fmi3Boolean(True), *flags)
        except FMICallException as error:
            if error.status != DISCARD or not terminates.value:
                raise
        if terminates.value:
            return self._ends()
        return (
            f"it returned early, at t = {reached.value:.6g} s, which was not allowed to it"
            if early.value
            else ""
        )

    def _do_step2(self, time: float, h: float) -> int:
        """Its status; FMI 2.0 discards the step of an FMU that has to end, as one that is too large."""
        try:
            status: int = self._fmu.fmi2DoStep(self._fmu.component, time, h, 1)
        except FMICallException as error:
            if error.status == DISCARD and self._terminates2():
                raise _Refusal(self._ends()) from None
            raise
        return status

    def _ends(self) -> str:
        """That it asks for the end, and what it last said about it."""
        return f"{_ENDS}: {self._last}" if self._last else _ENDS

    def _terminates2(self) -> bool:
        """Whether it reports that it has to end."""
        try:
            return bool(self._fmu.getBooleanStatus(fmi2Terminated))
        except Exception:
            return False

    def save_and_restore(self, serialize: bool) -> None:
        """Save the state, restore it from bytes where that is asked for, and as it is."""
        fmu = self._fmu
        state = fmu.getFMUState()
        if serialize:
            copy = fmu.deserializeFMUState(fmu.serializeFMUState(state))
            fmu.setFMUState(copy)
            fmu.freeFMUState(copy)
        fmu.setFMUState(state)
        fmu.freeFMUState(state)

    def not_finite(self) -> list[str]:
        """Every number of the FMU that is not finite, with its causality, name and value."""
        return [
            f"{v.causality} {v.name} is {value}"
            for v in self._variables.values()
            if v.type in _NUMBERS
            for value in self._values(v)
            if not math.isfinite(value)
        ]

    def get(self, names: Sequence[str]) -> list[float]:
        """Values of variables, or of elements of arrays such as "velocity[3]"."""
        found = (self._place(name) for name in names)
        return [float(self._values(variable)[element]) for variable, element in found]

    def _place(self, name: str) -> tuple[Any, int]:
        """The variable that a name means, and which of its elements."""
        if name in self._variables:
            return self._variables[name], 0
        array, _, places = name.removesuffix("]").rpartition("[")
        variable, element = self._variables[array], 0
        for size, place in zip(variable.shape, places.split(","), strict=True):
            element = element * size + int(place) - 1
        return variable, element

    def _kind(self, variable: Any) -> str:  # noqa: ANN401 - of FMPy
        kind: str = variable.type
        return self._kinds.get(kind, kind)

    def _set(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            variable, element = self._place(name)
            kind = self._kind(variable)
            if kind == "Boolean":
                value = bool(value)
            elif kind != "String":
                value = float(value) if kind in (*_NUMBERS, "Float32") else round(float(value))
            content = self._values(variable) if variable.shape else [value]
            content[element] = value
            getattr(self._fmu, f"set{kind}")([variable.valueReference], content)

    def _values(self, variable: Any) -> list[Any]:  # noqa: ANN401 - of FMPy
        """All elements of a variable."""
        more = {"nValues": math.prod(variable.shape)} if variable.shape else {}
        found: list[Any] = getattr(self._fmu, f"get{self._kind(variable)}")([variable.valueReference], **more)
        return found

    def raw(self, name: str, *arguments: Any) -> tuple[int, list[bytearray]]:  # noqa: ANN401
        """Call a function of `RAW`: its status, and what it made of memory that it may write, the bytearrays."""
        function = self._function(name)
        memory = [a for a in arguments if isinstance(a, bytearray)]
        given = ((c_char * len(a)).from_buffer(a) if isinstance(a, bytearray) else a for a in arguments)
        return function(self._fmu.component, *given), memory

    def _function(self, name: str) -> Any:  # noqa: ANN401 - of ctypes
        """A function of the binary that takes addresses; what FMPy declares takes arrays."""
        if name not in self._raw:
            self._raw[name] = function = self._fmu.dll[name]
            function.argtypes = (c_void_p, *RAW[name])
        return self._raw[name]

    def offers(self, name: str) -> bool:
        """Whether the binary has a function of `RAW`."""
        try:
            return self._function(name) is not None
        except AttributeError:
            return False

    def close(self) -> None:
        """Terminate, where it was initialised here, and free the instance."""
        fmu, self._fmu = self._fmu, None
        if fmu is not None and fmu.component:
            if self._initialized:
                fmu.terminate()
            fmu.freeInstance()


def serve(connection: Connection) -> None:
    """Answer until the instance is closed, or there is nobody who asks."""

    def send(kind: str, content: object) -> None:
        connection.send_bytes(pickle.dumps((kind, content)))

    instance = Instance(send)
    send(ANSWERED, None)
    while True:
        try:
            name, arguments = pickle.loads(connection.recv_bytes())
        except (EOFError, OSError):
            return
        instance.begin()
        try:
            answer = ANSWERED, getattr(instance, name)(*arguments)
        except Exception as error:
            answer = REFUSED, instance.why(error)
        with suppress(OSError):
            send(*answer)
        if name == "close":
            return


def _end_with(parent: int, pipe: int) -> None:
    """End this process, and those that the FMU started, with the process that asks, even where the FMU hangs."""
    watched = select.poll()
    watched.register(pipe, 0)
    while os.getppid() == parent and not any(event & select.POLLHUP for _, event in watched.poll(_LOOK)):
        pass
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_IGN)
    end = Connection(int(sys.argv[1]))
    Thread(target=_end_with, args=(os.getppid(), end.fileno()), daemon=True).start()
    serve(end)
