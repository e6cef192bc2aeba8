"""A host of FMI 3.0 that loads a scene as one FMU, with event mode and early return as it is asked for."""

from __future__ import annotations

import fmpy
from fmpy.fmi3 import FMU3Slave

from tests.unit.run.as_one.host import unpacked


class Host3:
    """One instance, started, at `time` (s). events: whether event mode is used; early: whether it may return early."""

    def __init__(self, path, *, events=True, early=True):
        description = fmpy.read_model_description(str(path))
        self.interface = description.coSimulation
        self._references = {v.name: v.valueReference for v in description.modelVariables}
        self._types = {v.name: v.type for v in description.modelVariables}
        self.fmu = FMU3Slave(
            guid=description.guid,
            unzipDirectory=unpacked(str(path)).name,
            modelIdentifier=self.interface.modelIdentifier,
            instanceName=self.interface.modelIdentifier,
        )
        self.fmu.instantiate(loggingOn=True, eventModeUsed=events, earlyReturnAllowed=early)
        self.time = 0.0
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()
        if events:
            self._update()
            self.fmu.enterStepMode()

    def step(self, h):
        """One step; (whether an event is to be handled, whether it returned early)."""
        needs_event, terminates, early, self.time = self.fmu.doStep(self.time, h)
        assert not terminates
        return needs_event, early

    def event(self, **values):
        """An event with these inputs."""
        self.fmu.enterEventMode()
        for name, value in values.items():
            self[name] = value
        self._update()
        self.fmu.enterStepMode()

    def _update(self):
        assert self.fmu.updateDiscreteStates()[:2] == (False, False)

    def reference(self, name):
        """Value reference of a variable."""
        return self._references[name]

    def __getitem__(self, name):
        return getattr(self.fmu, f"get{self._types[name]}")([self._references[name]])[0]

    def __setitem__(self, name, value):
        kind = self._types[name]
        convert = float if kind in ("Real", "Float64") else int
        getattr(self.fmu, f"set{kind}")([self._references[name]], [convert(value)])
