"""Components that the coupling in C calls back: what they raise comes out as it is, and runs go on where they stood."""

from __future__ import annotations

import numpy as np
import pytest

from components import Component, ComponentError
from components.contract.component import Port
from fmus import native_library
from orchestrator.assembly import Link
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import InProcess, ParticipantError, in_process
from orchestrator.cosim.settings import Settings
from orchestrator.scene.builder import Scene
from tests.references.coupled import mastered, rigid
from tests.unit.run.as_one.host import TWO_PANELS

pytestmark = pytest.mark.skipif(native_library() is None, reason="no C compiler")

FAILS_AT, END = 0.03, 0.05


class Raising(Component, registered=False):
    """Pushes with no force, and raises something in one of its functions from `FAILS_AT` (s) on, or once then."""

    kind = "raising"

    def __init__(self, error, where, *, once=False):
        self.error, self.where, self.once, self.raised = error, where, once, False
        self._declare({}, [Port("mount", "connection")])

    def _call(self, where, x):
        if where == self.where and x[0] >= FAILS_AT and not (self.once and self.raised):
            self.raised = True
            raise self.error

    def prepare(self, p):
        return None

    def initial(self, c, u):
        return np.zeros(1)

    def step(self, c, x, u, h):
        self._call("step", x + h)
        return x + h

    def outputs(self, c, x, u):
        self._call("outputs", x)
        return np.zeros(self.output_layout.size)

    def observe(self, c, x, u):
        self._call("observe", x)
        return np.zeros(0)

    @classmethod
    def example(cls):
        return cls(None, "")


def pushed(error, where, **once):
    """A body that such a component is on, under way; what was raised of its run, and the master."""
    (body,) = in_process([rigid("ship", 1.0, (1.0, 1.0, 1.0), {"tail": (0.0, 0.0, 0.0)})])
    parts = [body, InProcess("raising", Raising(error, where, **once))]
    run = mastered(Network(parts, [Link(("ship", "tail"), ("raising", "mount"))]), Settings(fixed_step=2e-3))
    run.master.initialize(preload=False)
    with pytest.raises(BaseException) as caught:  # noqa: PT011 - compared with what is raised
        run.master.run(END)
    return caught.value, run


@pytest.mark.parametrize("where", ["step", "outputs"])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), RuntimeError("of another kind"), MemoryError()])
def test_what_a_component_raises_comes_out_as_it_is(error, where):
    """It passes through C, where the step is given up; rows up to it are recorded."""
    raised, run = pushed(error, where)
    assert raised is error
    assert FAILS_AT - 5e-3 < run.times[-1] <= FAILS_AT + 1e-9
    assert run.master.time <= FAILS_AT + 1e-9


@pytest.mark.parametrize("where", ["step", "outputs"])
def test_an_interruption_comes_out_though_it_comes_once(where):
    error = KeyboardInterrupt()
    raised, run = pushed(error, where, once=True)
    assert raised is error
    assert run.master.time <= FAILS_AT + 1e-9


def test_what_a_component_refuses_has_its_name():
    raised, _ = pushed(ComponentError("the tank is empty"), "step")
    assert isinstance(raised, ParticipantError)
    assert str(raised).startswith("raising: ")
    assert "the tank is empty" in str(raised)


@pytest.mark.parametrize("order", [pytest.param(2, marks=pytest.mark.thorough), 4])
def test_a_run_goes_on_in_every_bit_where_it_stood(order):
    """Of components whose derivatives are differences of steps: rows, steps and sweeps from a snapshot on."""
    assembly, kept = assemble(Scene.load(TWO_PANELS).check()), []

    def under_way():
        network = Network(in_process(assembly.parts), assembly.links, order)
        return mastered(network, Settings(order=order, snapshot_every=0.01), assembly.hinge_lines)

    whole, resumed = under_way(), under_way()
    whole.master.keep = kept.append
    whole.master.initialize(preload=assembly.preload)
    whole.master.run(0.03)
    resumed.master.resume(kept[0])
    begin = resumed.master.time
    resumed.master.run(0.03)
    assert 0.01 <= begin < 0.02
    assert resumed.master.segments == whole.master.segments
    assert resumed.master.statistics.sweeps == whole.master.statistics.sweeps
    count = len(resumed.times)
    assert count > 10
    assert resumed.times == whole.times[-count:]
    for one, other in zip(resumed.rows, whole.rows[-count:], strict=True):
        np.testing.assert_array_equal(one, other)
