"""Loads that a hinge of order 4 records: what its steps felt where they do not resolve a motion, its law elsewhere."""

import numpy as np
import pytest

from tests.references.relative_motion import inputs, port_motion, with_moments
from tests.unit.components.hinge.hinge_cases import CONSTANT_TORQUE, hinge, observed

H = 0.01
TURNS = (0.0, 1.0e-7, 2.0e-7, 3.0e-7)
WITHIN = 1e-6  # rad, moment of a motion that goes out and comes back within each step
OF_LAW = 6e-3  # share of the law that counts at a roughness of 0.14, which three such steps reach: (ROUGH / 0.14)^2


def run(component, c, moment, turns=TURNS, impulse=()):
    """Turns of the outboard port step by step, latched at the first; states, inputs and mean torques of steps."""
    moments = np.zeros((2, 6))
    moments[1, 4] = moment
    states, given, torques = [], [], []
    for i, turn in enumerate(turns):
        u = inputs(component, port_motion(), port_motion(turn=(0.0, turn, 0.0)), latch_command=1.0)
        u = with_moments(component, u, moments)
        u[component.input_layout["impulse"]] = i in impulse
        states.append(component.step(c, states[-1], u, H) if states else component.initial(c, u))
        given.append(u)
        torques.append(component.outputs(c, states[-1], u)[component.output_layout["outboard.torque"]][1])
    return states, given, torques


def recorded(component, c, states, given, row, name="latch_torque"):
    return observed(component, c, states[row], given[row])[name]


def test_lock_torque_of_a_rough_motion_is_that_of_the_means():
    """Closed form: the line through the last two mean torques, whatever the angle is at the end of a step."""
    component, c = hinge(structure={"latch": "kinematic"}, order=4.0, lock_stiffness=1e8)
    states, given, torques = run(component, c, WITHIN)
    law = -1e8 * TURNS[3]
    found = recorded(component, c, states, given, 3)
    assert found == pytest.approx(1.5 * torques[3] - 0.5 * torques[2], rel=OF_LAW)
    assert abs(found - law) > abs(law)


def test_lock_torque_of_a_smooth_motion_is_that_of_its_law():
    """Closed form: a steady motion has no roughness; the lock damps its rate."""
    component, c = hinge(structure={"latch": "kinematic"}, order=4.0, lock_stiffness=1e8, lock_damping=2e3)
    states, given, _ = run(component, c, 0.0)
    law = -1e8 * TURNS[3] - 2e3 * (TURNS[3] - TURNS[2]) / H
    assert recorded(component, c, states, given, 3) == pytest.approx(law, rel=1e-12)


def test_a_latch_begins_where_it_engages():
    """Rule: at the instant of the command, and after an impulse, loads are those of the law."""
    component, c = hinge(structure={"latch": "spring"}, order=4.0, latch_stiffness=1e8)
    states, given, _ = run(component, c, WITHIN)
    assert recorded(component, c, states, given, 0) == 0.0
    states, given, _ = run(component, c, WITHIN, impulse=(3,))
    assert recorded(component, c, states, given, 3) == pytest.approx(-1e8 * TURNS[3], rel=1e-12)


def test_bushing_forces_of_a_rough_motion_are_those_of_the_means():
    """Closed form: axial motion within steps; stiffness along the hinge line only."""
    component, c = hinge(order=4.0, translational_stiffness=(1e8, 0.0, 0.0))
    moments = np.zeros((2, 6))
    moments[1, 1] = WITHIN
    x, forces = None, []
    for place in TURNS:
        u = with_moments(component, inputs(component, port_motion(), port_motion((0.0, place, 0.0))), moments)
        x = component.initial(c, u) if x is None else component.step(c, x, u, H)
        forces.append(component.outputs(c, x, u)[component.output_layout["outboard.force"]][1])
    found = observed(component, c, x, u)["axial_force"]
    assert found == pytest.approx(1.5 * forces[3] - 0.5 * forces[2], rel=OF_LAW)


def test_loads_one_step_earlier():
    """Closed form: between steps of one size the mean of both means and a third of what their slopes differ by."""
    component, c = hinge(
        structure={"latch": "kinematic", **CONSTANT_TORQUE},
        order=4.0,
        lock_stiffness=1e8,
        translational_stiffness=(1e6, 3e6, 4e6),
        rotational_stiffness=(0.0, 2e6, 3e6),
    )
    x, wrenches = None, []
    for turn, moment in zip(TURNS, (0.0, 1e-7, -2e-7, 3e-7), strict=True):
        offset = (4e2 * turn, turn, 3e2 * turn)
        u = inputs(component, port_motion(), port_motion(offset, (2 * turn, turn, turn)), latch_command=1.0)
        u = with_moments(component, u, moment * np.array([[0.0] * 6, [1.0, 2.0, 3.0, 0.5, 1.0, -2.0]]))
        x = component.initial(c, u) if x is None else component.step(c, x, u, H)
        y = component.outputs(c, x, u)
        names = ("force", "torque", "force_slope", "torque_slope")
        wrenches.append([y[component.output_layout[f"outboard.{name}"]] for name in names])
    (f0, t0, fs0, ts0), (f1, t1, fs1, ts1) = wrenches[-2:]
    force, torque = 0.5 * (f0 + f1) + (fs0 - fs1) / 3.0, 0.5 * (t0 + t1) + (ts0 - ts1) / 3.0
    found = observed(component, c, x, u)
    assert found["latch_torque_lagged"] == pytest.approx(torque[1] - 2.0, rel=1e-5)
    vectors = [[found[f"hinge_{name}_lagged[{i}]"] for i in (1, 2, 3)] for name in ("force", "torque")]
    assert vectors[0] == pytest.approx(force, rel=1e-5)
    assert vectors[1] == pytest.approx(torque, rel=1e-5)
    assert found["axial_force_lagged"] == pytest.approx(force[1], rel=1e-5)
    assert found["radial_force_lagged"] == pytest.approx(np.hypot(force[0], force[2]), rel=1e-5)


def test_friction_sees_the_rate_at_the_communication_point():
    """Closed form: a rate that grows as a parabola, of which each step tells mean and moment."""
    component, c = hinge(order=4.0, friction_preload=1.0, stiction_velocity=10.0)
    times = H * np.arange(4)
    moments, x = np.zeros((2, 6)), None
    for t in times:
        # rate 2 + 300 t^2; moment of t^2 about the middle of a step: its P1 share is h^2 (2 t - h) / 6
        moments[1, 4] = 300.0 * H * H * (2.0 * t - H) / 6.0
        u = inputs(component, port_motion(), port_motion(turn=(0.0, 2.0 * t + 100.0 * t**3, 0.0)))
        u = with_moments(component, u, moments)
        x = component.initial(c, u) if x is None else component.step(c, x, u, H)
    reference, d = hinge("endpoint", friction_preload=1.0, stiction_velocity=10.0)
    rate = 2.0 + 300.0 * times[-1] ** 2
    at_rest = inputs(reference, port_motion(), port_motion(spin=(0.0, rate, 0.0)))
    expected = observed(reference, d, reference.initial(d, at_rest), at_rest)["friction_torque"]
    assert observed(component, c, x, u)["friction_torque"] == pytest.approx(expected, rel=1e-10)
