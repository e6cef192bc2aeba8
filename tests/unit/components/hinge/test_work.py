"""Wrenches of a hinge against conservation laws: they sum to zero, and their work is its change of energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.references.relative_motion import inputs, port_motion, work, wrenches
from tests.unit.components.hinge.hinge_cases import CONSTANT_TORQUE, HARNESS, hinge, observed

SMALL = st.floats(-0.02, 0.02)
THREE = st.tuples(SMALL, SMALL, SMALL)
BUSHING = {
    "translational_stiffness": (3e3, 5e3, 5e3),
    "translational_damping": (2.0, 3.0, 3.0),
    "rotational_stiffness": (7.0, 90.0, 90.0),
    "rotational_damping": (0.1, 0.4, 0.4),
    "motor_stiffness": 0.3,
    "motor_wind_up": 5.0,
}
MECHANISM = {
    **BUSHING,
    "friction_coefficient": 0.1,
    "friction_bending_arm": 0.01,
    "friction_preload": 0.1,
    "latch_stiffness": 40.0,
    "latch_damping": 0.5,
}


def energy_rest(component, c, states, h=0.1):
    """Work + change of stored energy + heat over the second of two steps, and the size of what was exchanged."""
    x = component.step(c, component.initial(c, states[0]), states[1], h)
    y = component.step(c, x, states[2], h)
    before, after = observed(component, c, x, states[1]), observed(component, c, y, states[2])
    done = work(component.outputs(c, y, states[2]), states[1], states[2], 2)
    stored = after["potential_energy"] - before["potential_energy"]
    heat = sum(after[name] - before[name] for name in ("dissipated_energy", "numerical_dissipation"))
    scale = before["potential_energy"] + after["potential_energy"] + abs(heat)
    return done + stored + heat, scale


def test_work_in_space_is_the_change_of_energy_to_second_order():
    """Discrete gradient at large, both ports turning and swinging: the rest of a step goes with its cube.

    The next order is larger by h times the rates, at most 0.8 rad/s, hence the observed order off by up to
    0.8 h / (2 ln 2).
    """
    component, c = hinge("mean", HARNESS, **BUSHING)

    def passing(t):
        return inputs(
            component,
            port_motion((0.02 * t, 0.01 * t, -0.03 * t), (0.2 * t, -0.1 * t, 0.3 * t)),
            port_motion(
                (0.01 - 0.01 * t, 0.03 * t - 0.02, 0.01 + 0.02 * t),
                (0.02 + 0.35 * t, 0.3 + 0.6 * t, 0.2 * t - 0.03),
            ),
        )

    steps = np.array((0.1, 0.05, 0.025))
    rests = np.array(
        [energy_rest(component, c, [passing(1.0 + k * h) for k in (-1.5, -0.5, 0.5)], h)[0] for h in steps]
    )
    orders = np.log2(rests[:-1] / rests[1:])
    assert np.all(np.abs(orders - 3.0) < 0.8 * steps[:-1] / (2.0 * np.log(2.0)))


def test_mean_torque_points_along_the_mean_of_the_axis():
    """Definition: a torque held in hinge axes while the line tilts by 0.4 rad acts along the mean of both lines."""
    component, c = hinge("mean", CONSTANT_TORQUE)
    before = inputs(component, port_motion(), port_motion())
    after = inputs(component, port_motion(turn=(0.4, 0, 0)), port_motion(turn=(0.4, 0, 0)))
    y = component.step(c, component.initial(c, before), after, 0.1)
    expected = np.array((0.0, 1.0 + np.cos(0.4), np.sin(0.4)))
    assert wrenches(component.outputs(c, y, after), 2)[1][1] == pytest.approx(expected, abs=1e-12)


@given(swing=st.floats(-0.3, 0.3), rate=st.tuples(*[st.floats(-1.0, 1.0)] * 3))
def test_opening_torque_does_the_work_of_the_hinge_angle(swing, rate):
    """Virtual work: torque times relative rate is the opening torque times the rate of the angle, at any swing.

    By central differences over h = 1e-3 s on both sides of a rotation about a fixed axis: 2 N.m times h^3 / 3
    times the third derivative of the angle, at most 3 rad/s3 at such rates and swings.
    """
    component, c = hinge("endpoint", CONSTANT_TORQUE)
    tilted = Rotation.from_rotvec((swing, 0, 0.5 * swing)) * Rotation.from_rotvec((0, 0.7, 0))

    def moved(t):
        turn = (Rotation.from_rotvec(t * np.array(rate)) * tilted).as_rotvec()
        return inputs(component, port_motion(), port_motion(turn=turn))

    h = 1e-3
    x = component.initial(c, moved(0.0))
    angles = [observed(component, c, x, moved(t))["angle"] for t in (-h, h)]
    done = work(component.outputs(c, x, moved(0.0)), moved(-h), moved(h), 2)
    assert done == pytest.approx(2.0 * (angles[1] - angles[0]), abs=2.0 * h**3 / 3.0 * 3.0)


def test_endpoint_and_mean_wrench_agree_in_the_limit():
    """Consistency: on a smooth motion the mean wrench of a step tends to the end-point wrench, at first order.

    They differ by half a step times the rate of the force, at most k v. The next order is h times rates of 1.1
    rad/s; halving the step takes half of that off the ratio of 2.
    """
    mean, c = hinge("mean", HARNESS, **BUSHING)
    endpoint, d = hinge("endpoint", HARNESS, **BUSHING)

    def moving(component, t):
        return inputs(
            component,
            port_motion((0, 0, 0), (0, 0.3 * t, 0), (0, 0, 0), (0, 0.3, 0)),
            port_motion(
                (0.02 * t, -0.01 * t, 0.03 * t), (0, 0.4 + 1.1 * t, 0), (0.02, -0.01, 0.03), (0, 1.1, 0)
            ),
        )

    differences = []
    for h in (2e-3, 1e-3):
        x = mean.step(c, mean.initial(c, moving(mean, 0.0)), moving(mean, h), h)
        x = mean.step(c, x, moving(mean, 2 * h), h)
        u = moving(endpoint, 2 * h)
        y = endpoint.initial(d, u)
        differences.append(np.abs(mean.outputs(c, x, u)[:12] - endpoint.outputs(d, y, u)[:12]).max())
    assert differences[0] < 1e-3 * (5e3 * 0.05 + 10.0)
    assert differences[0] / differences[1] == pytest.approx(2.0, abs=1.1 * 2e-3)
