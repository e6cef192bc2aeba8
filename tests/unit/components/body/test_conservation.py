"""Bodies against conservation laws: momenta and energy summed over the nodes, and the reversal of time."""

import numpy as np
import pytest

from tests.unit.components.body.body_cases import (
    EVERY_NODE,
    HERTZ,
    MASSES,
    SPIN,
    VELOCITY,
    flexible,
    modal_data,
    motions,
    moving_state,
    no_wrench,
    observed,
    stepped,
    total_energy,
    wrenches,
)


def test_momenta_and_kinetic_energy_are_sums_over_the_nodes():
    """Independent formulation: sums of m v, x m v and m v^2 / 2 over ports at all nodes, to round-off."""
    body, c = flexible(ports=EVERY_NODE)
    x, _ = moving_state(body, c, rate=np.array([0.4, -0.7, 0.3, 1.1]))
    x = stepped(body, c, x, no_wrench(body), 2e-3, 20)
    nodes = motions(body, c, x)
    place, velocity = nodes[:, :3], nodes[:, 7:10]
    momentum = MASSES[:, None] * velocity
    assert observed(body, c, x, "linear_momentum") == pytest.approx(momentum.sum(0), rel=1e-13, abs=1e-13)
    assert observed(body, c, x, "angular_momentum") == pytest.approx(
        np.cross(place, momentum).sum(0), rel=1e-12, abs=1e-12
    )
    assert observed(body, c, x, "kinetic_energy") == pytest.approx(
        0.5 * np.sum(momentum * velocity), rel=1e-13
    )


def test_momenta_change_by_the_impulse_of_the_wrenches():
    """Conservation law: P by h sum f, H by h (mean place x f + torque), to round-off at every step size."""
    body, c = flexible(initial_velocity=VELOCITY)
    u = wrenches()
    force, torque = u[:12].reshape(2, 2, 3)[:, 0], u[:12].reshape(2, 2, 3)[:, 1]
    for h in (1e-4, 3e-3, 2e-2):
        x, _ = moving_state(body, c)
        for _ in range(20):
            y = body.step(c, x, u, h)
            places = 0.5 * (motions(body, c, x) + motions(body, c, y))[:, :3]
            for name, expected in (
                ("linear_momentum", force.sum(0)),
                ("angular_momentum", (np.cross(places, force) + torque).sum(0)),
            ):
                change = observed(body, c, y, name) - observed(body, c, x, name)
                scale = np.abs(observed(body, c, y, name)).max()
                assert change == pytest.approx(h * expected, rel=0, abs=1e-13 * max(scale, 1.0))
            x = y


def test_free_flight_keeps_both_momenta():
    """Conservation law: 200 steps without wrenches, momenta unchanged to round-off (1e-13 of their size).

    They are recomputed from the velocities of all nodes, not read from the state.
    """
    body, c = flexible(ports=EVERY_NODE)
    x, _ = moving_state(body, c)

    def momenta(x):
        nodes = motions(body, c, x)
        momentum = MASSES[:, None] * nodes[:, 7:10]
        return np.concatenate((momentum.sum(0), np.cross(nodes[:, :3] - x[:3], momentum).sum(0)))

    before = momenta(x)
    now = momenta(stepped(body, c, x, no_wrench(body), 2e-3, 200))
    assert np.abs(now - before).max() < 1e-13 * np.abs(before).max()


def excursions(body, c, x, h, steps):
    """Energy after every step over that at the start, less one."""
    start, rows = total_energy(body, c, x), []
    for _ in range(steps):
        x = body.step(c, x, no_wrench(body), h)
        rows.append(total_energy(body, c, x))
    return np.abs(np.array(rows) / start - 1.0)


