"""Flexible bodies against an independent formulation from the nodes, and what every inertia invariant adds."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.body import Body
from tests.references import nodal_flexible_body as nodal
from tests.unit.components.body.body_cases import (
    ENDS,
    HERTZ,
    PORTS,
    TORQUES,
    VELOCITY,
    coordinates,
    extrapolated,
    flexible,
    loads,
    modal_data,
    motions,
    moving_state,
    no_wrench,
    nodal_body,
    stepped,
    wrenches,
)

DURATION = 0.1
AGREED = 1e-8  # with the independent formulation
REFERENCE = 1e-10  # error of its coordinates
ROUND_OFF = 1e-13  # of generalised forces up to 100


def pose_of(motion):
    return np.concatenate((motion.position, motion.orientation, motion.eta))


def after(data, h, torque=0.0, start_of=None):
    """The component's state after the duration; `start_of`: data that its momenta at the start belong to."""
    body, c = flexible(data, initial_velocity=VELOCITY)
    x, _ = moving_state(Body((start_of or data).to_arrays(), PORTS), c)
    return stepped(body, c, x, wrenches(torque), h, round(DURATION / h))


@pytest.fixture(scope="module")
def forced():
    """Where the independent formulation is after `DURATION` under two forces, one of them with an offset."""
    data = modal_data()
    body, c = flexible(data)
    start = moving_state(body, c)[1]
    return data, nodal.integrate(nodal_body(data), loads(0.0), start, DURATION)


@pytest.fixture(scope="module")
def refined(forced):
    """The component after the same time at three step sizes."""
    return [after(forced[0], h) for h in (1e-3, 5e-4, 2.5e-4)]


def test_flexible_body_follows_the_nodal_equations(forced, refined):
    """Independent formulation: M(q) from the nodes. Second order; extrapolated, what is left is of the fourth.

    The next order changes that of halvings by (w h)^2 / 4 of the fastest mode at most, 0.01.
    """
    reference = pose_of(forced[1])
    found = [coordinates(x) for x in refined]
    errors = np.array([np.abs(value - reference).max() for value in found])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.01)
    value, bound = extrapolated(found)
    assert bound + REFERENCE < AGREED
    assert np.abs(value - reference).max() < bound + REFERENCE


def test_flexible_body_velocities_follow_the_nodal_equations(forced, refined):
    """Independent formulation: spin, modal rates and the velocity of the centre of mass at the end.

    Rates of the reference err by the frequency of the fastest mode times its coordinates' error.
    """
    data, end = forced
    body, c = flexible(data)

    def velocities(x):
        ports = motions(body, c, x)
        return np.concatenate((ports[:, 7:].ravel(), x[13:16]))

    y = moving_state(body, c, end.eta, end.spin, end.rate)[0]
    y[3:7] = end.orientation
    turn = Rotation.from_quat(np.roll(end.orientation, -1))
    y[10:13] = turn.apply(y[10:13])
    y[7:10] = data.mass * end.velocity
    value, bound = extrapolated([velocities(x) for x in refined])
    assert bound < AGREED
    assert np.abs(value - velocities(y)).max() < bound + 2 * np.pi * HERTZ[-1] * REFERENCE


@pytest.mark.parametrize("name", ["invariant5", "invariant8", "invariant9"])
def test_no_invariant_can_be_dropped(forced, name):
    """Independent formulation: without I5, I8 or I9 the first test would fail by a factor of 1e5 or more."""
    data, end = forced
    less = replace(data, **{name: np.zeros_like(getattr(data, name))})
    found = after(less, 1e-3, start_of=data)
    assert np.abs(coordinates(found) - pose_of(end)).max() > 1e5 * AGREED


@pytest.mark.parametrize(
    ("coupling", "dropped"),
    [
        ("partial", ("invariant5", "invariant9")),
        ("constant", ("invariant5", "invariant8", "invariant9")),
        ("rigid", ("invariant5", "invariant8", "invariant9")),
    ],
)
def test_inertia_coupling_levels_drop_exactly_their_invariants(coupling, dropped):
    """Table 1-1 of Bagnoli: a level is the full body without those invariants, the same to round-off."""
    data = modal_data()
    less = replace(data, **{name: np.zeros_like(getattr(data, name)) for name in dropped})
    level, full = flexible(data, coupling), flexible(less)
    x, _ = moving_state(flexible(data)[0], level[1])
    a, b = (stepped(body, c, x, wrenches(), 1e-3, 50) for body, c in (level, full))
    assert a == pytest.approx(b, rel=1e-12, abs=1e-12)
    assert np.abs(a - stepped(*flexible(data), x, wrenches(), 1e-3, 50)).max() > 1e-5


def test_torques_on_turning_nodes_do_the_nodal_work():
    """Independent formulation with torques, whose generalised force carries the left Jacobian in closed form.

    The component keeps its series to second order, so each torque errs by |tau| |Psi| theta^3 / 24: at once in
    the generalised force, and after a time t in a mode by at most t^2 / 2 or t / w as much.
    """
    data = modal_data(0.0)
    data = replace(data, rotation=0.1 * data.rotation)
    body, c = flexible(data)
    x, start = moving_state(body, c)

    def left_out(*etas):
        """Largest generalised force (modes,) that the series leaves out at these modal coordinates."""
        force = np.zeros(data.frequency.size)
        for torque, node in zip(TORQUES, ENDS, strict=True):
            theta = max(np.linalg.norm(data.rotation[node] @ eta) for eta in etas)
            force += np.linalg.norm(torque) * np.linalg.norm(data.rotation[node], axis=0) * theta**3 / 24
        return force

    added = body.rates(c, x, wrenches()) - body.rates(c, x, no_wrench(body))
    force = sum(nodal.generalised_load(nodal_body(data), start, load) for load in loads())
    assert np.all(np.abs(added[-4:] - force[-4:]) < left_out(start.eta) + ROUND_OFF)
    end = nodal.integrate(nodal_body(data), loads(), start, DURATION)
    value, bound = extrapolated([coordinates(after(data, h, torque=1.0)) for h in (2e-3, 1e-3, 5e-4)])
    response = np.minimum(0.5 * DURATION**2, DURATION / data.frequency)
    bound += (left_out(start.eta, end.eta) * response).max() + REFERENCE
    assert bound < AGREED
    assert np.abs(value - pose_of(end)).max() < bound
