"""A component at work in the compiled library of this process, without an FMU file around it.

Its calls are those of `components.Instance`, which computes the same in Python a hundred times as slowly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from ctypes import (
    CDLL,
    CFUNCTYPE,
    Array,
    Structure,
    byref,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint32,
    c_void_p,
    create_string_buffer,
)
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary, finalize

import numpy as np

import components
from components import Component, ComponentError, Instance
from components.cache.disk import replace_file
from components.cache.temporary import process_folder
from components.contract.component import Vector
from components.contract.instance import Value

from .archive import digest_of
from .description.variables import StartValue, start_values
from .native import equations, native_library
from .native.binary_data import component_bytes
from .native.compile import ASSEMBLY

NO_GUID = "{00000000-0000-0000-0000-000000000000}"
MODEL_EXCHANGE, CO_SIMULATION = 0, 1
"""Types of instances (fmi2Type)."""
_WARNING = 1
_DATA = "component.bin"
_Log = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)


class _Callbacks(Structure):
    """fmi2CallbackFunctions; the library allocates its memory itself."""

    _fields_ = (
        ("logger", _Log),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


_VALUES = (c_void_p, c_void_p, c_size_t, c_void_p)
_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "SetupExperiment": (c_void_p, c_int, c_double, c_double, c_int, c_double),
    "EnterInitializationMode": (c_void_p,),
    "ExitInitializationMode": (c_void_p,),
    "Reset": (c_void_p,),
    "SetReal": _VALUES,
    "GetReal": _VALUES,
    "DoStep": (c_void_p, c_double, c_double, c_int),
    "NewDiscreteStates": (c_void_p, c_void_p),
    "GetFMUstate": (c_void_p, c_void_p),
    "SetFMUstate": (c_void_p, c_void_p),
    "FreeFMUstate": (c_void_p, c_void_p),
    "SerializedFMUstateSize": (c_void_p, c_void_p, c_void_p),
    "SerializeFMUstate": (c_void_p, c_void_p, c_void_p, c_size_t),
    "DeSerializeFMUstate": (c_void_p, c_char_p, c_size_t, c_void_p),
    "FreeInstance": (c_void_p,),
}
"""Functions of FMI 2.0 that are called here, with their arguments."""
_EVENT_INFO = 64
"""Bytes that are room for fmi2EventInfo."""


def native_backend(component: Component) -> bool:
    """Whether a component can be exported as a native FMU here: compiled at installation, and with a kernel."""
    return native_library() is not None and has_kernel(component)


def has_kernel(component: Component) -> bool:
    """A kernel has the name of the component's file; kinds from outside have none, whatever data their bases give."""
    if component.kind == ASSEMBLY:
        return True
    package, _, file = type(component).__module__.rpartition(".")
    ours = package == components.__name__ and file in equations()
    return ours and component.native_data() is not None


def component_data(component: Component, start: Mapping[str, StartValue]) -> bytes:
    """What a native FMU of a component carries of it, for one inside of another FMU."""
    return component_bytes(component, start_values(component, start), NO_GUID)


@cache
def functions() -> CDLL:
    """The compiled library with the types of arguments of its functions of FMI 2.0."""
    found = CDLL(str(native_library()))
    for name, arguments in _FUNCTIONS.items():
        getattr(found, f"fmi2{name}").argtypes = arguments
    found.fmi2Instantiate.argtypes = (c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int)
    found.fmi2Instantiate.restype = c_void_p
    return found


_folders: WeakKeyDictionary[Component, Path] = WeakKeyDictionary()


def _resources(component: Component) -> Path:
    """A folder with the data of a component, which do not depend on the values of its parameters."""
    if component not in _folders:
        _folders[component] = _folder_of(component_data(component, {}))
    return _folders[component]


def _folder_of(data: bytes) -> Path:
    folder = process_folder() / f"data-{sha256(data).hexdigest()}"
    folder.mkdir(exist_ok=True)
    replace_file(folder / _DATA, data)
    return folder


@cache
def _library_digest() -> str:
    """Of the compiled library."""
    path = native_library()
    assert path is not None
    return sha256(path.read_bytes()).hexdigest()


class InLibrary:
    """An instance of a component, or of its data, in the compiled library; ComponentError where it cannot be.

    kind: `MODEL_EXCHANGE` or `CO_SIMULATION`. log: receives what it has to say. library: the functions; handle: their
    first argument, valid until `close`.
    """

    def __init__(
        self, component: Component | bytes, name: str, kind: int, log: Callable[[str], object]
    ) -> None:
        self.library = functions()
        if isinstance(component, bytes):
            self._resources = _folder_of(component)
        else:
            self._resources = _resources(component)
        self._callbacks = _Callbacks(_Log(lambda *words: log(words[-1].decode("utf-8", "replace"))))
        self.handle = c_void_p(
            self.library.fmi2Instantiate(
                name.encode(),
                kind,
                NO_GUID.encode(),
                str(self._resources).encode(),
                byref(self._callbacks),
                0,
                1,
            )
        )
        if not self.handle:
            raise ComponentError(f"{name}: the compiled library refuses it")
        self.close = finalize(self, self.library.fmi2FreeInstance, self.handle)
        self.library.fanfoldAcceptNumbers(self.handle)

    def digest(self, values: Vector) -> str:
        """SHA-256 of all that it computes with: the library, its data, and values of parameters and inputs."""
        parts = {_DATA: self._resources.name, "start": values.tobytes().hex(), "library": _library_digest()}
        return digest_of({name: text.encode() for name, text in parts.items()})