@pytest.mark.parametrize("level", ["rigid", "partial"])
def test_energy_of_torque_free_flexible_body_is_exact(level):
    """Conservation law, to the tolerance of the iteration: twice 1e-13 rad of 0.023 a step, over 300 steps."""
    body, c = flexible(modal_data(damping=0.0), level)
    x = body.complete(c, moving_state(*flexible(modal_data(damping=0.0)))[0])
    assert excursions(body, c, x, 4e-3, 300).max() < 300 * 2e-13 / (np.linalg.norm(SPIN) * 4e-3)


def test_energy_of_torque_free_flexible_body_with_gyroscopic_modes_is_bounded_and_second_order():
    """Conservation law: no drift over 600 steps, and the excursion falls with the square of the step.

    Left is the work of the angular velocity's change within a step through B, 1/4 dw B dB dw, nothing of the
    rotation's (w h)^2 / 12 at 5.8 rad/s. A drift would make the last quarter four times the first, a random walk
    twice. The next order is (w h)^2 / 4 of the fastest mode, 0.036 at 2 ms.
    """
    body, c = flexible(modal_data(damping=0.0))
    x, _ = moving_state(body, c)
    quarters = excursions(body, c, x, 4e-3, 600).reshape(4, -1).max(1)
    assert quarters.max() < 0.01 * (np.linalg.norm(SPIN) * 4e-3) ** 2 / 12
    assert quarters[3] < 2.0 * quarters[0]
    coarse, fine = (excursions(body, c, x, h, round(0.3 / h)).max() for h in (2e-3, 1e-3))
    assert coarse / fine == pytest.approx(4.0, rel=(2 * np.pi * HERTZ[-1] * 2e-3) ** 2 / 4)


@pytest.mark.parametrize("h", [1e-3, 1e-2])
def test_undamped_motion_retraces_itself_with_momenta_reversed(h):
    """Reversibility of mechanics: the step is time-symmetric at any size, which the even error expansion needs.

    Backwards, slopes are the other way round and moments the same. The turn of a step is iterated to 1e-13 rad,
    which twenty steps leave below 1e-10 of the largest state.
    """
    body, c = flexible(modal_data(damping=0.0))
    start, _ = moving_state(body, c)
    sign = np.ones(start.size)
    sign[7:16], sign[21:25] = -1.0, -1.0
    u, reverse = wrenches(), np.repeat((1.0, -1.0), 12)
    u[12:] = np.roll(u[:12], 5)
    first = body.step(c, start, u, h)
    there = stepped(body, c, first, u, h, 9)
    back = sign * stepped(body, c, sign * there, reverse * u, h, 10)
    assert np.abs(there - start).max() > 0.1
    start[25:] = first[25:]
    assert np.abs(back - start).max() < 1e-10 * np.abs(start).max()


def test_damping_heat_is_the_energy_lost_of_the_tumbling_body():
    """Closed form of the dissipation against the energy balance, at any step.

    What remains is that of an undamped body, see above, 0.01 (w h)^2 / 12 of its energy.
    """
    body, c = flexible()
    start, _ = moving_state(body, c)
    total = total_energy(body, c, start)
    for h in (4e-3, 2e-3, 1e-3):
        x = stepped(body, c, start, no_wrench(body), h, round(0.3 / h))
        assert observed(body, c, x, "dissipated_energy") > 0.05 * total
        rest = total_energy(body, c, x) - total
        assert abs(rest) < 0.01 * (np.linalg.norm(SPIN) * h) ** 2 / 12 * total


def test_gravity_gives_a_parabola_and_keeps_the_energy():
    """Closed form of the throw at any step size; potential and kinetic energy exchange."""
    gravity = np.array([0.3, -1.0, -9.81])
    body, c = flexible(gravity=gravity, initial_velocity=VELOCITY)
    start = body.initial(c, no_wrench(body))
    x = stepped(body, c, start, no_wrench(body), 0.05, 8)
    assert x[:3] - start[:3] == pytest.approx(0.4 * VELOCITY + 0.08 * gravity, rel=1e-13)
    assert total_energy(body, c, x) == pytest.approx(total_energy(body, c, start), rel=1e-13)
