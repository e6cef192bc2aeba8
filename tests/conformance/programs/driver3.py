"""An FMI 3.0 FMU with the interface of `driver.Fmu`: scalars by their positions, statuses instead of exceptions."""

from __future__ import annotations

import math

import numpy as np
from fmpy import read_model_description
from fmpy.fmi3 import FMU3Slave

from tests.conformance.programs.driver import OK, Fmu, unpacked


class Slave(FMU3Slave):
    """FMPy's FMI 3 under the names of its FMI 2, as far as `trial` uses them."""

    getFMUstate = FMU3Slave.getFMUState
    setFMUstate = FMU3Slave.setFMUState
    freeFMUstate = FMU3Slave.freeFMUState
    serializeFMUstate = FMU3Slave.serializeFMUState
    deSerializeFMUstate = FMU3Slave.deserializeFMUState

    def setupExperiment(self, startTime):
        assert startTime == 0.0


class Fmu3(Fmu):
    """One instance in initialization mode; `events` asks for event mode and early return."""

    def __init__(self, path, instance="instance", event_mode=False, early_return=False, initialize=True):
        self.description = read_model_description(path, validate=False)
        self.log = []
        self.variables = [v for v in self.description.modelVariables if v.causality != "independent"]
        self.sizes = {v.valueReference: math.prod(v.shape) for v in self.description.modelVariables}
        self.slave = Slave(
            guid=self.description.guid,
            unzipDirectory=unpacked(path),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=instance,
        )
        self.slave.instantiate(
            loggingOn=True,
            eventModeUsed=event_mode,
            earlyReturnAllowed=early_return,
            logMessage=lambda environment, status, category, text: self.log.append(text.decode()),
        )
        if initialize:
            self.slave.enterInitializationMode()

    def reference(self, name):
        return next(v.valueReference for v in self.description.modelVariables if v.name == name)

    def covering(self, first, size):
        """References of the variables that hold these scalars, and the position of the first of them."""
        found = [r for r, n in self.sizes.items() if r < first + size and first < r + n]
        return sorted(found), min(found, default=0)

    def get(self, first, size):
        references, start = self.covering(first, size)
        values = self.slave.getFloat64(references, sum(self.sizes[r] for r in references)) if size else []
        return np.array(values)[first - start : first - start + size]

    def set(self, first, values):
        """Scalars that are a part of an array are set with the others as they are."""
        references, start = self.covering(first, len(values))
        whole = np.array(self.slave.getFloat64(references, sum(self.sizes[r] for r in references)))
        whole[first - start : first - start + len(values)] = values
        return self.call("setFloat64", references, whole.tolist())

    def value(self, name):
        found = self.get(self.reference(name), self.sizes[self.reference(name)])
        return found[0] if found.size == 1 else found

    def put(self, name, *values):
        assert self.call("setFloat64", [self.reference(name)], values) == OK, self.log
