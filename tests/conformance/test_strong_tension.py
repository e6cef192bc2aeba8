"""Bodies whose tension is stronger than their bending, by loads or as it stretches them: FMUs against the component."""

from __future__ import annotations

import re

import numpy as np
import pytest

from components.body import Body
from components.contract.component import ComponentError
from fmus import native_library
from tests.conformance.programs.driver import OK, Fmu, Reference, built
from tests.unit.components.body.test_second_order import EULER, beam
from tests.unit.components.clamped_membrane import clamped_membrane

pytestmark = pytest.mark.skipif(native_library() is None, reason="no native library was built")
H = 5e-3
AMOUNT = 1e-3
"""Difference of loads (N, N.m): small beside the loads, and what it changes is large beside round-off."""


def pulled(rng, pull):
    """Inputs (24,): forces along x that stretch the beam, and small wrenches in all directions, with slopes."""
    u = pull * np.tile([1e-2, 1e-2, 1e-2, 1e-4, 1e-3, 1e-3], 4) * rng.standard_normal(24)
    u[0], u[6] = -pull, pull
    return u


def started(body):
    """The FMU of a body and the component."""
    fmu, reference = Fmu(str(built(body, "pulled", backend="native"))), Reference(body)
    assert fmu.start() == OK
    reference.start()
    return fmu, reference


@pytest.fixture
def pair():
    """Of a beam."""
    return started(beam(6, gyration_radius=0.05).body)


def membrane():
    """A foil that its ports bend by thicknesses."""
    data = clamped_membrane(7)
    return Body(data.to_arrays(), [{"name": name, "point": name} for name in data.point_names])


def pushed(rng, force):
    """Inputs (24,): forces across the foil that bend it, and small wrenches in all directions, with slopes."""
    u = force * np.tile([1e-2, 1e-2, 1e-2, 1e-4, 1e-4, 1e-4], 4) * rng.standard_normal(24)
    u[2], u[8] = -force, force
    return u


@pytest.mark.parametrize(
    ("build", "loads"),
    [
        (lambda: beam(6, gyration_radius=0.05).body, lambda rng: pulled(rng, 10.0 * EULER)),
        (membrane, lambda rng: pushed(rng, 30.0)),
    ],
    ids=["beam", "membrane"],
)
def test_steps_and_their_derivatives_are_equal(build, loads):
    """Ten times the Euler load, six thicknesses: outputs to round-off; derivatives as central differences truncate."""
    fmu, reference = started(build())
    rng = np.random.default_rng(4)
    outputs, first = (reference.firsts[2], reference.sizes[2]), reference.firsts[1]
    for k in range(20):
        reference.u = u = loads(rng)
        state = fmu.slave.getFMUstate()
        fmu.set(first, u)
        assert fmu.step(k * H, H) == OK, fmu.log
        reference.step(H)
        size = np.abs(reference.outputs()).max()
        assert fmu.get(*outputs) == pytest.approx(reference.outputs(), rel=0, abs=1e-12 * size)
    unknown = list(range(outputs[0], sum(outputs)))
    exact = [fmu.slave.getDirectionalDerivative(unknown, [first + c], [1.0]) for c in range(24)]
    sides = []
    for amount in (AMOUNT, -AMOUNT):
        rows = []
        for column in range(24):
            changed = u.copy()
            changed[column] += amount
            fmu.slave.setFMUstate(state)
            fmu.set(first, changed)
            assert fmu.step(19 * H, H) == OK
            rows.append(fmu.get(*outputs))
        sides.append(rows)
    differences = (np.array(sides[0]) - np.array(sides[1])) / (2.0 * AMOUNT)
    assert np.array(exact) == pytest.approx(differences, rel=0, abs=1e-7 * np.abs(differences).max())


def test_a_step_without_an_end_is_refused(pair):
    """Sentence, never a number that is none: a thousand times the load that the step resolves."""
    fmu, reference = pair
    u = pulled(np.random.default_rng(5), 1e4 * EULER)
    fmu.set(reference.firsts[1], u)
    sentence = r"0\.005 s .*40 iterations"
    assert fmu.step(0.0, H) != OK
    assert re.search(sentence, fmu.log[-1])
    reference.u = u
    with pytest.raises(ComponentError, match=sentence):
        reference.step(H)
