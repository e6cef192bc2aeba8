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
from fmpy.fmi2 import (
    FMU2Model,
    FMU2Slave,
    calloc,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2Terminated,
    free,
)
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free
from fmpy.fmi3 import FMU3Model, FMU3Slave, fmi3Boolean, fmi3Float64

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
    **{
        f"fmi2{verb}{kind}": (c_void_p, c_size_t, c_void_p)
        for verb in ("Set", "Get")
        for kind in ("Boolean", "Integer")
    },
    "fmi2DoStep": (c_double, c_double, c_int),
    "fmi2GetFMUstate": (c_void_p,),
    "fmi2SetFMUstate": (c_void_p,),
    "fmi2FreeFMUstate": (c_void_p,),
    "fmi2SerializedFMUstateSize": (c_void_p, c_void_p),
    "fmi2SerializeFMUstate": (c_void_p, c_void_p, c_size_t),
    "fmi2DeSerializeFMUstate": (c_void_p, c_size_t, c_void_p),
    "fmi2GetDirectionalDerivative": (c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_void_p),
    "fanfoldGetPortStiffness": (c_size_t, c_void_p),
    "fanfoldAcceptNumbers": (),
}
"""Functions that can be called as they are, and their arguments after the instance; pointers are those of memory."""
_ENDS = "it asks for the end of the simulation"
_KINDS = {"2": {"Enumeration": "Integer"}, "3": {"Enumeration": "Int64"}}
_NUMBERS = ("Real", "Float64")
_LONGEST = 1000
"""Characters of a message, of which nobody reads more."""
_LOOK = 1000
"""Time (ms) between two looks at who the parent is."""
_TOLERANCE = 1e-4
"""Of model exchange in an experiment without one."""
_ROUND_OFF = 1e-12
"""Relative difference of times that are one."""
_ONE_STEP, _ROOT, _FAILED, _SMALLER = 2, 2, -1, 1
"""Of CVODE: a task, a result, and what its callbacks return: failure, and that a smaller step may succeed."""


class _Refusal(Exception):
    """A sentence of this process, not of the FMU."""


class _EndError(Exception):
    """The FMU asks for the end of the simulation."""


class _OutsideError(_Refusal):
    """The equations of the FMU have no value at a state that CVODE tries."""


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


class FMU2Exchange(_Lenient, FMU2Model):  # type: ignore[misc]
    """Of FMI 2.0 for model exchange, with the names of FMI 3.0."""

    getContinuousStateDerivatives = FMU2Model.getDerivatives
    updateDiscreteStates = FMU2Model.newDiscreteStates

    def sizes(self, description: Any) -> tuple[int, int]:  # noqa: ANN401 - of FMPy
        """Numbers of continuous states and of event indicators."""
        return description.numberOfContinuousStates, description.numberOfEventIndicators


class FMU3Exchange(_Lenient, FMU3Model):  # type: ignore[misc]
    """Of FMI 3.0 for model exchange."""

    def sizes(self, _: Any) -> tuple[int, int]:  # noqa: ANN401 - of FMPy
        """Numbers of continuous states and of event indicators, which structural parameters may change."""
        return self.getNumberOfContinuousStates(), self.getNumberOfEventIndicators()


