"""The PythonFMU slave of every component: FMI calls on one side, pure functions on a flat state on the other.

An FMU carries this file together with the component. All values live in one array in the order of the value
references: parameters, inputs, outputs, observations. Outputs and observations are computed when they are
read, once per state. PythonFMU turns `do_step` returning False into fmi2Discard and any exception into
fmi2Fatal without its text, so the reason is always put into the log first, as a sentence.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import hashlib
import json
import os
import struct
import sys
from collections.abc import Sequence
from math import inf, isfinite
from pathlib import Path
from typing import Any, ClassVar, NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from components.contract.component import Component, ComponentError, Vector
from components.contract.instance import Instance

COMPONENT_FILE = "component.json"
ARRAYS_FILE = "arrays.npz"

ARRAY_KEY, TUPLE_KEY = "__array__", "__tuple__"
_HEADER = struct.Struct("<16sd?q")
_CHECK = struct.Struct("<I")
_REMEMBERED_ACCESSES = 256
_SAME_TIME = 1e-9
"""Relative tolerance of times."""
_KINDS = {"real": "a real number", "boolean": "a Boolean", "integer": "an integer"}
_TRUE = 0.5
"""Numbers above it are true."""
_NO_STATE: Vector = np.zeros(0)
_RELEASED: set[Path] = set()


def own_once_more(value: object) -> None:
    """Add a reference that nobody holds, for one that PythonFMU gives up without having owned it."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(value))


def release_interpreter_at_exit(resources: Path) -> None:
    """Let the binary of this FMU give up the interpreter while there still is one.

    PythonFMU 0.7 does so at the end of the process, twice, and thereby ends some runs with SIGABRT. Not for a
    host without Python, where the interpreter is PythonFMU's own.
    """
    if resources in _RELEASED or not sys.orig_argv or not hasattr(os, "RTLD_NOLOAD"):
        return
    _RELEASED.add(resources)
    for binary in resources.parent.glob("binaries/*/*.so"):
        with contextlib.suppress(OSError):  # the binaries of other platforms are not loaded
            library = ctypes.CDLL(str(binary), mode=os.RTLD_NOLOAD | os.RTLD_NOW)
            atexit.register(library.finalizePythonInterpreter)


def unpack_value(value: Any, arrays: dict[str, NDArray[Any]]) -> Any:  # noqa: ANN401 - any structure value
    """The structure value that the build turned into JSON data and arrays."""
    if isinstance(value, list):
        return [unpack_value(item, arrays) for item in value]
    if isinstance(value, dict):
        if ARRAY_KEY in value:
            return arrays[value[ARRAY_KEY]]
        if TUPLE_KEY in value:
            return tuple(unpack_value(item, arrays) for item in value[TUPLE_KEY])
        return {key: unpack_value(item, arrays) for key, item in value.items()}
    return value


class _Access(NamedTuple):
    """Where the variables of one list of value references are, and what touching them entails."""

    references: list[int]
    place: slice | NDArray[np.intp]
    layout: struct.Struct | None  # of a contiguous range: several times faster than indexing
    offset: int
    parameters: bool
    outputs: bool
    observations: bool


_NOWHERE = _Access([-1], slice(0, 0), None, 0, False, False, False)


class SavedState(NamedTuple):
    """Everything that determines the future of an instance; no state is one not yet computed."""

    owner: bytes
    time: float
    initialized: bool
    known: Vector
    state: Vector


