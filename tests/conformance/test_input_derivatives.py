"""Bodies under inputs that are linear in time, as other tools give them: FMI 2.0's derivatives of real inputs."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi2 import fmi2Integer, fmi2Real, fmi2ValueReference

from components import rotation_matrix
from fmus import native_library
from tests.conformance.programs.driver import ERROR, KINDS, OK, Fmu, Reference
from tests.conformance.test_fmus import BACKENDS, path_of

pytestmark = pytest.mark.skipif(native_library() is None, reason="no native library was built")
H = 2e-3
BODIES = ("body", "driven_base", "fixed_base", "moving_base")
NAMES = ("force", "torque")


def opened(kind):
    """An FMU in step mode, its component's numbers and its variables by name."""
    fmu, reference = Fmu(path_of(kind, "native")), Reference(KINDS[kind].example())
    assert fmu.start() == OK
    return fmu, reference, {v.name: v.valueReference for v in fmu.description.modelVariables}


def loads(reference, variables):
    """Value references of forces and torques of the first port, and of their slopes."""
    port = reference.component.ports[0].name
    return [
        [variables[f"{port}.{name}{ending}[{i}]"] for name in NAMES for i in (1, 2, 3)]
        for ending in ("", "_slope")
    ]


def set_derivatives(fmu, references, values, orders=None):
    """Status of the raw function; FMPy's own wrapper raises."""
    count = len(references)
    given = (
        (fmi2ValueReference * count)(*references),
        count,
        (fmi2Integer * count)(*(orders or [1] * count)),
        (fmi2Real * count)(*values),
    )
    return fmu.call("fmi2SetRealInputDerivatives", fmu.slave.component, *given)


def everything(fmu, reference):
    first = reference.firsts[2]
    return fmu.get(first, reference.sizes[2] + reference.sizes[3])


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_a_model_description_says_whether_inputs_are_interpolated(kind):
    """FMI 2.0, 4.3.1: bodies do; what takes motions has no use for their derivatives."""
    description = read_model_description(path_of(kind, "native"))
    assert description.coSimulation.canInterpolateInputs == (kind in BODIES)


@pytest.mark.parametrize("kind", BODIES)
def test_derivatives_are_means_and_slopes(kind):
    """Definition: u + r t is over a step u + r h / 2 in the mean, and r h / 2 in the slope; from step to step."""
    (fmu, reference, variables), (other, *_) = opened(kind), opened(kind)
    values, slopes = loads(reference, variables)
    rng = np.random.default_rng(7)
    for k in range(4):
        wrench, slope, rate = rng.normal(size=(3, 6))
        given = {"values": wrench, "slopes": slope}
        for one, shift in ((fmu, 0.0), (other, 0.5 * H * rate)):
            assert one.call("setReal", values, (given["values"] + shift).tolist()) == OK
            assert one.call("setReal", slopes, (given["slopes"] + shift).tolist()) == OK
        assert set_derivatives(fmu, values, rate) == OK
        assert fmu.step(k * H, H) == other.step(k * H, H) == OK
        np.testing.assert_allclose(
            everything(fmu, reference), everything(other, reference), rtol=1e-12, atol=1e-14
        )


def center_of_mass(fmu, reference, variables):
    """Along the first world axis (m), from the construction frame."""
    turned = rotation_matrix(tuple(fmu.get(variables["frame_orientation[1]"], 4).tolist()))
    place = fmu.get(variables["frame_position[1]"], 3) + turned @ reference.component.data.center_of_mass
    return place[0]


def test_a_body_under_a_growing_force():
    """Closed form: its centre of mass moves by f t^2 / 2 m + r t^3 / 6 m in one long step, however it turns."""
    fmu, reference, variables = opened("body")
    force, rate, h, mass = 3.0, 40.0, 0.1, reference.component.data.mass
    port = reference.component.ports[0].name
    for name in [p.name for p in reference.component.ports]:
        assert fmu.call("setReal", [variables[f"{name}.force[1]"]], [force if name == port else 0.0]) == OK
    before = center_of_mass(fmu, reference, variables)
    gravity = reference.p[reference.component.parameter_layout["gravity"]]
    velocity = reference.component.initial(reference.constants, reference.u)[7] / mass
    assert set_derivatives(fmu, [variables[f"{port}.force[1]"]], [rate]) == OK
    assert fmu.step(0.0, h) == OK
    place = center_of_mass(fmu, reference, variables)
    moved = (
        velocity * h + 0.5 * gravity[0] * h * h + force * h * h / (2.0 * mass) + rate * h**3 / (6.0 * mass)
    )
    assert place - before == pytest.approx(moved, rel=1e-10)


