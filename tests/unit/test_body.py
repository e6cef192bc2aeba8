"""Bodies against an independent formulation, closed forms and conservation laws."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components._component import ComponentError
from components._oscillators import propagator
from components.body import Body
from components.modal import ModalData
from tests.references import nodal_flexible_body as nodal
from tests.references.free_rotor import free_rotor

GRID = np.array([(x, y, z + 0.1 * x * y) for x in (0.0, 0.5, 1.0) for y in (-0.4, 0.4) for z in (0.0, 0.15)])
MASSES = np.linspace(0.8, 1.2, len(GRID))
HERTZ = np.array([2.0, 5.0, 11.0, 30.0])
FORCES = ((30.0, -20.0, 10.0), (-25.0, 15.0, 12.0))
TORQUES = ((1.0, 2.0, -1.5), (-2.0, 1.0, 1.0))
OFFSETS = ((0.0, 0.0, 0.0), (0.1, 0.05, 0.02))
ENDS = (0, len(GRID) - 1)
PORTS = tuple(
    {"name": name, "point": str(node), "offset": offset}
    for name, node, offset in zip(("first", "second"), ENDS, OFFSETS, strict=True)
)
ETA = np.array([0.12, -0.08, 0.05, 0.01])
SPIN = np.array([3.0, -4.0, 3.0])
VELOCITY = np.array([0.3, 0.2, -0.1])
DURATION = 0.4


def modal_data(turn=0.05, damping=(0.02, 0.05, 0.1, 0.3)):
    """Made-up shapes of a grid of point masses, no two invariants alike; every mass is a point."""
    shapes = [
        [
            np.sin((k + 1) * p[0] + 2 * axis + p[2]) + (k - 1) * p[1] * p[0] * np.cos(axis + k)
            for axis in range(3)
        ]
        for k in range(4)
        for p in GRID
    ]
    rotations = turn * np.random.default_rng(1).standard_normal((len(GRID), 3, 4))
    points = {str(i): i for i in range(len(GRID))}
    stacked = np.array(shapes).reshape(4, -1).T
    data = ModalData.from_point_masses(MASSES, GRID, stacked, 2 * np.pi * HERTZ, points, rotations)
    return data.with_damping(damping)


def nodal_body(data):
    arms = data.point_positions - data.center_of_mass
    return nodal.NodalBody(MASSES, arms, data.translation, data.rotation, data.frequency, data.damping_ratio)


def prepared(body, **start):
    p = body.parameter_layout.start_values()
    for name, value in start.items():
        p[body.parameter_layout[name]] = value
    return body.prepare(p)


def flexible(data=None, coupling="full", ports=PORTS, **start):
    data = modal_data() if data is None else data
    body = Body(modal=data.to_arrays(), ports=ports, inertia_coupling=coupling)
    return body, prepared(body, **start)


def rigid(mass=2.0, inertia=(1.0, 2.0, 3.0), points=None, **start):
    points = points or {"center": (0.0, 0.0, 0.0)}
    data = ModalData.rigid(mass, (0.0, 0.0, 0.0), np.diag(inertia), points)
    body = Body(modal=data.to_arrays(), ports=[{"name": n, "point": n} for n in points])
    return body, prepared(body, **start)


def loads(torque=1.0):
    return [
        nodal.PortLoad(node, offset, force, tuple(torque * np.array(moment)))
        for node, offset, force, moment in zip(ENDS, OFFSETS, FORCES, TORQUES, strict=True)
    ]


def wrenches(torque=1.0):
    return np.concatenate([(*load.force, *load.torque) for load in loads(torque)])


def no_wrench(body):
    return body.input_layout.start_values()


def moving_state(body, c, eta=ETA, spin=SPIN, rate=None):
    """A state of known eta, eta' and omega at the origin; its momenta from the nodes, not from invariants.

    Momenta are derivatives of the kinetic energy v^T M(q) v / 2, hence rows of M(q) v.
    """
    m = body.modes
    rate = np.zeros(m) if rate is None else rate
    motion = nodal.Motion(np.zeros(3), np.array([1.0, 0, 0, 0]), eta, VELOCITY, spin, rate)
    momenta = nodal.mass_matrix(nodal_body(body.data), motion) @ np.concatenate((VELOCITY, spin, rate))
    x = body.initial(c, no_wrench(body))
    x[0:3] = 0.0
    x[7:10], x[10:13] = momenta[:3], momenta[3:6]
    x[13:16] = spin
    x[-2 * m : -m], x[-m:] = eta, momenta[6:]
    return x, motion


def stepped(body, c, x, u, h, steps):
    for _ in range(steps):
        x = body.step(c, x, u, h)
    return x


def coordinates(x, modes=4):
    return np.concatenate((x[:7], x[-2 * modes : -modes]))


def pose_of(motion):
    return np.concatenate((motion.position, motion.orientation, motion.eta))


def motions(body, c, x):
    return body.outputs(c, x, no_wrench(body)).reshape(-1, 13)


def observed(body, c, x, name):
    z = body.observe(c, x, no_wrench(body))[body.observation_layout[name]]
    return z if len(z) > 1 else float(z[0])


def after(data, h, coupling="full", torque=0.0, duration=DURATION):
    body, c = flexible(data, coupling, initial_velocity=VELOCITY)
    x, _ = moving_state(Body(data.to_arrays(), PORTS), c)
    return stepped(body, c, x, wrenches(torque), h, round(duration / h))


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

    The error after extrapolation is bounded by the difference of the two extrapolated values, the finer one
    being 16 times better; the reference itself is good to 1e-10.
    """
    reference = pose_of(forced[1])
    errors = [np.abs(coordinates(x) - reference).max() for x in refined]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.02)
    coarse, fine = (
        (4 * b - a) / 3
        for a, b in zip(*[map(coordinates, s) for s in (refined[:-1], refined[1:])], strict=True)
    )
    bound = np.abs(fine - coarse).max() / 8 + 1e-10
    assert bound < 1e-8
    assert np.abs(fine - reference).max() < bound


