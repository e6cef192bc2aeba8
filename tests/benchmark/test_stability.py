"""A small grid of the stability sweep, and the kinematic latch as a plastic event.

The claims are those of the scheme, which native FMUs share with the Python components to round-off (see
`tests/conformance`) and carry out in a tenth of the time; where there are none, the components take their place.
"""

from itertools import product
from math import pi

import pytest

from orchestrator.cosim.settings import Settings
from tests.benchmark.stability import (
    STEPS,
    judge,
    latch_frequency,
    panel_data,
    panel_scene,
    plastic_event,
    run,
    sweep_row,
)
from tests.references.native_fmus import HAS_NATIVE, needs_native

PANELS = {"rigid": (0, 1.0), "flexible": (16, 1.0), "undamped": (16, 0.0)}
"""Modes, and the share of their damping."""
GRID = list(product((1e3, 2e6, 1e10), (1e2, 1e9), (1e-4, 2e-3, 2e-2)))
CASES = [(panel, *cell) for panel in PANELS for cell in GRID if panel != "flexible" or cell[0] == 2e6]
"""What damping could hide shows undamped, so that the damped panel is tried on one joint."""


@pytest.mark.parametrize(("panel", "joint", "latch", "h"), CASES)
def test_the_implicit_master_never_diverges(panel, joint, latch, h):
    """Held wrenches that are mean wrenches conserve energy at any stiffness and step (design: section 3)."""
    assert residual_of_stable_run(panel, joint, latch, Settings(fixed_step=h)) < 1e-3


@needs_native
@pytest.mark.parametrize(("panel", "joint", "latch", "h"), CASES)
def test_order_four_never_diverges(panel, joint, latch, h):
    """So do wrenches with slopes, up to the rotation of flexible bodies.

    A panel that bounces on a latch like a wall within steps of 20 ms, which do not resolve its first modes, leaves
    2.6e-3: that goes with the square of its rate and with h^2.5, and is 2e-6 without modes.
    """
    settings = Settings(fixed_step=h, order=4)
    assert residual_of_stable_run(panel, joint, latch, settings) < (4e-3 if h > 1e-2 else 1e-3)


def residual_of_stable_run(panel, joint, latch, settings):
    modes, damping = PANELS[panel]
    data = panel_data(modes)
    until = 60 * settings.fixed_step
    outcome = run(*panel_scene(data, joint, latch, damping), until, settings, native=HAS_NATIVE)
    verdict = judge(outcome, pi / latch_frequency(data, latch))
    assert not verdict.diverged, outcome.failure or verdict
    return verdict.residual


@needs_native
@pytest.mark.parametrize("latch", [1e2, 1e9])
def test_order_four_stores_no_passing_excess(latch):
    """Without inertial terms, which lend it thousands of times that, an unresolved latch holds what came in."""
    settings = Settings(fixed_step=2e-2, order=4)
    outcome = run(*panel_scene(panel_data(16), 1e10, latch), 60 * 2e-2, settings, native=True)
    assert judge(outcome, 1e-3).excess < 2e-3


@needs_native
@pytest.mark.parametrize("order", [2, 4])
def test_absurd_trial_wrenches_are_no_solution(order):
    """Undamped, under a latch like a wall: the iteration once went off to wrenches of 1e50 and passed for solved."""
    outcome = run(
        *panel_scene(panel_data(16), 1e5, 1e9, 0.0), 1.0, Settings(fixed_step=5e-3, order=order), native=True
    )
    assert not judge(outcome, 1e-3).diverged, outcome.failure


def test_a_resolved_latch_peak_is_accurate_and_the_baselines_diverge():
    """H w of 0.02: a scheme of second order errs by (H w)² / 12 or so; explicit steps do not hold the joint."""
    (cell,) = sweep_row(0, 1.0, 2e6, 2e3, (1e-3,), 60, native=HAS_NATIVE)
    assert cell.resolved
    assert cell.error < 1e-3
    assert cell.baselines == "JG"


def test_a_resolved_latch_peak_is_far_more_accurate_at_order_four():
    """The same cell: (H w)^4 instead of (H w)^2, and no worse than a hundredth of the error."""
    two, four = (sweep_row(0, 1.0, 2e6, 2e3, (1e-3,), 60, order, native=HAS_NATIVE)[0] for order in (2, 4))
    assert four.error < 1e-2 * two.error


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("h", STEPS)
def test_the_kinematic_latch_is_a_plastic_event(h, order):
    """Two free bodies become one with the same momenta; the energy falls to that of the one body."""
    event = plastic_event(h, order, native=HAS_NATIVE)
    assert event.linear_momentum < 1e-12
    assert event.angular_momentum < 1e-7
    assert abs(event.energy_drop) < 1e-6
    assert abs(event.reduced) < 1e-5  # the bushings swing, by 2e-6 of the rate, in the row before
    assert event.rate_left < 1e-5
