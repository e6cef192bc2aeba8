"""Run in a process of its own: everything an FMU of one kind is asked to do, one JSON object of findings.

    python trial.py BACKEND CHECKS KIND=PATH [KIND=PATH ...]

A finding is an empty string where all is well. Repository root on PYTHONPATH. A PythonFMU agrees with its
component in every bit, a native one to 1e-11 of the largest scalar of each quantity, or to what the rounding of
poses makes of a wrench; a PythonFMU's errors are fatal, because that is what PythonFMU makes of them.
"""

from __future__ import annotations

import contextlib
import gc
import json
import math
import sys

import numpy as np
from fmpy.fmi1 import FMICallException

from components import ComponentError
from tests.conformance.programs.driver import DISCARD, ERROR, FATAL, KINDS, OK, Fmu, Reference
from tests.conformance.programs.findings import checks_of, finding

NATIVE = len(sys.argv) > 1 and sys.argv[1] == "native"
STEPS = 120 if NATIVE else 60
FAILED = ERROR if NATIVE else FATAL
REFUSED = ERROR if NATIVE else DISCARD
AGREEMENT = 1e-11
CANCELLED = 1e-3
"""Quantities below it are what is left of sums of terms of order one; first moments, of a tenth of a step's travel."""
MOMENT = 1e-4
TRUE = 0.5
"""Numbers above it are true."""


def pair(kind, path, instance="instance"):
    return Fmu(path, instance), Reference(KINDS[kind].example())


def set_order(fmu, reference):
    """Order 4 before the start; whether there is a choice."""
    layout = reference.component.parameter_layout
    if "order" not in layout:
        return False
    p = reference.p.copy()
    p[layout["order"]] = 4.0
    reference.prepare(p)
    assert fmu.set(layout["order"].start, [4.0]) == OK, fmu.log
    return True


def begin(fmu, reference, rng):
    reference.u = reference.random_inputs(rng)
    fmu.set(reference.firsts[1], reference.u)
    reference.start()
    assert fmu.start() == OK, fmu.log


def same(fmu, reference, what="", observed=True):
    """Outputs and observations agree."""
    _, _, y, z = reference.firsts
    _, _, n_y, n_z = reference.sizes
    component = reference.component
    found, expected = fmu.get(y, n_y), reference.outputs()
    agree(component.output_layout, found, expected, f"outputs differ {what}", reference.noise)
    if observed:
        found, expected = fmu.get(z, n_z), reference.observations()
        agree(component.observation_layout, found, expected, f"observations differ {what}", reference.noise)


def agree(layout, found, expected, what, noise=lambda unit: 0.0):
    if not NATIVE:
        assert found.tobytes() == expected.tobytes(), what
        return
    for quantity in layout.quantities:
        place = layout[quantity.name]
        error, size = (np.abs(values).max() for values in (found[place] - expected[place], expected[place]))
        smallest = MOMENT if quantity.name.endswith("_moment") else CANCELLED
        allowed = max(AGREEMENT * max(size, smallest), noise(quantity.unit))
        assert error <= allowed, f"{what}: {quantity.name} by {error:g}"


def advance(fmu, reference, rng):
    """One step with new inputs of both; where the component refuses, the FMU has to discard the step."""
    u, h = reference.random_inputs(rng), float(rng.choice([5e-4, 1e-3, 2e-3]))
    reference.u = u
    assert fmu.set(reference.firsts[1], u) == OK
    time = reference.time
    try:
        reference.step(h)
    except (ComponentError, ArithmeticError, np.linalg.LinAlgError):
        assert fmu.step(time, h) == DISCARD, "the component refuses a step that the FMU makes"
        return 1
    assert fmu.step(time, h) == OK, fmu.log
    return 0


def check_equal(kind, path):
    """Initialization, steps, tunable parameters and rollback, against the component."""
    fmu, reference = pair(kind, path)
    reference.start()
    same(fmu, reference, "in initialization mode")
    go_on_alike(fmu, reference)


def check_equal_of_order_four(kind, path):
    """The same with wrenches that are linear in time, where a component has them."""
    fmu, reference = pair(kind, path)
    if set_order(fmu, reference):
        go_on_alike(fmu, reference)


def go_on_alike(fmu, reference):
    rng = np.random.default_rng(1)
    begin(fmu, reference, rng)
    same(fmu, reference, "at the start")
    refused = 0
    for k in range(STEPS):
        if k % 40 == 5 and reference.sizes[0]:
            tune(fmu, reference, rng)
        if k % 25 == 10:
            wander(fmu, reference, rng)
        refused += advance(fmu, reference, rng)
        same(fmu, reference, f"after step {k + 1}", observed=k % 3 == 0)
    assert refused <= STEPS // 10, f"{refused} of {STEPS} steps refused"


