"""BepiColombo MPO array, rigid and semi-flexible, and the impact with a raised holding torque (Bagnoli 2007, 4.1)."""

import numpy as np
import pytest

from orchestrator.analysis.impact import impacts

from .scene_runs import THESIS as RUNS

RIGID = ("all",)
PEAKS = {"rigid": 124.79, "semi-flexible": 114.64}
"""N.m; Fanfold, 2026-11-21, tolerance 1e-4: a change must be meant."""


STRUCK = 5.2
"""s; behind the first strike after the latch-up at 4.58 s with the raised torque."""


def after_latch_up(result, component, variable, delay=0.0):
    (time, _, _) = result.events[0]
    return result.signal(component, variable)[result.time > time + delay]


@pytest.mark.parametrize(
    ("name", "rigid"), [("rigid", RIGID), pytest.param("semi-flexible", (), marks=pytest.mark.thorough)]
)
def test_latch_up_is_that_of_the_thesis(name, rigid):
    """Section 2.3.1: HL2 latches at 4.24 s; the run ends two seconds later."""
    found = RUNS("bepicolombo", rigid=rigid).headline
    assert found.latch_times["HL2"] == pytest.approx(4.24, rel=0.05)
    assert found.end_time == pytest.approx(6.24, abs=1e-9)
    assert found.latch_torque_peaks["HL2"] == pytest.approx(PEAKS[name], rel=2e-3)
    assert found.energy_residual < 1e-4


def test_semi_flexible_array_has_the_modes_of_the_thesis():
    """Section 3.4.1.4: 23 and 11 flexible modes."""
    result = RUNS.result("bepicolombo")
    shapes = [np.shape(result.geometry[name].shapes)[-1] for name in ("inboard_panel", "outboard_panel")]
    assert shapes == [23, 11]


def test_transverse_sadm_torque_needs_flexible_panels():
    """Section 4.1.3.2: the rigid model underestimates it (1.77 there, with inputs that are lost; more than 1.3 here).

    This rigid array is symmetric about its centre line, so its torque normal to the hinge line is round-off.
    """
    rigid, flexible = (
        np.abs(RUNS.result("bepicolombo", rigid=r).signal("spacecraft", "interface_torque")).max(axis=0)
        for r in (RIGID, ())
    )
    for axis in (0, 2):
        assert flexible[axis] > 1.3 * rigid[axis]
        assert flexible[axis] > 0.1
    assert rigid[[0, 2]].max() < 1e-6


def test_in_plane_interface_forces_are_of_one_size():
    """Section 4.1.3.1: about 10 % apart in the thesis."""
    rigid, flexible = (
        np.array(RUNS("bepicolombo", rigid=r).headline.interface_force_peaks) for r in (RIGID, ())
    )
    assert flexible[[0, 2]] / rigid[[0, 2]] == pytest.approx([1.0, 1.0], abs=0.15)


def test_semi_flexible_peak_is_lower_and_oscillates_slower():
    """Section 4.1.2: the rigid peak is slightly higher, the semi-flexible array oscillates slower."""
    rigid, flexible = RUNS.result("bepicolombo", rigid=RIGID), RUNS.result("bepicolombo")
    crossings = [
        int(np.sum(np.diff(np.sign(after_latch_up(r, "hl2_left", "latch_torque"))) != 0))
        for r in (rigid, flexible)
    ]
    peaks = [RUNS("bepicolombo", rigid=r).headline.latch_torque_peaks["HL2"] for r in (RIGID, ())]
    assert 0.8 * peaks[0] < peaks[1] < peaks[0]
    assert crossings[1] < crossings[0]


def test_inboard_panel_is_pressed_on_the_wall_then_pulled_off():
    """Data sheet, sheet (b): no contact at 4 N.m once the outboard panel pulls; contact after latch-up at 20 N.m.

    It is pressed as soon as the joints, of periods of milliseconds, have taken up the motor's start.
    """
    normal = impacts(RUNS.result("bepicolombo", rigid=RIGID))
    raised = impacts(RUNS.result("bepicolombo", "impact", rigid=RIGID, until=STRUCK))
    assert normal[0].start < 1e-2
    assert all(impact.start < 2.0 for impact in normal)
    assert any(impact.start > 4.0 and impact.peak_force > 100.0 for impact in raised)


def test_flexible_panels_strike_the_wall_with_the_momentum_of_rigid_ones():
    """Momentum: the same latch-up throws them, so impulses of the first strike agree; flexible ones strike softer.

    The SADM's friction of 20 N.m lets a light joint stick and slip within less than the smallest step of the control.
    """
    rigid, flexible = (
        next(i for i in impacts(RUNS.result("bepicolombo", "impact", rigid=r, until=STRUCK)) if i.start > 4.0)
        for r in (RIGID, ())
    )
    assert flexible.impulse == pytest.approx(rigid.impulse, rel=0.1)
    assert flexible.peak_force < rigid.peak_force
