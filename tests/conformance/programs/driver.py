"""An FMU driven through FMPy with statuses instead of exceptions, and the component it must agree with."""

from __future__ import annotations

import tempfile
from ctypes import c_void_p
from functools import cache
from pathlib import Path

import numpy as np
from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from components import REGISTRY, ComponentError
from components.contract.roles import FAILURE_COMMAND
from fmus import build_fmu
from tests.conformance.programs.toy import Toy

KINDS = {**REGISTRY, Toy.kind: Toy}
TYPICAL = {"N/m": 2e6, "N.s/m": 170.0, "N.m/rad": 2e3, "N.m.s/rad": 1.5, "m": 0.02, "m/s2": 1.6, "rad": 0.3}
"""Values of a hinge or loop by unit, for parameters that are zero by default."""
LOOSE, PLAY = ("clearance", "play"), 2e-3
"""Endings of the names of parameters (m, rad) within which there is no load; random motions are larger."""
LOADS = {"N": 20.0, "N.m": 5.0, "m/s3": 1e3, "rad/s3": 1e3}
"""Random forces and torques, means and slopes, and rates of accelerations."""
OK, DISCARD, ERROR, FATAL = 0, 2, 3, 4
POSE_ROUNDING = 4.0 * np.finfo(float).eps
"""Of a relative pose of order one, whose coordinates are sums of four products."""
STIFFNESS_UNITS = {"N": ("N/m",), "N.m": ("N.m/rad", "N/m")}
SECTION_STIFFNESSES = {"N": ("axial", "shear_y", "shear_z"), "N.m": ("torsion", "bending_y", "bending_z")}


@cache
def _folder():
    return tempfile.TemporaryDirectory(prefix="fanfold_fmus_")  # goes with the session


def built(component, name, **options):
    """The path of an FMU in a folder of its own; options are those of `build_fmu`."""
    return build_fmu(component, name, tempfile.mkdtemp(dir=_folder().name), **options)


def unpacked(path):
    """The folder beside an FMU that it is unpacked to, once for all instances and programs."""
    folder = Path(path).with_suffix("")
    if not folder.exists():
        extract(path, str(folder))
    return str(folder)


class Fmu:
    """One instance; every call returns the FMI status, `log` holds what it said.

    numbers: whether Booleans and integers are read and written as real numbers, as masters of Fanfold do.
    """

    interface = FMU2Slave

    def __init__(self, path, instance="instance", numbers=True):
        self.description = read_model_description(path, validate=False)
        self.log = []
        self._logger = fmi2CallbackLoggerTYPE(self._append)
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = self._logger
        self._callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self._callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.slave = self.interface(
            guid=self.description.guid,
            unzipDirectory=unpacked(path),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=instance,
        )
        self.slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        if numbers and hasattr(self.slave.dll, "fanfoldAcceptNumbers"):
            self.slave.dll.fanfoldAcceptNumbers(c_void_p(self.slave.component))
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()

    def _append(self, environment, instance, status, category, message):
        self.log.append((message or b"").decode())

    def call(self, name, *args):
        try:
            getattr(self.slave, name)(*args)
        except FMICallException as error:
            return error.status
        return OK

    def set(self, first, values):
        return self.call("setReal", list(range(first, first + len(values))), list(values))

    def get(self, first, size):
        return np.array(self.slave.getReal(list(range(first, first + size))) if size else [])

    def end_at(self, stop):
        """Begin anew, with a stop time."""
        self.slave.reset()
        self.slave.setupExperiment(startTime=0.0, stopTime=stop)
        self.slave.enterInitializationMode()

    def start(self):
        return self.call("exitInitializationMode")

    def step(self, time, h):
        return self.call("doStep", time, h)


class Reference:
    """The component itself, given nothing but read-only arrays."""

    def __init__(self, component):
        self.component = component
        parameters, inputs, outputs, observations = component.layouts
        self.p = parameters.start_values()
        self.start_inputs = self.u = _inputs(component)
        self.sizes = (parameters.size, inputs.size, outputs.size, observations.size)
        self.firsts = (0, *np.cumsum(self.sizes)[:-1].tolist())
        self.time = 0.0
        self.prepare(self.p)
        self.x = None

    def prepare(self, p):
        self.constants = self.component.prepare(_frozen(p))
        self.p = p

    def start(self):
        self.x = _frozen(self.component.initial(self.constants, _frozen(self.u)))

    def step(self, h):
        self.x = _frozen(self.component.step(self.constants, self.x, _frozen(self.u), h))
        self.time += h

    def outputs(self):
        return self.component.outputs(self.constants, self.x, _frozen(self.u))

    def observations(self):
        return self.component.observe(self.constants, self.x, _frozen(self.u))

    def noise(self, unit):
        """What the rounding of poses makes of a force or torque: by the largest stiffness, at arms up to a metre.

        Strains of sections are differences of numbers of order one, their curvatures of such over a tenth of a metre.
        """
        layout, units = self.component.parameter_layout, STIFFNESS_UNITS.get(unit, ())
        felt = [self.p[layout[q.name]].max() for q in layout.quantities if q.unit in units]
        section = self.component.structure.get("section", {})
        felt += [10.0 * section[name] for name in SECTION_STIFFNESSES.get(unit, ()) if name in section]
        return POSE_ROUNDING * max(felt, default=0.0)

    def random_inputs(self, rng):
        """Inputs near their start values, within their ranges, quaternions of length one; nothing fails.

        Of a joint that has failed there would be nothing left to compare.
        """
        u = self.start_inputs.copy()
        for quantity in self.component.input_layout.quantities:
            if quantity.name == FAILURE_COMMAND.name:
                continue
            part = u[self.component.input_layout[quantity.name]]
            noise = rng.standard_normal(part.size)
            if quantity.variability == "discrete":
                noise = np.round(noise)
            else:
                noise *= LOADS.get(quantity.unit, 0.01 * (1.0 + np.abs(part)))
            part += noise
            np.clip(part, quantity.minimum, quantity.maximum, out=part)
            if quantity.name.endswith(".orientation"):
                part /= np.linalg.norm(part)
        return u

    def random_parameters(self, rng):
        """The present parameters with the tunable ones moved a little, and those that are zero made typical.

        Zero stay those that the component refuses with the others, such as a clearance of unequal stiffnesses.
        """
        p, typical = self.p.copy(), {}
        for quantity in self.component.parameter_layout.quantities:
            if quantity.variability == "tunable":
                place = self.component.parameter_layout[quantity.name]
                factors = 1.0 + 0.01 * rng.random(quantity.size)
                p[place] = np.clip(p[place] * factors, quantity.minimum, quantity.maximum)
                usual = PLAY if quantity.name.endswith(LOOSE) else TYPICAL.get(quantity.unit, 0.1)
                values = np.where(p[place] == 0.0, usual * factors, p[place])
                typical[quantity.name] = place, np.clip(values, quantity.minimum, quantity.maximum)
        for place, values in typical.values():
            before = p[place].copy()
            p[place] = values
            try:
                self.component.prepare(_frozen(p))
            except ComponentError:
                p[place] = before
        return p


def start_of(component):
    """Start values under which a component can be initialized: its ports apart from one another."""
    positions = [q.name for q in component.input_layout.quantities if q.name.endswith(".position")]
    return {name: (0.5 * k, 0.0, 0.0) for k, name in enumerate(positions)}


def _inputs(component):
    u = component.input_layout.start_values()
    for name, position in start_of(component).items():
        u[component.input_layout[name]] = position
    return u


def _frozen(values):
    values = np.array(values, dtype=float)
    values.setflags(write=False)
    return values
