"""Run in a process of its own: what an FMI 3.0 FMU of one kind is asked to do, one JSON object of findings.

    python trial3.py native KIND=PATH [KIND=PATH ...]

With several kinds they are run together. The checks that FMI 2 has as well are those of `trial`.
"""

from __future__ import annotations

import json
import math
import sys

import numpy as np

from tests.conformance.programs import trial
from tests.conformance.programs.driver import ERROR, KINDS, LOADS, OK, Reference
from tests.conformance.programs.driver3 import Fmu3
from tests.conformance.programs.findings import checks_of, finding
from tests.conformance.programs.trial import advance, begin, pair, refuse_state, said, same, tunable

trial.Fmu = Fmu3
H = 2e-3
SEEDS = {**LOADS, "m/s3": 1e8, "rad/s3": 1e8}
"""Rates of accelerations move a port by the third power of a step."""


def check_order(kind, path):
    """Every call at a wrong time is an error with a sentence and changes nothing."""
    fmu = Fmu3(path, "wing", initialize=False)
    reference = Reference(KINDS[kind].example())
    for call in (
        "exitInitializationMode",
        "terminate",
        "enterEventMode",
        "enterStepMode",
        "updateDiscreteStates",
    ):
        said(fmu, fmu.call(call), ERROR, "wing at t = 0 s")
    said(fmu, fmu.step(0.0, H), ERROR, "initialization")
    said(fmu, fmu.call("enterInitializationMode", None, math.nan), ERROR, "start time")
    said(fmu, fmu.call("enterInitializationMode", None, 1.0, 0.5), ERROR, "stop time")
    assert fmu.call("enterInitializationMode", None, 0.0, 1.0) == OK
    said(fmu, fmu.call("enterInitializationMode"), ERROR, "once")
    begin(fmu, reference, np.random.default_rng(1))
    said(fmu, fmu.call("enterEventMode"), ERROR, "not asked for")
    said(fmu, fmu.step(1.0, H), ERROR, "stop time")
    advance(fmu, reference, np.random.default_rng(2))
    same(fmu, reference, "after refused calls")
    assert fmu.value("time") == reference.time
    assert fmu.call("terminate") == OK
    said(fmu, fmu.call("terminate"), ERROR, "terminated")
    said(fmu, fmu.step(0.0, H), ERROR, "step mode")


def check_values(kind, path):
    """Wrong references, counts, types and values: a sentence, and the state is as before."""
    fmu, reference = pair(kind, path, "wing")
    begin(fmu, reference, np.random.default_rng(3))
    name = {v.valueReference: v.name for v in fmu.variables}
    _, u, y, _ = reference.firsts
    for h in (0.0, -1e-3, math.nan, math.inf):
        said(fmu, fmu.step(0.25, h), ERROR, "wing at t = 0.25 s", "step size")
    for bad in (math.nan, math.inf):
        said(fmu, fmu.set(u, [bad]), ERROR, name[u])
    said(fmu, fmu.call("setFloat64", [y], [0.0] * fmu.sizes[y]), ERROR, name[y], "output")
    said(fmu, fmu.call("setFloat64", [fmu.reference("time")], [0.0]), ERROR, "independent")
    said(fmu, fmu.call("getFloat64", [100000]), ERROR, "100000")
    arrays = [r for r, n in fmu.sizes.items() if n > 1]
    for r in arrays[:1]:
        said(fmu, fmu.call("getFloat64", [r + 1]), ERROR, f"reference {r + 1}")
        said(fmu, fmu.call("getFloat64", [r], fmu.sizes[r] - 1), ERROR, f"have {fmu.sizes[r]} values")
    for i in np.flatnonzero(~tunable(reference))[:1]:
        said(fmu, fmu.set(int(i), [reference.p[i]]), ERROR, "fixed")
    for kind_of, word in {
        "Int32": "real",
        "Boolean": "real",
        "String": "Float64",
        "Binary": "Float64",
    }.items():
        said(fmu, fmu.call(f"get{kind_of}", [0]), ERROR, word)
    for r, kind_of in fmu.types.items():
        if kind_of != "Float64":
            said(fmu, fmu.call("getFloat64", [r]), ERROR, name[r], "Float64")
    said(fmu, fmu.call("getClock", [0]), ERROR, "clocks")
    said(fmu, fmu.call("getAdjointDerivative", [y], [u], [1.0]), ERROR, "adjoint")
    said(fmu, fmu.call("enterConfigurationMode"), ERROR, "structural")
    said(fmu, fmu.call("setDebugLogging", True, ["logNoise"]), ERROR, "logNoise")
    assert fmu.call("setDebugLogging", True, [c.name for c in fmu.description.logCategories]) == OK
    for strange in (b"", b"no state", bytes(67 + 8 * len(name))):
        refuse_state(fmu, strange)
    for _ in range(3):
        advance(fmu, reference, np.random.default_rng(4))
        same(fmu, reference, "after refused calls")


