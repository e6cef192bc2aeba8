"""Run in a process of its own: step derivatives of one native FMU against differences of whole steps.

    python derivatives.py native KIND=PATH

Prints the largest error of every kind of pair relative to the largest derivative of the same output quantity
with respect to the same input quantity's unit, as one JSON object.
"""

from __future__ import annotations

import json
import sys

import numpy as np

from tests.conformance.programs.driver import KINDS, OK, Fmu, Reference
from tests.conformance.programs.trial import begin, set_order, tune

H = 2e-3
AMOUNTS = {
    "N": 1.0,
    "N.m": 1.0,
    "m": 1e-5,
    "rad": 1e-5,
    "m/s": 1e-3,
    "rad/s": 1e-3,
    "m/s2": 1.0,
    "rad/s2": 1.0,
    "m/s3": 1e3,
    "rad/s3": 1e3,
    "1": 1e-4,
}
"""Differences by unit: motions beyond round-off, without leaving what cubic terms describe."""
ENGAGED = {
    "strand_damping": {"preload": 400.0, "strand_damping": 10.0},
    "stop_angle": {"stop_angle": -1.0},
}
"""Parameters (SI) of what has one of them: random motions of 10 mm at 5 m/s leave strands taut, as slack ones have
nothing to compare, and lines in their stops, as differences tell nothing where a torque begins."""
ROUND_OFF = 1e-14
"""Relative rounding of an output; what is left of larger numbers cancelled may be a few digits worse."""


def stepped(fmu, state, first, u, outputs):
    """Outputs after one step from a saved state."""
    fmu.slave.setFMUstate(state)
    assert fmu.set(first, u) == OK
    assert fmu.step(0.1, H) == OK, fmu.log
    return fmu.get(*outputs)


def difference(fmu, state, first, u, outputs, column, amount):
    """Central difference with one Richardson extrapolation: truncation of the fourth order."""
    found = []
    for size in (amount, 0.5 * amount):
        ahead, behind = u.copy(), u.copy()
        ahead[column] += size
        behind[column] -= size
        after = [stepped(fmu, state, first, v, outputs) for v in (ahead, behind)]
        found.append((after[0] - after[1]) / (ahead[column] - behind[column]))
    return (4.0 * found[1] - found[0]) / 3.0


def errors_of_orders(kind, path):
    """Largest relative error by input quantity, of both orders where there is a choice."""
    result = {}
    for fourth in (False, True):
        fmu, reference = Fmu(path), Reference(KINDS[kind].example())
        if fourth and not set_order(fmu, reference):
            break
        result |= {f"{name}{', order 4' * fourth}": e for name, e in errors(fmu, reference).items()}
    return result


def errors(fmu, reference):
    rng = np.random.default_rng(11)
    begin(fmu, reference, rng)
    tune(fmu, reference, rng)
    component = reference.component
    for mark, values in ENGAGED.items():
        for name, value in values.items() if mark in component.parameter_layout else ():
            assert fmu.set(component.parameter_layout[name].start, [value]) == OK
    first, outputs = reference.firsts[1], (reference.firsts[2], reference.sizes[2])
    for _ in range(3):
        fmu.set(first, reference.random_inputs(rng))
        assert fmu.step(0.0, H) == OK
    state = fmu.slave.getFMUstate()
    u = reference.random_inputs(rng)
    slopes = [q for q in component.input_layout.quantities if q.name.endswith("_slope")]
    held = u.copy()
    for quantity in slopes:
        held[component.input_layout[quantity.name]] = 0.0
    continuous = [q for q in component.input_layout.quantities if q.variability != "discrete"]
    return {
        **errors_at(fmu, component, state, (first, u), outputs, continuous),
        **{
            f"{k}, held": v
            for k, v in errors_at(fmu, component, state, (first, held), outputs, slopes).items()
        },
    }


def errors_at(fmu, component, state, inputs, outputs, quantities):
    """The same of a step from a state under inputs."""
    first, u = inputs
    after = stepped(fmu, state, first, u, outputs)
    references = [list(range(a, a + n)) for a, n in ((first, u.size), outputs)]
    result = {}
    for quantity in quantities:
        place = component.input_layout[quantity.name]
        exact, approximate = [], []
        for column in range(place.start, place.stop):
            stepped(fmu, state, first, u, outputs)
            known, unknown = [references[0][column]], references[1]
            exact.append(fmu.slave.getDirectionalDerivative(unknown, known, [1.0]))
            approximate.append(difference(fmu, state, first, u, outputs, column, AMOUNTS[quantity.unit]))
        exact, approximate = np.array(exact), np.array(approximate)
        for output in component.output_layout.quantities:
            where = component.output_layout[output.name]
            size = np.abs(approximate[:, where]).max()
            round_off = ROUND_OFF * np.abs(after[where]).max() / AMOUNTS[quantity.unit]
            if size > 1e3 * round_off:
                error = max(np.abs(exact[:, where] - approximate[:, where]).max() - round_off, 0.0)
                result[f"{output.name} by {quantity.name}"] = float(error / size)
    return result


if __name__ == "__main__":
    ((kind, path),) = (argument.split("=", 1) for argument in sys.argv[2:])
    print("\n" + json.dumps(errors_of_orders(kind, path)))
