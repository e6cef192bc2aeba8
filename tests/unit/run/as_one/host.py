"""A host that loads a scene as one FMU and knows its variables by name."""

from __future__ import annotations

from functools import cache
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    free,
)

import orchestrator as fanfold

TWO_PANELS = "tests/scenes/two_panels.toml"
STACK = "tests/scenes/snubbed_stack.toml"


def latching(events=None, **scene):
    """A rigid panel that its motor opens by 30 degrees in a second, where a spring latch stops it."""
    tree = {
        "scene": {"name": "latching", "until": 2.0, **scene},
        "base": {"points": {"root": [0.0, 0.0, 0.0]}},
        "body": [
            {
                "name": "panel",
                "rigid": {
                    "mass": 8.0,
                    "center_of_mass": [0.8, 0.0, 0.0],
                    "inertia": [0.9, 1.8, 2.7],
                    "points": {"root": [0.0, 0.0, 0.0]},
                },
            }
        ],
        "hinge_line": [
            {
                "name": "HL",
                "inboard": "base",
                "outboard": "panel",
                "axis": "+y",
                "aligned_angle": "90 deg",
                "start_angle": "60 deg",
                "latch": {"kind": "spring", "stiffness": "2e4 N.m/rad", "damping_ratio": 0.02},
                "motor": {"stowed": "8 N.m", "deployed": "8 N.m"},
                "hinges": [{"name": "root", "inboard": "root", "outboard": "root"}],
            }
        ],
        **({"event": events} if events else {}),
    }
    return fanfold.Scene.of_tree("latching.toml", tree)


@cache
def unpacked(path: str) -> TemporaryDirectory[str]:
    """The folder of an FMU's files, which goes when the process ends."""
    folder = TemporaryDirectory()
    fmpy.extract(path, folder.name)
    return folder


class Host:
    """One instance, at `time` (s)."""

    def __init__(self, path):
        self.description = fmpy.read_model_description(str(path))
        identifier = self.description.coSimulation.modelIdentifier
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self._types = {v.name: v.type for v in self.description.modelVariables}
        self.outputs = [v.name for v in self.description.modelVariables if v.causality == "output"]
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=unpacked(str(path)).name,
            modelIdentifier=identifier,
            instanceName=identifier,
        )
        self.said = []
        self._callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(lambda _, __, ___, ____, message: self.said.append(message.decode())),
            fmi2CallbackAllocateMemoryTYPE(calloc),
            fmi2CallbackFreeMemoryTYPE(free),
        )
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        self.time = 0.0

    def start(self, tolerance=None, /, **values):
        for name, value in values.items():
            self[name] = value
        self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def to(self, time, step):
        """In communication steps of a size, the last one cut to end at the time."""
        while self.time < time - 1e-12:
            h = min(step, time - self.time)
            self.fmu.doStep(self.time, h)
            self.time += h
        return self

    def __getitem__(self, name):
        return getattr(self.fmu, f"get{self._types[name]}")([self.references[name]])[0]

    def __setitem__(self, name, value):
        kind = self._types[name]
        convert = float if kind in ("Real", "Float64") else int
        getattr(self.fmu, f"set{kind}")([self.references[name]], [convert(value)])

    def read(self, names):
        """Values of variables of any type as numbers, shape (len(names),)."""
        values = np.zeros(len(names))
        for kind in ("Real", "Boolean", "Integer"):
            places = [i for i, name in enumerate(names) if self._types[name] == kind]
            references = [self.references[names[i]] for i in places]
            values[places] = getattr(self.fmu, f"get{kind}")(references) if places else []
        return values

    def all(self):
        """Every output but counts of steps, which tell how far the master is ahead."""
        names = [name for name in self.outputs if name not in ("steps", "rejected_steps")]
        return self.read(names)
