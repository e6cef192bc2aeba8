"""Relative motion of two ports: rates against differences of poses, and loads against the work they do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components import ComponentError
from components.contract.frames import multiply, rotate
from components.contract.ports import PortMotion
from components.numerics.relative_motion import axis_frame, conjugate_torque, relative_pose, relative_rates
from tests.references.relative_motion import port_motion

AXIS_FRAME = axis_frame((0.0, 1.0, 0.0), "the hinge line")
NUMBER = st.floats(-1.0, 1.0)
THREE = st.tuples(NUMBER, NUMBER, NUMBER)


def coordinates(u):
    """Offset, twist and swing of a pose as one array."""
    pose = relative_pose(u, AXIS_FRAME)
    return np.array((*pose.offset, pose.twist, *pose.swing))


def moving(turn_a, turn_b, place, velocities, time):
    """Inputs of two ports that turn at constant spin and move at constant velocity, `time` after the start."""
    first, second = [np.array(v) for v in velocities[:2]], [np.array(v) for v in velocities[2:]]
    ports = []
    for place_of, turn, (velocity, spin) in (((0.0, 0.0, 0.0), turn_a, first), (place, turn_b, second)):
        start = port_motion(place_of, turn, velocity, spin)
        turned = port_motion(turn=time * spin)
        start[:3] += time * velocity
        start[3:7] = multiply(tuple(turned[3:7]), tuple(start[3:7]))
        ports.append(start)
    return [PortMotion.read(port.tolist()) for port in ports]


@given(THREE, THREE, THREE, st.tuples(THREE, THREE, THREE, THREE))
def test_rates_are_those_of_the_pose(turn_a, turn_b, place, velocities):
    """Central differences of a pose along rigid motions; error of the differences below 1e-7."""
    step = 1e-4
    pose = relative_pose(moving(turn_a, turn_b, place, velocities, 0.0), AXIS_FRAME)
    if np.hypot(*pose.swing) > 2.0:
        return
    rates = relative_rates(moving(turn_a, turn_b, place, velocities, 0.0), pose)
    ahead, behind = (coordinates(moving(turn_a, turn_b, place, velocities, t)) for t in (step, -step))
    found = (*rates.offset, rates.twist, *rates.swing)
    assert found == pytest.approx((ahead - behind) / (2.0 * step), abs=2e-6)


@given(THREE, THREE, THREE, THREE, THREE)
def test_torque_has_the_power_of_its_loads(turn_a, turn_b, spin_a, spin_b, loads):
    """Virtual work: loads on twist and swing against the torque on the difference of the spins."""
    u = [
        PortMotion.read(port_motion(turn=t, spin=s).tolist()) for t, s in ((turn_a, spin_a), (turn_b, spin_b))
    ]
    pose = relative_pose(u, AXIS_FRAME)
    if np.hypot(*pose.swing) > 2.5:
        return
    rates = relative_rates(u, pose)
    torque = rotate(pose.frame, conjugate_torque(loads[0], loads[1:], pose.swing))
    power = np.dot(torque, np.subtract(spin_b, spin_a))
    assert power == pytest.approx(np.dot(loads, (rates.twist, *rates.swing)), abs=1e-11)


@pytest.mark.parametrize(
    ("axis", "sentence"),
    [
        ((0.0, 1.0), "axis .*2 numbers"),
        ((0.0, 0.0, 1.0, 0.0), "axis has 4 numbers"),
        ((0.0, 0.0, 0.0), "axis .*length"),
        ((0.0, np.inf, 0.0), "finite"),
        ((0.0, np.nan, 0.0), "finite"),
    ],
)
def test_what_is_no_direction_is_refused_by_a_sentence(axis, sentence):
    with pytest.raises(ComponentError, match=sentence):
        axis_frame(axis, "a hinge line")
