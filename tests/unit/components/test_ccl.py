"""Cable loops: published statics, force balance, energy, and the stiff loop as a one-coordinate mechanism."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.ccl import CableLoop
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.closed_forms import spring_driven_angle
from tests.references.coupled import base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, work
from tests.unit.components.prepared import made

R1, R2, FREE, PRELOAD, STIFFNESS = 0.06, 0.03, 0.95, 40.0, 5000.0
DISTANCE = np.hypot(FREE, R1 - R2)
STRANDS = (56.101, 23.899)
AXIS = (0.0, 1.0, 0.0)


def loop(mode="mean", guided=False, **change):
    start = {"radius_1": R1, "radius_2": R2, "preload": PRELOAD, "strand_stiffness": STIFFNESS, **change}
    return made(CableLoop, mode, {"axis": AXIS, "guided": guided}, **start)


def motions(component, turn_1=0.0, turn_2=0.0, turn_link=0.0, shift=(0.0, 0.0, 0.0)):
    """Pulley 1 at the origin, pulley 2 along x, turned about the axis; the guide turns with `turn_link`."""
    place = np.array([DISTANCE, 0.0, 0.0]) + shift
    ports = [port_motion((0, 0, 0), (0, turn_1, 0)), port_motion(place, (0, turn_2, 0))]
    if len(component.ports) == 3:
        ports.append(port_motion((0.5, 0, 0), (0, turn_link, 0)))
    return inputs(component, *ports)


def observed(component, c, x, u):
    z = component.observe(c, x, u)
    return {
        q.name: float(z[component.observation_layout[q.name]][0])
        for q in component.observation_layout.quantities
    }


def turn_for(tension):
    """Turn of pulley 1 against the strands that brings strand a from the preload to a tension."""
    return -(tension - PRELOAD) / STIFFNESS / R1


def loaded(mode="endpoint", guided=False):
    component, c = loop(mode, guided)
    start = motions(component)
    x = component.initial(c, start)
    return component, c, x, motions(component, turn_for(STRANDS[0]))


def test_published_statics():
    """Reference: r 60 and 30 mm, L 0.95 m, strands 23.899 and 56.101 N; to the digits given."""
    component, c, x, u = loaded()
    z = observed(component, c, x, u)
    assert (z["tension_a"], z["tension_b"]) == pytest.approx(STRANDS, rel=1e-12)
    assert z["torque_1"] == pytest.approx(1.93212, abs=5e-6)
    assert z["torque_2"] == pytest.approx(-0.96606, abs=5e-6)
    assert z["axial_force"] == pytest.approx(79.96014, abs=5e-6)
    assert z["lateral_force"] == pytest.approx(-1.01640, abs=5e-6)
    balance = z["torque_1"] + z["torque_2"] + z["lateral_force"] * DISTANCE
    assert balance == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("turns", [(-0.05, 0.0), (0.02, -0.03), (0.01, 0.08)])
def test_equations_2_3_to_2_6(turns):
    """Bagnoli 2007, 2.3 to 2.6, with L the free strand: T1 and T2 from tensions, axial and lateral forces.

    The wrench on pulley 2 has the components of the observations; the lateral direction is axis x centre line.
    """
    component, c, x, _ = loaded()
    u = motions(component, *turns)
    a, b = (PRELOAD + sign * STIFFNESS * (-R1 * turns[0] + R2 * turns[1]) for sign in (1, -1))
    z = observed(component, c, x, u)
    assert (z["tension_a"], z["tension_b"]) == pytest.approx((a, b), rel=1e-12)
    force = component.outputs(c, x, u).reshape(2, 6)
    assert force[0, 3:] == pytest.approx((0, R1 * (a - b), 0), abs=1e-12)
    assert force[1, 3:] == pytest.approx((0, -R2 * (a - b), 0), abs=1e-12)
    cosine, sine = FREE / DISTANCE, (R1 - R2) / DISTANCE
    expected = -(a + b) * cosine * np.array([1.0, 0, 0]) - (a - b) * sine * np.cross(AXIS, (1.0, 0, 0))
    assert force[1, :3] == pytest.approx(expected, abs=1e-11)
    assert z["axial_force"] == pytest.approx(-force[1, 0], rel=1e-12)
    assert z["lateral_force"] == pytest.approx(np.cross(AXIS, (1.0, 0, 0)) @ force[1, :3], rel=1e-11)
    assert z["synchronization_error"] == pytest.approx((a - b) / (2 * STIFFNESS), abs=1e-15)


def test_guided_cable_puts_its_torque_on_the_guide():
    """Law of the guided loop: torques r (Ta - Tb) on the pulleys, -(T1 + T2) on the guide, no lateral force."""
    component, c, x, u = loaded(guided=True)
    force = component.outputs(c, x, u).reshape(3, 6)
    t1, t2 = R1 * (STRANDS[0] - STRANDS[1]), -R2 * (STRANDS[0] - STRANDS[1])
    assert force[:, 4] == pytest.approx((t1, t2, -(t1 + t2)), rel=1e-12)
    assert force[1, :3] == pytest.approx((-sum(STRANDS), 0, 0), abs=1e-11)
    assert force[2, :3] == pytest.approx(0.0)
    assert observed(component, c, x, u)["lateral_force"] == 0.0


@pytest.mark.parametrize("guided", [False, True])
@given(turn=st.floats(-40.0, 40.0))
def test_tension_is_never_negative(guided, turn):
    """Law of a cable: a slack strand carries nothing, the other one at least the preload, after any turn."""
    component, c = loop("endpoint", guided)
    x = component.initial(c, motions(component))
    steps = np.linspace(0.0, turn, int(abs(turn)) + 2)
    for angle in steps:
        u = motions(component, angle)
        x = component.step(c, x, u, 0.1)
    z = observed(component, c, x, u)
    assert min(z["tension_a"], z["tension_b"]) == pytest.approx(
        max(0.0, PRELOAD - STIFFNESS * R1 * abs(turn)), abs=1e-8
    )
    assert max(z["tension_a"], z["tension_b"]) == pytest.approx(
        PRELOAD + STIFFNESS * R1 * abs(turn), rel=1e-9
    )


@pytest.mark.parametrize("order", [2.0, 4.0])
@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_damping_never_pushes(mode, order):
    """Law of a cable: strands that shorten faster than their damper lets go carry nothing.

    Pulley 2 comes nearer by 2 mm in 1 ms: 10 N less of 40, and a damper of 50 N.s/m would push with 100 N.
    """
    if (mode, order) == ("endpoint", 4.0):
        pytest.skip("order 4 is that of mean wrenches")
    component, c = loop(mode, strand_damping=50.0, **({"order": order} if mode == "mean" else {}))
    start = motions(component)
    nearer = motions(component, shift=(-2e-3, 0.0, 0.0))
    place = component.input_layout["pulley_2.velocity"]
    nearer[place] = (-2.0, 0.0, 0.0)
    x = component.step(c, component.initial(c, start), nearer, 1e-3)
    y = component.outputs(c, x, nearer)
    assert y[component.output_layout["pulley_2.force"]] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    z = observed(component, c, x, nearer)
    assert (z["tension_a"], z["tension_b"]) == (0.0, 0.0)
    assert z["dissipated_energy"] > 0.0


@pytest.mark.parametrize("guided", [False, True])
def test_work_in_space_is_the_change_of_energy_to_second_order(guided):
    """Discrete gradient for planar motions at large: the rest per step goes with the cube of the step."""
    component, c = loop("mean", guided)
    rest = []
    for s in (1.0, 0.5, 0.25):
        u0, u1 = (
            inputs(
                component,
                *(
                    port_motion((0.1 * v, 0, 0.2 * v), (0, 0.3 * v, 0)),
                    port_motion((DISTANCE + 0.05 * v, 0, -0.3 * v), (0, -0.5 * v, 0)),
                    port_motion((0.5, 0, 0), (0, 0.4 * v, 0)),
                )[: len(component.ports)],
            )
            for v in (-0.5 * s, 0.5 * s)
        )
        x0 = component.initial(c, motions(component))
        x0 = component.step(c, x0, u0, 1.0)
        x1 = component.step(c, x0, u1, 0.1)
        stored = [observed(component, c, x, u)["potential_energy"] for x, u in ((x0, u0), (x1, u1))]
        rest.append(work(component.outputs(c, x1, u1), u0, u1, len(component.ports)) + stored[1] - stored[0])
    orders = np.log2(np.abs(rest[:-1]) / np.abs(rest[1:]))
    assert np.all(orders > 2.7)


def test_endpoint_and_mean_wrench_agree_in_the_limit():
    """Consistency: the mean over a vanishing step is the end-point wrench, damping included."""
    mean, c = loop("mean", strand_damping=20.0)
    endpoint, d = loop("endpoint", strand_damping=20.0)
    spin_1, spin_2, velocity = 0.7, -0.4, np.array([0.3, 0.0, -0.2])

    def at(component, t):
        return inputs(
            component,
            port_motion((0, 0, 0), (0, spin_1 * t, 0), (0, 0, 0), (0, spin_1, 0)),
            port_motion((DISTANCE, 0, 0) + velocity * t, (0, spin_2 * t, 0), velocity, (0, spin_2, 0)),
        )

    differences = []
    for h in (1e-3, 5e-4):
        x = mean.initial(c, at(mean, 0.0))
        y = mean.step(c, x, at(mean, h), h)
        end = endpoint.outputs(d, endpoint.initial(d, at(endpoint, 0.0)), at(endpoint, h))
        differences.append(np.abs(mean.outputs(c, y, at(mean, h))[:12] - end).max())
    # first order: half a step times the force's rate of change, at most 2 k v plus the turning of 80 N
    assert differences[0] < 1e-3 * (STIFFNESS * 0.4 + 80.0)
    assert differences[0] / differences[1] == pytest.approx(2.0, rel=0.05)


def test_distance_changes_strands_by_the_open_belt_length():
    """Closed form of an open belt: strand sqrt(d^2 - (r1-r2)^2) plus the change of wrap, found by its arcs."""
    component, c, x, _ = loaded()
    z = observed(component, c, x, motions(component, shift=(0.004, 0.0, 0.0)))

    def belt(d):
        lean = np.arcsin((R1 - R2) / d)
        return np.sqrt(d**2 - (R1 - R2) ** 2) + R1 * (np.pi / 2 + lean) + R2 * (np.pi / 2 - lean)

    expected = PRELOAD + STIFFNESS * (belt(DISTANCE + 0.004) - belt(DISTANCE))
    assert (z["tension_a"], z["tension_b"]) == pytest.approx((expected, expected), rel=1e-12)


def test_hold_adjusts_the_strands_to_their_preload():
    """Definition: held, the loop has its preload in any pose, and starts from there."""
    component, c, x, u = loaded("mean")
    u[component.input_layout["hold"]] = 1.0
    y = component.step(c, x, u, 0.1)
    z = observed(component, c, y, u)
    assert (z["tension_a"], z["tension_b"]) == pytest.approx((PRELOAD, PRELOAD), rel=1e-13)
    assert component.outputs(c, y, u)[:12].reshape(2, 6)[1, :3] == pytest.approx(
        (-2 * PRELOAD * FREE / DISTANCE, 0, 0), abs=1e-11
    )


def synchronised(radius_1, radius_2, strand, guided, until=1.5):
    """A link on a fixed base with a wheel on its end; the loop runs from the base to the wheel."""
    stiff = {
        "translational_stiffness": (1e8,) * 3,
        "translational_damping": (1e3,) * 3,
        "rotational_stiffness": (0.0, 1e6, 1e6),
        "rotational_damping": (0.0, 1e2, 1e2),
    }
    motor = {"motor_stiffness": 0.05, "motor_wind_up": 8.0}
    points = {"root": (0, 0, 0), "tip": (1, 0, 0), **({"cable": (0.5, 0, 0)} if guided else {})}
    parts = [
        base(root=(0, 0, 0), pulley=(0, 0, 0)),
        rigid("link", 2.0, (0.5, 3.0, 3.0), points),
        rigid(
            "wheel",
            3.0,
            (0.7, 0.8, 0.9),
            {"hub": (0, 0, 0), "pulley": (0, 0, 0)},
            initial_position=(1.0, 0, 0),
        ),
        Part("root_hinge", "hinge", {"axis": (0, -1, 0)}, {**stiff, **motor}),
        Part("tip_hinge", "hinge", {"axis": (0, -1, 0)}, stiff),
        Part(
            "cable",
            "ccl",
            {"axis": (0, -1, 0), "guided": guided},
            {
                "radius_1": radius_1,
                "radius_2": radius_2,
                "preload": 200.0,
                "strand_stiffness": strand,
                "strand_damping": 1e-4 * strand,
            },
        ),
    ]
    links = [
        *between("root_hinge", "base.root", "link.root"),
        *between("tip_hinge", "link.tip", "wheel.hub"),
        *between("cable", "base.pulley", "wheel.pulley", ("pulley_1", "pulley_2")),
    ]
    if guided:
        links += between("cable", "link.cable", "link.cable", ("guide", "guide"))[:1]
    return completed(until, parts, links, settings=Settings(tolerance=1e-6, fixed_step=0.01))


@pytest.mark.parametrize(
    ("radius_1", "radius_2", "guided"), [(0.06, 0.03, False), (0.05, 0.05, False), (0.04, 0.06, True)]
)
def test_stiff_loop_makes_one_coordinate(radius_1, radius_2, guided):
    """Closed form: r1 phi1 = r2 phi2 makes the pair a spring-driven rotor of inertia J + m d^2 + Jw (1 - r1/r2)^2.

    The wheel turns by -r1/r2 against the link. The loop errs by what its strands give, torque / (2 k r2); the
    angle by that over r1, by (w h)^2 of itself for the step, by 1e-6 for the iteration (1e-9 of the 400 N in the
    strands, on 1 m, against 0.4 N.m), and by 8e-6 for the inertia, as 400 N press 1e8 N/m at two hinges.
    """
    strand = 1e6
    run = synchronised(radius_1, radius_2, strand, guided)
    angle, wheel = run.signal("root_hinge", "angle"), run.signal("tip_hinge", "angle")
    inertia = 3.0 + 3.0 + 0.8 * (1 - radius_1 / radius_2) ** 2
    times = np.array(run.times)
    expected = np.array([spring_driven_angle(inertia, 0.05, 8.0, t) for t in times])
    assert expected[-1] > 0.06
    # the strands carry what turns the wheel; twice the static give, as for any load applied at once
    give = 0.8 * (0.05 * 8.0 / inertia) * abs(1 - radius_1 / radius_2) / (2 * strand * radius_2)
    assert np.abs(radius_1 * angle + radius_2 * wheel).max() < 2 * give + 1e-9
    assert np.abs(run.signal("cable", "synchronization_error")).max() < 2 * give + 1e-9
    square = 0.05 / inertia * 0.01**2
    assert angle[-1] == pytest.approx(expected[-1], abs=2 * give / radius_1 + (square + 9e-6) * expected[-1])
