"""Run in a process of its own: what a native FMU is asked to do in model exchange, one JSON object of findings.

    python exchange.py SUBJECT=PATH

A finding is an empty string where all is well. Repository root on PYTHONPATH.
"""

from __future__ import annotations

import json
import math
import sys
from ctypes import c_double, c_size_t, c_void_p

import numpy as np

from components.contract.roles import FAILURE_COMMAND
from tests.conformance.programs.driver import ERROR, OK, Fmu, Reference
from tests.conformance.programs.exchange_pair import SUBJECTS, Model, Pair, agree, said, same
from tests.conformance.programs.findings import checks_of, finding

DISCARD = 2
STATES = 200


def check_equal(subject, path):
    """At random states and inputs, with integrator steps completed in between."""
    pair = Pair(subject, path)
    same(pair, "at the start")
    assert np.array_equal(
        pair.fmu.vector("getNominalsOfContinuousStates")[1], pair.component.continuous.nominals()
    )
    for k in range(STATES):
        pair.wander()
        assert pair.fmu.call("setTime", 1e-3 * k) == OK
        same(pair, f"at state {k}")
        if k % 3 == 0:
            assert pair.fmu.call("completedIntegratorStep") == OK
            pair.x = pair.component.update(pair.c, pair.x, pair.u, False)


def check_commands(subject, path):
    """Discrete inputs act in event mode, and nowhere else."""
    pair = Pair(
        subject, path, 3
    )  # with 2 friction stands at its limit, where rounding decides whether it slides
    discrete = [q.name for q in pair.component.input_layout.quantities if q.variability == "discrete"]
    holding = [name for name in discrete if name != FAILURE_COMMAND.name]
    for names in (holding, (), discrete):
        before = pair.u.copy()
        u = pair.inputs()
        for name in names:
            u[pair.component.input_layout[name]] = 1.0
        said = len(pair.fmu.log)
        assert pair.fmu.set(pair.reference.firsts[1], u) == OK
        if np.any(u[-1:] != before[-1:]) and discrete:
            assert any("event mode" in line for line in pair.fmu.log[said:]), pair.fmu.log
        pair.reference.u = u.copy()
        for name in discrete:
            pair.u[pair.component.input_layout[name]] = before[pair.component.input_layout[name]]
        same(pair, "with commands that have to wait")
        pair.x = pair.component.update(pair.c, pair.x, pair.u, False)
        assert pair.fmu.call("enterEventMode") == OK
        pair.put(u)
        assert pair.fmu.call("newDiscreteStates") == OK
        pair.x = pair.component.update(pair.c, pair.x, u, True)
        same(pair, "after commands")
        assert pair.fmu.call("enterContinuousTimeMode") == OK
        for _ in range(5):
            u = pair.inputs()
            for name in names:
                u[pair.component.input_layout[name]] = 1.0
            pair.put(u)
            same(pair, "under commands")


AMOUNTS = {
    "N": 1.0,
    "N.m": 1.0,
    "m": 1e-5,
    "m/s": 1e-3,
    "rad/s": 1e-3,
    "m/s2": 1.0,
    "rad/s2": 1.0,
    "m/s3": 1e3,
    "rad/s3": 1e3,
    "1": 1e-4,
}


def check_parameters(subject, path):
    """Tunable parameters change in event mode; with a parameter that has no rates there is a sentence."""
    pair = Pair(subject, path, 6)
    layout = pair.component.parameter_layout
    tunable = [q.name for q in layout.quantities if q.variability == "tunable"]
    if not tunable:
        return
    p = pair.reference.random_parameters(pair.rng)
    place = layout[tunable[0]]
    said(pair.fmu, pair.fmu.set(place.start, p[place]), ERROR, tunable[0], "event mode only")
    same(pair, "after a parameter that has to wait")
    assert pair.fmu.call("enterEventMode") == OK
    for name in tunable:
        assert pair.fmu.set(layout[name].start, p[layout[name]]) == OK
    pair.reference.prepare(p)
    same(pair, "with other parameters")


