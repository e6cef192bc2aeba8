"""A native FMU in model exchange beside the component it must agree with: what the checks of model exchange share.

Rates agree with those of the component to 1e-11 of the largest scalar of each quantity, wrenches also to what the
rounding of poses makes of them.
"""

from __future__ import annotations

from ctypes import c_double

import numpy as np
from fmpy.fmi2 import FMU2Model

from components import REGISTRY
from components.body import Body
from components.ccl import CableLoop
from components.damper import EddyCurrentDamper
from components.driven_base import DrivenBase
from components.fixed_base import FixedBase
from components.hinge import Hinge
from components.moving_base import MovingBase
from tests.conformance.programs.driver import OK, Fmu, Reference

AGREEMENT, CANCELLED = 1e-11, 1e-3


def body(**changes):
    structure = Body.example().structure
    if changes:  # lower levels of coupling are for modes of first order
        structure["modal"] = {**structure["modal"], "second_order_points": (), "tension_forms": ()}
    return Body(**{**structure, **changes})


def hinge(**changes):
    return Hinge(**{**Hinge.example().structure, "wrench_mode": "endpoint", **changes})


def endpoint(kind):
    return REGISTRY[kind](**{**REGISTRY[kind].example().structure, "wrench_mode": "endpoint"})


SUBJECTS = {
    "body": body,
    "body_partial": lambda: body(inertia_coupling="partial"),
    "body_constant": lambda: body(inertia_coupling="rigid"),
    "hinge": hinge,
    "hinge_without_latch": lambda: hinge(latch="none"),
    "hinge_with_table": lambda: hinge(
        latch="table", latch_deflection=(-0.2, 0.0, 0.2), latch_torque=(-30, 0, 30)
    ),
    "guided_loop": lambda: CableLoop(guided=True, wrench_mode="endpoint"),
    "free_loop": lambda: CableLoop(wrench_mode="endpoint"),
    "damper": lambda: EddyCurrentDamper(wrench_mode="endpoint"),
    "fixed_base": FixedBase.example,
    "contact": lambda: endpoint("contact"),
    "drag": lambda: endpoint("drag"),
    "drive": lambda: endpoint("drive"),
    "end_stop": lambda: endpoint("end_stop"),
    "gear": lambda: endpoint("gear"),
    "hold_down": lambda: endpoint("hold_down"),
    "load": lambda: endpoint("load"),
    "driven_base": DrivenBase.example,
    "moving_base": MovingBase.example,
    "point_motion": lambda: endpoint("point_motion"),
    "rail": lambda: endpoint("rail"),
    "spring": lambda: endpoint("spring"),
    "suspension": lambda: endpoint("suspension"),
    "tape_hinge": lambda: endpoint("tape_hinge"),
}


class Model(Fmu):
    """An instance for model exchange; vectors instead of pointers, and statuses instead of exceptions."""

    interface = FMU2Model

    def __init__(self, path, component, instance="instance"):
        super().__init__(path, instance)
        self.nx, self.nz = len(component.continuous.places), component.continuous.indicators

    def vector(self, name, size=None, count=None):
        size = self.nx if size is None else size
        values = (c_double * (size + 1))()
        status = self.call(name, values, size if count is None else count)
        return status, np.array(values[:size])

    def states(self):
        return self._good(self.vector("getContinuousStates"))

    def rates(self):
        return self._good(self.vector("getDerivatives"))

    def indicators(self):
        return self._good(self.vector("getEventIndicators", self.nz))

    def _good(self, found):
        assert found[0] == OK, self.log
        return found[1]

    def move(self, states):
        return self.call("setContinuousStates", (c_double * (len(states) + 1))(*states), len(states))

    def event(self):
        """Event mode, update, continuous-time mode."""
        for name in ("enterEventMode", "newDiscreteStates", "enterContinuousTimeMode"):
            assert self.call(name) == OK, self.log


