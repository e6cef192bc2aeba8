"""A small grid of the stability sweep, and the kinematic latch as a plastic event."""

from itertools import product
from math import pi

import pytest

from orchestrator.cosim.master import Settings
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

PANELS = {"rigid": (0, 1.0), "flexible": (16, 1.0), "undamped": (16, 0.0)}
GRID = list(product((1e3, 2e6, 1e10), (1e2, 1e9), (1e-4, 2e-3, 2e-2)))


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("panel", PANELS)
@pytest.mark.parametrize(("joint", "latch", "h"), GRID)
def test_the_implicit_master_never_diverges(panel, joint, latch, h, order):
    """Wrenches that do the work of a potential conserve energy at any stiffness and step (design: section 3)."""
    modes, damping = PANELS[panel]
    data = panel_data(modes)
    outcome = run(*panel_scene(data, joint, latch, damping), 60 * h, Settings(fixed_step=h, order=order))
    verdict = judge(outcome, pi / latch_frequency(data, latch))
    assert not verdict.diverged, outcome.failure or verdict
    # rotations are of second order in the step, and a wall has slopes that work on them
    assert verdict.residual < (1e-3 if order == 2 else 1e-2)


@pytest.mark.parametrize("order", [2, 4])
def test_absurd_trial_wrenches_are_no_solution(order):
    """Undamped, under a latch like a wall: the iteration once went off to wrenches of 1e50 and passed for solved."""
    outcome = run(*panel_scene(panel_data(16), 1e5, 1e9, 0.0), 1.0, Settings(fixed_step=5e-3, order=order))
    assert not judge(outcome, 1e-3).diverged, outcome.failure


def test_a_resolved_latch_peak_is_accurate_and_the_baselines_diverge():
    """H w of 0.02: a scheme of second order errs by (H w)² / 12 or so; explicit steps do not hold the joint."""
    (cell,) = sweep_row(0, 1.0, 2e6, 2e3, (1e-3,), 60)
    assert cell.resolved
    assert cell.error < 1e-3
    assert cell.baselines == "JG"


def test_a_resolved_latch_peak_is_far_more_accurate_at_order_four():
    """The same cell: (H w)^4 instead of (H w)^2, and no worse than a hundredth of the error."""
    two, four = (sweep_row(0, 1.0, 2e6, 2e3, (1e-3,), 60, order)[0] for order in (2, 4))
    assert four.error < 1e-2 * two.error


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("h", STEPS)
def test_the_kinematic_latch_is_a_plastic_event(h, order):
    """Two free bodies become one with the same momenta; the energy falls to that of the one body."""
    event = plastic_event(h, order)
    assert event.linear_momentum < 1e-12
    assert event.angular_momentum < 1e-7
    assert abs(event.energy_drop) < 1e-6
    assert abs(event.reduced) < 1e-6
    assert event.rate_left < 1e-5