def test_derivatives_hold_until_others_are_set_and_are_part_of_the_state():
    """Rule: like inputs; a restored state has those it was saved with, and a reset has none."""
    fmu, reference, variables = opened("body")
    values, _ = loads(reference, variables)
    plain, *_ = opened("body")
    assert set_derivatives(fmu, values, [50.0] * 6) == OK
    state = fmu.slave.getFMUState()
    data = fmu.slave.serializeFMUState(state)
    assert fmu.step(0.0, H) == OK
    held = everything(fmu, reference)
    assert plain.step(0.0, H) == OK
    assert np.any(held != everything(plain, reference))
    assert set_derivatives(fmu, values, [0.0] * 6) == OK
    for saved in (state, fmu.slave.deserializeFMUState(data)):
        fmu.slave.setFMUState(saved)
        assert fmu.step(0.0, H) == OK
        assert np.array_equal(everything(fmu, reference), held)
    fmu.slave.reset()
    fmu.slave.setupExperiment(startTime=0.0)
    fmu.slave.enterInitializationMode()
    assert fmu.start() == OK
    assert fmu.step(0.0, H) == OK
    assert np.array_equal(everything(fmu, reference), everything(plain, reference))


def test_directional_derivatives_after_a_step_are_those_under_its_inputs():
    """Independent: differences of whole steps with the same derivatives of inputs, about a body that turns."""
    fmu, reference, variables = opened("body")
    values, _ = loads(reference, variables)
    unknowns = list(range(reference.firsts[2], reference.firsts[3]))
    rate, amount, h = [3e3, -2e3, 1e3, 400.0, 300.0, -500.0], 1e-2, 0.02
    assert set_derivatives(fmu, values, rate) == OK
    state = fmu.slave.getFMUState()
    assert fmu.step(0.0, h) == OK
    found = np.array(fmu.slave.getDirectionalDerivative(unknowns, values[:1], [1.0]))
    ends = []
    for shift in (amount, -amount):
        fmu.slave.setFMUState(state)
        assert fmu.call("setReal", values[:1], [shift]) == OK
        assert fmu.step(0.0, h) == OK
        ends.append(fmu.get(unknowns[0], len(unknowns)))
    expected = (ends[0] - ends[1]) / (2.0 * amount)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-12 / amount)


@pytest.mark.parametrize("seed", [np.nan, np.inf])
def test_a_seed_that_is_no_number_is_refused(seed):
    """Rule: bad input gives a sentence, not a derivative of zero."""
    fmu, reference, variables = opened("body")
    values, _ = loads(reference, variables)
    assert fmu.step(0.0, H) == OK
    with pytest.raises(Exception, match="DirectionalDerivative"):
        fmu.slave.getDirectionalDerivative([reference.firsts[2]], values[:1], [seed])
    assert "finite" in fmu.log[-1]


@pytest.mark.parametrize(
    ("name", "order", "value", "sentence"),
    [
        ("{port}.force[1]", 2, 1.0, "order 2"),
        ("{port}.force[1]", 1, np.nan, "must be a finite number"),
        ("{port}.force_slope[1]", 1, 1.0, "no derivative"),
        ("{port}.position[1]", 1, 1.0, "no derivative"),
        (None, 1, 1.0, "an input"),
    ],
)
def test_what_takes_no_derivative_is_told(name, order, value, sentence):
    """Rule: errors are sentences, and nothing is changed."""
    fmu, reference, variables = opened("body")
    place = 10**6 if name is None else variables[name.format(port=reference.component.ports[0].name)]
    assert set_derivatives(fmu, [place], [value], [order]) == ERROR
    assert sentence in fmu.log[-1]
    plain, *_ = opened("body")
    assert fmu.step(0.0, H) == plain.step(0.0, H) == OK
    assert np.array_equal(everything(fmu, reference), everything(plain, reference))


def test_connections_take_no_derivatives():
    """FMI 2.0: asking for none of them is no error."""
    fmu, _, variables = opened("hinge")
    assert set_derivatives(fmu, [variables["inboard.position[1]"]], [1.0]) == ERROR
    assert set_derivatives(fmu, [], []) == OK
