"""Order of the coupling on flexible bodies: a latched panel, a locked one, and two panels that open.

All are native FMUs in fixed steps, against the same run with much smaller ones from the same instant, which lies after
what starts the vibration: by then its content falls with frequency. Joints hold with 2e6 N/m and more, so steps resolve
the panels and not the hinges. Whatever turns is of order 2, by the mean directions of a step, with a constant that goes
with the square of the rate: in these scenes it takes over where errors at order 4 have come down to 1e-6.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orchestrator.assembly.assemble import assemble
from orchestrator.scene import load_scene
from tests.references.native_fmus import needs_native
from tests.regression.order.held_panel import FINEST, SETTLED, WINDOW, Followed, follow, means, run

pytestmark = needs_native
TWO_PANELS = Path(__file__).parents[2] / "scenes" / "two_flexible_panels.toml"
JOINT = 2e6
STEPS = {"spring": (2e-3, 1e-3, 5e-4), "lock": (1e-3, 5e-4, 2.5e-4)}
"""H (s) where vibration dominates: what the impulse of a lock leaves in the modes reaches to higher frequencies."""
SLOPES = {"spring": 3.0, "lock": 3.5}
KINETIC = 5.9
"""J, of the panel when it latches."""
OPENING, OPENING_WINDOW, COMMON = 0.8, 0.24, 4e-3
"""The two panels open for that long (s) in steps of 0.4 ms, in all runs, then for the window; the longest H."""


def slope(steps, found):
    """Slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log(steps), np.log(found), 1)[0])


def errors(holds, order):
    """Largest relative error of both mean loads at each step, against order 4 at the finest one."""
    exact = means(run(JOINT, holds, FINEST, 4))
    lost = [means(run(JOINT, holds, h, order)) - exact for h in STEPS[holds]]
    return np.array([(np.linalg.norm(one, axis=0) / np.linalg.norm(exact, axis=0)).max() for one in lost])


@pytest.mark.parametrize("holds", ["spring", pytest.param("lock", marks=pytest.mark.thorough)])
def test_a_held_panel_is_of_order_four(holds):
    """Mean force and torque of a hinge; a tenth of the errors at order 2 and less, at equal steps.

    Beside the spring, modes of the panel that 2 ms do not resolve lie between: 3.2 there, 3.6 beside a joint of half
    the stiffness.
    """
    four = errors(holds, 4)
    assert slope(STEPS[holds], four) >= SLOPES[holds]
    assert np.all(four <= 0.1 * errors(holds, 2))


def recorded(holds, h):
    """Loads at common points (points, 2): latch torque of both hinges, interface torque about their line."""
    record = run(JOINT, holds, h, 4).record
    points = record.events[0][0] + SETTLED + STEPS[holds][0] * np.arange(1, round(WINDOW / STEPS[holds][0]))
    rows = np.searchsorted(record.times, points - 0.5 * FINEST)
    latch = sum(record.signal(f"{side}_hinge", "latch_torque") for side in ("left", "right"))
    return np.stack([latch, record.signal("base", "interface_torque")[:, 1]], axis=1)[rows]


@pytest.mark.parametrize("holds", ["spring", pytest.param("lock", marks=pytest.mark.thorough)])
def test_recorded_loads_are_of_order_four(holds):
    """At the communication points themselves, by the mean and slope of the steps on both sides."""
    exact = recorded(holds, FINEST)
    found = [np.linalg.norm(recorded(holds, h) - exact, axis=0) for h in STEPS[holds]]
    lost = np.array(found) / np.linalg.norm(exact, axis=0)
    assert min(slope(STEPS[holds], column) for column in lost.T) >= 3.5


@cache
def opening(h, order):
    scene = assemble(load_scene(TWO_PANELS))
    plan = ((4e-4,) * round(OPENING / 4e-4) + (h,) * round(OPENING_WINDOW / h),)
    return follow(scene.parts, scene.links, (), OPENING + OPENING_WINDOW, plan, order)


def at_common_points(found: Followed) -> tuple[np.ndarray, np.ndarray]:
    """Modal coordinates (points, modes) of both panels, and mean torques (steps, ports, 3) between these points."""
    points = OPENING + COMMON * np.arange(round(OPENING_WINDOW / COMMON) + 1)
    rows = np.searchsorted(found.record.times, points - 0.5 * FINEST)
    modes = [found.record.signal(body, "modal_coordinate")[rows] for body in ("inner", "outer")]
    return np.concatenate(modes, axis=1), found.means(points)[..., 3:]


@pytest.mark.thorough
def test_two_panels_that_open_are_of_order_four():
    """Modal coordinates and mean torques of all ports, between 2 and 0.5 ms: down to 1e-6 and 2e-7."""
    steps = (2e-3, 1e-3, 5e-4)
    exact = at_common_points(opening(5e-5, 4))
    four, two = (
        np.array(
            [
                [np.linalg.norm(a - b) / np.linalg.norm(b) for a, b in zip(found, exact, strict=True)]
                for found in (at_common_points(opening(h, order)) for h in steps)
            ]
        )
        for order in (4, 2)
    )
    modes, torques = (slope(steps, column) for column in four.T)
    assert modes >= 3.5
    assert torques >= 3.4  # the last of them are at 1e-7, where rotation begins to tell
    assert np.all(four <= 0.1 * two)


def test_two_panels_that_open_turn():
    """The scene is one with rotations: the outer panel turns at 0.3 rad/s, and has turned by nine degrees."""
    record = opening(2e-3, 4).record
    assert record.signal("middle_left", "angular_rate")[-1] > 0.25
    assert record.signal("middle_left", "angle")[-1] > 0.15


@pytest.mark.parametrize("holds", ["spring", "lock"])
@pytest.mark.parametrize("h", [4e-3, 1e-3, 2.5e-4])
def test_energy_of_a_held_panel_closes(holds, h):
    """Conservation, up to what the rotation leaves at either order (of order 2 in h, 1e-6 of the energy at 4 ms).

    A lock whose own frequency no step resolves rings on at order 4 where order 2 damps it, which costs up to ten
    times the residual in steps that do not resolve the panel either.
    """
    two, four = (residual(run(JOINT, holds, h, order)) for order in (2, 4))
    if holds == "spring":
        assert four < 1.6 * two + 1e-9 * KINETIC
    assert four < 1e-5 * KINETIC * (h / 4e-3)


def residual(found: Followed) -> float:
    """Range of the balance of energy after settling (J)."""
    record = found.record
    after = np.array(record.times) > record.events[0][0] + SETTLED
    return float(np.ptp(record.scene("energy_residual")[after]))


@pytest.mark.thorough
def test_residual_of_two_panels_that_open():
    """The same without a latch, at every step that is compared above."""
    for h in (2e-3, 1e-3, 5e-4):
        two, four = (np.abs(opening(h, order).record.scene("energy_residual")).max() for order in (2, 4))
        assert four < 1.6 * two