class ComponentSlave(Fmi2Slave):  # type: ignore[misc] # PythonFMU has no type information
    """FMI slave of the component class named by a subclass, built from the FMU's resources."""

    component_class: ClassVar[type[Component]]

    def __init__(self, **kwargs: Any) -> None:  # noqa: ANN401 - PythonFMU's keyword arguments
        """Build the component; PythonFMU passes instance name and resources folder."""
        super().__init__(**kwargs)
        self._time = 0.0
        self._stop_time = inf
        self._initialized = False
        self._broken: BaseException | None = None
        try:
            release_interpreter_at_exit(Path(self.resources))
            self._load(Path(self.resources))
        except (Exception, SystemExit) as error:
            # raised again as soon as there is a log to put the reason into
            self._broken = error

    def _load(self, resources: Path) -> None:
        text = (resources / COMPONENT_FILE).read_bytes()
        digest = hashlib.sha256(text)
        arrays: dict[str, NDArray[Any]] = {}
        if (resources / ARRAYS_FILE).exists():
            digest.update((resources / ARRAYS_FILE).read_bytes())
            with np.load(resources / ARRAYS_FILE, allow_pickle=False) as stored:
                arrays = dict(stored)
        content = json.loads(text)
        self._owner = digest.digest()[:16]
        self._place(self.component_class(**unpack_value(content["structure"], arrays)), content["start"])

    def _place(self, component: Component, start: Sequence[float]) -> None:
        """Lay out all values in one array, of which parameters, inputs, ... are views."""
        layouts = component.layouts
        ends = np.cumsum([layout.size for layout in layouts]).tolist()
        self._names = [name for layout in layouts for name in layout.scalar_names()]
        self._kinds = [q.kind for layout in layouts for q in layout.quantities for _ in range(q.size)]
        self._values = np.zeros(ends[-1])
        self._buffer = self._values.data.cast("B")
        self._known = self._values[: ends[1]]
        self._p, self._u, self._y, self._z = (
            self._values[end - layout.size : end] for layout, end in zip(layouts, ends, strict=True)
        )
        self._ends = ends
        self._known[:] = start
        self._instance = Instance(component)
        self._instance.parameters, self._instance.inputs = self._p, self._u
        tunable = [q.variability == "tunable" for q in layouts[0].quantities for _ in range(q.size)]
        self._fixed = {i for i, can_change in enumerate(tunable) if not can_change}
        self._accesses: dict[tuple[int, ...], _Access] = {}
        self._reading = self._writing = _NOWHERE
        self._outputs_known = self._observations_known = False

    # Life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Take the times over, in s; without a stop time the experiment has no end."""
        self._time = start_time
        self._stop_time = inf if stop_time is None else stop_time

    def enter_initialization_mode(self) -> None:
        """Only a check that the instance could be built."""
        if self._broken is not None:
            raise self._failure(self._broken)

    def exit_initialization_mode(self) -> None:
        """Fix the state at the start for the inputs and parameters now set."""
        try:
            self._require_finite(self._u, "input", self._ends[0])
            self._require_state()
            self._require_finite_state()
        except (Exception, SystemExit) as error:
            raise self._failure(error) from None
        self._initialized = True
        self._writing = _NOWHERE

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One step; False, with the reason in the log and the state as before, if it cannot be done."""
        before: Vector | None = None
        try:
            if not (step_size > 0.0 and isfinite(step_size)):
                raise ComponentError(f"the communication step size is {step_size:g} s; it must be positive")
            if not self._initialized:
                raise ComponentError("a step before the end of initialization mode")
            self._require_time(current_time + step_size)
            u = self._u
            if not isfinite(u.dot(u)):  # also when the square overflows, hence the exact check
                self._require_finite(u, "input", self._ends[0])
            before = self._instance.state
            self._instance.step(step_size)
            self._require_finite_state()
        except (Exception, SystemExit) as error:
            if before is not None:
                self._instance.state = before
            self._time = current_time
            self._log_reason(error, Fmi2Status.discard)
            return False
        self._time = current_time + step_size
        self._outputs_known = self._observations_known = False
        return True

    # Variables

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of the given references; computes outputs and observations that are not known yet."""
        try:
            access = self._reading
            if vrs != access.references:
                access = self._reading = self._access(vrs)
            if access.outputs and not self._outputs_known:
                self._require_state()
                self._y[:] = self._instance.outputs()
                self._outputs_known = True
            if access.observations and not self._observations_known:
                self._require_state()
                self._z[:] = self._instance.observe()
                self._observations_known = True
        except (Exception, SystemExit) as error:
            raise self._failure(error) from None
        if access.layout is not None:
            return list(access.layout.unpack_from(self._buffer, access.offset))
        values: list[float] = self._values[access.place].tolist()
        return values

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set inputs and parameters; what follows from them is computed when it is next needed."""
        try:
            access = self._writing
            if vrs != access.references:
                access = self._writing = self._writable(vrs)
            if access.layout is not None:
                access.layout.pack_into(self._buffer, access.offset, *values)
            else:
                self._values[access.place] = values
        except (Exception, SystemExit) as error:
            raise self._failure(error) from None
        self._observations_known = False
        if access.parameters:
            self._instance.set_parameters(self._p)
            self._outputs_known = False
        elif self._instance.component.feedthrough:
            self._outputs_known = False
        if not self._initialized:
            self._instance.state = _NO_STATE
            self._outputs_known = False

    def _access(self, vrs: list[int]) -> _Access:
        """The access of a list of references, remembered because a master asks for the same few."""
        key = tuple(vrs)
        found = self._accesses.get(key)
        if found is None:
            if len(self._accesses) >= _REMEMBERED_ACCESSES:
                self._accesses.clear()
            found = self._accesses[key] = self._locate(vrs)
        return found

    def _locate(self, vrs: list[int]) -> _Access:
        parameters, inputs, outputs, end = self._ends
        for reference in vrs:
            if not 0 <= reference < end:
                raise ComponentError(f"there is no value reference {reference}; it must be below {end}")
        first, size = (vrs[0], len(vrs)) if vrs else (0, 0)
        contiguous = vrs == list(range(first, first + size))
        return _Access(
            list(vrs),
            slice(first, first + size) if contiguous else np.array(vrs),
            struct.Struct(f"={size}d") if contiguous else None,
            first * self._values.itemsize,
            any(r < parameters for r in vrs),
            any(inputs <= r < outputs for r in vrs),
            any(r >= outputs for r in vrs),
        )

    def _writable(self, vrs: list[int]) -> _Access:
        access = self._access(vrs)
        if access.outputs or access.observations:
            name = next(self._names[r] for r in vrs if r >= self._ends[1])
            raise ComponentError(f"{name} is an output; it cannot be set")
        if self._initialized and access.parameters:
            fixed = [self._names[r] for r in vrs if r in self._fixed]
            if fixed:
                raise ComponentError(f"{fixed[0]} is fixed; it cannot be set after initialization")
        return access

    def _require_state(self) -> None:
        """Until initialization ends the state follows from the values set."""
        if not self._instance.state.size:
            self._instance.initialize()

    # Failures

    def _require_time(self, time: float) -> None:
        if time > self._stop_time + _SAME_TIME * (1.0 + abs(self._stop_time)):
            raise ComponentError(f"{time:.9g} s is after the stop time {self._stop_time:.9g} s")

    def _require_finite(self, values: Vector, what: str, first: int) -> None:
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            name = self._names[first + bad[0]]
            raise ComponentError(f"{what} {name} is {values[bad[0]]}; it must be a finite number")

    def _require_finite_state(self) -> None:
        x = self._instance.state
        if isfinite(x.dot(x)):
            return
        bad = np.flatnonzero(~np.isfinite(x))
        if not bad.size:
            return
        sentence = f"the new state is not finite, first x[{bad[0]}] = {x[bad[0]]} of {x.size}"
        outputs = np.flatnonzero(~np.isfinite(self._instance.outputs()))
        if outputs.size:
            sentence += f", seen in output {self._names[self._ends[1] + outputs[0]]}"
        raise ComponentError(sentence)

    def _log_reason(self, error: BaseException, status: Fmi2Status) -> None:
        error = self._broken or error  # nothing else is worth saying of an instance that was never built
        sentence = str(error)
        if not isinstance(error, ComponentError):
            sentence = f"{type(error).__name__} in {self.component_class.kind}: {error}"
        self.log(f"{self.instance_name} at t = {self._time:.9g} s: {sentence}", status)

    def _failure(self, error: BaseException) -> Exception:
        """The error to raise, with its reason in the log and the instance safe from what PythonFMU does then.

        On an exception PythonFMU gives up its references to the instance, its class and its log, and does so
        once more when the instance is freed.
        """
        self._log_reason(error, Fmi2Status.error)
        for given_up in (self, type(self), self.log_queue):
            own_once_more(given_up)
        return error if isinstance(error, Exception) else ComponentError(f"{type(error).__name__}: {error}")

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Values of Booleans, which are 0 or 1 inside."""
        return [value > _TRUE for value in self.get_real(self._of_kind("boolean", vrs))]

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Booleans."""
        self.set_real(self._of_kind("boolean", vrs), [float(value) for value in values])

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of integers."""
        return [int(value) for value in self.get_real(self._of_kind("integer", vrs))]

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set integers."""
        self.set_real(self._of_kind("integer", vrs), [float(value) for value in values])

    def _of_kind(self, kind: str, vrs: list[int]) -> list[int]:
        for reference in vrs:
            own = self._kinds[reference] if 0 <= reference < len(self._kinds) else kind
            if own != kind:
                name = self._names[reference]
                raise self._failure(
                    ComponentError(f"{name} is {_KINDS[own]}; it has no value that is {_KINDS[kind]}")
                )
        return vrs

    def _refuse_texts(self, *_: object) -> None:
        raise self._failure(ComponentError("this FMU has no variables of type String"))

    get_string = set_string = _refuse_texts

    # FMU state

    def _get_fmu_state(self) -> SavedState:
        if self._broken is not None:
            raise self._failure(self._broken)
        state = self._instance.state.copy()
        return SavedState(self._owner, self._time, self._initialized, self._known.copy(), state)

    def _set_fmu_state(self, state: SavedState) -> None:
        if self._broken is not None or state.owner != self._owner:
            raise self._failure(ComponentError("the FMU state belongs to an FMU of other content"))
        if state.known[: self._ends[0]].tobytes() != self._p.tobytes():
            self._instance.set_parameters(state.known[: self._ends[0]])
        self._known[:] = state.known
        self._instance.state = state.state
        self._time = state.time
        if state.initialized != self._initialized:
            self._initialized = state.initialized
            self._writing = _NOWHERE
        self._outputs_known = self._observations_known = False

    @staticmethod
    def _fmu_state_to_bytes(state: SavedState) -> bytes:
        header = _HEADER.pack(state.owner, state.time, state.initialized, state.known.size)
        content = header + state.known.tobytes() + state.state.tobytes()
        return _CHECK.pack(crc32(content)) + content

    @staticmethod
    def _fmu_state_from_bytes(data: bytes) -> SavedState:
        """The state; bytes that are none make a state without owner, which no instance takes."""
        content = data[_CHECK.size :]
        if len(content) < _HEADER.size or _CHECK.pack(crc32(content)) != data[: _CHECK.size]:
            return SavedState(b"", 0.0, False, _NO_STATE, _NO_STATE)
        owner, time, initialized, size = _HEADER.unpack_from(content)
        numbers = np.frombuffer(content, offset=_HEADER.size)
        return SavedState(owner, time, initialized, numbers[:size].copy(), numbers[size:].copy())
