"""An FMI 3.0 FMU with the interface of `driver.Fmu`: scalars by their positions, statuses instead of exceptions."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np
from fmpy import read_model_description
from fmpy.fmi3 import FMU3Slave

from tests.conformance.programs.driver import OK, Fmu, unpacked

_CONVERT = {"Float64": float, "Int32": int, "Boolean": lambda value: value > 0.5}


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
        self.types = {v.valueReference: v.type for v in self.description.modelVariables}
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
        return self._whole(references)[first - start : first - start + size]

    def _whole(self, references):
        values = []
        for kind, group in self._groups(references):
            values += getattr(self.slave, f"get{kind}")(group, sum(self.sizes[r] for r in group))
        return np.array(values, dtype=float)

    def _groups(self, references):
        """References in a row of variables of one type."""
        for kind, group in groupby(references, key=self.types.__getitem__):
            yield kind, list(group)

    def set(self, first, values):
        """Scalars that are a part of an array are set with the others as they are."""
        references, start = self.covering(first, len(values))
        whole = self._whole(references)
        whole[first - start : first - start + len(values)] = values
        return self.put_all(references, whole.tolist())

    def put_all(self, references, values):
        """The worst status."""
        worst = OK
        for kind, group in self._groups(references):
            count = sum(self.sizes[r] for r in group)
            own, values = values[:count], values[count:]
            worst = max(worst, self.call(f"set{kind}", group, [_CONVERT[kind](value) for value in own]))
        return worst

    def value(self, name):
        found = self.get(self.reference(name), self.sizes[self.reference(name)])
        return found[0] if found.size == 1 else found

    def put(self, name, *values):
        assert self.put_all([self.reference(name)], values) == OK, self.log