class Integration:
    """Integrates a model-exchange FMU by CVODE (backward differentiation) from one communication point to the next.

    Inputs are constant over a step; a change of them is an event, as are roots of event indicators, times that the FMU
    gives, and steps after which it asks for one. Each restarts CVODE. Times are in s.

    fmu, description: after initialization mode, and as FMPy reads it. tolerance: relative error of a step; times the
    nominal value of a state it is the absolute one.
    """

    def __init__(self, fmu: Any, description: Any, tolerance: float) -> None:  # noqa: ANN401 - of FMPy
        try:
            from fmpy import sundials
        except OSError:
            raise _Refusal(
                "it has model exchange only, and FMPy has no CVODE for this platform; export it for co-simulation"
            ) from None
        self._fmu, self._cv, self._tolerance = fmu, sundials, tolerance
        self._completes = description.modelExchange.needsCompletedIntegratorStep
        self._time, self._next, self._memory = 0.0, math.inf, 0
        self._failure: Exception | None = None
        self._words = ""
        self._settle()
        self._states, indicators = fmu.sizes(description)
        rates = (u.variable for u in description.derivatives)
        self._rate_names = [f"its {v.name}" for v in rates for _ in range(math.prod(v.shape))]
        if len(self._rate_names) != self._states:
            raise _Refusal(
                f"its binary has {self._states} continuous states, its model description {len(self._rate_names)}"
            )
        self._root_names = [f"its event indicator {k + 1}" for k in range(indicators)]
        self._create()
        self._restart()

    def _create(self) -> None:
        """Memory of CVODE, which ends with this process. It has a state, at rest, where the FMU has none."""
        cv, context, size = self._cv, self._cv.SUNContext(), max(1, self._states)
        cv.SUNContext_Create(cv.SUN_COMM_NULL, byref(context))
        cv.sundials_core.SUNContext_ClearErrHandlers(context)  # which print
        self._callbacks = (
            cv.CVRhsFn(self._rates),
            cv.CVRootFn(self._roots),
            cv.SUNErrHandlerFn(self._note),
        )
        cv.SUNContext_PushErrHandler(context, self._callbacks[2], None)
        self._x, self._error = (cv.N_VNew_Serial(size, context) for _ in range(2))
        self._values, self._errors = cv.NV_DATA_S(self._x), cv.NV_DATA_S(self._error)
        self._values[0] = self._errors[0] = 1.0
        self._memory = cv.CVodeCreate(cv.CV_BDF, context)
        matrix = cv.SUNDenseMatrix(size, size, context)
        cv.CVodeInit(self._memory, self._callbacks[0], self._time, self._x)
        cv.CVodeRootInit(self._memory, len(self._root_names), self._callbacks[1])
        cv.CVodeSetNoInactiveRootWarn(self._memory)
        cv.CVodeSetLinearSolver(self._memory, cv.SUNLinSol_Dense(self._x, matrix, context), matrix)
        for name, number in (("CVodeSetStopTime", c_double), ("CVodeSetMaxHnilWarns", c_int)):
            getattr(cv.sundials_cvode, name).argtypes = c_void_p, number
        cv.sundials_cvode.CVodeSetMaxHnilWarns(self._memory, -1)  # which are printed

    def event(self, change: Callable[[], None] = lambda: None) -> None:
        """Change inputs, and all that is discrete, at the present time."""
        self._fmu.enterEventMode()
        change()
        self._settle()
        self._restart()

    def _settle(self) -> None:
        """From event mode to continuous-time mode."""
        again = True
        while again:
            again, ends, _, _, has_next, time = self._fmu.updateDiscreteStates()
            if ends:
                raise _EndError
        self._next = time if has_next else math.inf
        self._fmu.enterContinuousTimeMode()

    def _restart(self) -> None:
        """From the present states of the FMU, which an event may have set."""
        if self._states:
            self._fmu.getContinuousStates(self._values, self._states)
            self._fmu.getNominalsOfContinuousStates(self._errors, self._states)
        for k in range(self._states):
            nominal = self._errors[k]
            if not (nominal > 0.0 and math.isfinite(nominal)):
                raise _Refusal(
                    f"the nominal value of its continuous state {k + 1} is {nominal:g}, not above zero"
                )
            self._errors[k] = nominal * self._tolerance
        self._cv.CVodeSVtolerances(self._memory, self._tolerance, self._error)
        self._cv.CVodeReInit(self._memory, self._time, self._x)

    def reach(self, end: float) -> None:
        """Integrate up to a time, with all events until then."""
        while True:
            if self._is_at(self._next):
                self._time = max(self._time, self._next)
                self._fmu.setTime(self._time)
                self.event()
            elif self._is_at(end):
                return
            elif self._advance(min(self._next, end)):
                self.event()

    def _is_at(self, time: float) -> bool:
        return self._time >= time or math.isclose(self._time, time, rel_tol=_ROUND_OFF)

    def _advance(self, goal: float) -> bool:
        """Make one step of CVODE towards a time, or to it; whether an event follows."""
        reached, self._failure = c_double(), None
        self._cv.sundials_cvode.CVodeSetStopTime(self._memory, goal)
        result = self._cv.CVode(self._memory, goal, self._x, byref(reached), _ONE_STEP)
        if result < 0:
            raise self._failure or _Refusal(
                f"CVODE cannot integrate it at t = {self._time:.6g} s: {self._words}"
            )
        self._time = reached.value
        self._put(self._time, self._values)
        asks, ends = self._fmu.completedIntegratorStep() if self._completes else (False, False)
        if ends:
            raise _EndError
        return bool(asks) or result == _ROOT

    def _put(self, time: float, values: Any) -> None:  # noqa: ANN401 - of ctypes
        self._fmu.setTime(time)
        if self._states:
            self._fmu.setContinuousStates(values, self._states)

    def _rates(self, time: float, x: Any, rates: Any, _: Any) -> int:  # noqa: ANN401 - of ctypes
        """Derivatives of the states, for CVODE."""
        into = self._cv.NV_DATA_S(rates)
        into[0] = 0.0
        return self._evaluate("getContinuousStateDerivatives", self._rate_names, time, x, into)

    def _roots(self, time: float, x: Any, into: Any, _: Any) -> int:  # noqa: ANN401 - of ctypes
        """Event indicators, for CVODE."""
        return self._evaluate("getEventIndicators", self._root_names, time, x, into)

    def _evaluate(self, function: str, names: Sequence[str], time: float, x: Any, into: Any) -> int:  # noqa: ANN401
        """Let a function of the FMU write numbers; the result that CVODE needs, as exceptions would be lost in it."""
        try:
            self._put(time, self._cv.NV_DATA_S(x))
            if names:
                getattr(self._fmu, function)(into, len(names))
            for name, value in zip(names, into, strict=False):
                if not math.isfinite(value):
                    raise _OutsideError(f"{name} is {value:g} at t = {time:.6g} s")
        except Exception as error:
            self._failure = error
            outside = isinstance(error, _OutsideError) or getattr(error, "status", None) == DISCARD
            return _SMALLER if outside else _FAILED
        return 0

    def _note(self, *arguments: Any) -> None:  # noqa: ANN401 - of ctypes
        self._words = arguments[3].decode("utf-8", "replace")