def test_flexible_body_velocities_follow_the_nodal_equations(forced, refined):
    """Independent formulation: spin, modal rates and the velocity of the centre of mass at the end."""
    data, end = forced
    body, c = flexible(data)

    def velocities(x):
        ports = motions(body, c, x)
        return np.concatenate((ports[:, 7:].ravel(), x[13:16]))

    a, b = velocities(refined[1]), velocities(refined[2])
    y = moving_state(body, c, end.eta, end.spin, end.rate)[0]
    y[3:7] = end.orientation
    turn = Rotation.from_quat(np.roll(end.orientation, -1))
    y[10:13] = turn.apply(y[10:13])
    y[7:10] = data.mass * end.velocity
    expected = velocities(y)
    assert np.abs((4 * b - a) / 3 - expected).max() < np.abs(b - a).max() * 1e-3
    assert np.abs(b - a).max() < 1e-3


@pytest.mark.parametrize("name", ["invariant5", "invariant8", "invariant9"])
def test_no_invariant_can_be_dropped(forced, refined, name):
    """Independent formulation: without I5, I8 or I9 the test above would fail by a factor of 1e5 or more."""
    data, end = forced
    less = replace(data, **{name: np.zeros_like(getattr(data, name))})
    found = stepped_with(less, data, 1e-3)
    assert np.abs(coordinates(found) - pose_of(end)).max() > 1e5 * 1e-8


