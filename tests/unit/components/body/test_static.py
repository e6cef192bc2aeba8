"""Quasi-static steps of a body: their fixed points in closed form are equilibria of the dynamic step."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.unit.components.body.body_cases import (
    ENDS,
    PORTS,
    coordinates,
    flexible,
    modal,
    modal_data,
    stepped,
    wrenches,
)
from tests.unit.components.prepared import prepared

PLAIN_PORTS = tuple({"name": p["name"], "point": p["point"]} for p in PORTS)


def balanced_pull(data, pull=40.0):
    """Opposite forces of two ports along their line, so the body stays where it is."""
    arms = data.point_positions[list(ENDS)]
    line = (arms[1] - arms[0]) / np.linalg.norm(arms[1] - arms[0])
    u = np.zeros(24)
    u[0:3], u[6:9] = -pull * line, pull * line
    return u


def test_static_steps_find_the_deflection_and_a_dynamic_step_stays_there():
    """Closed form eta = Phi^T f / w^2 for forces that hardly turn the body; equilibrium of the dynamic step.

    400 steps of the gradient flow leave round-off of coordinates of order one.
    """
    data = modal_data()
    body, static = flexible(data, ports=PLAIN_PORTS, quasi_static=1.0)
    u = balanced_pull(data)
    x = stepped(body, static, body.initial(static, u), u, 0.1, 400)
    assert np.abs(body.step(static, x, u, 0.1) - x).max() < 1e-14
    turn = Rotation.from_quat(np.roll(x[3:7], -1)).as_matrix()
    force = u[:12].reshape(2, 6)[:, :3] @ turn
    expected = sum(data.translation[i].T @ f for i, f in zip(ENDS, force, strict=True)) / data.frequency**2
    assert np.abs(expected).max() > 0.01
    assert modal(x)[0] == pytest.approx(expected, abs=1e-14)
    dynamic = prepared(body)
    y = stepped(body, dynamic, x, u, 1e-2, 10)
    assert coordinates(y) == pytest.approx(coordinates(x), abs=1e-14)


def test_static_steps_leave_the_centre_of_a_free_scene_alone():
    """Conservation law: forces that sum to zero do not move the centre of mass; gravity drops it by h^2 g."""
    body, c = flexible(quasi_static=1.0, gravity=(0.0, 0.0, -9.81))
    u = wrenches()
    u[6:9] = -u[0:3]
    x = body.initial(c, u)
    assert body.step(c, x, u, 0.01)[:3] - x[:3] == pytest.approx((0, 0, -9.81e-4), abs=1e-15)