def check_derivatives(subject, path):
    """Directional derivatives of outputs and rates, against central differences of the fourth order."""
    pair = Pair(subject, path, 5)
    pair.wander()
    layout, firsts, sizes = pair.component.input_layout, pair.reference.firsts, pair.reference.sizes
    n, nx = sum(sizes), pair.fmu.nx
    unknowns = [*range(firsts[2], firsts[3]), *range(n + nx, n + 2 * nx)]
    states, u = pair.fmu.states(), pair.u.copy()
    knowns = [
        (firsts[1] + i, AMOUNTS[q.unit])
        for q in layout.quantities
        if q.variability != "discrete"
        for i in range(layout[q.name].start, layout[q.name].stop)
    ] + [(n + i, 1e-3 * size) for i, size in enumerate(pair.component.continuous.nominals())]

    def at(known, amount):
        moved, shifted = u.copy(), states.copy()
        if known < n:
            moved[known - firsts[1]] += amount
        else:
            shifted[known - n] += amount
        pair.put(moved)
        assert pair.fmu.move(shifted) == OK
        return pair.evaluated()

    quantities = [*pair.component.output_layout.quantities, *pair.component.continuous.quantities]
    exact, near = [], []
    for known, amount in knowns:
        at(known, 0.0)
        size = np.abs(pair.evaluated())
        exact.append(pair.fmu.slave.getDirectionalDerivative(unknowns, [known], [1.0]))
        coarse, fine = ((at(known, h) - at(known, -h)) / (2.0 * h) for h in (amount, 0.5 * amount))
        near.append((4.0 * fine - coarse) / 3.0)
    exact, near = np.array(exact), np.array(near)
    first = 0
    for quantity in quantities:
        place = slice(first, first + quantity.size)
        first += quantity.size
        for kind in {amount for _, amount in knowns}:
            rows = [i for i, (_, amount) in enumerate(knowns) if amount == kind]
            slopes = near[rows][:, place]
            noise = 1e-14 * max(size[place].max(), 1.0) / kind
            error = np.abs(exact[rows][:, place] - slopes).max() - 10.0 * noise
            assert error <= 1e-6 * np.abs(slopes).max() + 1e-12, (
                f"{quantity.name}: {error:g} of {np.abs(slopes).max():g}"
            )


def check_state(subject, path):
    """A saved state, and its bytes in a second instance, give back the same numbers to the bit."""
    pair = Pair(subject, path, 4)
    pair.wander()
    pair.fmu.event()
    pair.wander()
    before, states = pair.evaluated().tobytes(), pair.fmu.states().tobytes()
    saved = pair.fmu.slave.getFMUstate()
    data = pair.fmu.slave.serializeFMUstate(saved)
    for _ in range(3):
        pair.wander()
        pair.fmu.event()
    assert pair.fmu.nx == 0 or pair.evaluated().tobytes() != before
    pair.fmu.slave.setFMUstate(saved)
    assert (pair.evaluated().tobytes(), pair.fmu.states().tobytes()) == (before, states)
    second = Pair(subject, path, 5)
    second.fmu.slave.setFMUstate(second.fmu.slave.deSerializeFMUstate(data))
    assert (second.evaluated().tobytes(), second.fmu.states().tobytes()) == (before, states)
    other = Fmu(path, "other")
    said(other, other.call("setFMUstate", other.slave.deSerializeFMUstate(data)), ERROR, "interface type")


