"""What a native body keeps of the start of a step changes no bit of the steps from there."""

from contextlib import ExitStack
from types import SimpleNamespace

import numpy as np

from components.body import Body
from orchestrator.assembly import Part
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.run.run import export
from tests.references.native_fmus import needs_native

SIZES = (0.01, 0.003, 0.01)


def step(body: FmuParticipant, state: bytes, wrenches: np.ndarray, h: float) -> np.ndarray:
    """Outputs after a step (s) from a state, and the state behind them."""
    body.deserialize(state)
    body.inputs[:] = wrenches
    body.write()
    body.do_step(0.0, h)
    body.read()
    body.save()
    return np.concatenate((body.outputs, np.frombuffer(body.serialized(), dtype=np.uint8)))


@needs_native
def test_steps_in_any_order_are_those_of_a_new_instance(tmp_path):
    """Identity of every bit: from two states in turn, under any wrenches and of any size."""
    part = Part("body", "body", Body.example().structure, {"initial_angular_velocity": (0.3, -0.2, 0.1)})
    (path,) = export(SimpleNamespace(name="scene", parts=[part]), tmp_path, "native")
    random = np.random.default_rng(1)
    with ExitStack() as stack:

        def loaded() -> FmuParticipant:
            body = FmuParticipant("body", path)
            stack.callback(body.close)
            body.initialize(0.0)
            return body

        used = loaded()
        used.save()
        states = [used.serialized()]
        step(used, states[0], random.normal(size=used.inputs.size), 0.01)
        states.append(used.serialized())
        for trial, h in enumerate(SIZES * 2):
            wrenches = random.normal(size=used.inputs.size)
            state = states[trial % 2]
            step(used, state, 0.5 * wrenches, h)
            found = step(used, state, wrenches, h)
            np.testing.assert_array_equal(found, step(loaded(), state, wrenches, h))
