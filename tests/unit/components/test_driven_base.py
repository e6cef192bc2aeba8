"""Driven base: it follows what its inputs prescribe, and its work closes the balance of energy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from components.contract.instance import Instance
from components.driven_base import DrivenBase

JERK, SPIN = (3.0, -2.0, 1.0), (4.0, 1.0, -3.0)


def followed(h, until, jerk=JERK, spin=SPIN):
    """After steps of constant rates of both accelerations, from rest."""
    base = Instance(DrivenBase.example())
    base.initialize()
    layout = base.component.input_layout
    base.inputs[layout["acceleration_rate"]] = jerk
    base.inputs[layout["angular_acceleration_rate"]] = spin
    for _ in range(round(until / h)):
        base.step(h)
    return base


def state(base, name):
    return base.state[base.component.state_layout[name]]


def test_the_frame_moves_as_the_closed_form():
    """Constant rates j of the acceleration: j t^3 / 6, j t^2 / 2, j t, whatever the steps."""
    base = followed(0.1, 1.0)
    for name, share in (("position", 1 / 6), ("velocity", 0.5), ("acceleration", 1.0)):
        assert state(base, name) == pytest.approx(share * np.array(JERK), rel=1e-12)
    assert state(base, "angular_velocity") == pytest.approx(0.5 * np.array(SPIN), rel=1e-12)


def test_the_frame_turns_as_another_solution():
    """About an axis that turns itself: spins about two axes one after the other, against DOP853 by quaternions."""

    def spin(t):
        return np.array(SPIN) if t < 0.5 else np.array((-6.0, 5.0, 2.0))

    def turning(t, y):
        x, y_, z, w = y[:4]
        p, q, r = y[4:7]
        # half of the angular velocity, as a quaternion, times the orientation
        half = (
            w * p + q * z - r * y_,
            w * q + r * x - p * z,
            w * r + p * y_ - q * x,
            -p * x - q * y_ - r * z,
        )
        return np.concatenate((0.5 * np.array(half), y[7:], spin(t)))

    start = np.array((0.0, 0.0, 0.0, 1.0, *np.zeros(6)))
    half = solve_ivp(turning, (0.0, 0.5 - 1e-12), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    last = solve_ivp(turning, (0.5, 1.0), half, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    errors = []
    for h in (0.02, 0.01):
        base = followed(h, 0.5)
        base.inputs[base.component.input_layout["angular_acceleration_rate"]] = spin(0.7)
        for _ in range(round(0.5 / h)):
            base.step(h)
        w, x, y, z = state(base, "orientation")
        apart = Rotation.from_quat((x, y, z, w)) * Rotation.from_quat(last[:4]).inv()
        errors.append(apart.magnitude())
    assert errors[0] < 1e-6
    assert errors[1] < errors[0] / 12.0  # of fourth order


def test_ports_move_with_the_frame():
    """Velocities of ports are rates of their positions, by central differences of two steps."""
    base, h = followed(0.01, 0.5), 1e-4
    before = base.outputs()[:26].reshape(2, 13)
    base.step(h)
    now = base.outputs()[:26].reshape(2, 13)
    base.step(h)
    after = base.outputs()[:26].reshape(2, 13)
    assert now[:, 7:10] == pytest.approx((after[:, :3] - before[:, :3]) / (2 * h), rel=1e-6)


def test_what_is_held_stands_still():
    base = followed(0.01, 0.1)
    base.inputs[base.component.input_layout["hold"]] = 1.0
    before = state(base, "position").copy()
    base.step(0.1)
    assert np.array_equal(state(base, "position"), before)
