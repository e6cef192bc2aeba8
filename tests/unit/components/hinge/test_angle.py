"""The hinge angle: its definition over many turns, and the torques about the line that are laws of it."""

import numpy as np
import pytest

from tests.references.relative_motion import inputs, port_motion, wrenches
from tests.unit.components.hinge.hinge_cases import HARNESS, hinge, observed, outboard

PI = np.pi
ROUND_OFF = 1e-12  # of angles up to 8 rad and energies up to 100 J


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
@pytest.mark.parametrize("direction", [1, -1])
def test_angle_is_followed_beyond_full_turns(mode, direction):
    """Definition: unwrapped past 180 and 360 deg, with the motor spring to match."""
    component, c = hinge(mode, motor_stiffness=0.3, motor_wind_up=20.0, aligned_angle=0.5, stowed_angle=0.5)
    u = outboard(component)
    x = component.initial(c, u)
    for turn in np.arange(0.2, 8.0, 0.2) * direction:
        u = outboard(component, turn)
        x = component.step(c, x, u, 0.1)
        z = observed(component, c, x, u)
        assert z["angle"] == pytest.approx(0.5 + turn, abs=ROUND_OFF)
        assert z["motor_torque"] == pytest.approx(0.3 * (20.0 - 0.5 - turn), abs=ROUND_OFF)
        assert z["motor_energy"] == pytest.approx(0.15 * (19.5**2 - (19.5 - turn) ** 2), abs=ROUND_OFF)
    assert component.outputs(c, x, u)[12] == pytest.approx(-0.5 - turn, abs=ROUND_OFF)


def test_start_angle_is_the_one_nearest_the_stowed_angle():
    """Definition: a scene stowed at one and a half turns starts there."""
    component, c = hinge(stowed_angle=3 * PI)
    u = outboard(component, PI - 0.01)
    angle = observed(component, c, component.initial(c, u), u)["angle"]
    assert angle == pytest.approx(3 * PI - 0.01, abs=ROUND_OFF)


@pytest.mark.parametrize("axis", [(0, 1, 0), (0, -1, 0), (0, 0, 2), (1, 1, -1)])
def test_angle_grows_with_the_right_handed_turn_about_the_axis(axis):
    """Definition of the hinge angle and of the sense of an opening torque, for any direction of the line."""
    unit = np.array(axis) / np.linalg.norm(axis)
    component, c = hinge("endpoint", {"axis": axis}, motor_stiffness=1.0, motor_wind_up=2.0)
    u = inputs(component, port_motion(), port_motion(turn=0.7 * unit, spin=0.2 * unit))
    x = component.initial(c, u)
    z = observed(component, c, x, u)
    assert (z["angle"], z["angular_rate"]) == pytest.approx((0.7, 0.2), abs=ROUND_OFF)
    assert wrenches(component.outputs(c, x, u), 2)[1][1] == pytest.approx(1.3 * unit, abs=ROUND_OFF)


def test_harness_table_acts_on_the_hinge_angle():
    """Definition: the table's points, positive opening, on both modes."""
    for angle, torque in zip(HARNESS["harness_angle"], HARNESS["harness_torque"], strict=True):
        component, c = hinge("endpoint", HARNESS)
        u = outboard(component, angle)
        x = component.initial(c, u)
        assert observed(component, c, x, u)["harness_torque"] == pytest.approx(torque, abs=ROUND_OFF)
        assert component.outputs(c, x, u)[10] == pytest.approx(torque, abs=ROUND_OFF)
        mean, d = hinge("mean", HARNESS)
        y = mean.step(d, mean.initial(d, u), u, 0.1)
        assert mean.outputs(d, y, u)[10] == pytest.approx(torque, abs=ROUND_OFF)


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_hold_keeps_the_angle(mode):
    """Closed form: hold_stiffness against the angle where the command came; none without it."""
    component, c = hinge(mode, hold_stiffness=1e4)
    x = component.initial(c, outboard(component, 0.3))
    x = component.step(c, x, outboard(component, 0.3, hold=1.0), 0.1)
    u = outboard(component, 0.301, hold=1.0)
    y = component.step(c, x, u, 0.1)
    assert wrenches(component.outputs(c, y, u), 2)[1][1, 1] == pytest.approx(-10.0, abs=1e4 * ROUND_OFF)
    u = outboard(component, 0.301)
    assert component.outputs(c, component.step(c, y, u, 0.1), u)[10] == pytest.approx(0.0, abs=ROUND_OFF)
