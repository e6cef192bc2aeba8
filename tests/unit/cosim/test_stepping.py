"""Step size control on errors of known laws, event location on known functions, and when matrices are too slow."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi
from types import SimpleNamespace

import pytest
from orchestrator.cosim.events.crossings import Fall, find_event, first_met, met_with
from orchestrator.cosim.implicit.convergence import MAX_ITERATIONS, is_too_slow
from orchestrator.cosim.stepping import STEPS_AFTER_DIVISION, StepSizes, SubdividedStep

LARGEST, SMALLEST = 0.02, 2e-5
STEPS = 200


def sizes(start: float = 1e-3) -> StepSizes:
    found = StepSizes(LARGEST, SMALLEST)
    found.restart(start)
    return found


def rejected(steps: StepSizes, error_of: float, order: int = 3) -> int:
    """Judge `STEPS` errors of a law error_of (h / 1 ms)^order; how many of them did not stand."""
    return sum(not steps.judge(error_of * (steps.size / 1e-3) ** order) for _ in range(STEPS))


@pytest.mark.parametrize("error_of", [1e-6, 1e-2, 1.0, 50.0])
def test_size_settles_where_a_smooth_error_is_allowed(error_of):
    """Closed form: error c h^3 is 1 at h = c^(-1/3); below it, by at most the growth margin and two grid steps."""
    steps = sizes()
    rejected(steps, error_of)
    allowed = min(error_of ** (-1.0 / 3.0) * 1e-3, LARGEST)
    assert 0.5 ** (1.0 / 3.0) * 0.5 * allowed < steps.size <= allowed * (1.0 + 1e-9)


def test_a_jump_of_the_error_makes_the_step_small_enough_at_once():
    """Closed form: an error 1000 times too large needs a tenth of the step, found in at most two refusals."""
    steps = sizes()
    rejected(steps, 0.5)
    before = steps.size
    refused = 0
    while not steps.judge(1000.0 * (steps.size / before) ** 3):
        refused += 1
    assert 1 <= refused <= 2
    assert steps.size <= 0.25 * before


def test_stirring_after_a_change_does_not_drive_the_step_down():
    """Law of a stiff coordinate: each change adds an error that halves every step and does not depend on the size."""
    steps, stir, level = sizes(), 0.0, None
    smallest = LARGEST
    for _ in range(STEPS):
        stir = 6.0 if steps.level != level else 0.5 * stir
        level = steps.level
        steps.judge(stir + 1e-2 * (steps.size / 1e-3) ** 3)
        smallest = min(smallest, steps.size)
    assert smallest >= 0.5e-3
    assert steps.size > 1e-3


def test_large_errors_are_refused_right_after_a_change():
    steps = sizes()
    assert not steps.judge(11.0)
    assert steps.size < 1e-3


def test_no_step_below_the_smallest():
    steps = sizes()
    rejected(steps, 1e12)
    assert steps.size >= 0.5 * SMALLEST


@pytest.mark.parametrize("root", [1e-9, 0.123, 0.5, 0.999999])
def test_find_event_of_known_functions(root):
    """Closed form: zero of cos at a known place, steep at its ends or flat; also the last call is at the result."""
    calls = []

    def distance(h: float) -> float:
        calls.append(h)
        return cos(0.5 * pi * (h / root)) if h < 2.0 * root else -1.0

    h = min(1.0, 2.0 * root)
    found = find_event(distance, 1.0, distance(h), h)
    assert found == pytest.approx(root, abs=1e-11)
    assert calls[-1] == found


def test_matrices_are_too_slow_where_the_iterations_left_do_not_suffice():
    """Closed form: a contraction of a tenth takes an iteration a decade."""
    assert not is_too_slow(1e5, 1e6, MAX_ITERATIONS - 6)
    assert is_too_slow(1e7, 1e8, MAX_ITERATIONS - 6)
    assert is_too_slow(2.0, 2.0, 4)


def test_what_ends_a_step_acts_however_slowly_it_comes():
    """Definition: the line that a step was ended for comes first, though 1e-11 of its way is left at 1e-6 rad/s.

    Others act with it that reach zero within 1e-7 s, at their rates; what began below zero never falls through it.
    """
    slow, twin, later, past = (SimpleNamespace(name=name) for name in ("slow", "twin", "later", "past"))
    h = 1e-2
    met = first_met([Fall(slow, 1e-8, -1e-9), Fall(later, 1.0, 0.5)], h)
    assert met.one is slow
    ends = [
        Fall(slow, 1e-8, 1e-11),
        Fall(twin, 1e-2, 0.9e-7),
        Fall(later, 1e-2, 1.1e-7),
        Fall(past, -1e-3, -2e-3),
    ]
    assert met_with(met, ends, h) == [slow, twin]


def test_a_divided_step_becomes_whole_seldom():
    """Steps that are whole and divided in turn pump what is stiff: sizes change once in so many steps at the most."""
    step, sizes = SubdividedStep(), []
    for _ in range(200):
        while step.parts < 4:
            assert step.divide()
        step.stood()
        sizes.append(step.parts)
    changes = sum(a != b for a, b in pairwise(sizes))
    assert changes <= 2 * len(sizes) / STEPS_AFTER_DIVISION
    assert any(SubdividedStep(parts).divide() is False for parts in (512, 1024))
    whole = SubdividedStep(2)
    for _ in range(STEPS_AFTER_DIVISION):
        whole.stood()
    assert whole == SubdividedStep()
