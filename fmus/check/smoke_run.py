"""A short run of an FMU in a process of its own, because a bad binary ends it.

    python -P trial.py FMU FOLDER

unpacks into the folder and prints what it is about to do, each on a line that begins with `DOING`, and as the last line
a JSON string: what went wrong, or nothing. Needs FMPy only.
"""

from __future__ import annotations

import json
import math
import sys
from abc import ABC, abstractmethod
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, calloc, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, free
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free
from fmpy.fmi3 import FMU3Slave

DOING = "now to be "


class _Trial(ABC):
    """An instance, what it says, and what is being done with it."""

    fmu: Any
    doing: str

    def __init__(self, description: Any, folder: str) -> None:  # noqa: ANN401
        self.description = description
        self.interface = description.coSimulation
        self.log: list[str] = []
        self._arguments = {
            "guid": description.guid,
            "unzipDirectory": folder,
            "instanceName": "trial",
            "modelIdentifier": self.interface.modelIdentifier,
        }

    def run(self) -> None:
        """Two steps with the default start values, a state saved and restored, every variable read."""
        self._begin("instantiated")
        self.instantiate()
        self._begin("initialized with its default start values")
        self.initialize()
        experiment = self.description.defaultExperiment
        h = float(experiment.stepSize or 1e-3) if experiment is not None else 1e-3
        self._begin(f"stepped by {h:g} s with its default start values")
        self.fmu.doStep(0.0, h)
        if self.interface.canGetAndSetFMUstate:
            self._begin("saved and restored")
            self.save_and_restore()
        self._begin("stepped a second time")
        self.fmu.doStep(h, h)
        self._begin("read")
        bad = [f"{name} is {value}" for name, value in self.values() if not math.isfinite(value)]
        if bad:
            self.log.append(f"after two steps {bad[0]}")
            raise ValueError
        self._begin("ended")
        self.fmu.terminate()
        self.fmu.freeInstance()

    def _begin(self, doing: str) -> None:
        """Note what comes next, for the case that it ends the process."""
        self.doing = doing
        print(f"\n{DOING}{doing}", flush=True)

    @abstractmethod
    def instantiate(self) -> None:
        """Make the instance and let it log."""

    @abstractmethod
    def initialize(self) -> None:
        """Pass through initialization mode."""

    @abstractmethod
    def save_and_restore(self) -> None:
        """Save the state, restore it from bytes where that is offered, and as it is."""

    @abstractmethod
    def values(self) -> list[tuple[str, float]]:
        """Causality and name, and value, of every scalar of every variable."""

    def _note(self, status: int, message: bytes | None) -> None:
        if status:
            self.log.append((message or b"").decode(errors="replace"))

    def _variables(self, kind: str) -> list[Any]:
        return [v for v in self.description.modelVariables if v.type == kind]


class _Trial2(_Trial):
    """FMI 2.0."""

    def instantiate(self) -> None:
        self.fmu = FMU2Slave(**self._arguments)
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda e, i, status, c, text: self._note(status, text)
        )
        self._callbacks.allocateMemory = Allocate(calloc)
        self._callbacks.freeMemory = Free(free)
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)

    def initialize(self) -> None:
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def save_and_restore(self) -> None:
        state = self.fmu.getFMUstate()
        if self.interface.canSerializeFMUstate:
            copy = self.fmu.deSerializeFMUstate(self.fmu.serializeFMUstate(state))
            self.fmu.setFMUstate(copy)
            self.fmu.freeFMUstate(copy)
        self.fmu.setFMUstate(state)
        self.fmu.freeFMUstate(state)

    def values(self) -> list[tuple[str, float]]:
        variables = self._variables("Real")
        values = self.fmu.getReal([v.valueReference for v in variables]) if variables else []
        return [(f"{v.causality} {v.name}", value) for v, value in zip(variables, values, strict=True)]


class _Trial3(_Trial):
    """FMI 3.0, without event mode."""

    def instantiate(self) -> None:
        self.fmu = FMU3Slave(**self._arguments)
        self.fmu.instantiate(loggingOn=True, logMessage=lambda e, status, c, text: self._note(status, text))

    def initialize(self) -> None:
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()

    def save_and_restore(self) -> None:
        state = self.fmu.getFMUState()
        if self.interface.canSerializeFMUstate:
            copy = self.fmu.deserializeFMUState(self.fmu.serializeFMUState(state))
            self.fmu.setFMUState(copy)
            self.fmu.freeFMUState(copy)
        self.fmu.setFMUState(state)
        self.fmu.freeFMUState(state)

    def values(self) -> list[tuple[str, float]]:
        found: list[tuple[str, float]] = []
        for v in self._variables("Float64"):
            values = self.fmu.getFloat64([v.valueReference], nValues=math.prod(v.shape))
            found.extend((f"{v.causality} {v.name}", value) for value in values)
        return found


def main(path: str, folder: str) -> str:
    """What went wrong, or an empty string."""
    description = read_model_description(path, validate=False)
    trial = (_Trial2 if description.fmiVersion == "2.0" else _Trial3)(description, folder)
    try:
        trial.doing = "unpacked"
        extract(path, folder)
        trial.run()
    except Exception as error:
        reason = trial.log[0] if trial.log else str(error)
        return f"it cannot be {trial.doing}: {' '.join(reason.split())}"
    return ""


if __name__ == "__main__":
    print("\n" + json.dumps(main(*sys.argv[1:])), flush=True)