def tune(fmu, reference, rng):
    p = reference.random_parameters(rng)
    with contextlib.suppress(ComponentError):
        reference.prepare(p)
        for i in np.flatnonzero(tunable(reference)):
            assert fmu.set(int(i), [p[i]]) == OK, fmu.log
        same(fmu, reference, "after a parameter was tuned")


def tunable(reference):
    layout = reference.component.parameter_layout
    return np.array(
        [q.variability == "tunable" for q in layout.quantities for _ in range(q.size)], dtype=bool
    )


def wander(fmu, reference, rng):
    """Save, go astray with other parameters and inputs, restore."""
    before = (reference.p, reference.u, reference.x, reference.time)
    state = fmu.slave.getFMUstate()
    for _ in range(3):
        tune(fmu, reference, rng)
        advance(fmu, reference, rng)
    fmu.slave.setFMUstate(state)
    fmu.slave.freeFMUstate(state)
    p, reference.u, reference.x, reference.time = before
    reference.prepare(p)
    same(fmu, reference, "after restoring")


def check_serialization(kind, path):
    """Bytes of a state start a second instance that continues bit for bit, also from before the start."""
    for steps in (None, 7):
        rng = np.random.default_rng(2)
        fmu, reference = pair(kind, path)
        if steps:
            begin(fmu, reference, rng)
            tune(fmu, reference, rng)
            for _ in range(steps):
                advance(fmu, reference, rng)
        state = fmu.slave.getFMUstate()
        data = fmu.slave.serializeFMUstate(state)
        fmu.slave.freeFMUstate(state)
        fmu.slave.freeInstance()
        fmu = Fmu(path, "second")
        state = fmu.slave.deSerializeFMUstate(data)
        assert fmu.slave.serializeFMUstate(state) == data, "serialized again, the state has other bytes"
        fmu.slave.setFMUstate(state)
        if not steps:
            begin(fmu, reference, rng)
        for _ in range(10):
            advance(fmu, reference, rng)
            same(fmu, reference, "after deserializing")


def check_failures(kind, path):
    """Wrong values and step sizes give a sentence and a failed call, and leave the state alone."""
    rng = np.random.default_rng(3)
    fmu, reference = pair(kind, path, "wing")
    begin(fmu, reference, rng)
    names = [v.name for v in fmu.description.modelVariables]
    _, u, y, _ = reference.firsts
    for h in (0.0, -1e-3, math.nan, math.inf):
        said(fmu, fmu.step(0.25, h), REFUSED, "wing at t = 0.25 s", "step size")
    if reference.sizes[1]:
        good = reference.u[0]
        for bad in (math.nan, math.inf):
            said(fmu, fmu.set(u, [bad]) or fmu.step(0.0, 1e-3), REFUSED, "wing at t = 0 s", names[u])
        fmu.set(u, [good])
    said(fmu, fmu.set(y, [1.0]), FAILED, names[y], "output")
    said(fmu, fmu.call("getReal", [100000]), FAILED, "100000")
    for i in np.flatnonzero(~tunable(reference))[:1]:
        said(fmu, fmu.set(int(i), [reference.p[i]]), FAILED, names[i], "fixed")
    for strange in (b"", b"no state", bytes(43 + 8 * len(names))):
        refuse_state(fmu, strange)
    for damaged in damaged_states(fmu, rng):
        refuse_state(fmu, damaged)
    said(fmu, fmu.call("getInteger", [0]), FAILED, "a real number")
    try_booleans(fmu)
    for _ in range(3):
        advance(fmu, reference, rng)
        same(fmu, reference, "after refused calls")


def try_booleans(fmu):
    """Read by their own functions, set and set back; other types are refused."""
    for v in fmu.description.modelVariables:
        if v.type != "Boolean":
            continue
        r = [v.valueReference]
        said(fmu, fmu.call("getInteger", r), FAILED, v.name, "a Boolean")
        before = fmu.slave.getReal(r)
        assert fmu.slave.getBoolean(r) == [before[0] > TRUE]
        if v.causality == "input":
            assert fmu.call("setBoolean", r, [before[0] <= TRUE]) == OK
            assert fmu.slave.getReal(r) == [float(before[0] <= TRUE)]
            assert fmu.set(r[0], before) == OK


def damaged_states(fmu, rng):
    """A state with one bit that is another, in its head and anywhere."""
    saved = fmu.slave.getFMUstate()
    sound = fmu.slave.serializeFMUstate(saved)
    fmu.slave.freeFMUstate(saved)
    for place in (0, 17, 25, 60, *rng.integers(len(sound), size=10)):
        damaged = bytearray(sound)
        damaged[place] ^= 1 << int(rng.integers(8))
        yield bytes(damaged)