def stepped_with(data, true_data, h):
    body, c = flexible(data)
    x, _ = moving_state(flexible(true_data)[0], c)
    return stepped(body, c, x, wrenches(0.0), h, round(DURATION / h))


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

    The component keeps its series to second order, so each torque errs by |tau| |Psi| theta^3 / 24, which
    moves a mode by at most half the time squared as much.
    """
    data = modal_data(0.0)
    data = replace(data, rotation=0.1 * data.rotation)
    body, c = flexible(data)
    start = moving_state(body, c)[1]
    end = nodal.integrate(nodal_body(data), loads(), start, DURATION)
    a, b = (coordinates(after(data, h, torque=1.0)) for h in (1e-3, 5e-4))
    theta = max(np.linalg.norm(data.rotation[i] @ end.eta) for i in ENDS)
    effect = sum(
        np.linalg.norm(t) * np.linalg.norm(data.rotation[i]) for t, i in zip(TORQUES, ENDS, strict=True)
    )
    bound = effect * theta**3 / 24 * 0.5 * DURATION**2 + np.abs(b - a).max() * 1e-3
    assert bound < 1e-6
    assert np.abs((4 * b - a) / 3 - pose_of(end)).max() < bound


def test_momenta_and_kinetic_energy_are_sums_over_the_nodes():
    """Independent formulation: sums of m v, x m v and m v^2 / 2 over ports at all nodes, to round-off."""
    ports = [{"name": f"n{i}", "point": str(i)} for i in range(len(GRID))]
    body, c = flexible(ports=ports)
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
    force, torque = u.reshape(2, 2, 3)[:, 0], u.reshape(2, 2, 3)[:, 1]
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
    """Conservation law: 500 steps without wrenches, momenta unchanged to round-off (1e-13 of their size).

    They are recomputed from the velocities of all nodes, not read from the state.
    """
    ports = [{"name": f"n{i}", "point": str(i)} for i in range(len(GRID))]
    body, c = flexible(ports=ports)
    x, _ = moving_state(body, c)

    def momenta(x):
        nodes = motions(body, c, x)
        momentum = MASSES[:, None] * nodes[:, 7:10]
        return np.concatenate((momentum.sum(0), np.cross(nodes[:, :3] - x[:3], momentum).sum(0)))

    before = momenta(x)
    now = momenta(stepped(body, c, x, no_wrench(body), 2e-3, 500))
    assert np.abs(now - before).max() < 1e-13 * np.abs(before).max()


def energy(body, c, x):
    names = ("kinetic_energy", "potential_energy", "dissipated_energy")
    return sum(observed(body, c, x, name) for name in names)


def test_energy_of_torque_free_flexible_body_is_bounded_and_second_order():
    """Conservation law: no drift over 1000 steps, and the excursion falls with the square of the step."""
    body, c = flexible(modal_data(damping=0.0))
    start, _ = moving_state(body, c)
    total = energy(body, c, start)
    excursion = []
    for h in (2e-3, 1e-3):
        x, halves = start, []
        for _ in range(2):
            worst = 0.0
            for _ in range(500):
                x = body.step(c, x, no_wrench(body), h)
                worst = max(worst, abs(energy(body, c, x) - total))
            halves.append(worst)
        assert halves[1] < 2.0 * halves[0]
        excursion.append(max(halves))
    assert excursion[0] < 1e-3 * total
    assert excursion[0] / excursion[1] == pytest.approx(4.0, rel=0.25)


@pytest.mark.parametrize("h", [1e-3, 1e-2])
def test_undamped_motion_retraces_itself_with_momenta_reversed(h):
    """Reversibility of mechanics: the step is time-symmetric at any size, which the even error expansion needs.

    The turn of a step is iterated to 1e-12 rad, which twenty steps leave below 1e-10 of the largest state.
    """
    body, c = flexible(modal_data(damping=0.0))
    start, _ = moving_state(body, c)
    sign = np.ones(start.size)
    sign[7:16], sign[-4:] = -1.0, -1.0
    there = stepped(body, c, start, wrenches(), h, 10)
    back = sign * stepped(body, c, sign * there, wrenches(), h, 10)
    assert np.abs(there - start).max() > 0.1
    assert np.abs(back - start).max() < 1e-10 * np.abs(start).max()


def test_torque_free_asymmetric_rotor():
    """Closed form (elliptic functions) and the published w(10 s) of I = (1, 2, 3), w0 = (1, 0.01, 1).

    Extrapolated from h and h/2: the fourth-order rest is h^4 times a constant of order one.
    """
    start, steps = np.array([1.0, 0.01, 1.0]), 2000
    found = []
    for n in (steps, 2 * steps):
        body, c = rigid(initial_angular_velocity=start)
        x = stepped(body, c, body.initial(c, no_wrench(body)), no_wrench(body), 10.0 / n, n)
        found.append(Rotation.from_quat(np.roll(x[3:7], -1)).inv().apply(motions(body, c, x)[0, 10:]))
    value = (4 * found[1] - found[0]) / 3
    exact = free_rotor(np.array([1.0, 2.0, 3.0]), start).angular_velocity(10.0)
    assert np.abs(value - exact).max() < 10 * (10.0 / steps) ** 4 + 1e-11
    assert value == pytest.approx((-0.92490028, 0.38034125, 0.97560930), abs=0.6e-8)


@pytest.mark.parametrize("zeta", [0.0, 0.01, 0.7, 1.0, 1.5])
def test_single_mode_decays_in_closed_form(zeta):
    """Closed form of the damped oscillator in one step of any size, and the energy it lost."""
    data = modal_data(damping=zeta).keep_modes([1])
    body, c = flexible(data)
    w, eta, h = 2 * np.pi * HERTZ[1], 0.2, 0.137
    x = body.initial(c, no_wrench(body))
    x[-2] = eta
    y = body.step(c, x, no_wrench(body), h)
    root = np.emath.sqrt(1.0 - zeta**2) * w
    ratio = h if root == 0 else np.sin(root * h) / root
    decay = np.exp(-zeta * w * h)
    assert y[-2] == pytest.approx(eta * (decay * (np.cos(root * h) + zeta * w * ratio)).real, abs=1e-14)
    assert y[-1] == pytest.approx(eta * (-decay * w * w * ratio).real, abs=1e-13)
    before = 0.5 * (w * eta) ** 2
    assert observed(body, c, y, "dissipated_energy") == pytest.approx(
        before - 0.5 * (y[-1] ** 2 + (w * y[-2]) ** 2), rel=1e-12, abs=1e-13 * before
    )


def test_damping_heat_is_the_energy_lost_of_the_tumbling_body():
    """Closed form of the dissipation against the energy balance, whose rest is the second-order rotation error."""
    body, c = flexible()
    start, _ = moving_state(body, c)
    total = energy(body, c, start)
    rest = []
    for h in (1e-3, 5e-4):
        x = stepped(body, c, start, no_wrench(body), h, round(0.5 / h))
        rest.append(energy(body, c, x) - total)
    heat = observed(body, c, x, "dissipated_energy")
    assert heat > 0.05 * total
    assert abs((4 * rest[1] - rest[0]) / 3) < 1e-6 * heat
    assert abs(rest[1]) < 1e-3 * heat


def test_damping_scale_multiplies_every_ratio():
    """Closed form: no damping without, and the published default of twice the ratio with 2."""
    body, _ = flexible(modal_data(damping=0.03))
    doubled, plain = prepared(body, damping_scale=2.0), flexible(modal_data(damping=0.06))
    x, _ = moving_state(body, doubled)
    assert body.step(doubled, x, wrenches(), 1e-3) == pytest.approx(
        plain[0].step(plain[1], x, wrenches(), 1e-3), rel=1e-14
    )
    undamped = prepared(body, damping_scale=0.0)
    assert body.step(undamped, x, wrenches(), 1e-3)[16] == 0.0


def balanced_pull(body, data, pull=40.0):
    """Opposite forces of two ports along their line, so the body stays where it is."""
    arms = data.point_positions[list(ENDS)]
    line = (arms[1] - arms[0]) / np.linalg.norm(arms[1] - arms[0])
    u = np.zeros(12)
    u[0:3], u[6:9] = -pull * line, pull * line
    return u


PLAIN_PORTS = tuple({"name": p["name"], "point": p["point"]} for p in PORTS)


def test_static_steps_find_the_deflection_and_a_dynamic_step_stays_there():
    """Closed form eta = Phi^T f / w^2 for forces that hardly turn the body; equilibrium of the dynamic step."""
    data = modal_data()
    body, static = flexible(data, ports=PLAIN_PORTS, quasi_static=1.0)
    u = balanced_pull(body, data)
    x = stepped(body, static, body.initial(static, u), u, 0.1, 400)
    assert np.abs(body.step(static, x, u, 0.1) - x).max() < 1e-13
    turn = Rotation.from_quat(np.roll(x[3:7], -1)).as_matrix()
    force = u.reshape(2, 6)[:, :3] @ turn
    expected = sum(data.translation[i].T @ f for i, f in zip(ENDS, force, strict=True)) / data.frequency**2
    assert x[-8:-4] == pytest.approx(expected, abs=1e-13)
    dynamic = prepared(body)
    y = stepped(body, dynamic, x, u, 1e-2, 10)
    assert coordinates(y) == pytest.approx(coordinates(x), abs=1e-11)


def test_static_steps_leave_the_centre_of_a_free_scene_alone():
    """Conservation law: forces that sum to zero do not move the centre of mass; gravity drops it by h^2 g."""
    body, c = flexible(quasi_static=1.0, gravity=(0.0, 0.0, -9.81))
    u = wrenches()
    u[6:9] = -u[0:3]
    x = body.initial(c, u)
    assert body.step(c, x, u, 0.01)[:3] - x[:3] == pytest.approx((0, 0, -9.81e-4), abs=1e-15)


def test_gravity_gives_a_parabola_and_keeps_the_energy():
    """Closed form of the throw at any step size; potential and kinetic energy exchange."""
    gravity = np.array([0.3, -1.0, -9.81])
    body, c = flexible(gravity=gravity, initial_velocity=VELOCITY)
    start = body.initial(c, no_wrench(body))
    x = stepped(body, c, start, no_wrench(body), 0.05, 8)
    assert x[:3] - start[:3] == pytest.approx(0.4 * VELOCITY + 0.08 * gravity, rel=1e-13)
    assert energy(body, c, x) == pytest.approx(energy(body, c, start), rel=1e-13)


def test_initial_parameters_place_and_move_the_construction_frame():
    """Closed form: ports of a rigid body at p + R s with velocity v + w x (R s), v that of the centre of mass."""
    turn = Rotation.from_rotvec((0.4, -1.1, 0.7))
    place, velocity, spin = np.array([1.0, 2.0, 3.0]), VELOCITY, SPIN
    center = np.array([0.2, -0.1, 0.3])
    data = ModalData.rigid(2.0, center, np.diag((1.0, 2.0, 2.5)), {"p": (0.5, 0.6, -0.7)})
    port_turn = Rotation.from_rotvec((0.2, 0.3, -0.9))
    ports = [
        {
            "name": "p",
            "point": "p",
            "offset": (0.1, 0.0, -0.2),
            "orientation": tuple(np.roll(port_turn.as_quat(), 1)),
        }
    ]
    body = Body(modal=data.to_arrays(), ports=ports)
    c = prepared(
        body,
        initial_position=place,
        initial_orientation=np.roll(turn.as_quat(), 1),
        initial_velocity=velocity,
        initial_angular_velocity=spin,
    )
    x = body.initial(c, no_wrench(body))
    port = motions(body, c, x)[0]
    arm = turn.apply(np.array([0.6, 0.6, -0.9]))
    assert port[:3] == pytest.approx(place + arm)
    assert Rotation.from_quat(np.roll(port[3:7], -1)).as_matrix() == pytest.approx(
        (turn * port_turn).as_matrix()
    )
    assert port[7:10] == pytest.approx(velocity + np.cross(spin, arm - turn.apply(center)))
    assert port[10:13] == pytest.approx(spin)
    assert observed(body, c, x, "frame_position") == pytest.approx(place)
    assert observed(body, c, x, "angular_momentum") == pytest.approx(
        np.cross(place + turn.apply(center), 2.0 * velocity)
        + turn.apply(data.inertia @ turn.inv().apply(spin))
    )


def test_port_velocities_are_derivatives_of_port_poses():
    """Finite differences across two steps about their middle: second order in h, extrapolated to the fourth.

    The port's orientation is q exp(Psi eta); its angular velocity has the left Jacobian, series to second
    order, hence the bound theta^3 / 24 of the local twist.
    """
    data = modal_data()
    data = replace(data, rotation=0.2 * data.rotation)
    turned = dict(PORTS[1], orientation=(np.cos(0.3), 0.0, np.sin(0.3), 0.0))
    body, c = flexible(data, ports=(PORTS[0], turned))
    rate = np.array([0.9, -1.2, 0.5, 0.3])
    start, _ = moving_state(body, c, rate=rate)

    def differences(h):
        """Port rates by difference minus port rates given, in the middle."""
        x = body.step(c, start, wrenches(), h)
        behind, now, ahead = (motions(body, c, s) for s in (start, x, body.step(c, x, wrenches(), h)))
        spin = [
            (Rotation.from_quat(np.roll(a, -1)) * Rotation.from_quat(np.roll(b, -1)).inv()).as_rotvec()
            for a, b in zip(ahead[:, 3:7], behind[:, 3:7], strict=True)
        ]
        return np.hstack(((ahead - behind)[:, :3], spin)) / (2 * h) - now[:, 7:]

    coarse, middle, fine = (differences(h) for h in (1e-3, 5e-4, 2.5e-4))
    extrapolated = (4 * fine - middle) / 3
    # the middle moves with h, so odd powers stay: the next term shrinks by 8 per halving
    bound = np.abs(extrapolated - (4 * middle - coarse) / 3).max() / 4
    theta = max(np.linalg.norm(data.rotation[i] @ ETA) for i in ENDS)
    twist = max(np.linalg.norm(data.rotation[i] @ rate) for i in ENDS)
    assert bound < 1e-4
    assert np.abs(extrapolated[:, :3]).max() < bound
    assert np.abs(extrapolated[:, 3:]).max() < bound + twist * theta**3 / 24


def test_port_mobility_at_rest():
    """Closed form: rigid part plus X diag(b(h)) X^T, for poses and for rates; central differences."""
    data = modal_data()
    body, c = flexible(data)
    x = body.initial(c, no_wrench(body))
    h, amplitude = 0.02, 1e-4
    columns = []
    for k in range(12):
        u = np.zeros(12)
        u[k] = amplitude
        up, down = (motions(body, c, body.step(c, x, s * u, h)) for s in (1, -1))
        difference = (up - down) / (2 * amplitude)
        # a small turn is twice the vector part of its quaternion; the first port's axes are the body's
        columns.append(np.hstack((difference[:, :3], 2 * difference[:, 4:7], difference[:, 7:])).ravel())
    found = np.array(columns).T.reshape(2, 12, 12)

    motion = []
    for node, offset in zip(ENDS, OFFSETS, strict=True):
        arm = data.point_positions[node] - data.center_of_mass + np.array(offset)
        elastic = data.translation[node] - nodal.cross_matrix(np.array(offset)) @ data.rotation[node]
        rigid_part = np.block([[np.eye(3), -nodal.cross_matrix(arm)], [np.zeros((3, 3)), np.eye(3)]])
        motion.append((rigid_part, np.vstack((elastic, data.rotation[node]))))
    rigid_rows, shapes = (np.vstack(part) for part in zip(*motion, strict=True))
    inverse = np.zeros((6, 6))
    inverse[:3, :3] = np.eye(3) / data.mass
    inverse[3:, 3:] = np.linalg.inv(data.inertia)
    modal = propagator(data.frequency, data.damping_ratio, h)
    pose = 0.5 * h * h * rigid_rows @ inverse @ rigid_rows.T + shapes @ np.diag(modal.b1) @ shapes.T
    rate = h * rigid_rows @ inverse @ rigid_rows.T + shapes @ np.diag(modal.b2) @ shapes.T
    for port in range(2):
        rows = slice(6 * port, 6 * port + 6)
        assert found[port, :6] == pytest.approx(pose[rows], rel=1e-7, abs=1e-7 * np.abs(pose).max())
        assert found[port, 6:] == pytest.approx(rate[rows], rel=1e-7, abs=1e-7 * np.abs(rate).max())


def test_rigid_spin_up_by_a_held_torque():
    """Closed form: about a principal axis, w = T t / I and the angle T t^2 / 2 I, exact at any step size."""
    body, c = rigid()
    u = no_wrench(body)
    u[5] = 0.6
    x = stepped(body, c, body.initial(c, u), u, 0.1, 10)
    assert motions(body, c, x)[0, 12] == pytest.approx(0.2, rel=1e-13)
    assert 2 * np.arctan2(x[6], x[3]) == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mass": 0.0}, "mass is 0 kg; it must be positive"),
        ({"inertia": np.diag((1.0, 1.0, 2.5))}, "triangle inequality"),
        ({"inertia": np.diag((1.0, 1.0, -0.5))}, "must be positive"),
        ({"frequency": np.array([0.0, 1.0, 2.0, 3.0])}, "positive frequency"),
    ],
)
def test_impossible_bodies_are_refused(change, words):
    """Laws of mechanics: masses, principal moments and frequencies that cannot be are named in a sentence."""
    with pytest.raises(ComponentError, match=words):
        flexible(replace(modal_data(), **change))
    with pytest.raises(ComponentError, match="there is no point 'nowhere'"):
        flexible(ports=[{"name": "a", "point": "nowhere"}])