def shape_of(variable: Any, given: Mapping[str, Value]) -> tuple[int, ...]:  # noqa: ANN401 - of FMPy
    """Elements of an array by dimension, which may be the value of a structural parameter; () for a scalar."""
    return tuple(
        int(d.start if d.variable is None else given.get(d.variable.name, d.variable.start))
        for d in variable.dimensions or ()
    )


class Instance:
    """One instance of an FMU 2.0 or 3.0; its methods raise where the FMU refuses.

    One without co-simulation is integrated here, which nothing outside notices.
    """

    def __init__(self, send: Callable[..., None]) -> None:
        self._send = send
        self._fmu: Any = None
        self._initialized = False
        self._integration: Integration | None = None
        self._inputs: Mapping[str, Value] = {}
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
        if description.coSimulation is None and any(
            v.type == "Clock" and v.causality == "input" for v in description.modelVariables
        ):
            raise _Refusal(
                "it has model exchange only, with clocks that nobody ticks; export it for co-simulation"
            )
        steps, exchange = (FMU2Lenient, FMU2Exchange) if self._fmi2 else (FMU3Lenient, FMU3Exchange)
        self._fmu = fmu = (steps if description.coSimulation else exchange)(
            guid=description.guid,
            modelIdentifier=(description.coSimulation or description.modelExchange).modelIdentifier,
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
        if isinstance(error, _EndError):
            return self._ends()
        said = "" if isinstance(error, _Refusal) else self._last
        return said or f"{error}" or type(error).__name__

    def initialize(
        self,
        start: Mapping[str, Value],
        inputs: Mapping[str, Value],
        tolerance: float | None,
        until: float | None = None,
    ) -> None:
        """From the new instance to its first communication point, t = 0.

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
        self._initialized, self._inputs = True, inputs
        if self._description.coSimulation is None:
            self._integration = Integration(self._fmu, self._description, tolerance or _TOLERANCE)

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
        if self._integration is None:
            self._set(inputs)
        elif inputs != self._inputs:
            self._integration.event(lambda: self._set(inputs))
        self._inputs = inputs
        if ended := self.step(time, h):
            raise _Refusal(ended)
        return self.get(outputs)

    def step(self, time: float, h: float) -> str:
        """Step from a time (s) over h; why the FMU ended before, empty where it did not."""
        if self._integration is not None:
            self._integration.reach(time + h)
            return ""
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