def check_absurd_inputs(kind, path):
    """Of inputs that squares and sums overflow with, a native FMU gives numbers, or a sentence and none."""
    if not NATIVE:
        return
    rng = np.random.default_rng(8)
    fmu, reference = pair(kind, path, "wing")
    begin(fmu, reference, rng)
    _, u, y, z = reference.firsts
    for scale in np.repeat(10.0 ** np.array([100, 155, 200, 307]), 25):
        fmu.set(u, scale * rng.uniform(-1.0, 1.0, reference.u.size))
        for first, layout in (
            (y, reference.component.output_layout),
            (z, reference.component.observation_layout),
        ):
            try:
                values = fmu.get(first, layout.size)
            except FMICallException as error:
                said(fmu, error.status, REFUSED, "wing at t = ")
                continue
            assert np.isfinite(values).all(), f"{scale:g}: {values}"


def refuse_state(fmu, strange):
    """Native FMUs refuse bytes that are no state at once, PythonFMUs when they are to be restored."""
    try:
        state = fmu.slave.deSerializeFMUstate(strange)
    except FMICallException as error:
        said(fmu, error.status, FAILED, "FMU state")
        return
    said(fmu, fmu.call("setFMUstate", state), FAILED, "other content")
    fmu.slave.freeFMUstate(state)


def said(fmu, status, expected, *words):
    assert status == expected, f"status {status}, not {expected}: {fmu.log}"
    last = [line for line in fmu.log if "py exception" not in line][-1]
    assert all(word in last for word in words), last
    assert "Traceback" not in last


def check_parameter(kind, path):
    """A parameter that is not a number is refused by name when initialization ends, and can be mended."""
    fmu, reference = pair(kind, path)
    for i in range(min(1, reference.sizes[0])):
        said(fmu, fmu.set(i, [math.nan]) or fmu.start(), FAILED, fmu.description.modelVariables[i].name)
    fmu, reference = pair(kind, path)
    begin(fmu, reference, np.random.default_rng(4))
    for i in np.flatnonzero(tunable(reference))[:1]:
        said(
            fmu,
            fmu.set(int(i), [math.nan]) or fmu.step(0.0, 1e-3),
            REFUSED,
            fmu.description.modelVariables[i].name,
        )
        fmu.set(int(i), [reference.p[i]])
        advance(fmu, reference, np.random.default_rng(5))
        same(fmu, reference, "after the parameter was mended")


def check_reset(kind, path):
    """Reset gives the instance as it was made."""
    fmu, reference = pair(kind, path)
    begin(fmu, reference, np.random.default_rng(6))
    advance(fmu, reference, np.random.default_rng(6))
    fmu.slave.reset()
    fmu.slave.setupExperiment(startTime=0.0)
    fmu.slave.enterInitializationMode()
    fresh = Reference(reference.component)
    fresh.start()
    same(fmu, fresh, "after reset")


def check_stop_time(kind, path):
    """FMI 2.0 section 2.1.6: steps end at the stop time, up to the rounding of their sum; one beyond is refused."""
    fmu, reference = pair(kind, path, "wing")
    fmu.end_at(0.003)
    begin(fmu, reference, np.random.default_rng(8))
    for k in range(3):
        assert fmu.step(1e-3 * k, 1e-3) == OK, fmu.log
        reference.step(1e-3)
    said(fmu, fmu.step(0.003, 1e-3), REFUSED, "0.004 s is after the stop time 0.003 s")
    same(fmu, reference, "after a step beyond the stop time")


def check_instances(kind, path):
    """PythonFMU drops a reference per instance: many instances, then a collection, must not crash."""
    for _ in range(10):
        fmu = Fmu(path)
        fmu.slave.freeInstance()
    gc.collect()


def run_together(paths):
    """All kinds, two instances each, interleaved in one process."""
    rng = np.random.default_rng(7)
    pairs = [pair(kind, path, f"{kind}{i}") for kind, path in paths.items() for i in range(2)]
    for fmu, reference in pairs:
        begin(fmu, reference, rng)
    for _ in range(6):
        for fmu, reference in pairs:
            advance(fmu, reference, rng)
        for fmu, reference in pairs:
            same(fmu, reference, f"of {reference.component.kind}")
        gc.collect()


CHECKS = checks_of(globals())


if __name__ == "__main__":
    paths = dict(argument.split("=", 1) for argument in sys.argv[3:])
    if sys.argv[2] == "together":
        findings = {"together": finding(run_together, paths)}
    else:
        ((kind, path),) = paths.items()
        findings = {name: finding(check, kind, path) for name, check in CHECKS.items()}
    print("\n" + json.dumps(findings))