class Pair:
    """An FMU in continuous-time mode and the component it must agree with, parameters made typical."""

    def __init__(self, subject, path, seed=1, stop=None):
        self.rng = np.random.default_rng(seed)
        self.component = SUBJECTS[subject]()
        self.reference = Reference(self.component)
        self.fmu = Model(path, self.component)
        if stop is not None:
            self.fmu.end_at(stop)
        self.reference.prepare(self.reference.random_parameters(self.rng))
        assert self.fmu.set(0, self.reference.p) == OK
        self.put(self.inputs())
        self.reference.start()
        self.x = self.reference.x.copy()
        assert self.fmu.start() == OK, self.fmu.log
        for name in ("newDiscreteStates", "enterContinuousTimeMode"):
            assert self.fmu.call(name) == OK, self.fmu.log
        self.x = self.component.update(self.c, self.x, self.u, True)

    @property
    def c(self):
        return self.reference.constants

    @property
    def u(self):
        return self.reference.u

    def inputs(self):
        """Random inputs; discrete ones are zero, and wrenches are felt."""
        u = self.reference.random_inputs(self.rng)
        for quantity in self.component.input_layout.quantities:
            place = self.component.input_layout[quantity.name]
            if quantity.variability == "discrete":
                u[place] = 0.0
            elif quantity.unit in ("N", "N.m"):
                u[place] = self.rng.standard_normal(quantity.size)
        return u

    def put(self, u):
        self.reference.u = u
        assert self.fmu.set(self.reference.firsts[1], u) == OK, self.fmu.log

    def wander(self):
        """Another continuous state and other inputs, in both."""
        s = self.x[list(self.component.continuous.places)]
        nominal = self.component.continuous.nominals()
        s = s + 0.1 * nominal * self.rng.standard_normal(s.size)
        assert self.fmu.move(s) == OK, self.fmu.log
        self.x = self.x.copy()
        self.x[list(self.component.continuous.places)] = s
        self.put(self.inputs())

    def evaluated(self):
        """Outputs and rates of the FMU."""
        return np.concatenate(
            (self.fmu.get(self.reference.firsts[2], self.reference.sizes[2]), self.fmu.rates())
        )


def same(pair, what=""):
    """Rates, indicators, outputs and observations agree."""
    component, c, u = pair.component, pair.c, pair.u
    sizes, firsts = pair.reference.sizes, pair.reference.firsts
    complete = component.complete(c, pair.x)
    rates = pair.fmu.rates()
    agree(component.continuous.quantities, rates, component.rates(c, pair.x, u), f"rates {what}")
    agree_numbers(pair.fmu.indicators(), component.indicators(c, complete, u), f"indicators {what}")
    found, expected = pair.fmu.get(firsts[2], sizes[2]), component.outputs(c, complete, u)
    agree(component.output_layout.quantities, found, expected, f"outputs {what}", pair.reference.noise)
    found = pair.fmu.get(firsts[3], sizes[3])
    agree(
        component.observation_layout.quantities, found, component.observe(c, complete, u), f"observed {what}"
    )
    shown = pair.fmu.get(sum(sizes), 2 * pair.fmu.nx)
    assert shown.tobytes() == np.concatenate((pair.fmu.states(), rates)).tobytes(), "variables differ"


def agree(quantities, found, expected, what, noise=lambda unit: 0.0):
    first = 0
    for quantity in quantities:
        place = slice(first, first + quantity.size)
        agree_numbers(found[place], expected[place], f"{what}: {quantity.name}", noise(quantity.unit))
        first += quantity.size
    assert first == len(found) == len(expected), what


def agree_numbers(found, expected, what, noise=0.0):
    error, size = (np.abs(values).max(initial=0.0) for values in (found - expected, expected))
    assert error <= max(AGREEMENT * max(size, CANCELLED), noise), f"{what} by {error:g}"


def said(fmu, status, expected, *words):
    assert status == expected, f"status {status}, not {expected}: {fmu.log}"
    assert all(word in fmu.log[-1] for word in words), fmu.log[-1]