def check_parameter(kind, path):
    """A parameter that is not a number is refused by name, and can be mended."""
    fmu, reference = pair(kind, path)
    for i in range(min(1, reference.sizes[0])):
        said(fmu, fmu.set(i, [math.nan]), ERROR, reference.component.parameter_layout.quantities[0].name)
        begin(fmu, reference, np.random.default_rng(4))
        same(fmu, reference, "after the parameter was mended")


def check_access(kind, path):
    """Any order of variables, and any of them twice, gives the same values as one at a time."""
    fmu, reference = pair(kind, path)
    begin(fmu, reference, np.random.default_rng(5))
    advance(fmu, reference, np.random.default_rng(5))
    references = 2 * [r for r, kind_of in fmu.types.items() if kind_of == "Float64"]
    np.random.default_rng(6).shuffle(references)
    found = fmu.slave.getFloat64(references, sum(fmu.sizes[r] for r in references))
    singly = [value for r in references for value in fmu.slave.getFloat64([r], fmu.sizes[r])]
    assert found == singly
    inputs = [v.valueReference for v in fmu.variables if v.causality == "input"][::-1]
    u = reference.random_inputs(np.random.default_rng(7))
    flat = [u[r - reference.firsts[1] + k] for r in inputs for k in range(fmu.sizes[r])]
    assert fmu.put_all(inputs, flat) == OK
    reference.u = u
    same(fmu, reference, "with inputs set backwards")


def check_derivative(kind, path):
    """Along a random direction of all continuous inputs: that of whole steps, by differences."""
    rng = np.random.default_rng(8)
    fmu, reference = pair(kind, path)
    begin(fmu, reference, rng)
    for _ in range(3):
        assert advance(fmu, reference, rng) == 0
    first, (y, n_y) = reference.firsts[1], (reference.firsts[2], reference.sizes[2])
    inputs = [v for v in fmu.variables if v.causality == "input" and v.variability == "continuous"]
    outputs = [r for r in fmu.sizes if y <= r < y + n_y and fmu.types[r] == "Float64"]
    layout = reference.component.output_layout
    real = [k for q in layout.quantities if q.kind == "real" for k in range(n_y)[layout[q.name]]]
    u, state = reference.random_inputs(rng), fmu.slave.getFMUState()
    seed, units = np.zeros_like(u), {q.name: q.unit for q in reference.component.input_layout.quantities}
    for v in inputs:
        place = slice(v.valueReference - first, v.valueReference - first + fmu.sizes[v.valueReference])
        seed[place] = SEEDS.get(units[v.name], 1.0) * rng.standard_normal(place.stop - place.start)

    def stepped(amount):
        fmu.slave.setFMUState(state)
        fmu.set(first, u + amount * seed)
        assert fmu.step(reference.time, H) == OK, fmu.log
        return fmu.get(y, n_y)

    def difference(amount):
        return (stepped(amount) - stepped(-amount)) / (2.0 * amount)

    approximate = (4.0 * difference(5e-6) - difference(1e-5)) / 3.0
    stepped(0.0)
    flat = [seed[v.valueReference - first + k] for v in inputs for k in range(fmu.sizes[v.valueReference])]
    exact, knowns = np.zeros(n_y), [v.valueReference for v in inputs]
    exact[real] = fmu.slave.getDirectionalDerivative(outputs, knowns, flat, len(real))
    for quantity in layout.quantities:
        place = layout[quantity.name]
        scale = np.abs(approximate[place]).max()
        error = np.abs(exact[place] - approximate[place]).max()
        assert error <= 1e-5 * scale, f"{quantity.name}: {error:g} of {scale:g}"


def check_event_mode(kind, path):
    """Entering and leaving event mode between steps changes nothing where there is no event."""
    rng = np.random.default_rng(9)
    fmu, reference = Fmu3(path, event_mode=True, early_return=True), Reference(KINDS[kind].example())
    begin(fmu, reference, rng)
    said(fmu, fmu.step(0.0, H), ERROR, "step mode")
    for _ in range(20):
        assert fmu.slave.updateDiscreteStates()[:5] == (False,) * 5
        assert fmu.call("enterStepMode") == OK
        said(fmu, fmu.call("updateDiscreteStates"), ERROR, "event mode")
        advance(fmu, reference, rng)
        assert fmu.call("enterEventMode") == OK
        same(fmu, reference, "in event mode")


CHECKS = {
    **{name: trial.CHECKS[name] for name in ("equal", "serialization", "reset", "instances")},
    **checks_of(globals()),
}


if __name__ == "__main__":
    paths = dict(argument.split("=", 1) for argument in sys.argv[2:])
    if len(paths) > 1:
        findings = {"together": finding(trial.run_together, paths)}
    else:
        ((kind, path),) = paths.items()
        findings = {name: finding(check, kind, path) for name, check in CHECKS.items()}
    print("\n" + json.dumps(findings))
