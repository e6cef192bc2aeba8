"""The process of an FMU that has signals: `python -m orchestrator.cosim.signals.host END`, the number of a pipe's end.

It answers requests, a name and arguments, by (True, what was asked for, what the FMU warned of) or (False, why not,
what it warned of). Signals of the system are for the process that asks: this one ends
with it.
"""

from __future__ import annotations

import os
import signal
import sys
from collections import deque
from collections.abc import Mapping, Sequence
from multiprocessing.connection import Connection
from threading import Thread
from time import sleep
from typing import Any

from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Terminated
from fmpy.simulation import instantiate_fmu

from components.contract.errors import shortened
from orchestrator.assembly.array_elements import element, length

Value = float | int | bool | str
_OK, _WARNING = 0, 1
_DISCARD = 2
_ENDS = "it asks for the end of the simulation"
_FMI2_KINDS = {"Enumeration": "Integer"}
_FMI3_KINDS = {"Enumeration": "Int64"}


class Host:
    """One instance of an FMU; its calls raise where the FMU refuses."""

    def __init__(self) -> None:
        self.said: deque[str] = deque(maxlen=1)
        """last message of a call: the last that tells more than that all is well, where there is one"""
        self.warned: list[str] = []
        self._worst = _OK
        self._fmu: Any = None

    def open(
        self,
        folder: str,
        start: Mapping[str, Value],
        inputs: Sequence[str],
        outputs: Sequence[str],
        values: Sequence[float],
        tolerance: float,
    ) -> list[float]:
        """Instantiate what is unpacked in a folder, initialise it at t = 0 with these inputs, and give its outputs.

        tolerance: relative accuracy of the experiment.
        """
        description = read_model_description(folder, validate=False)
        self._fmi2 = description.fmiVersion.startswith("2.")
        self._variables = {v.name: v for v in description.modelVariables}
        self._inputs, self._outputs = tuple(inputs), tuple(outputs)
        self._found = {name: self._variable(name) for name in (*start, *inputs, *outputs)}
        # without logging many FMUs do not even say why they fail
        self._fmu = instantiate_fmu(folder, description, "CoSimulation", debug_logging=True, logger=self._log)
        if self._fmi2:
            self._fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
        for name, value in start.items():
            self._set(name, value)
        self._fmu.enterInitializationMode(**({} if self._fmi2 else {"tolerance": tolerance}))
        self._hand_over(values)
        self._fmu.exitInitializationMode()
        return self._given()

    def sample(self, time: float, h: float, values: Sequence[float]) -> list[float]:
        """Step from a time (s) over h with the inputs of the end, and give the outputs."""
        self._hand_over(values)
        if self._fmi2:
            if self._do_step2(time, h) == _WARNING and not self.warned:
                self.warned.append(" ".join(self.said) or "a warning without a word")
            return self._given()
        _, terminates, early, reached = self._fmu.doStep(
            currentCommunicationPoint=time, communicationStepSize=h
        )
        if terminates:
            raise RuntimeError(_ENDS)
        if early:
            raise RuntimeError(f"it returned early, at t = {reached:.6g} s, which was not allowed to it")
        return self._given()

    def _do_step2(self, time: float, h: float) -> int:
        """Its status; FMI 2.0 discards the step of an FMU that has to end, as one that is too large."""
        try:
            status: int = self._fmu.fmi2DoStep(self._fmu.component, time, h, 1)
        except FMICallException as error:
            if error.status == _DISCARD and self._terminates2():
                raise RuntimeError(_ENDS) from None
            raise
        return status

    def _terminates2(self) -> bool:
        """Whether it reports that it has to end."""
        try:
            return bool(self._fmu.getBooleanStatus(fmi2Terminated))
        except Exception:
            return False

    def _log(self, *arguments: Any) -> None:  # noqa: ANN401 - FMI 2.0 and 3.0 differ
        status, _, text = arguments[-3:]
        message = shortened(text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text))
        if status == _WARNING:
            self.warned.append(message)
        if status >= self._worst:
            self._worst = status
            self.said.append(message)

    def reason_of(self, error: Exception) -> str:
        """Why a call failed: what this process says of it, else what the FMU said that is no good news."""
        if not isinstance(error, FMICallException):
            return f"{error}" or type(error).__name__
        return (" ".join(" ".join(self.said).split()) if self._worst > _OK else "") or f"{error}"

    def forget_messages(self) -> None:
        """Before the next call."""
        self.said.clear()
        self.warned.clear()
        self._worst = _OK

    def _variable(self, name: str) -> tuple[Any, int, int]:
        """A variable, how many elements it has, and the place of the one that a name means."""
        if name in self._variables:
            return self._variables[name], 1, 0
        array, place = element(name) or (name, 0)
        return self._variables[array], length(self._variables[array]) or 1, place

    def _kind(self, name: str) -> str:
        kind = self._found[name][0].type
        found: str = (_FMI2_KINDS if self._fmi2 else _FMI3_KINDS).get(kind, kind)
        return found

    def _set(self, name: str, value: Value) -> None:
        kind = self._kind(name)
        if kind == "Boolean":
            value = bool(value)
        elif kind != "String":
            value = float(value) if kind in ("Real", "Float64", "Float32") else round(float(value))
        variable, size, place = self._found[name]
        values = [value] if size == 1 else self._values(name)
        values[place] = value
        getattr(self._fmu, f"set{kind}")([variable.valueReference], values)

    def _hand_over(self, values: Sequence[float]) -> None:
        for name, value in zip(self._inputs, values, strict=True):
            self._set(name, value)

    def _given(self) -> list[float]:
        return [float(self._values(name)[self._found[name][2]]) for name in self._outputs]

    def _values(self, name: str) -> list[Any]:
        """All elements of the variable that a name is of."""
        variable, size, _ = self._found[name]
        more = {} if size == 1 else {"nValues": size}
        found: list[Any] = getattr(self._fmu, f"get{self._kind(name)}")([variable.valueReference], **more)
        return found

    def close(self) -> None:
        """Terminate and free the instance."""
        if self._fmu is not None:
            self._fmu.terminate()
            self._fmu.freeInstance()


def serve(connection: Connection) -> None:
    """Answer until there is nobody who asks."""
    host = Host()
    while True:
        try:
            name, arguments = connection.recv()
        except (EOFError, OSError):
            return
        try:
            answer = True, getattr(host, name)(*arguments), list(host.warned)
        except Exception as error:
            answer = False, host.reason_of(error), list(host.warned)
        host.forget_messages()
        connection.send(answer)


def _end_with(parent: int) -> None:
    """End this process when the one that asks has gone, even where the FMU hangs."""
    while os.getppid() == parent:
        sleep(1.0)
    os._exit(1)


if __name__ == "__main__":
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_IGN)
    Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    serve(Connection(int(sys.argv[1])))