def check_order(subject, path):
    """Calls out of order, with wrong sizes or wrong numbers give an error and a sentence, and change nothing."""
    component = SUBJECTS[subject]()
    fmu = Model(path, component, "wing")
    reference = Reference(component)
    refused = lambda name, *words: said(fmu, fmu.call(name), ERROR, "wing at t", *words)  # noqa: E731
    refused("enterContinuousTimeMode", "from event mode")
    refused("newDiscreteStates", "in event mode")
    said(fmu, fmu.call("setTime", 1.0), ERROR, "event or continuous-time mode")
    refused("terminate", "initialization")
    said(fmu, fmu.set(reference.firsts[1], [math.nan]), ERROR, "finite number")
    fmu.set(reference.firsts[1], reference.u)
    assert fmu.start() == OK, fmu.log
    refused("completedIntegratorStep", "in continuous-time mode")
    said(fmu, fmu.move(np.zeros(fmu.nx)), ERROR, "in continuous-time mode")
    assert fmu.call("newDiscreteStates") == OK
    assert fmu.call("enterContinuousTimeMode") == OK
    refused("newDiscreteStates", "in event mode")
    refused("enterContinuousTimeMode", "from event mode")
    refused("exitInitializationMode", "initialization")
    said(
        fmu, fmu.move(np.zeros(fmu.nx + 1)), ERROR, f"there are {fmu.nx} continuous states, not {fmu.nx + 1}"
    )
    for name in (
        "getContinuousStates",
        "getDerivatives",
        "getEventIndicators",
        "getNominalsOfContinuousStates",
    ):
        said(fmu, fmu.vector(name, count=fmu.nx + 5)[0], ERROR, f"not {fmu.nx + 5}")
    said(fmu, fmu.call("setTime", math.nan), ERROR, "finite")
    step = fmu.slave.dll.fmi2DoStep
    said(
        fmu,
        step(c_void_p(fmu.slave.component), c_double(0.0), c_double(1e-3), 1),
        ERROR,
        "solver outside",
    )
    first = sum(reference.sizes)
    if fmu.nx:
        states = fmu.states()
        said(fmu, fmu.set(first, [1.0]), ERROR, "continuous state")
        assert fmu.move(np.full(fmu.nx, math.nan)) == OK
        if subject.startswith("body"):
            said(fmu, fmu.vector("getDerivatives")[0], DISCARD, "nan")
        assert fmu.move(states) == OK
    for value in (math.nan, math.inf):  # a solver's trial, which a smaller step may spare
        said(fmu, fmu.set(reference.firsts[1], [value]), DISCARD, "finite number")
    assert fmu.vector("getDerivatives")[0] == OK, fmu.log
    assert fmu.call("terminate") == OK
    other = Fmu(path, "other")
    assert other.set(reference.firsts[1], reference.u) == OK
    assert other.start() == OK
    component = c_void_p(other.slave.component)
    said(other, other.slave.dll.fmi2EnterEventMode(component), ERROR, "co-simulation")
    rates = other.slave.dll.fmi2GetDerivatives
    said(other, rates(component, (c_double * 3)(), c_size_t(3)), ERROR, "co-simulation")


def check_stop_time(subject, path):
    """FMI 2.0 section 2.1.6: solvers look beyond the stop time and come back; a step completed there is an error."""
    pair = Pair(subject, path, 9, stop=0.5)
    for time in (0.4, 0.6, 1e3):
        assert pair.fmu.call("setTime", time) == OK, pair.fmu.log
        pair.wander()
        same(pair, f"at {time} s")
    said(pair.fmu, pair.fmu.call("completedIntegratorStep"), ERROR, "1000 s is after the stop time 0.5 s")
    same(pair, "after a step beyond the stop time")
    assert pair.fmu.call("setTime", 0.1 + 0.4) == OK, pair.fmu.log
    assert pair.fmu.call("completedIntegratorStep") == OK, pair.fmu.log
    pair.x = pair.component.update(pair.c, pair.x, pair.u, False)
    same(pair, "after the last step")


def check_variables(subject, path):
    """Continuous states and rates can be looked at in co-simulation, too."""
    component = SUBJECTS[subject]()
    reference, fmu = Reference(component), Fmu(path)
    fmu.set(reference.firsts[1], reference.u)
    reference.start()
    assert fmu.start() == OK
    assert fmu.step(0.0, 1e-3) == OK
    reference.step(1e-3)
    n, places = sum(reference.sizes), list(component.continuous.places)
    found = fmu.get(n, 2 * len(places))
    agree(component.continuous.quantities, found[: len(places)], reference.x[places], "states")
    expected = component.rates(reference.constants, reference.x, reference.u)
    agree(component.continuous.quantities, found[len(places) :], expected, "rates")


CHECKS = checks_of(globals())


if __name__ == "__main__":
    ((subject, path),) = (argument.split("=", 1) for argument in sys.argv[1:])
    print("\n" + json.dumps({name: finding(check, subject, path) for name, check in CHECKS.items()}))
