"""Connections that give the derivatives of a step at once: they are the standard's directional derivatives."""

from __future__ import annotations

from ctypes import POINTER, c_double, c_size_t, c_void_p

import numpy as np
import pytest

from components.contract.roles import FAILURE_COMMAND
from components.damper import EddyCurrentDamper
from components.hinge import Hinge
from fmus import native_library
from tests.conformance.programs import trial
from tests.conformance.programs.driver import DISCARD, OK, Fmu, Reference, built, start_of

pytestmark = pytest.mark.skipif(native_library() is None, reason="no native library was built")
TABLE = {
    "latch_deflection": (-1.0, -0.01, 0.0, 0.02, 1.0),
    "latch_torque": (-50.0, -9.0, 0.0, 8.0, 60.0),
}
VARIANTS = {
    "spring_latch": Hinge.example(),
    "table_latch": Hinge(latch="table", **TABLE),
    "kinematic_latch": Hinge(axis=(0.3, 0.9, -0.1), latch="kinematic"),
}
H = 2e-3
ROUND_OFF = 1e-12
"""Of sums of a few hundred products, relative to the largest derivative of a quantity by another."""
COLUMNS = (
    ("position", "m"),
    ("rotation", "rad"),
    ("velocity_moment", "m"),
    ("angular_velocity_moment", "rad"),
    ("velocity", "m/s"),
    ("angular_velocity", "rad/s"),
)
ROWS = ("force", "torque", "force_slope", "torque_slope")


@pytest.fixture(autouse=True)
def native(monkeypatch):
    """FMUs agree with their components to round-off, not in every bit."""
    monkeypatch.setattr(trial, "NATIVE", True)


def instance(component, name, order):
    """An FMU and its reference at an order of the coupling, with random parameters that leave nothing out."""
    fmu = Fmu(str(built(component, name, start=start_of(component), backend="native")))
    reference, rng = Reference(component), np.random.default_rng(5)
    if order == 4:
        assert trial.set_order(fmu, reference)
    trial.begin(fmu, reference, rng)
    trial.tune(fmu, reference, rng)
    return fmu, reference, rng


def at_once(fmu, ports):
    """Status and derivatives, by the function that is not of the standard."""
    function = fmu.slave.dll.fanfoldGetPortStiffness
    function.argtypes = (c_void_p, c_size_t, POINTER(c_double))
    found = np.full((12 * ports, 18 * ports), np.nan)
    return function(fmu.slave.component, ports, found.ctypes.data_as(POINTER(c_double))), found


def seeds(layout, u, port, quantity):
    """References, beside the first input, and seeds for the three components of a port's motion."""
    if quantity != "rotation":
        place = layout[f"{port}.{quantity}"]
        return [([i], [1.0]) for i in range(place.start, place.stop)]
    place = layout[f"{port}.orientation"]
    w, x, y, z = u[place]
    by_axis = ((-x, w, -z, y), (-y, z, w, -x), (-z, -y, x, w))  # half of the axis times the quaternion
    return [(list(range(place.start, place.stop)), [0.5 * s for s in seed]) for seed in by_axis]


def by_columns(fmu, reference, u):
    """The same derivatives by fmi2GetDirectionalDerivative."""
    inputs, outputs = reference.component.input_layout, reference.component.output_layout
    rows = [i for p in ports(reference) for r in ROWS for i in range(*outputs[f"{p}.{r}"].indices(10**6))]
    unknowns = [reference.firsts[2] + i for i in rows]
    columns = [
        fmu.slave.getDirectionalDerivative(unknowns, [reference.firsts[1] + i for i in knowns], seed)
        for port in ports(reference)
        for quantity, _ in COLUMNS
        for knowns, seed in seeds(inputs, u, port, quantity)
    ]
    return np.array(columns).T


def ports(reference):
    return [p.name for p in reference.component.ports]


@pytest.mark.parametrize("name", VARIANTS)
def test_is_what_directional_derivatives_are(name):
    """Over random steps, latched and held or not, failed in the end; every block of force by motion to round-off."""
    fmu, reference, rng = instance(VARIANTS[name], name, 4)
    time, states = 0.0, set()
    commands = [reference.component.input_layout[c].start for c in ("latch_command", "hold", "impulse")]
    for k in range(40):
        u = reference.random_inputs(rng)
        u[commands] = (float(k >= 20), float(k % 2), 0.0)
        states.add(tuple(u[commands]))
        u[reference.component.input_layout[FAILURE_COMMAND.name]] = float(k == 39)
        assert fmu.set(reference.firsts[1], u) == OK
        assert fmu.step(time, H) == OK, fmu.log
        time += H
        status, found = at_once(fmu, 2)
        assert status == OK
        expected = by_columns(fmu, reference, u)
        error, size = (np.abs(a).reshape(8, 3, 12, 3).max(axis=(1, 3)) for a in (found - expected, expected))
        largest = size.reshape(2, 4, 2, 6).max(axis=(0, 2))  # of a quantity by another, over both ports
        assert np.all(error <= ROUND_OFF * np.tile(largest, (2, 2))), np.max(error / np.tile(largest, (2, 2)))
    assert len(states) == 4
    assert np.all(found == 0.0)


def test_is_refused_where_there_is_none():
    """Before a step, for another number of ports, in an impulse, at order 2, and of kinds without it."""
    fmu, reference, rng = instance(VARIANTS["spring_latch"], "hinge", 4)
    assert at_once(fmu, 2)[0] == DISCARD
    u = reference.random_inputs(rng)
    impulse = reference.component.input_layout["impulse"]
    for command, count, expected in ((0.0, 2, OK), (0.0, 3, DISCARD), (1.0, 2, DISCARD)):
        u[impulse] = command
        fmu.set(reference.firsts[1], u)
        state = fmu.slave.getFMUstate()
        assert fmu.step(0.0, H) == OK
        assert at_once(fmu, count)[0] == expected
        fmu.slave.setFMUstate(state)
        assert at_once(fmu, 2)[0] == DISCARD
    for component, order in ((VARIANTS["spring_latch"], 2), (EddyCurrentDamper.example(), 4)):
        other, its, rng = instance(component, "other", order)
        other.set(its.firsts[1], its.random_inputs(rng))
        assert other.step(0.0, H) == OK
        assert at_once(other, 2)[0] == DISCARD
