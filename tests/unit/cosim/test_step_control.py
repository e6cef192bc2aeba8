"""Step sizes on errors of known laws, the guard of the balance of energy, and what ends a step, in C."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from components import Component, Quantity
from components.contract.component import Port
from fmus import native_library
from orchestrator.assembly import Condition, Event, Link
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import InProcess, in_process
from orchestrator.cosim.settings import Settings
from tests.references.coupled import mastered, rigid
from tests.references.coupling_parts import call

pytestmark = pytest.mark.skipif(native_library() is None, reason="no C compiler")

LARGEST, SMALLEST = 0.02, 2e-5
STEPS = 200
JUMP = 1e-4
"""Largest jump of the balance of energy over the energy in motion, at the reference tolerance."""


class Sizes:
    """Steps of the master, from 1 ms on."""

    def __init__(self) -> None:
        self._sizes = call("new_sizes", LARGEST, SMALLEST, 2, 1e-3)

    @property
    def now(self) -> float:
        return call("present_size", self._sizes)

    def judge(self, error: float) -> bool:
        return bool(call("judge", self._sizes, error))

    def settle(self, error_of: float) -> None:
        """Judge `STEPS` errors of a law error_of (h / 1 ms)^3."""
        for _ in range(STEPS):
            self.judge(error_of * (self.now / 1e-3) ** 3)

    def __del__(self) -> None:
        call("discard", self._sizes)


@pytest.mark.parametrize("error_of", [1e-6, 1e-2, 1.0, 50.0])
def test_size_settles_where_a_smooth_error_is_allowed(error_of):
    """Closed form: error c h^3 is 1 at h = c^(-1/3); below it, by at most the growth margin and two grid steps."""
    steps = Sizes()
    steps.settle(error_of)
    allowed = min(error_of ** (-1.0 / 3.0) * 1e-3, LARGEST)
    assert 0.5 ** (1.0 / 3.0) * 0.5 * allowed < steps.now <= allowed * (1.0 + 1e-9)


def test_a_jump_of_the_error_makes_the_step_small_enough_at_once():
    """Closed form: an error 1000 times too large needs a tenth of the step, found in at most two refusals."""
    steps = Sizes()
    steps.settle(0.5)
    before, refused = steps.now, 0
    while not steps.judge(1000.0 * (steps.now / before) ** 3):
        refused += 1
    assert 1 <= refused <= 2
    assert steps.now <= 0.25 * before


def test_stirring_after_a_change_does_not_drive_the_step_down():
    """Law of a stiff coordinate: each change adds an error that halves every step and does not depend on the size."""
    steps, stir, before = Sizes(), 0.0, 0.0
    smallest = LARGEST
    for _ in range(STEPS):
        stir = 6.0 if steps.now != before else 0.5 * stir
        before = steps.now
        steps.judge(stir + 1e-2 * (before / 1e-3) ** 3)
        smallest = min(smallest, steps.now)
    assert smallest >= 0.5e-3
    assert steps.now > 1e-3


def test_large_errors_are_refused_right_after_a_change():
    steps = Sizes()
    assert not steps.judge(11.0)
    assert steps.now < 1e-3


def test_no_step_below_the_smallest():
    steps = Sizes()
    steps.settle(1e12)
    assert steps.now >= 0.5 * SMALLEST


def test_a_divided_step_becomes_whole_seldom():
    """Alternating sizes excite stiff joints: the size of a divided step changes at most once in sixteen steps."""
    step, sizes = np.array([1, 0], dtype=np.uintp), []
    for _ in range(STEPS):
        while step[0] < 4:
            assert call("divide", step)
        call("stood", step)
        sizes.append(int(step[0]))
    assert sum(a != b for a, b in pairwise(sizes)) <= 2 * len(sizes) / 16
    assert not any(call("divide", np.array([parts, 0], dtype=np.uintp)) for parts in (512, 1024))
    halves = np.array([2, 0], dtype=np.uintp)
    for _ in range(16):
        call("stood", halves)
    assert halves.tolist() == [1, 0]


def test_matrices_are_too_slow_where_the_iterations_left_do_not_suffice():
    """Closed form: a contraction of a tenth takes an iteration a decade."""
    assert not call("too_slow", 1e5, 1e6, 6)
    assert call("too_slow", 1e7, 1e8, 6)
    assert call("too_slow", 2.0, 2.0, 10)


class Guard:
    """Of the balance of energy, from kinetic, potential, dissipated, numerical and supplied energies (J)."""

    def __init__(self, *energies: float) -> None:
        self._guard = call("new_guard", np.array(energies))

    def allows(self, h: float, *energies: float) -> bool:
        return bool(call("allows", self._guard, np.array(energies), h, JUMP))

    def accept(self, *energies: float) -> None:
        call("accepts", self._guard, np.array(energies))

    def give_in(self, *energies: float) -> None:
        call("gives_in", self._guard, np.array(energies))

    def __del__(self) -> None:
        call("discard", self._guard)


def test_guard_rejects_what_smaller_steps_cure():
    """A jump of the balance beside the energy in motion is refused, one of rounding size is not."""
    guard = Guard(0.0, 5e4, 0.0, 0.0, 0.0)
    guard.accept(10.0, 5e4 - 10.0, 0.0, 0.0, 0.0)
    assert not guard.allows(0.02, 11.0, 5e4 - 10.0, 0.0, 0.0, 0.0)
    assert guard.allows(0.01, 11.0, 5e4 - 11.0 + 1e-4, 0.0, 0.0, 0.0)
    assert guard.allows(0.01, 0.0, 5e4, 3.0, 0.0, 3.0)  # supplied and turned to heat at once


def test_guard_lets_rounding_of_what_hardly_moves_pass():
    """Regression: 1e-22 J at the start of a law made another run divide its steps until time stood still."""
    guard = Guard(0.0, 0.0, 0.0, 0.0, 0.0)
    assert guard.allows(3e-5, 1.5e-23, 1.8e-22, 1.06e-20, 0.0, 1.04e-20)
    assert not guard.allows(3e-5, 1e-18, 2e-18, 0.0, 0.0, 0.0)


def test_guard_never_waits_for_a_participant_that_keeps_no_books():
    """A power nobody accounts for passes after a few halvings, rounding once the smallest step is reached."""
    halved = (0.1 * 0.5 ** np.arange(8)).tolist()
    guard = Guard(1.0, 0.0, 0.0, 0.0, 0.0)
    answers = [guard.allows(h, 1.0, 0.0, 5.0 * h, 0.0, 0.0) for h in halved[:5]]
    assert answers == [False, False, False, True, True]
    guard.accept(1.0, 0.0, 5.0 * 0.1, 0.0, 0.0)
    assert guard.allows(0.1, 1.0, 0.0, 5.0 * 0.2, 0.0, 0.0)

    guard, noisy = Guard(1.0, 0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.5, 0.0, 0.0)
    assert not any(guard.allows(h, *noisy) for h in halved)
    guard.give_in(*noisy)
    guard.accept(*noisy)
    assert guard.allows(0.1, 1.0, 0.0, 0.0, 0.0, 0.0)


def met(before, after, h=1e-2):
    """What ends a step, by its number, and all that acts then."""
    reached = np.zeros(len(before))
    first = call("crossed", len(before), np.array(before), np.array(after), h, reached)
    return first, np.flatnonzero(reached).tolist()


def test_what_ends_a_step_acts_however_slowly_it_comes():
    """Definition: others act with it that reach zero within 1e-7 s; what began below zero never falls through it."""
    assert met([1e-8, 1.0], [-1e-9, 0.5]) == (0, [0])
    slow, twin, later, past = (1e-8, -1e-11), (1e-2, 0.9e-7), (1e-2, 1.1e-7), (-1e-3, -2e-3)
    assert met(*zip(slow, twin, later, past, strict=True)) == (0, [0, 1])
    assert met(*zip(later, past, strict=True)) == (-1, [])


class Clock(Component, registered=False):
    """Pushes with no force, and observes the cosine that vanishes at `root` (s)."""

    kind = "clock"

    def __init__(self, root: float) -> None:
        self.root = root
        self._declare(
            {"root": root}, ports=[Port("mount", "connection")], observations=[Quantity("wave", "1", "")]
        )

    def prepare(self, p):
        return None

    def initial(self, c, u):
        return np.zeros(1)

    def step(self, c, x, u, h):
        return x + h

    def outputs(self, c, x, u):
        return np.zeros(self.output_layout.size)

    def observe(self, c, x, u):
        return np.cos(0.5 * np.pi * x / self.root) if x[0] < 2.0 * self.root else -np.ones(1)

    @classmethod
    def example(cls):
        return cls(1.0)


@pytest.mark.parametrize("root", [1e-9, 0.123, 0.5, 0.999999])
def test_a_condition_is_met_where_it_holds(root):
    """Closed form: the zero of a cosine within a step, however steep or flat."""
    (body,) = in_process([rigid("ship", 1.0, (1.0, 1.0, 1.0), {"tail": (0.0, 0.0, 0.0)})])
    network = Network([body, InProcess("clock", Clock(root))], [Link(("ship", "tail"), ("clock", "mount"))])
    event = Event("zero", None, Condition("clock", "wave", 0, 0.0, rising=False))
    run = mastered(network, Settings(fixed_step=min(1.0, 2.0 * root)), events=[event])
    run.master.initialize(preload=False)
    run.master.run(1.0 if root > 1e-3 else 3.0 * root)
    ((time, name, _),) = run.events
    assert (time, name) == (pytest.approx(root, abs=1e-11), "zero")
