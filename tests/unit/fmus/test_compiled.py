"""A component in the compiled library has the outputs that it has in Python, and refuses with a sentence."""

import numpy as np
import pytest

from components import REGISTRY, ComponentError, Instance
from components.contract.connection import Connection
from components.hinge import Hinge
from fmus.compiled import CompiledInstance, at_work
from tests.references.native_fmus import needs_native

pytestmark = needs_native
KINDS = sorted(name for name, kind in REGISTRY.items() if issubclass(kind, Connection))


def instances(kind, mode):
    component = REGISTRY[kind](**{**REGISTRY[kind].example().structure, "wrench_mode": mode})
    start = {q.name: 1.0 for q in component.parameter_layout.quantities if q.name == "hold_stiffness"}
    found = at_work(component, start, makes_steps=mode == "mean")
    if isinstance(found, Instance):
        pytest.skip("has no kernel of this kind")
    pair = found, Instance(component, start)
    for one in pair:
        moved(one, 0.4)
        one.initialize()
    return pair


def moved(one, size=1e-3):
    """Move every port further than the one before."""
    for k, port in enumerate(one.component.ports):
        place = one.component.input_layout[f"{port.name}.position"]
        one.inputs[place] += k * size * np.array((1.0, -2.0, 3.0))


@pytest.mark.parametrize("kind", KINDS)
def test_steps_and_the_way_back(kind):
    pair = instances(kind, "mean")
    for one in pair:
        moved(one)
    for _ in range(2):
        for one in pair:
            one.return_to_start()
            one.step(0.5)
            one.step(0.5)
        compiled, python = (one.outputs() for one in pair)
        assert compiled == pytest.approx(python, rel=1e-9, abs=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_events_and_present_inputs(kind):
    pair = instances(kind, "endpoint")
    for one in pair:
        if "hold" in one.component.input_layout:
            one.set("hold", 1.0)
            one.update(True)
        moved(one)
    compiled, python = (one.outputs() for one in pair)
    assert compiled == pytest.approx(python, rel=1e-9, abs=1e-7)


def test_an_impossible_parameter_is_refused_in_a_sentence():
    one = CompiledInstance(Hinge(), {"latch_damping": -1.0}, makes_steps=True)
    with pytest.raises(ComponentError, match=r"^latch_damping"):
        one.initialize()


def test_outputs_are_arrays_of_their_own():
    one, _ = instances("suspension", "endpoint")
    before, kept = one.outputs(), one.outputs()
    moved(one)
    assert not np.array_equal(before, one.outputs())
    assert np.array_equal(before, kept)
