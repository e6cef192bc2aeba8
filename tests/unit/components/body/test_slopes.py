"""Bodies under wrenches linear in time: what they take up, against steps of many parts, momenta and energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.body import Body
from components.flexible.modal import ModalData
from tests.unit.components.body.body_cases import (
    PORTS,
    extrapolated,
    flexible,
    modal,
    modal_data,
    moments,
    motions,
    moving_state,
    no_wrench,
    observed,
    total_energy,
    wrenches,
)
from tests.unit.components.prepared import prepared

LEVELS = ("rigid", "partial", "full")


def without_turns(data):
    """The same modes, which turn no port."""
    return replace(data, rotation=np.zeros_like(data.rotation))


def rotations(table):
    """Rotations of ports from their motions."""
    return Rotation.from_quat(np.roll(table[:, 3:7], -1, axis=1))


def travel(body, c, x, y):
    """Translation and rotation vector of every port from one state to the next (ports, 6)."""
    before, after = motions(body, c, x), motions(body, c, y)
    turn = (rotations(after) * rotations(before).inv()).as_rotvec()
    return np.hstack((after[:, :3] - before[:, :3], turn))


def work(body, c, x, y, u):
    """Work (J) of the wrenches u over the step from x to y: means times travel, slopes times moments."""
    mean, slope = u.reshape(2, -1, 6)
    return float(np.sum(mean * travel(body, c, x, y)) + np.sum(slope * moments(body, c, y)))


def in_parts(body, c, x, u, h, parts=20):
    """State after the same step in many, and the first moments of the motion (ports, 6) summed up over them.

    Each part has its mean and its slope, so what remains is the error of `parts` steps: of moments below a 400th.
    """
    found, part = np.zeros((len(body.ports), 6)), h / parts
    for k in range(parts):
        middle = (2 * k + 1) / parts - 1.0
        v = u.copy()
        v[:12], v[12:] = u[:12] + middle * u[12:], u[12:] / parts
        y = body.step(c, x, v, part)
        found += middle * travel(body, c, x, y) + moments(body, c, y) / parts
        x = y
    return x, found


def rigid_body(**start):
    """A rigid body whose principal axes are not those of construction, and its state at the start."""
    inertia = np.array([[1.0, 0.1, 0.0], [0.1, 2.0, -0.2], [0.0, -0.2, 2.6]])
    points = {"a": (0.5, 0.2, 0.0), "b": (-0.6, 0.0, 0.3)}
    data = ModalData.rigid(2.0, (0.1, 0.0, 0.0), inertia, points)
    body = Body(modal=data.to_arrays(), ports=[{"name": name, "point": name} for name in points])
    c = prepared(body, **start)
    return body, c, body.initial(c, no_wrench(body))


def moving(level, seed, spin=3.0, damping=(0.02, 0.05, 0.1, 0.3)):
    """A flexible body in motion; any of its levels has momenta that fit."""
    rng = np.random.default_rng(seed)
    body, c = flexible(modal_data(damping=damping), level, gravity=rng.standard_normal(3))
    eta, rate, rates = (
        0.03 * rng.standard_normal(4),
        0.3 * rng.standard_normal(4),
        spin * rng.standard_normal(3),
    )
    if level == "full":
        return body, c, moving_state(body, c, eta, rates, rate)[0], rng
    x = body.initial(c, no_wrench(body))
    for part, values in zip(modal(x), (eta, rate), strict=True):
        part[:] = values
    x[10:13] = body.data.inertia @ rates
    return body, c, body.complete(c, x), rng


def test_no_slopes_leave_everything_as_it_was():
    """Zero slopes are held wrenches: one step of the rigid part in closed form, moments h (v1 - v0) / 6."""
    body, c, x = rigid_body(initial_velocity=(0.3, 0.2, -0.1), gravity=(0.0, 0.0, -9.81))
    u = no_wrench(body)
    u[0:3] = (3.0, -2.0, 1.0)
    arm = np.array([0.4, 0.2, 0.0])
    u[3:6] = -np.cross(arm, u[0:3])
    y = body.step(c, x, u, 0.1)
    change = 0.1 * (u[0:3] / 2.0 + (0.0, 0.0, -9.81))
    assert y[7:10] == pytest.approx(x[7:10] + 2.0 * change, rel=1e-14)
    assert y[13:16] == pytest.approx(np.zeros(3), abs=1e-15)
    assert moments(body, c, y) == pytest.approx(np.tile((*(0.1 * change / 6), 0, 0, 0), (2, 1)), abs=1e-15)


def test_slopes_move_a_rigid_body_in_closed_form():
    """A force that runs from -f to f moves the centre by -h^2 f / 6 m and leaves it its velocity."""
    body, c, x = rigid_body()
    u = no_wrench(body)
    u[12:15] = (3.0, -2.0, 1.0)
    u[15:18] = -np.cross((0.4, 0.2, 0.0), u[12:15])
    y = body.step(c, x, u, 0.1)
    assert y[0:3] - x[0:3] == pytest.approx(-0.01 / 12 * u[12:15], rel=1e-13)
    assert y[7:16] == pytest.approx(np.zeros(9), abs=1e-15)
    assert moments(body, c, y) == pytest.approx(np.zeros((2, 6)), abs=1e-15)


@pytest.mark.parametrize("h", [1e-4, 1e-2, 0.1, 1.0])
def test_work_of_mean_and_slope_is_the_energy_taken_up(h):
    """Conservation law, to round-off at any step size: modes, gravity and damping, of a body too heavy to turn."""
    data = replace(modal_data(turn=0.0), inertia=1e15 * np.eye(3))
    rng = np.random.default_rng(1)
    for _ in range(20):
        damped = data.with_damping(rng.uniform(0.0, 2.0, 4) * rng.integers(0, 2, 4))
        body = Body(modal=damped.to_arrays(), ports=PORTS, inertia_coupling="rigid")
        c = prepared(body, gravity=rng.standard_normal(3))
        x = body.initial(c, no_wrench(body))
        x[7:10], (eta, pi) = rng.standard_normal(3), modal(x)
        eta[:], pi[:] = 0.1 * rng.standard_normal(4), rng.standard_normal(4)
        u = 30.0 * rng.standard_normal(24)
        u.reshape(4, 6)[:, 3:] = 0.0
        y = body.step(c, x, u, h)
        change = total_energy(body, c, y) - total_energy(body, c, x)
        energies = (observed(body, c, z, f"{n}_energy") for z in (x, y) for n in ("kinetic", "potential"))
        size = sum(abs(energy) for energy in energies)
        assert work(body, c, x, y, u) == pytest.approx(change, rel=0, abs=1e-12 * size)


def test_torques_on_turning_ports_do_the_same_work():
    """Conservation law, to round-off: shapes that turn ports about one axis, so that turns add up."""
    data = replace(modal_data(), inertia=1e15 * np.eye(3))
    data = replace(data, rotation=data.rotation * np.array([[[0.0], [0.0], [1.0]]]))
    body = Body(modal=data.to_arrays(), ports=PORTS, inertia_coupling="rigid")
    c, rng = prepared(body), np.random.default_rng(2)
    for h in (1e-3, 1e-2, 0.1):
        x = body.initial(c, no_wrench(body))
        x[17:25] = 0.3 * rng.standard_normal(8)
        u = 10.0 * rng.standard_normal(24)
        y = body.step(c, x, u, h)
        change = total_energy(body, c, y) - total_energy(body, c, x)
        assert work(body, c, x, y, u) == pytest.approx(change, rel=0, abs=1e-12 * total_energy(body, c, y))


@pytest.mark.parametrize("level", LEVELS)
def test_rotation_leaves_the_work_as_good_as_that_of_held_wrenches(level):
    """Energy that work does not account for: third order, with slopes as large as the means no more than without.

    Of eight bodies that tumble at 5 rad/s the worst. It may exceed that of held wrenches by half.
    """

    def missing(h, share):
        worst = 0.0
        for seed in range(8):
            body, c, x, rng = moving(level, seed)
            u = 10.0 * rng.standard_normal(24)
            u[12:] *= share
            y = body.step(c, x, u, h)
            worst = max(
                worst, abs(total_energy(body, c, y) - total_energy(body, c, x) - work(body, c, x, y, u))
            )
        return worst

    for h in (4e-3, 2e-3, 1e-3):
        assert missing(h, 1.0) < 1.5 * missing(h, 0.0)
    assert missing(2e-3, 1.0) / missing(1e-3, 1.0) > 6.0


def test_momenta_change_by_means_and_by_arms_that_move():
    """Conservation law, to round-off: the mean moment of a force that changes on a port that moves on.

    P by h sum f; H by h (mean place x f + torque + change of place / 6 x slope).
    """
    for h in (1e-4, 3e-3, 2e-2):
        body, c = flexible(initial_velocity=(0.3, 0.2, -0.1))
        x, _ = moving_state(body, c)
        u = np.random.default_rng(3).standard_normal(24) * 20.0
        (force, torque), slope = u[:12].reshape(2, 2, 3).transpose(1, 0, 2), u[12:].reshape(2, 6)[:, :3]
        for _ in range(20):
            y = body.step(c, x, u, h)
            before, after = motions(body, c, x)[:, :3], motions(body, c, y)[:, :3]
            moment = np.cross(0.5 * (before + after), force) + torque + np.cross(after - before, slope) / 6.0
            for name, expected in (("linear_momentum", force), ("angular_momentum", moment)):
                change = observed(body, c, y, name) - observed(body, c, x, name)
                scale = max(np.abs(observed(body, c, y, name)).max(), 1.0)
                assert change == pytest.approx(h * expected.sum(0), rel=0, abs=1e-13 * scale)
            x = y


def test_modes_and_translation_are_exact_in_one_step():
    """Steps of twenty parts end where one does, at any size, with the same first moments: to round-off.

    The moment of forces on arms that vibrate is not among these, nor are torques on ports that turn.
    """
    data = without_turns(replace(modal_data(), inertia=1e15 * np.eye(3)))
    body = Body(modal=data.to_arrays(), ports=PORTS, inertia_coupling="rigid")
    c, rng = prepared(body, gravity=(0.0, 1.0, -2.0)), np.random.default_rng(4)
    for h in (1e-3, 0.03, 0.5):
        x = body.initial(c, no_wrench(body))
        x[7:10], x[17:25] = rng.standard_normal(3), 0.1 * rng.standard_normal(8)
        u = 30.0 * rng.standard_normal(24)
        y, (z, expected) = body.step(c, x, u, h), in_parts(body, c, x, u, h)
        for found, parts in ((y[:10], z[:10]), (y[16:25], z[16:25])):
            assert found == pytest.approx(parts, rel=1e-10, abs=1e-11)
        assert moments(body, c, y) == pytest.approx(expected, rel=0, abs=1e-11)


@pytest.mark.parametrize("spin", [0.0, 3.0])
@pytest.mark.parametrize("level", LEVELS)
def test_moments_are_those_of_the_motion(level, spin):
    """The same step in many parts: what a step calls moments differs from theirs in the fourth order.

    Slopes are a hundredth of the means times the step in ms, as smooth wrenches have them.
    """
    errors = []
    for h in (8e-3, 4e-3, 2e-3):
        worst = 0.0
        for seed in range(3):
            body, c, x, rng = moving(level, seed, spin)
            u = 10.0 * rng.standard_normal(24)
            u[12:] *= 10.0 * h
            y, (_, expected) = body.step(c, x, u, h), in_parts(body, c, x, u, h)
            worst = max(worst, float(np.abs(moments(body, c, y) - expected).max()))
        errors.append(worst)
    assert errors[0] / errors[1] > 10.0
    assert errors[1] / errors[2] > 10.0
    assert errors[2] < 1e-6


def test_moments_of_a_tumbling_rigid_body():
    """The same of a rigid one, fourth order."""
    errors = []
    for h in (8e-3, 4e-3, 2e-3):
        body, c, x = rigid_body(initial_angular_velocity=(3.0, -4.0, 2.0), initial_velocity=(0.3, 0.2, -0.1))
        u = wrenches()
        u[12:] = 10.0 * h * np.roll(u[:12], 4)
        y, (_, expected) = body.step(c, x, u, h), in_parts(body, c, x, u, h)
        errors.append(float(np.abs(moments(body, c, y) - expected).max()))
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(16.0, rel=0.1)


def test_slopes_make_a_wrench_that_swings_fourth_order_in_the_vibration():
    """A force that swings over three steps a period: with its slopes the state errs in the fourth order.

    The slope that agrees with the first moment of sin is exact to the third order of a step, so modes are to the
    fourth in a run; held means leave the second.
    """
    data = replace(modal_data(turn=0.0), inertia=1e15 * np.eye(3))
    body = Body(modal=data.to_arrays(), ports=PORTS, inertia_coupling="rigid")
    c, w, end = prepared(body), 2.0 * np.pi * 3.0, 0.4

    def at_the_end(steps, share):
        h, x = end / steps, body.initial(c, no_wrench(body))
        for k in range(steps):
            t = (k + 0.5) * h
            half = 0.5 * w * h
            u = no_wrench(body)
            u[0:3] = np.array((3.0, -2.0, 1.0)) * np.sin(w * t) * np.sin(half) / half
            # 3/h times the integral of P1 sin over the step
            first = 3.0 * np.cos(w * t) * (np.sin(half) - half * np.cos(half)) / half**2
            u[12:15] = share * first * np.array((3.0, -2.0, 1.0))
            x = body.step(c, x, u, h)
        return modal(x)[0]

    exact = at_the_end(800, 1.0)  # errs by 1/256 of the finest compared with it
    for share, factor in ((0.0, 4.0), (1.0, 16.0)):
        errors = [np.abs(at_the_end(n, share) - exact).max() for n in (100, 200)]
        assert errors[0] / errors[1] == pytest.approx(factor, rel=0.1)


def test_extrapolated_energy_of_sloped_steps():
    """Energy balance of a tumbling body under a wrench that swings: what is missing vanishes with the step.

    Ports do not turn with the modes, whose torques' work has a series to second order. A step's turn of 3e-3 rad and
    more is iterated to 1e-13, twice whose share of the energy each step may leave either way.
    """
    rest = []
    for steps in (50, 100, 200):
        body, c = flexible(without_turns(modal_data()))
        x, _ = moving_state(body, c)
        start, put_in, h = total_energy(body, c, x), 0.0, 0.2 / steps
        for k in range(steps):
            phase = 20.0 * (k + 0.5) * h
            u = wrenches(0.2)
            u[12:] = u[:12] * np.cos(phase) * 10.0 * h
            u[:12] *= np.sin(phase)
            y = body.step(c, x, u, h)
            put_in += work(body, c, x, y, u)
            x = y
        rest.append(total_energy(body, c, x) - start - put_in)
    value, bound = extrapolated(rest)
    assert rest[1] / rest[2] == pytest.approx(4.0, rel=0.05)
    assert bound < 1e-6 * start
    assert abs(value) < bound + np.sqrt(steps) * 2e-13 / 2.9e-3 * start