def at_work(
    component: Component, start: Mapping[str, Value], *, makes_steps: bool
) -> Instance | CompiledInstance:
    """An instance of a component in the compiled library where that has its kernel, otherwise in Python."""
    if native_backend(component) and (makes_steps or component.continuous is not None):
        return CompiledInstance(component, start, makes_steps=makes_steps)
    return Instance(component, start)


class CompiledInstance:
    """A component with values by name, as `Instance` is.

    It either makes steps or, for model exchange, follows events by `update`. Parameters are fixed from `initialize` on.
    inputs: (input_layout.size,), written to in place.
    """

    def __init__(self, component: Component, start: Mapping[str, Value], *, makes_steps: bool) -> None:
        self.component = component
        first = component.parameter_layout.size
        self._values = np.concatenate(
            (component.parameter_layout.start_values(), component.input_layout.start_values())
        )
        self.inputs: Vector = self._values[first:]
        self._outputs = component.output_layout.start_values()
        for name, value in start.items():
            layout, values = (
                (component.input_layout, self.inputs)
                if name in component.input_layout
                else (component.parameter_layout, self._values[:first])
            )
            values[layout[name]] = value
        place, count = self._values.ctypes.data, len(self._values)
        self._known = _range(0, count), place
        self._input = _range(first, count - first), place + first * self._values.itemsize
        self._output = _range(count, len(self._outputs)), self._outputs.ctypes.data
        self._said: list[str] = []
        kind = CO_SIMULATION if makes_steps else MODEL_EXCHANGE
        self._instance = InLibrary(component, component.kind, kind, self._said.append)
        self._state = c_void_p()
        one = self._instance
        finalize(self, one.library.fmi2FreeFMUstate, one.handle, byref(self._state))

    def set(self, name: str, value: Value) -> None:
        """Change an input."""
        self.inputs[self.component.input_layout[name]] = value

    def initialize(self) -> None:
        """Take the state that belongs to the parameters and the present inputs."""
        self._values_of("SetReal", self._known)
        self._call("EnterInitializationMode")
        self._call("ExitInitializationMode")
        self._call("GetFMUstate", byref(self._state))

    def return_to_start(self) -> None:
        """Take the state of `initialize` again."""
        self._call("SetFMUstate", self._state)

    def step(self, h: float) -> None:
        """Step over h (s)."""
        self._values_of("SetReal", self._input)
        self._call("DoStep", 0.0, h, 0)

    def update(self, at_event: bool) -> None:
        """Let happen what does at an event."""
        self._values_of("SetReal", self._input)
        self._call("NewDiscreteStates", create_string_buffer(_EVENT_INFO))

    def outputs(self) -> Vector:
        """Outputs in declared order."""
        self._values_of("SetReal", self._input)
        self._values_of("GetReal", self._output)
        return self._outputs.copy()

    def _values_of(self, name: str, where: tuple[_References, int]) -> None:
        references, place = where
        self._call(name, references, len(references), place)

    def _call(self, name: str, *arguments: Any) -> None:  # noqa: ANN401 - of ctypes
        """A function of FMI; ComponentError with the kernel's words where it fails."""
        if getattr(self._instance.library, f"fmi2{name}")(self._instance.handle, *arguments) > _WARNING:
            raise self._refusal()

    def _refusal(self) -> ComponentError:
        sentence = "".join(self._said[-1:])
        self._said.clear()
        return ComponentError(sentence.partition(" s: ")[2] or sentence)


_References = Array[c_uint32]


def _range(first: int, count: int) -> _References:
    """Value references in a row."""
    return (c_uint32 * count)(*range(first, first + count))


def run_through(data: bytes, times: Sequence[float], references: range) -> Vector:
    """Values (times, references) at communication points (s) of a run of a component from its data.

    Inputs stay at their start values. ComponentError where the run fails.
    """
    said: list[str] = []
    one = InLibrary(data, "run", CO_SIMULATION, said.append)
    wanted, values = _range(references.start, len(references)), np.zeros((len(times), len(references)))

    def call(name: str, *arguments: Any) -> None:  # noqa: ANN401 - of ctypes
        if getattr(one.library, f"fmi2{name}")(one.handle, *arguments) > _WARNING:
            raise ComponentError("".join(said[-1:]) or f"{name} fails")

    try:
        call("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        call("EnterInitializationMode")
        call("ExitInitializationMode")
        before = 0.0
        for time, row in zip(times, values, strict=True):
            if time > before:
                call("DoStep", before, time - before, 1)
            call("GetReal", wanted, len(wanted), row.ctypes.data)
            before = time
    finally:
        one.close()
    return values
